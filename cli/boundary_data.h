#pragma once
// Boundary conditions and coefficients of Poisson's equation from the command line.

#include <optional>
#include <string>
#include <vector>

#include "carat/apps/boundary_conditions.h"
#include "cli/expression.h"
#include "cli/mesh_kinds.h"
#include "cli/operator_options.h"

namespace carat::cli {

/// Values on the boundary: [PATCH=]EXPR as often as wanted. An expression without a patch holds on
/// the sides that no other one of the same option names.
class BoundaryExpressions {
 public:
  /// \throws InvalidOption  an expression does not parse, or a patch is named twice
  BoundaryExpressions(std::string option, const std::vector<std::string>& texts);

  bool empty() const { return entries_.empty(); }
  /// The expression where it is the only one and names no patch, else nullptr.
  const Expression* everywhere() const {
    return entries_.size() == 1 && entries_[0].patch.empty() ? &entries_[0].value : nullptr;
  }
  /// Entry of each of the sides, -1: none. Those with a patch come before the one without.
  /// \throws InvalidOption  a patch that the mesh does not have, or one without faces
  template <class Data>
  std::vector<int> entries_of(const Data& data, const std::vector<Index>& sides) const;
  double value(int entry, const Vec3& point) const {
    return entries_[static_cast<std::size_t>(entry)].value(point);
  }

 private:
  struct Entry {
    std::string patch;
    Expression value;
  };
  int of_patch(std::span<const BoundaryPatch> patches, std::size_t entry) const;

  std::string option_;
  std::vector<Entry> entries_;  // the one without a patch last
};

/// What the options of the command say of the boundary.
struct BoundaryData {
  BoundaryExpressions dirichlet, neumann, robin;
  std::optional<Expression> dirichlet_where;
};

/// Dirichlet data at the vertices, Neumann and Robin data on the sides with a free vertex.
/// \throws InvalidOption  data for which there is no place
BoundaryConditions boundary_conditions(const SurfaceData& data, const BoundaryData& given);
BoundaryConditions boundary_conditions(const VolumeData& data, const BoundaryData& given);

/// A field of the cells as the coefficient: 1 component, 6 (xx yy zz xy yz xz) or 9 (row by row).
/// \throws InvalidOption  no such field, another number of components, a tensor that is not
///                        symmetric, a surface
Matrix cell_coefficient(const SurfaceData& data, const std::string& name);
Matrix cell_coefficient(const VolumeData& data, const std::string& name);

}  // namespace carat::cli
