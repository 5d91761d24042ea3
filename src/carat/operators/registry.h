#pragma once
// All operators by name.

#include <memory>
#include <string>
#include <vector>

#include "carat/operators/discretization.h"

namespace carat {

/// What the literature promises of an operator; the claim tests hold it to that.
struct OperatorClaims {
  bool symmetric = true;
  bool semidefinite = true;         ///< stiffness is positive semidefinite
  bool kernel_is_constants = true;  ///< one dimension a connected component
  bool linear_precision = true;     ///< S x = 0 at inner vertices of planar meshes
  bool equals_cotan_on_triangles = false;
  bool triangles_only = false;
  bool face_local = false;  ///< couples vertices of common faces only
};

/// One operator on polygon meshes.
struct SurfaceOperator {
  const char* name;      ///< as on the command line
  const char* title;     ///< one line
  const char* citation;  ///< where it comes from
  OperatorClaims claims;
  /// Runs the symbolic phase.
  std::unique_ptr<Assembly> (*prepare)(const PolygonMesh&, const DiscretizationOptions&);
};

#define CARAT_SURFACE_OPERATOR(name) extern const SurfaceOperator name##_surface_operator;
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR

/// In the order of operators.def; the first is the default.
const std::vector<const SurfaceOperator*>& surface_operators();

/// \throws InvalidOption  unknown name; the message lists the known ones
const SurfaceOperator& surface_operator(const std::string& name);

/// Both phases at once.
/// \throws InvalidOption, DegenerateElement, InvalidMesh  (a triangle operator on other faces)
Discretization discretize(const PolygonMesh& mesh, const std::string& operator_name = "diamond",
                          const DiscretizationOptions& options = {});

}  // namespace carat
