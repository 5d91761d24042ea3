#pragma once
// The problems of the experiments, with exact solutions, and the methods that are compared on them.

#include <memory>
#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "cli/experiments/experiment.h"

namespace carat::cli {

/// An operator with a mass and the parameters that it leaves open.
struct Method {
  std::string name;
  MassKind mass = MassKind::Default;
  std::optional<double> theta{}, tau{};
};

/// Those of the published operators that are defined on the family, with their default masses, and
/// ours. Surfaces and volumes.
std::vector<Method> compared_methods(const std::string& family);

/// Options of a method, and the parameters that name it: operator, mass, theta, tau.
DiscretizationOptions options_of(const Method& method, DiscretizationParts parts, int threads);
template <class Mesh>
Json parameters_of(const Method& method);

/// Generates meshes, and keeps the last one: cases of one mesh follow each other.
template <class Mesh>
class MeshSource {
 public:
  const Mesh& get(const std::string& family, const FamilyOptions& options);

 private:
  std::string key_;
  Mesh mesh_;
};

/// vertices, mean_edge, max_edge.
template <class Mesh>
Json sizes_of(const Mesh& mesh);

/// A function with its Laplacian.
struct TestFunction {
  double (*value)(const Vec3&);
  double (*laplacian)(const Vec3&);
};
extern const TestFunction kFranke, kFranke3d, kWaves, kWaves3d;

/// Eigenfunctions of the unit sphere: third degree, order -1, of eigenvalue 12; fourth degree,
/// order 1, of eigenvalue 20.
double third_harmonic(const Vec3& x);
double fourth_harmonic(const Vec3& x);

template <class Mesh>
Vector values_at(const Mesh& mesh, double (*function)(const Vec3&));

/// Solves S u = M f for several masses with the exact values at boundary vertices.
/// \return root mean squares of the error over the other vertices
template <class Mesh>
std::vector<double> dirichlet_errors(const Mesh& mesh, const SparseMatrix& stiffness,
                                     const std::vector<const SparseMatrix*>& masses,
                                     const TestFunction& function);
/// The same where the operator has unknowns beyond the vertices; with its own mass.
double dirichlet_error(const PolyhedralMesh& mesh, const Discretization& discretization,
                       const TestFunction& function);

/// S u = M f on a closed surface, f an eigenfunction of that eigenvalue; up to a constant.
std::vector<double> sphere_poisson_errors(const SparseMatrix& stiffness,
                                          const std::vector<const SparseMatrix*>& masses,
                                          const Vector& eigenfunction, double eigenvalue);
/// Root mean square of M^-1 S f - eigenvalue f; null if M is not positive definite.
Json applied_error(const SparseMatrix& stiffness, const SparseMatrix& mass,
                   const Vector& eigenfunction, double eigenvalue);
/// Root mean square of H - 1 on the unit sphere; null as above.
Json sphere_curvature_error(const PolygonMesh& mesh, Discretization discretization);

double root_mean_square(const Vector& errors);

}  // namespace carat::cli
