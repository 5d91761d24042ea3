#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/random.h"
#include "carat/generators/short_edges.h"
#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"
#include "carat/generators/voronoi_cell.h"

namespace carat {
namespace {

// Sites move as far as this share of the distance of neighbours in the lattice, with jitter up to
// kMostDisorder.
constexpr double kDisorder = 0.2, kMostDisorder = 0.5;
constexpr double kShortest = 0.1;      // edge, in cubes
constexpr double kWallDistance = 0.1;  // least distance of a site from the border, in cubes

/// The points of a body-centred lattice, moved at random: the cubes' centres and inner corners.
Array<Vec3> place_sites(const CubeLattice& lattice, const VolumeDomain& domain, double jitter,
                        std::uint64_t seed) {
  Array<Vec3> sites;
  const double disorder = kDisorder + (kMostDisorder - kDisorder) / 0.5 * jitter;
  const double reach = disorder * std::sqrt(3.0) / 2 / lattice.n;
  const double margin = kWallDistance / lattice.n;
  const auto add = [&](const Vec3& x) {
    RandomStream random(seed, sites.size());
    const Vec3 moved = x + reach * random.in_ball();
    sites.push_back(
        domain.place(moved.cwiseMax(Vec3::Constant(margin)).cwiseMin(Vec3::Constant(1 - margin))));
  };
  lattice.for_cells([&](Index i, Index j, Index k) {
    add(lattice.at(i + 0.5, j + 0.5, k + 0.5));
    if (i > 0 && j > 0 && k > 0) add(lattice.at(i, j, k));
  });
  return sites;
}

/// Sites by the cube of a grid that they lie in, for visiting them from near to far.
class SiteGrid {
 public:
  SiteGrid(const Array<Vec3>& sites, Index n, double low, double high)
      : n_(n), low_(low), width_((high - low) / n) {
    Array<Index> bucket(sites.size());
    buckets_.offsets.assign(static_cast<std::size_t>(n) * n * n + 1, 0);
    for (std::size_t s = 0; s < sites.size(); ++s) {
      const auto at = bucket_of(sites[s]);
      bucket[s] = number(at[0], at[1], at[2]);
      ++buckets_.offsets[bucket[s] + 1];
    }
    for (Index b = 0; b < buckets_.n_rows(); ++b) buckets_.offsets[b + 1] += buckets_.offsets[b];
    buckets_.indices.resize(sites.size());
    Array<Index> next(buckets_.offsets.begin(), buckets_.offsets.end() - 1);
    for (std::size_t s = 0; s < sites.size(); ++s)
      buckets_.indices[next[bucket[s]]++] = static_cast<Index>(s);
  }

  /// Calls visit(site) for all sites within reach() of x and some more; reach() may fall.
  template <class Reach, class Visit>
  void for_sites_around(const Vec3& x, Reach&& reach, Visit&& visit) const {
    const auto at = bucket_of(x);
    for (Index shell = 0; shell <= n_ && (shell - 1) * width_ <= reach(); ++shell)
      for (Index k = at[2] - shell; k <= at[2] + shell; ++k)
        for (Index j = at[1] - shell; j <= at[1] + shell; ++j) {
          const bool whole_row = std::max(std::abs(k - at[2]), std::abs(j - at[1])) == shell;
          const Index step = whole_row || shell == 0 ? 1 : 2 * shell;
          for (Index i = at[0] - shell; i <= at[0] + shell; i += step) {
            if (std::min({i, j, k}) < 0 || std::max({i, j, k}) >= n_) continue;
            for (const Index s : buckets_.row(number(i, j, k))) visit(s);
          }
        }
  }

 private:
  std::array<Index, 3> bucket_of(const Vec3& x) const {
    std::array<Index, 3> at;
    for (int k = 0; k < 3; ++k)
      at[k] = std::clamp(static_cast<Index>((x[k] - low_) / width_), Index{0}, n_ - 1);
    return at;
  }
  Index number(Index i, Index j, Index k) const { return (k * n_ + j) * n_ + i; }

  Index n_;
  double low_, width_;
  Csr buckets_;
};

/// All cells of a diagram, with their corners matched.
class VoronoiDiagram {
 public:
  VoronoiDiagram(const Array<Vec3>& sites, const VolumeDomain& domain) : is_ball_(domain.is_ball) {
    // Half as many cubes as there are sites, as in the lattice that they come from.
    const auto n = static_cast<Index>(std::cbrt(static_cast<double>(sites.size()) / 2)) + 1;
    const SiteGrid grid(sites, n, is_ball_ ? -1 : 0, 1);
    VoronoiCell cell;
    first_corner_.push_back(0);
    for (Index s = 0; s < static_cast<Index>(sites.size()) && sound_; ++s) {
      cell.start(sites[s], is_ball_ ? -kBox : 0, is_ball_ ? kBox : 1);
      if (is_ball_) cell.cut_by_tangent_plane();
      grid.for_sites_around(
          sites[s], [&] { return cell.influence(); },
          [&](Index other) {
            if (other != s) cell.cut_by_site(other, sites[other]);
          });
      if (is_ball_) cell.cut_by_sphere();
      sound_ = cell.is_sound() && add_corners(s, cell);
    }
    sound_ = sound_ && std::all_of(due_.begin(), due_.end(), [](int due) { return due == 0; });
  }

