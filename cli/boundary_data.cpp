#include "cli/boundary_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "carat/base/error.h"

namespace carat::cli {
namespace {

/// Position of a '=' that is no part of == <= >= !=, or npos.
std::size_t patch_mark(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;
      continue;
    }
    if (i == 0 || std::string("<>!").find(text[i - 1]) == std::string::npos) return i;
  }
  return std::string::npos;
}

std::string quoted_names(std::span<const BoundaryPatch> patches) {
  std::string list;
  for (const BoundaryPatch& patch : patches) list += (list.empty() ? "" : ", ") + patch.name;
  return list;
}

/// Puts the given data in their places, step by step: what the parts find together decides on the
/// next step.
template <class Mesh>
class Placement {
 public:
  Placement(const Boundary<Mesh>& boundary, const BoundaryData& given, const BoundaryParts& parts)
      : boundary_(boundary), given_(given), parts_(parts) {
    std::vector<std::int64_t> counts{static_cast<std::int64_t>(boundary.sides.size())};
    for (const BoundaryPatch& patch : boundary.patches)
      counts.push_back(static_cast<std::int64_t>(patch.faces.size()));
    counts = parts.sum(std::move(counts));
    n_sides_ = counts[0];
    n_patch_faces_.assign(counts.begin() + 1, counts.end());
  }

  GivenConditions place() {
    if (!given_.dirichlet.empty()) add_dirichlet();
    if (!given_.neumann.empty() || !given_.robin.empty()) add_fluxes();
    return std::move(result_);
  }

 private:
  void add_dirichlet() {
    // Where patches meet, the one that was named first holds.
    std::vector<int> of_vertex(static_cast<std::size_t>(boundary_.mesh.n_vertices()), -1);
    parts_.together([&] {
      if (n_sides_ == 0)
        throw InvalidOption("--dirichlet: the mesh is closed, it has no boundary; leave it out");
      const std::vector<int> entries = given_.dirichlet.entries_of(boundary_, n_patch_faces_);
      for (std::size_t k = 0; k < boundary_.sides.size(); ++k) {
        if (entries[k] < 0) continue;
        for (const Index v : boundary_side(boundary_.mesh, boundary_.sides[k]).vertices) {
          int& entry = of_vertex[static_cast<std::size_t>(v)];
          entry = entry < 0 ? entries[k] : std::min(entry, entries[k]);
        }
      }
    });
    parts_.take_lowest(of_vertex);
    BoundaryConditions& conditions = result_.conditions;
    std::int64_t n_own = 0;
    parts_.together([&] {
      for (Index v = 0; v < boundary_.mesh.n_vertices(); ++v) {
        const int entry = of_vertex[static_cast<std::size_t>(v)];
        if (entry < 0) continue;
        const Vec3 point = boundary_.mesh.point(v);
        if (given_.dirichlet_where && (*given_.dirichlet_where)(point) == 0) continue;
        conditions.dirichlet_vertices.push_back(v);
        conditions.dirichlet_values.push_back(given_.dirichlet.value(entry, point));
        if (parts_.owns(v)) ++n_own;
      }
    });
    result_.n_dirichlet = parts_.sum({n_own})[0];
    parts_.together([&] {
      if (result_.n_dirichlet == 0)
        throw InvalidOption(
            "--dirichlet-where is 0 at every boundary vertex; leave --dirichlet out, or widen it: "
            "points are compared as they are, so allow for rounding, e.g. \"x < 1e-9\"");
    });
  }

  /// Neumann and Robin data on the sides that Dirichlet data do not cover.
  void add_fluxes() {
    const Mesh& mesh = boundary_.mesh;
    BoundaryConditions& conditions = result_.conditions;
    parts_.together([&] {
      const std::vector<int> fluxes = given_.neumann.entries_of(boundary_, n_patch_faces_);
      const std::vector<int> alphas = given_.robin.entries_of(boundary_, n_patch_faces_);
      std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
      for (const Index v : conditions.dirichlet_vertices) fixed[static_cast<std::size_t>(v)] = true;
      for (std::size_t k = 0; k < boundary_.sides.size(); ++k) {
        if (fluxes[k] < 0 && alphas[k] < 0) continue;
        const BoundarySide side = boundary_side(mesh, boundary_.sides[k]);
        if (std::all_of(side.vertices.begin(), side.vertices.end(),
                        [&](Index v) { return fixed[static_cast<std::size_t>(v)]; }))
          continue;
        const double flux = fluxes[k] < 0 ? 0 : given_.neumann.value(fluxes[k], side.centre);
        if (alphas[k] >= 0) {
          conditions.robin_sides.push_back(side.id);
          conditions.robin_alpha.push_back(given_.robin.value(alphas[k], side.centre));
          conditions.robin_g.push_back(flux);
        } else {
          conditions.neumann_sides.push_back(side.id);
          conditions.neumann_flux.push_back(flux);
        }
      }
    });
    const std::vector<std::int64_t> counts =
        parts_.sum({static_cast<std::int64_t>(conditions.neumann_sides.size()),
                    static_cast<std::int64_t>(conditions.robin_sides.size())});
    result_.n_neumann = counts[0];
    result_.n_robin = counts[1];
    parts_.together([&] {
      if (counts[0] + counts[1] > 0) return;
      const std::string side = words(mesh).side;
      throw InvalidOption(std::string(given_.robin.empty() ? "--neumann" : "--robin") +
                          ": no boundary " + side + " is left for it; " +
                          (n_sides_ == 0 ? "the mesh is closed, leave it out"
                                         : "every one has Dirichlet data at all its vertices, "
                                           "restrict them with --dirichlet-where"));
    });
  }

