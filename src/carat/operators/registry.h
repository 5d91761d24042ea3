#pragma once
// All operators by name.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// What the literature promises of an operator; the claim tests hold it to that. Where it denies a
/// property, the tests assert that it fails somewhere.
struct OperatorClaims {
  bool symmetric = true;
  bool semidefinite = true;            ///< stiffness is positive semidefinite
  bool kernel_is_constants = true;     ///< one dimension a connected component
  bool linear_precision = true;        ///< S x = 0 at inner vertices of planar and volume meshes
  bool gradient = true;                ///< defines a gradient
  bool divergence_of_gradient = true;  ///< L = D G; no stabilising term beside it
  /// The mass sums to the measure of the virtual refinement, not of vector areas.
  bool total_mass = true;
  bool positive_mass = true;  ///< the mass is positive definite on any sound mesh
  /// No positive entry off the diagonal of S in rows of inner vertices of Delaunay meshes.
  bool maximum_principle = false;
  bool second_order = true;  ///< Poisson's equation, error at the vertices
  /// On triangles, tetrahedra: linear finite elements.
  bool equals_cotan_on_simplices = false;
  bool simplices_only = false;  ///< defined on triangles, tetrahedra only
  bool face_local = false;      ///< couples vertices of common faces, in volumes cells, only
  bool vertex_unknowns = true;  ///< no unknowns beyond the vertices
};

/// Which of DiscretizationOptions an operator has a use for; the others are errors.
struct OperatorOptionSet {
  std::vector<MassKind> masses{MassKind::Full, MassKind::Lumped};  ///< the default first
  bool virtual_vertex = false;
  std::optional<double> lambda{};           ///< its default
  std::optional<bool> boundary_unknowns{};  ///< its default
  std::optional<double> theta{};            ///< its default
  std::optional<double> tau{};              ///< of the moment-exact mass, its default
  bool products = false;                    ///< OperatorForm::Products
  bool own_interfaces = false;              ///< its samples belong to interfaces
  bool tensor_coefficient = true;           ///< symmetric tensors in cell_coefficient
  bool stiffness_alone = false;             ///< DiscretizationParts::Stiffness saves something
};

/// What a user wants to know before choosing; docs/operators.md is made of it.
struct OperatorCard {
  const char* definition;  ///< the formula, in words and symbols
  const char* unknowns;
  const char* sparsity;
  const char* when;  ///< when to use it, and when not
  const char* references;
};

/// One operator on meshes of one kind.
template <class Mesh>
struct OperatorEntry {
  const char* name;      ///< as on the command line
  const char* title;     ///< one line
  const char* citation;  ///< where it comes from
  OperatorClaims claims;
  OperatorOptionSet options;
  OperatorCard card;
  /// The symbolic phase, with options that have been checked and hold no default.
  std::unique_ptr<Assembly> (*make)(const Mesh&, const DiscretizationOptions&);

  /// The options with the operator's own defaults in place of what was left open.
  /// \throws InvalidOption  one that the operator has no use for, or a bad value
  DiscretizationOptions settle(const DiscretizationOptions& options) const;
  /// Settles the options and runs the symbolic phase.
  /// \throws InvalidOption  as settle()
  /// \throws InvalidMesh    a simplex operator on other elements
  std::unique_ptr<Assembly> prepare(const Mesh& mesh, const DiscretizationOptions& options) const;
};
using SurfaceOperator = OperatorEntry<PolygonMesh>;
using VolumeOperator = OperatorEntry<PolyhedralMesh>;

/// "full", "moment-exact", "lumped", "voronoi", "default".
const char* mass_kind_name(MassKind kind);

/// In the order of operators.def; the first is the one whose matrices are given where none is
/// named.
const std::vector<const SurfaceOperator*>& surface_operators();
const std::vector<const VolumeOperator*>& volume_operators();

/// \throws InvalidOption  unknown name; the message lists the known ones
const SurfaceOperator& surface_operator(const std::string& name);
const VolumeOperator& volume_operator(const std::string& name);

/// For operators that couple more than the vertices of one face or cell: assembles the stiffness of
/// bunge on the same mesh, with the same coefficient. It has a fifth to a half of the entries and
/// is spectrally equivalent, so that preconditioners are built from it. Empty: there is nothing
/// sparser.
/// \param mesh  must outlive the function
std::function<SparseMatrix()> sparser_stiffness(const PolygonMesh& mesh,
                                                const Discretization& discretization);
std::function<SparseMatrix()> sparser_stiffness(const PolyhedralMesh& mesh,
                                                const Discretization& discretization);

/// Both phases at once.
/// \throws InvalidOption      an unknown operator, or an option that it has no use for
/// \throws InvalidMesh        a simplex operator on other elements
/// \throws DegenerateElement  with DegeneratePolicy::Strict
Discretization discretize(const PolygonMesh& mesh, const std::string& operator_name = "diamond",
                          const DiscretizationOptions& options = {});
Discretization discretize(const PolyhedralMesh& mesh, const std::string& operator_name = "diamond",
                          const DiscretizationOptions& options = {});

}  // namespace carat