  /// Whether the cells agree on their corners, as they do unless five sites lie on one sphere to
  /// rounding, and whether the sphere cut every cell once.
  bool is_sound() const { return sound_; }

  PolyhedralMesh mesh() const {
    Points points(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t v = 0; v < points_.size(); ++v)
      points.row(static_cast<Eigen::Index>(v)) = points_[v].transpose();
    VolumeBuilder cells(std::move(points));
    std::vector<Index> face;
    for (std::size_t s = 0; s + 1 < first_corner_.size(); ++s) {
      for (const Index surface : surfaces_of(s)) {
        trace_face(s, surface, face);
        cells.add_face(face);
      }
      cells.end_cell();
    }
    return std::move(cells).build();
  }

 private:
  static constexpr double kBox = 1.5;  // about the ball, clear of it

  struct Corner {
    std::array<Index, 4> key;  ///< the site and the three surfaces, ascending
    std::array<Index, 3> surfaces;
    Index vertex;
  };

  bool add_corners(Index s, const VoronoiCell& cell) {
    for (const VoronoiCell::Corner& corner : cell.corners()) {
      Corner entry{
          {s, corner.surfaces[0], corner.surfaces[1], corner.surfaces[2]}, corner.surfaces, -1};
      std::sort(entry.key.begin(), entry.key.end());
      const auto first_site =
          std::find_if(entry.key.begin(), entry.key.end(), [](Index name) { return name >= 0; });
      if (*first_site == s) {
        entry.vertex = static_cast<Index>(points_.size());
        points_.push_back(on_border(corner));
        due_.push_back(static_cast<std::int8_t>(entry.key.end() - first_site - 1));
      } else {
        const auto owner = static_cast<std::size_t>(*first_site);
        const auto begin = corners_.begin() + first_corner_[owner],
                   end = corners_.begin() + first_corner_[owner + 1];
        const auto same =
            std::find_if(begin, end, [&](const Corner& other) { return other.key == entry.key; });
        if (same == end || --due_[same->vertex] < 0) return false;
        entry.vertex = same->vertex;
      }
      corners_.push_back(entry);
    }
    first_corner_.push_back(static_cast<Index>(corners_.size()));
    return true;
  }

  /// The corner's place, with coordinates on the walls of the cube free of rounding.
  static Vec3 on_border(const VoronoiCell::Corner& corner) {
    Vec3 x = corner.x;
    for (const Index surface : corner.surfaces)
      if (surface < 0 && surface >= VoronoiCell::kHighZ)
        x[(-surface - 1) / 2] = surface % 2 == 0 ? 1 : 0;
    return x;
  }

  std::span<const Corner> corners_of(std::size_t s) const {
    return {corners_.data() + first_corner_[s],
            static_cast<std::size_t>(first_corner_[s + 1] - first_corner_[s])};
  }

  /// Ascending, each once.
  std::vector<Index> surfaces_of(std::size_t s) const {
    std::vector<Index> surfaces;
    for (const Corner& corner : corners_of(s))
      surfaces.insert(surfaces.end(), corner.surfaces.begin(), corner.surfaces.end());
    std::sort(surfaces.begin(), surfaces.end());
    surfaces.erase(std::unique(surfaces.begin(), surfaces.end()), surfaces.end());
    return surfaces;
  }

  /// The corners on a surface, around it: the last of their other two surfaces is the first of the
  /// next corner's.
  void trace_face(std::size_t s, Index surface, std::vector<Index>& face) const {
    face.clear();
    const auto corners = corners_of(s);
    Index start = surface, at = surface;
    do {
      for (const Corner& corner : corners) {
        const auto m = std::find(corner.surfaces.begin(), corner.surfaces.end(), surface) -
                       corner.surfaces.begin();
        if (m == 3) continue;
        const Index before = corner.surfaces[(m + 1) % 3], after = corner.surfaces[(m + 2) % 3];
        if (at != surface && before != at) continue;
        if (start == surface) start = before;
        face.push_back(corner.vertex);
        at = after;
        break;
      }
    } while (at != start);
  }

  bool is_ball_;
  bool sound_ = true;
  Array<Index> first_corner_;
  std::vector<Corner> corners_;
  std::vector<Vec3> points_;
  std::vector<std::int8_t> due_;  // cells that are still to meet a vertex
};

}  // namespace

/// Voronoi cells of a body-centred lattice of n = 3 * 2^level cubes along a side with its sites
/// moved at random, cut at the border. In the ball the border's faces have their corners on the
/// sphere. Jitter moves the sites farther, not the vertices.
PolyhedralMesh generate_volume_voronoi(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 3, 160)};
  constexpr int kAttempts = 8;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::uint64_t seed =
        options.seed + static_cast<std::uint64_t>(attempt) * 0x5851f42d4c957f2d;
    const VoronoiDiagram diagram(place_sites(lattice, domain, options.jitter, seed), domain);
    if (!diagram.is_sound()) continue;
    const PolyhedralMesh mesh =
        merge_short_edges(diagram.mesh(), domain, kShortest * domain.size / lattice.n);
    FamilyOptions no_jitter = options;
    no_jitter.jitter = 0;
    return finish_volume(
        mesh.with_points(squeeze_points(domain, mesh.points(), options.anisotropy)), domain,
        no_jitter);
  }
  throw InvalidOption("seed " + std::to_string(options.seed) +
                      ": five Voronoi sites lie on one sphere; choose another seed or jitter");
}

}  // namespace carat