  const Boundary<Mesh>& boundary_;
  const BoundaryData& given_;
  const BoundaryParts& parts_;
  std::int64_t n_sides_ = 0;
  std::vector<std::int64_t> n_patch_faces_;
  GivenConditions result_;
};

}  // namespace

BoundaryExpressions::BoundaryExpressions(std::string option, const std::vector<std::string>& texts)
    : option_(std::move(option)) {
  for (const std::string& text : texts) {
    const std::size_t mark = patch_mark(text);
    const std::string patch = mark == std::string::npos ? "" : text.substr(0, mark);
    if (mark == 0)
      throw InvalidOption(option_ + " '" + text +
                          "': no patch before '='; write PATCH=EXPR or EXPR");
    for (const Entry& entry : entries_)
      if (entry.patch == patch)
        throw InvalidOption(option_ + (patch.empty() ? " without a patch" : " " + patch + "=") +
                            " is given twice; once is possible");
    entries_.push_back(
        {patch, Expression(option_, mark == std::string::npos ? text : text.substr(mark + 1))});
  }
  std::stable_partition(entries_.begin(), entries_.end(),
                        [](const Entry& entry) { return !entry.patch.empty(); });
}

int BoundaryExpressions::of_patch(std::span<const BoundaryPatch> patches,
                                  std::span<const std::int64_t> n_faces, std::size_t entry) const {
  const std::string& name = entries_[entry].patch;
  const auto found = std::find_if(patches.begin(), patches.end(),
                                  [&](const BoundaryPatch& patch) { return patch.name == name; });
  if (found == patches.end())
    throw InvalidOption(option_ + " " + name + "=: there is no boundary patch of this name; " +
                        (patches.empty() ? std::string("the mesh has none: give EXPR alone")
                                         : "the mesh has " + quoted_names(patches)) +
                        " (to compare, write '==')");
  const auto patch = found - patches.begin();
  if (n_faces[static_cast<std::size_t>(patch)] == 0)
    throw InvalidOption(option_ + " " + name + "=: this patch has no faces; leave it out");
  return static_cast<int>(patch);
}

template <class Mesh>
std::vector<int> BoundaryExpressions::entries_of(
    const Boundary<Mesh>& boundary, std::span<const std::int64_t> n_patch_faces) const {
  const std::vector<Index>& sides = boundary.sides;
  const bool rest = !entries_.empty() && entries_.back().patch.empty();
  std::vector<int> entries(sides.size(), rest ? static_cast<int>(entries_.size()) - 1 : -1);
  for (std::size_t e = 0; e + (rest ? 1 : 0) < entries_.size(); ++e) {
    const int patch = of_patch(boundary.patches, n_patch_faces, e);
    for (const Index face : boundary.patches[static_cast<std::size_t>(patch)].faces) {
      const auto side = std::lower_bound(sides.begin(), sides.end(), face);
      if (side != sides.end() && *side == face)
        entries[static_cast<std::size_t>(side - sides.begin())] = static_cast<int>(e);
    }
  }
  return entries;
}

GivenConditions boundary_conditions(const Boundary<PolygonMesh>& boundary,
                                    const BoundaryData& given, const BoundaryParts& parts) {
  return Placement(boundary, given, parts).place();
}

GivenConditions boundary_conditions(const Boundary<PolyhedralMesh>& boundary,
                                    const BoundaryData& given, const BoundaryParts& parts) {
  return Placement(boundary, given, parts).place();
}

Matrix cell_coefficient(const PolygonMesh&, const MeshFields&, const std::string& name,
                        std::span<const Index>) {
  throw InvalidOption("--coefficient-field " + name +
                      ": it belongs to the cells of volume meshes; on surfaces use --coefficient");
}

Matrix cell_coefficient(const PolyhedralMesh& mesh, const MeshFields& fields,
                        const std::string& name, std::span<const Index> numbers) {
  const auto field = std::find_if(fields.cell.begin(), fields.cell.end(),
                                  [&](const Field& candidate) { return candidate.name == name; });
  const std::string option = "--coefficient-field " + name;
  if (field == fields.cell.end()) {
    std::string known;
    for (const Field& other : fields.cell) known += (known.empty() ? "" : ", ") + other.name;
    throw InvalidOption(option + ": the mesh has no such field of cells; it has " +
                        (known.empty() ? "none" : known));
  }
  const Index width = field->components, n = mesh.n_cells();
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      values(field->values.data(), n, width);
  if (width == 1 || width == 6) return values;
  if (width != 9)
    throw InvalidOption(option + ": it has " + count(width, "component") +
                        "; a coefficient has 1, 6 (xx yy zz xy yz xz) or 9");
  for (Index c = 0; c < n; ++c) {
    constexpr std::array<std::array<int, 2>, 3> pairs{{{1, 3}, {5, 7}, {2, 6}}};
    // What is left of a symmetric tensor after a change of basis in double precision.
    const double tolerance = 1e-12 * values.row(c).cwiseAbs().maxCoeff();
    for (const auto& [a, b] : pairs)
      if (!(std::abs(values(c, a) - values(c, b)) <= tolerance)) {
        const Index cell = numbers.empty() ? c : numbers[static_cast<std::size_t>(c)];
        throw InvalidOption(option + ": the tensor of cell " + std::to_string(cell) +
                                " is not symmetric: " + text(values(c, a)) + " against " +
                                text(values(c, b)) + "; only symmetric ones are possible",
                            {cell});
      }
  }
  return values(Eigen::all, std::array<int, 6>{0, 4, 8, 1, 5, 2});
}

}  // namespace carat::cli
