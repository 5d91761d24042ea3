#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/lattice.h"
#include "carat/generators/random.h"

namespace carat {
namespace {

// What lies on the other side of a cell's side: a site (>= 0) or a border of the square.
constexpr Index kBottom = -1, kRight = -2, kTop = -3, kLeft = -4;

constexpr double kWallDistance = 0.1;  // least distance of a site from the border, in cells

/// Sites in rows, every other row shifted by half a cell, each moved at random.
struct Sites {
  Index columns, rows;
  std::vector<double> x_even, x_odd;  ///< of the rows before the sites were moved
  Array<Vec2> at;                     ///< row by row
  double reach = 0;                   ///< no site was moved farther

  double row_y(Index j) const { return (j + 0.5) / rows; }
  const std::vector<double>& row_x(Index j) const { return j % 2 == 0 ? x_even : x_odd; }
};

Sites place_sites(Index columns, Index rows, const FamilyOptions& options, double jitter,
                  std::uint64_t seed) {
  Sites sites{columns, rows, {}, {}, {}};
  for (Index i = 0; i < columns; ++i) {
    sites.x_even.push_back(grade((i + 0.25) / columns, options.anisotropy));
    sites.x_odd.push_back(grade((i + 0.75) / columns, options.anisotropy));
  }
  sites.at.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const double height = 1.0 / rows;
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      const double left = grade(double(i) / columns, options.anisotropy);
      const double width = grade(double(i + 1) / columns, options.anisotropy) - left;
      const double reach = jitter * std::min(width, std::hypot(width / 2, height));
      const Index s = j * columns + i;
      const Vec2 offset = reach * RandomStream(seed, static_cast<std::uint64_t>(s)).in_disc();
      const Vec2 margin = kWallDistance * Vec2(width, height);
      sites.at[s] = (Vec2(sites.row_x(j)[i], sites.row_y(j)) + offset)
                        .cwiseMax(margin)
                        .cwiseMin(Vec2::Ones() - margin);
      sites.reach = std::max(sites.reach, reach);
    }
  return sites;
}

/// One Voronoi cell, cut out of the square by the bisectors of its site.
class Cell {
 public:
  void start(const Vec2& site) {
    site_ = site;
    corners_ = {{{0, 0}, kBottom}, {{1, 0}, kRight}, {{1, 1}, kTop}, {{0, 1}, kLeft}};
    update_radius();
  }
  /// Sites farther away than this cannot touch the cell.
  double influence() const { return 2 * radius_; }

  void cut(Index other, const Vec2& at) {
    const Vec2 normal = at - site_;
    if (normal.squaredNorm() >= 4 * radius_ * radius_) return;
    const Vec2 middle = (site_ + at) / 2;
    kept_.clear();
    bool changed = false;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Corner& here = corners_[k];
      const Corner& there = corners_[k + 1 == corners_.size() ? 0 : k + 1];
      const double h = normal.dot(here.x - middle), t = normal.dot(there.x - middle);
      if (h <= 0) kept_.push_back(here);
      changed = changed || h > 0;
      if ((h <= 0) == (t <= 0)) continue;
      const Vec2 crossing = here.x + h / (h - t) * (there.x - here.x);
      kept_.push_back({crossing, h <= 0 ? other : here.neighbour});
    }
    if (!changed) return;
    std::swap(corners_, kept_);
    update_radius();
  }
  void append_neighbours(Csr& cells) const {
    for (const Corner& corner : corners_) cells.indices.push_back(corner.neighbour);
    cells.offsets.push_back(static_cast<Index>(cells.indices.size()));
  }

 private:
  struct Corner {
    Vec2 x;
    Index neighbour;  ///< beyond the side that starts here
  };
  void update_radius() {
    double squared = 0;
    for (const Corner& corner : corners_)
      squared = std::max(squared, (corner.x - site_).squaredNorm());
    radius_ = std::sqrt(squared);
  }

  Vec2 site_;
  double radius_ = 0;
  std::vector<Corner> corners_, kept_;
};

/// The lattice neighbours of the site in column i of row j; cut first, they make the cell small.
bool is_lattice_neighbour(Index i, Index j, Index other_i, Index other_j) {
  return std::abs(i - other_i) <= 1 && std::abs(j - other_j) <= 1;
}

void cut_with_lattice_neighbours(const Sites& sites, Index i, Index j, Cell& cell) {
  for (Index row = std::max(j - 1, 0); row <= std::min(j + 1, sites.rows - 1); ++row)
    for (Index c = std::max(i - 1, 0); c <= std::min(i + 1, sites.columns - 1); ++c) {
      const Index other = row * sites.columns + c;
      if (row != j || c != i) cell.cut(other, sites.at[other]);
    }
}

/// Cuts with the other sites of `row`, from column i outwards, as far as they can touch the cell.
void cut_with_row(const Sites& sites, Index i, Index j, Index row, Cell& cell) {
  const std::vector<double>& x = sites.row_x(row);
  const double here = sites.at[j * sites.columns + i].x();
  const auto cut = [&](Index c) {
    if (std::abs(x[c] - here) - sites.reach > cell.influence()) return false;
    const Index other = row * sites.columns + c;
    if (!is_lattice_neighbour(i, j, c, row)) cell.cut(other, sites.at[other]);
    return true;
  };
  for (Index c = i; c < sites.columns; ++c)
    if (!cut(c) && x[c] > here) break;
  for (Index c = i - 1; c >= 0; --c)
    if (!cut(c) && x[c] < here) break;
}

