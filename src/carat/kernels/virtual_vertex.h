#pragma once
// The virtual vertex of a polygon: where it lies and how it depends on the polygon's vertices.

#include <span>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Where the virtual vertex of a face is placed. Triangles: always the centroid.
enum class VirtualPoint {
  AreaMinimizer,   ///< least sum of squared virtual-triangle areas     [BBA21 (19)]
  Centroid,        ///< mean of the vertices
  TraceMinimizer,  ///< least trace of the virtual fan's cotan stiffness, in the face's plane
                   ///< (Bunge, Bukenberger, Wagner, Alexa, Botsch 2024)
};

/// Which of the many affine combinations gives the virtual vertex.
enum class AffineWeights {
  InPlane,      ///< minimum norm in the plane normal to the vector area; Lipschitz in the vertices
  MinimumNorm,  ///< minimum norm in space; jumps where a face becomes planar
};

struct VirtualVertexRule {
  VirtualPoint point = VirtualPoint::AreaMinimizer;
  AffineWeights weights = AffineWeights::InPlane;
  /// Move a point that flips a virtual triangle to the centroid of the face's kernel.
  bool keep_in_kernel = true;

  bool operator==(const VirtualVertexRule&) const = default;
};

/// How the virtual vertex of a face came about.
enum class VirtualVertexStatus : unsigned char {
  Regular,     ///< as asked for
  Moved,       ///< it flipped a virtual triangle and now lies in the kernel's centroid
  Flipped,     ///< it flips a virtual triangle: the kernel is empty, or moving was switched off
  Degenerate,  ///< the face has no area to speak of: mean of the vertices
};

/// One virtual triangle (x_i, x_{i+1}, x_f), seen from its hinge (x_i, x_{i+1}).
struct VirtualTriangle {
  double foot;         ///< of x_f on the hinge: 0 at x_i, 1 at x_{i+1}
  double double_area;  ///< twice the area, >= 0                                [length^2]
};

/// Computes virtual vertices. Holds scratch memory: one object a thread; no allocation once the
/// largest face has been met.
class VirtualVertexKernel {
 public:
  explicit VirtualVertexKernel(VirtualVertexRule rule) : rule_(rule) {}

  /// \param points     all positions
  /// \param face       the face's vertices, n >= 3
  /// \param weights    receives n affine weights, sum 1              [BBA21 (15)]
  /// \param triangles  receives the n virtual triangles
  /// The point itself is available from point() until the next call.
  VirtualVertexStatus compute(const Points& points, std::span<const Index> face, double* weights,
                              VirtualTriangle* triangles);

  /// Virtual vertex of the last face.  [length]
  Vec3 point() const { return mean_ + offset_; }
  /// Vector area of the last face.  [length^2]
  const Vec3& area_vector() const { return area_vector_; }

 private:
  // N: the number of vertices where it is known while compiling, so that loops unroll; 0: n_.
  template <int N>
  VirtualVertexStatus compute_polygon(const Points& points, const Index* face, double* weights,
                                      VirtualTriangle* triangles);
  VirtualVertexStatus compute_triangle(const Points& points, const Index* face, double* weights,
                                       VirtualTriangle* triangles);
  template <int N>
  void load(const Points& points, const Index* face);
  template <int N>
  bool minimise_area();
  template <int N>
  bool set_weights(double* weights);
  template <int N>
  bool flips_a_triangle() const;
  bool set_weights_in_space(double* weights);
  bool minimise_trace();
  bool find_kernel_centroid();
  int next(int i) const { return i + 1 == n_ ? 0 : i + 1; }

  VirtualVertexRule rule_;
  int n_ = 0;
  std::vector<Vec3> x_;  // vertices relative to their mean
  Vec3 mean_, area_vector_, normal_, axis_s_, axis_t_;
  Vec3 offset_;      // virtual vertex relative to the mean
  double size_ = 0;  // largest distance of a vertex from the mean
  std::vector<Vec2> plane_, clipped_, clip_scratch_;
};

}  // namespace carat
