#include "cli/figure_render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carat/mesh/transform.h"

namespace carat::cli {
namespace {

/// Every pixel is the mean of so many by so many.
constexpr int kSamples = 2;
constexpr double kMargin = 0.03;
/// Half the width of an isoline in samples.
constexpr double kHalfLine = 1.3;
constexpr double kAmbient = 0.42;
constexpr Color kBackground = rgb(0xffffff);
constexpr Color kLine = rgb(0x10131a);
constexpr Color kNoValue = rgb(0xb8b8b8);

/// Viridis at equal steps.
constexpr std::array<Color, 9> kColors{rgb(0x440154), rgb(0x472d7b), rgb(0x3b528b),
                                       rgb(0x2c728e), rgb(0x21918c), rgb(0x28ae80),
                                       rgb(0x5ec962), rgb(0xaddc30), rgb(0xfde725)};

Color mix(const Color& a, const Color& b, double t) {
  return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
          a.blue + t * (b.blue - a.blue)};
}

/// To the right, upwards, and towards the eye.
Eigen::Matrix3d view_frame() {
  const double azimuth = 0.45, elevation = 0.3;
  const Vec3 eye(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                 std::cos(azimuth) * std::cos(elevation));
  Eigen::Matrix3d frame;
  frame.row(0) = Vec3::UnitY().cross(eye).normalized();
  frame.row(2) = eye;
  frame.row(1) = eye.cross(Vec3(frame.row(0)));
  return frame;
}

Points vertex_normals(const Points& points, const PolygonMesh& triangles) {
  Points normals = Points::Zero(points.rows(), 3);
  const auto& corners = triangles.faces().indices;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    const Vec3 a = points.row(corners[c]), b = points.row(corners[c + 1]),
               d = points.row(corners[c + 2]);
    const Vec3 normal = (b - a).cross(d - a);
    for (std::size_t k = 0; k < 3; ++k) normals.row(corners[c + k]) += normal;
  }
  normals.rowwise().normalize();
  return normals;
}

/// Samples with depths; nearer ones hide others.
class Painter {
 public:
  Painter(int width, int height)
      : width_(width),
        height_(height),
        depths_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                -std::numeric_limits<double>::infinity()),
        colors_(depths_.size(), kBackground) {}

  /// Corners in samples, downwards and with depths; `shade` gives the colour for the three
  /// barycentric coordinates.
  template <class Shade>
  void triangle(const std::array<Vec3, 3>& p, const Shade& shade) {
    const double area = (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) -
                        (p[2].x() - p[0].x()) * (p[1].y() - p[0].y());
    if (!(std::abs(area) > 0)) return;
    const auto range = [](double a, double b, double c, int n) {
      return std::pair{std::max(0, static_cast<int>(std::floor(std::min({a, b, c})))),
                       std::min(n - 1, static_cast<int>(std::ceil(std::max({a, b, c}))))};
    };
    const auto [x0, x1] = range(p[0].x(), p[1].x(), p[2].x(), width_);
    const auto [y0, y1] = range(p[0].y(), p[1].y(), p[2].y(), height_);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double sx = x + 0.5, sy = y + 0.5;
        const double b1 =
            ((sx - p[0].x()) * (p[2].y() - p[0].y()) - (p[2].x() - p[0].x()) * (sy - p[0].y())) /
            area;
        const double b2 =
            ((p[1].x() - p[0].x()) * (sy - p[0].y()) - (sx - p[0].x()) * (p[1].y() - p[0].y())) /
            area;
        const double b0 = 1 - b1 - b2;
        if (b0 < 0 || b1 < 0 || b2 < 0) continue;
        const double depth = b0 * p[0].z() + b1 * p[1].z() + b2 * p[2].z();
        const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                               static_cast<std::size_t>(x);
        if (depth <= depths_[at]) continue;
        depths_[at] = depth;
        colors_[at] = shade(Vec3(b0, b1, b2));
      }
  }

  Image image() const {
    Image image{width_ / kSamples, height_ / kSamples};
    image.pixels.reserve(static_cast<std::size_t>(image.width) *
                         static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        Color sum{0, 0, 0};
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i) {
            const Color& color = colors_[static_cast<std::size_t>(kSamples * y + j) *
                                             static_cast<std::size_t>(width_) +
                                         static_cast<std::size_t>(kSamples * x + i)];
            sum = {sum.red + color.red, sum.green + color.green, sum.blue + color.blue};
          }
        const auto byte = [](double value) {
          return static_cast<std::uint32_t>(
              std::lround(255 * std::clamp(value / (kSamples * kSamples), 0.0, 1.0)));
        };
        image.pixels.push_back(byte(sum.red) << 16 | byte(sum.green) << 8 | byte(sum.blue));
      }
    return image;
  }

 private:
  int width_, height_;
  std::vector<double> depths_;
  std::vector<Color> colors_;
};

}  // namespace

Color ColorScale::at(double value) const {
  if (!std::isfinite(value)) return kNoValue;
  const double t = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) : 0.5;
  const double place = t * static_cast<double>(kColors.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
  return mix(kColors[k], kColors[k + 1], place - static_cast<double>(k));
}

Image render(const PolygonMesh& mesh, const Vector& values, const ColorScale& scale, int width,
             int height) {
  Painter painter(kSamples * width, kSamples * height);
  const PolygonMesh triangles = triangulate(mesh);
  Points seen = mesh.points() * view_frame().transpose();
  const Points normals = vertex_normals(seen, triangles);
  const Eigen::RowVector3d low = seen.colwise().minCoeff(), high = seen.colwise().maxCoeff();
  const double room = (1 - 2 * kMargin) * kSamples;
  const double zoom = std::min(room * width / std::max(high.x() - low.x(), 1e-300),
                               room * height / std::max(high.y() - low.y(), 1e-300));
  seen = (seen.rowwise() - (low + high) / 2) * zoom;
  seen.col(0).array() += kSamples * width / 2.0;
  seen.col(1) = kSamples * height / 2.0 - seen.col(1).array();
  const double step = scale.isolines > 0 ? (scale.high - scale.low) / scale.isolines : 0;
  const auto& corners = triangles.faces().indices;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    std::array<Vec3, 3> p;
    Vec3 value, light;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = corners[c + k];
      p[k] = seen.row(v);
      value[static_cast<Eigen::Index>(k)] = values[v];
      light[static_cast<Eigen::Index>(k)] = std::abs(normals(v, 2));
    }
    // Change of the value a sample, along the screen.
    const Vec3 a = p[1] - p[0], b = p[2] - p[0];
    const double area = a.x() * b.y() - a.y() * b.x();
    const Vec2 slope((value[1] - value[0]) * b.y() - (value[2] - value[0]) * a.y(),
                     (value[2] - value[0]) * a.x() - (value[1] - value[0]) * b.x());
    const double change = slope.norm() / std::abs(area);
    painter.triangle(p, [&](const Vec3& weights) {
      const double here = weights.dot(value);
      const double shade = kAmbient + (1 - kAmbient) * weights.dot(light);
      const Color color = mix(rgb(0), scale.at(here), shade);
      if (!(step > 0)) return color;
      const double from_line = std::abs(here - step * std::round(here / step));
      return from_line < kHalfLine * change ? kLine : color;
    });
  }
  return painter.image();
}

}  // namespace carat::cli