/// Cell -> neighbours in the order of its sides.
Csr cell_neighbours(const Sites& sites) {
  Csr cells;
  Cell cell;
  for (Index j = 0; j < sites.rows; ++j)
    for (Index i = 0; i < sites.columns; ++i) {
      const Index s = j * sites.columns + i;
      const double y = sites.at[s].y();
      cell.start(sites.at[s]);
      cut_with_lattice_neighbours(sites, i, j, cell);
      cut_with_row(sites, i, j, j, cell);
      bool above = true, below = true;
      for (Index k = 1; above || below; ++k) {
        const auto visit = [&](Index row) {
          if (row < 0 || row >= sites.rows ||
              std::abs(sites.row_y(row) - y) - sites.reach > cell.influence())
            return false;
          cut_with_row(sites, i, j, row, cell);
          return true;
        };
        above = above && visit(j + k);
        below = below && visit(j - k);
      }
      cell.append_neighbours(cells);
    }
  return cells;
}

/// The point at the same distance from site a and from the two others, each a site or a border.
Vec2 equidistant_point(const Sites& sites, Index a, Index b, Index c) {
  const auto border = [](Index side, Vec2 x) {
    if (side == kBottom) x.y() = 0;
    if (side == kRight) x.x() = 1;
    if (side == kTop) x.y() = 1;
    if (side == kLeft) x.x() = 0;
    return x;
  };
  const Vec2 origin = sites.at[a];
  if (b < 0) return border(b, border(c, origin));
  const Vec2 p = sites.at[b] - origin;
  if (c < 0) {
    const int along = c == kBottom || c == kTop ? 0 : 1;
    Vec2 x = border(c, origin);
    x[along] += (p.squaredNorm() / 2 - (x - origin)[1 - along] * p[1 - along]) / p[along];
    return x;
  }
  const Vec2 q = sites.at[c] - origin;
  const double doubled = 2 * (p.x() * q.y() - p.y() * q.x());
  return origin + Vec2(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(),
                       p.x() * q.squaredNorm() - q.x() * p.squaredNorm()) /
                      doubled;
}

/// Numbers the vertices, each a triple of neighbours, once.
/// \return whether the cells agree on their vertices, as they do unless four sites lie on one
///         circle to rounding
bool number_vertices(const Sites& sites, const Csr& cells, Points& points, Csr& faces) {
  faces.offsets = cells.offsets;
  faces.indices.resize(cells.indices.size());
  std::vector<Vec2> vertices;
  std::vector<std::int8_t> missing;  // visits by the other cells that are still due
  for (Index s = 0; s < cells.n_rows(); ++s)
    for (Index k = cells.begin(s); k < cells.end(s); ++k) {
      Index b = cells.indices[k == cells.begin(s) ? cells.end(s) - 1 : k - 1];
      Index c = cells.indices[k];
      if (b < c) std::swap(b, c);  // sites before borders
      Index owner = s;
      if (b >= 0) owner = std::min(owner, b);
      if (c >= 0) owner = std::min(owner, c);
      if (owner == s) {
        if (c >= 0) std::swap(b, c);
        faces.indices[k] = static_cast<Index>(vertices.size());
        vertices.push_back(equidistant_point(sites, s, b, c));
        missing.push_back(static_cast<std::int8_t>((b >= 0) + (c >= 0)));
        continue;
      }
      const Index other = owner == b ? c : b;
      Index found = -1;
      for (Index m = cells.begin(owner); m < cells.end(owner) && found < 0; ++m) {
        const Index before = cells.indices[m == cells.begin(owner) ? cells.end(owner) - 1 : m - 1];
        const Index after = cells.indices[m];
        if ((before == s && after == other) || (before == other && after == s))
          found = faces.indices[m];
      }
      if (found < 0 || --missing[found] < 0) return false;
      faces.indices[k] = found;
    }
  points.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec2 x = vertices[v].cwiseMax(Vec2::Zero()).cwiseMin(Vec2::Ones());
    points.row(static_cast<Eigen::Index>(v)) << x.x(), x.y(), 0;
  }
  return std::all_of(missing.begin(), missing.end(), [](int due) { return due == 0; });
}

}  // namespace

/// Voronoi cells of 6 * 2^level by 7 * 2^level sites; without jitter they are
/// hexagons inside, with sides equal to 2.4 %. Jitter moves the sites, within `jitter` times the
/// distance of their neighbours, not the vertices; the anisotropy grades the sites.
PolygonMesh generate_plane_voronoi(const FamilyOptions& options) {
  const Index columns = lattice_size(options.level, 6, 7.0 / 6 * 6.2);
  const Index rows = columns / 6 * 7;
  constexpr int kAttempts = 8;
  constexpr double kNudge = 1e-6;  // of a cell: enough to part four sites from one circle
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Sites sites =
        place_sites(columns, rows, options, std::max(options.jitter, attempt * kNudge),
                    options.seed + static_cast<std::uint64_t>(attempt) * 0x5851f42d4c957f2d);
    Points points;
    Csr faces;
    if (number_vertices(sites, cell_neighbours(sites), points, faces))
      return PolygonMesh(std::move(points), std::move(faces));
  }
  throw InvalidOption("seed " + std::to_string(options.seed) +
                      ": four Voronoi sites lie on one circle; choose another seed or jitter");
}

}  // namespace carat
