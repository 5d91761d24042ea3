#include "carat/kernels/virtual_vertex_block.h"

#include <cmath>

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

// As in VirtualVertexKernel: rounding noise of the cross products.
constexpr double kNoise = 1e-13;
constexpr double kNoise2 = kNoise * kNoise;

/// The faces' coordinates and results, one lane a face, so that the loop over lanes becomes vector
/// instructions of whatever width there is.
template <int N>
struct alignas(64) Lanes {
  double x[N][3][kBlockFaces];
  double weight[N][kBlockFaces], foot[N][kBlockFaces], double_area[N][kBlockFaces];
  double sound[kBlockFaces];  // 1, or 0 where the general kernel is needed
};

template <int N>
[[gnu::always_inline]] inline void compute_lanes(Lanes<N>& lanes, bool centroid) {
  const double use_point = centroid ? 0.0 : 1.0;
  for (int l = 0; l < kBlockFaces; ++l) {
    double x[N][3], mean[3] = {0, 0, 0};
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
#pragma GCC unroll 6
      for (int i = 0; i < N; ++i) x[i][k] = lanes.x[i][k][l];
#pragma GCC unroll 6
      for (int i = 0; i < N; ++i) mean[k] += x[i][k];
#pragma GCC unroll 6
      for (int i = 0; i < N; ++i) x[i][k] -= mean[k] / N;
    }
    // Vector area, size, and A x_f = b of the area minimiser   [BBA21 (19)]
    double nx = 0, ny = 0, nz = 0, size2 = 0;
    double a00 = 0, a11 = 0, a22 = 0, a01 = 0, a02 = 0, a12 = 0, b0 = 0, b1 = 0, b2 = 0;
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      const int j = i + 1 == N ? 0 : i + 1;
      nx += x[i][1] * x[j][2] - x[i][2] * x[j][1];
      ny += x[i][2] * x[j][0] - x[i][0] * x[j][2];
      nz += x[i][0] * x[j][1] - x[i][1] * x[j][0];
      const double r2 = x[i][0] * x[i][0] + x[i][1] * x[i][1] + x[i][2] * x[i][2];
      size2 = r2 > size2 ? r2 : size2;
      const double e0 = x[j][0] - x[i][0], e1 = x[j][1] - x[i][1], e2 = x[j][2] - x[i][2];
      const double l2 = e0 * e0 + e1 * e1 + e2 * e2;
      const double ex = e0 * x[i][0] + e1 * x[i][1] + e2 * x[i][2];
      a00 += l2 - e0 * e0;
      a11 += l2 - e1 * e1;
      a22 += l2 - e2 * e2;
      a01 -= e0 * e1;
      a02 -= e0 * e2;
      a12 -= e1 * e2;
      b0 += l2 * x[i][0] - e0 * ex;
      b1 += l2 * x[i][1] - e1 * ex;
      b2 += l2 * x[i][2] - e2 * ex;
    }
    const double double_area = std::sqrt(nx * nx + ny * ny + nz * nz);
    bool sound = double_area > 2 * kNoise * size2;
    const double c00 = a11 * a22 - a12 * a12, c01 = a02 * a12 - a01 * a22,
                 c02 = a01 * a12 - a02 * a11;
    const double c11 = a00 * a22 - a02 * a02, c12 = a01 * a02 - a00 * a12,
                 c22 = a00 * a11 - a01 * a01;
    const double det = a00 * c00 + a01 * c01 + a02 * c02;
    const double trace = a00 + a11 + a22;
    sound = sound & (det > kNoise2 * trace * trace * trace);
    const double scale = use_point / det;
    const double f0 = (c00 * b0 + c01 * b1 + c02 * b2) * scale;
    const double f1 = (c01 * b0 + c11 * b1 + c12 * b2) * scale;
    const double f2 = (c02 * b0 + c12 * b1 + c22 * b2) * scale;
    // An orthonormal basis (s, t) of the plane normal to the vector area, without branches.
    nx /= double_area;
    ny /= double_area;
    nz /= double_area;
    const double sign = nz < 0 ? -1.0 : 1.0;
    const double p = -1 / (sign + nz), q = nx * ny * p;
    const double s0 = 1 + sign * nx * nx * p, s1 = sign * q, s2 = -sign * nx;
    const double t0 = q, t1 = sign + ny * ny * p, t2 = -ny;
    // a_i = 1/n + y_i^T (sum y y^T)^-1 y_f
    double ys[N], yt[N], ss = 0, st = 0, tt = 0;
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      ys[i] = x[i][0] * s0 + x[i][1] * s1 + x[i][2] * s2;
      yt[i] = x[i][0] * t0 + x[i][1] * t1 + x[i][2] * t2;
      ss += ys[i] * ys[i];
      st += ys[i] * yt[i];
      tt += yt[i] * yt[i];
    }
    const double fs = f0 * s0 + f1 * s1 + f2 * s2, ft = f0 * t0 + f1 * t1 + f2 * t2;
    const double det2 = ss * tt - st * st;
    sound = sound & (det2 > kNoise2 * (ss + tt) * (ss + tt));
    const double ws = (tt * fs - st * ft) / det2, wt = (ss * ft - st * fs) / det2;
    double y0 = 0, y1 = 0, y2 = 0;  // the virtual vertex
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      const double w = 1.0 / N + ys[i] * ws + yt[i] * wt;
      lanes.weight[i][l] = w;
      y0 += w * x[i][0];
      y1 += w * x[i][1];
      y2 += w * x[i][2];
    }
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      const int j = i + 1 == N ? 0 : i + 1;
      const double e0 = x[j][0] - x[i][0], e1 = x[j][1] - x[i][1], e2 = x[j][2] - x[i][2];
      const double d0 = y0 - x[i][0], d1 = y1 - x[i][1], d2 = y2 - x[i][2];
      const double m0 = e1 * d2 - e2 * d1, m1 = e2 * d0 - e0 * d2, m2 = e0 * d1 - e1 * d0;
      const double l2 = e0 * e0 + e1 * e1 + e2 * e2;
      const double signed_area = m0 * nx + m1 * ny + m2 * nz;
      sound = sound & (signed_area > 0) & (signed_area * signed_area > kNoise2 * size2 * l2);
      lanes.foot[i][l] = (e0 * d0 + e1 * d1 + e2 * d2) / l2;
      lanes.double_area[i][l] = std::sqrt(m0 * m0 + m1 * m1 + m2 * m2);
    }
    lanes.sound[l] = sound ? 1.0 : 0.0;
  }
}

