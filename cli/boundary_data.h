#pragma once
// Boundary conditions and coefficients of Poisson's equation from the command line.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "carat/apps/boundary_conditions.h"
#include "cli/expression.h"
#include "cli/mesh_kinds.h"
#include "cli/operator_options.h"

namespace carat::cli {

/// The boundary of a mesh, or of a part of one.
template <class Mesh>
struct Boundary {
  const Mesh& mesh;
  std::vector<Index> sides;  ///< those whose data are this part's to give, ascending
  std::span<const BoundaryPatch> patches;
};

/// How the parts of a boundary agree, each in a process of its own. Of a whole mesh there is one.
class BoundaryParts {
 public:
  virtual ~BoundaryParts() = default;
  /// Runs work that may throw; if it does in one part, all throw.
  virtual void together(const std::function<void()>& work) const { work(); }
  /// Sums over all parts.
  virtual std::vector<std::int64_t> sum(std::vector<std::int64_t> counts) const { return counts; }
  /// The lowest of all parts' entries of every vertex that is not -1.
  virtual void take_lowest(std::vector<int>& entry_of_vertex) const {
    static_cast<void>(entry_of_vertex);
  }
  /// Whether a vertex counts here; each does in one part.
  virtual bool owns(Index vertex) const { return vertex >= 0; }
};

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
  /// \param n_patch_faces  of every patch of the whole mesh
  /// \throws InvalidOption  a patch that the mesh does not have, or one without faces
  template <class Mesh>
  std::vector<int> entries_of(const Boundary<Mesh>& boundary,
                              std::span<const std::int64_t> n_patch_faces) const;
  double value(int entry, const Vec3& point) const {
    return entries_[static_cast<std::size_t>(entry)].value(point);
  }

 private:
  struct Entry {
    std::string patch;
    Expression value;
  };
  int of_patch(std::span<const BoundaryPatch> patches, std::span<const std::int64_t> n_faces,
               std::size_t entry) const;

  std::string option_;
  std::vector<Entry> entries_;  // the one without a patch last
};

/// What the options of the command say of the boundary.
struct BoundaryData {
  BoundaryExpressions dirichlet, neumann, robin;
  std::optional<Expression> dirichlet_where;
};

/// The boundary conditions that count here, and how many there are of the whole mesh.
struct GivenConditions {
  BoundaryConditions conditions;
  std::int64_t n_dirichlet = 0, n_neumann = 0, n_robin = 0;
};

/// Dirichlet data at the vertices, Neumann and Robin data on the sides with a free vertex.
/// \throws InvalidOption  data for which there is no place
GivenConditions boundary_conditions(const Boundary<PolygonMesh>& boundary,
                                    const BoundaryData& given, const BoundaryParts& parts = {});
GivenConditions boundary_conditions(const Boundary<PolyhedralMesh>& boundary,
                                    const BoundaryData& given, const BoundaryParts& parts = {});

/// A field of the cells as the coefficient: 1 component, 6 (xx yy zz xy yz xz) or 9 (row by row).
/// \param mesh  or a part of one
/// \param numbers  of its cells in messages; empty: as they are
/// \throws InvalidOption  no such field, another number of components, a tensor that is not
///                        symmetric, a surface
Matrix cell_coefficient(const PolygonMesh& mesh, const MeshFields& fields, const std::string& name,
                        std::span<const Index> numbers = {});
Matrix cell_coefficient(const PolyhedralMesh& mesh, const MeshFields& fields,
                        const std::string& name, std::span<const Index> numbers = {});

}  // namespace carat::cli
