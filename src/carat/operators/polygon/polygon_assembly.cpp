#include "carat/operators/polygon/polygon_assembly.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "carat/assembly/row_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/common.h"

namespace carat {

PolygonAssembly::PolygonAssembly(const char* name, const PolygonMesh& mesh,
                                 const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(surface_incidence(mesh_)) {
  result_.name = name;
  result_.stiffness = face_pattern(incidence_, options_.threads);
  result_.mass =
      options_.mass == MassKind::Full ? result_.stiffness : diagonal_pattern(mesh_.n_vertices());
  result_.sample_measure.resize(mesh_.n_faces());
}

void PolygonAssembly::reassemble(const Points& points) {
  measure_faces(points);
  compute_terms();
  assemble_matrices();
  if (options_.parts != DiscretizationParts::Matrices) {
    if (result_.gradient_dimension == 0) make_gradient_pattern();
    assemble_gradient();
  }
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

void PolygonAssembly::measure_faces(const Points& points) {
  corners_.resize(static_cast<std::size_t>(mesh_.n_corners()));
  faces_.resize(static_cast<std::size_t>(mesh_.n_faces()));
  // The caller's function is not asked to be thread-safe.
  const int threads = options_.coefficient ? 1 : options_.threads;
  parallel_blocks(mesh_.n_faces(), threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) measure_face(points, f);
  });
}

void PolygonAssembly::measure_face(const Points& points, Index f) {
  const std::span<const Index> face = mesh_.face(f);
  const std::size_t n = face.size();
  Corner* const corners = corners_.data() + faces().begin(f);
  const auto from_first = [&](std::size_t i) -> Vec3 {
    return (points.row(face[i]) - points.row(face[0])).transpose();
  };
  Vec3 mean = Vec3::Zero(), double_area = Vec3::Zero();
  double size2 = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = from_first(i);
    mean += x / static_cast<double>(n);
    size2 = std::max(size2, x.squaredNorm());
    if (i + 1 < n) double_area += x.cross(from_first(i + 1));
  }
  const double limit = options_.eps_rel * size2;
  Face& result = faces_[f];
  result = {0.0, 1.0, Eigen::Matrix<double, 3, 2>::Zero()};
  if (double_area.norm() / 2 > limit) {
    const Vec3 normal = double_area.normalized();
    // The frame starts along the face, so that the coordinate across a thin one is rounded like its
    // width, not like its length.
    Vec3 along = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 x = from_first(i) - mean;
      x -= normal.dot(x) * normal;
      if (x.squaredNorm() > along.squaredNorm()) along = x;
    }
    result.axes.col(0) = along.normalized();
    result.axes.col(1) = normal.cross(along).normalized();
    const Vec3 upwards = result.axes.col(0).cross(result.axes.col(1));
    Vec2 middle = Vec2::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 x = from_first(i) - mean;
      corners[i].y = result.axes.transpose() * x;
      corners[i].height = upwards.dot(x);
      middle += corners[i].y / static_cast<double>(n);
    }
    for (std::size_t i = 0; i < n; ++i) corners[i].y -= middle;
    // From the same coordinates as the gradients: only then is the gradient of y the identity, to
    // rounding, on thin faces too.
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 &y = corners[i].y, &z = corners[i + 1 == n ? 0 : i + 1].y;
      result.area += (y.x() * z.y() - y.y() * z.x()) / 2;
    }
  }
  if (!(result.area > limit)) {
    result.area = result_.sample_measure[f] = 0;
    std::fill(corners, corners + n, Corner{Vec2::Zero(), 0, Vec2::Zero()});
    return;
  }
  const double area = result_.sample_measure[f] = result.area;
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &before = corners[i == 0 ? n - 1 : i - 1].y,
               &after = corners[i + 1 == n ? 0 : i + 1].y;
    const Vec2 across = after - before;
    corners[i].gradient = Vec2(across.y(), -across.x()) / (2 * area);
    moment +=
        (corners[i].y + after) * (corners[i].y.x() * after.y() - corners[i].y.y() * after.x());
  }
  if (options_.coefficient) {
    const Vec3 origin = points.row(face[0]).transpose();
    result.coefficient =
        coefficient_at(options_, origin + mean + result.axes * (moment / (6 * area)));
  }
}

void PolygonAssembly::make_gradient_pattern() {
  if (std::int64_t{mesh_.n_faces()} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(mesh_.n_faces()) +
                      " faces has more rows than 32 bits can number; split the mesh");
  result_.gradient_dimension = 3;
  Array<Index> row_sizes(3 * static_cast<std::size_t>(mesh_.n_faces()));
  std::vector<Index> columns;
  const auto collect = [&](Index f) {
    columns.assign(mesh_.face(f).begin(), mesh_.face(f).end());
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  };
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    collect(f);
    std::fill_n(row_sizes.begin() + 3 * std::ptrdiff_t{f}, 3, static_cast<Index>(columns.size()));
  }
  result_.gradient =
      allocate_rows(3 * mesh_.n_faces(), mesh_.n_vertices(), row_sizes, "the gradient on faces");
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    collect(f);
    for (Index row = 3 * f; row < 3 * f + 3; ++row)
      std::copy(columns.begin(), columns.end(),
                result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[row]);
  }
}

void PolygonAssembly::assemble_gradient() {
  const Index* const outer = result_.gradient.outerIndexPtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  double* const values = result_.gradient.valuePtr();
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      std::fill(values + outer[3 * f], values + outer[3 * f + 3], 0.0);
      const Index n = outer[3 * f + 1] - outer[3 * f];
      const Index* const columns = inner + outer[3 * f];
      for (Index a = 0; a < faces().size(f); ++a) {
        const Vec3 g = faces_[f].axes * corners_of(f)[a].gradient;
        const Index v = faces().indices[faces().begin(f) + a];
        const Index place = static_cast<Index>(std::lower_bound(columns, columns + n, v) - columns);
        for (Index k = 0; k < 3; ++k) values[outer[3 * f + k] + place] += g[k];
      }
    }
  });
}

void PolygonAssembly::collect_frames() {
  // Every corner stands for its share of the face.
  result_.frames.parts.clear();
  for (Index f = 0; f < mesh_.n_faces(); ++f)
    if (faces_[f].area > 0)
      for (const Index v : mesh_.face(f))
        result_.frames.parts.push_back(
            {faces_[f].area / static_cast<double>(faces().size(f)), f, f, {v, -1, -1}});
}

void PolygonAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index f = 0; f < mesh_.n_faces(); ++f)
    if (!(faces_[f].area > 0)) excluded.push_back(f);
  report_degenerate(
      std::move(excluded), options_, "face",
      [&](Index f) {
        return std::to_string(faces().size(f)) + " vertices, the first " +
               std::to_string(mesh_.face(f)[0]);
      },
      result_.diagnostics);
}

}  // namespace carat