template <int N>
[[gnu::always_inline]] inline unsigned block(const double* points, const Index* const* faces,
                                             bool centroid, double* const* weights,
                                             VirtualTriangle* const* triangles) {
  Lanes<N> lanes;
  for (int l = 0; l < kBlockFaces; ++l) {
    const double* const anchor = points + 3 * static_cast<std::ptrdiff_t>(faces[l][0]);
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      const double* const x = points + 3 * static_cast<std::ptrdiff_t>(faces[l][i]);
      for (int k = 0; k < 3; ++k) lanes.x[i][k][l] = x[k] - anchor[k];
    }
  }
  compute_lanes<N>(lanes, centroid);
  unsigned unsound = 0;
  for (int l = 0; l < kBlockFaces; ++l) {
    unsound |= static_cast<unsigned>(!(lanes.sound[l] > 0)) << l;
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      weights[l][i] = lanes.weight[i][l];
      triangles[l][i] = {lanes.foot[i][l], lanes.double_area[i][l]};
    }
  }
  return unsound;
}

#define CARAT_BLOCK(N)                                                                   \
  CARAT_MULTIVERSION unsigned block_##N(const double* points, const Index* const* faces, \
                                        bool centroid, double* const* weights,           \
                                        VirtualTriangle* const* triangles) {             \
    return block<N>(points, faces, centroid, weights, triangles);                        \
  }
CARAT_BLOCK(4)
CARAT_BLOCK(5)
CARAT_BLOCK(6)
#undef CARAT_BLOCK

}  // namespace

unsigned virtual_vertex_block(int valence, const double* points, const Index* const* faces,
                              bool centroid, double* const* weights,
                              VirtualTriangle* const* triangles) {
  switch (valence) {
    case 4:
      return block_4(points, faces, centroid, weights, triangles);
    case 5:
      return block_5(points, faces, centroid, weights, triangles);
    default:
      return block_6(points, faces, centroid, weights, triangles);
  }
}

}  // namespace carat
