#pragma once
// All operators by name.

#include <memory>
#include <string>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// What the literature promises of an operator; the claim tests hold it to that.
struct OperatorClaims {
  bool symmetric = true;
  bool semidefinite = true;         ///< stiffness is positive semidefinite
  bool kernel_is_constants = true;  ///< one dimension a connected component
  bool linear_precision = true;     ///< S x = 0 at inner vertices of planar and volume meshes
  /// On triangles, tetrahedra: linear finite elements.
  bool equals_cotan_on_simplices = false;
  bool simplices_only = false;  ///< defined on triangles, tetrahedra only
  bool face_local = false;      ///< couples vertices of common faces, in volumes cells, only
};

/// One operator on meshes of one kind.
template <class Mesh>
struct OperatorEntry {
  const char* name;      ///< as on the command line
  const char* title;     ///< one line
  const char* citation;  ///< where it comes from
  OperatorClaims claims;
  /// Runs the symbolic phase.
  std::unique_ptr<Assembly> (*prepare)(const Mesh&, const DiscretizationOptions&);
};
using SurfaceOperator = OperatorEntry<PolygonMesh>;
using VolumeOperator = OperatorEntry<PolyhedralMesh>;

#define CARAT_SURFACE_OPERATOR(name) extern const SurfaceOperator name##_surface_operator;
#define CARAT_VOLUME_OPERATOR(name) extern const VolumeOperator name##_volume_operator;
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR
#undef CARAT_VOLUME_OPERATOR

/// In the order of operators.def; the first is the default.
const std::vector<const SurfaceOperator*>& surface_operators();
const std::vector<const VolumeOperator*>& volume_operators();

/// \throws InvalidOption  unknown name; the message lists the known ones
const SurfaceOperator& surface_operator(const std::string& name);
const VolumeOperator& volume_operator(const std::string& name);

/// Both phases at once.
/// \throws InvalidOption, DegenerateElement, InvalidMesh  (a simplex operator on other elements)
Discretization discretize(const PolygonMesh& mesh, const std::string& operator_name = "diamond",
                          const DiscretizationOptions& options = {});
Discretization discretize(const PolyhedralMesh& mesh, const std::string& operator_name = "diamond",
                          const DiscretizationOptions& options = {});

}  // namespace carat
