#include "carat/kernels/face_diamond_block.h"

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

constexpr int kLanes = kBlockDiamondFaces;

struct alignas(64) Lanes {
  double x[kMostDiamondCorners][3][kLanes], point[3][kLanes], axis[3][kLanes], share[kLanes];
  // What a diamond adds at the first and second vertex of its side.
  double spoke_a[kMostDiamondCorners][kLanes], spoke_b[kMostDiamondCorners][kLanes];
  double tip_a[kMostDiamondCorners][kLanes], tip_b[kMostDiamondCorners][kLanes];
  double mass[kMostDiamondCorners][kLanes];
  double degenerate[kLanes];  // how many diamonds are
};

CARAT_MULTIVERSION void compute(int valence, double limit2, Lanes& __restrict lanes,
                                FaceDiamonds& __restrict out) {
  for (int l = 0; l < kLanes; ++l) {
    lanes.degenerate[l] = 0;
    out.point_diagonal[l] = out.point_tip[l] = out.point_mass[l] = 0;
    out.gamma[l] = out.tip_mass[l] = 0;
  }
  for (int i = 0; i < valence; ++i) {
    const int j = i + 1 == valence ? 0 : i + 1;
    for (int l = 0; l < kLanes; ++l) {
      const double x0 = lanes.x[i][0][l], x1 = lanes.x[i][1][l], x2 = lanes.x[i][2][l];
      const double p0 = lanes.x[j][0][l] - x0, p1 = lanes.x[j][1][l] - x1,
                   p2 = lanes.x[j][2][l] - x2;
      const double q0 = lanes.point[0][l] - x0, q1 = lanes.point[1][l] - x1,
                   q2 = lanes.point[2][l] - x2;
      const double d0 = lanes.axis[0][l], d1 = lanes.axis[1][l], d2 = lanes.axis[2][l];
      const double s0 = q1 * d2 - q2 * d1, s1 = q2 * d0 - q0 * d2, s2 = q0 * d1 - q1 * d0;
      const double t0 = d1 * p2 - d2 * p1, t1 = d2 * p0 - d0 * p2, t2 = d0 * p1 - d1 * p0;
      const double w0 = p1 * q2 - p2 * q1, w1 = p2 * q0 - p0 * q2, w2 = p0 * q1 - p1 * q0;
      const double det = w0 * d0 + w1 * d1 + w2 * d2;
      double size2 = p0 * p0 + p1 * p1 + p2 * p2;
      const double qq = q0 * q0 + q1 * q1 + q2 * q2, dd = d0 * d0 + d1 * d1 + d2 * d2;
      size2 = qq > size2 ? qq : size2;
      size2 = dd > size2 ? dd : size2;
      const bool sound = (det > 0) & (det * det > limit2 * (size2 * size2 * size2));
      lanes.degenerate[l] += sound ? 0.0 : 1.0;
      // |D| |g|^2 with g = (s (u2-u1) + t (uf-u1) + w (ur-ul)) / det   [BBA21 (28)]
      const double scale = 1 / (6 * det);
      const double ss = scale * (s0 * s0 + s1 * s1 + s2 * s2);
      const double tt = scale * (t0 * t0 + t1 * t1 + t2 * t2);
      const double st = scale * (s0 * t0 + s1 * t1 + s2 * t2);
      const double sw = scale * (s0 * w0 + s1 * w1 + s2 * w2);
      const double tw = scale * (t0 * w0 + t1 * w1 + t2 * w2);
      const double volume = det / 6;
      const double share = volume / lanes.share[l];
      out.side[i][l] = ss + st;
      lanes.spoke_a[i][l] = tt + st;
      lanes.spoke_b[i][l] = -st;
      lanes.tip_a[i][l] = -(sw + tw);
      lanes.tip_b[i][l] = sw;
      lanes.mass[i][l] = share;
      out.volume[i][l] = volume;
      out.point_diagonal[l] += tt;
      out.point_tip[l] += tw;
      out.point_mass[l] += share;
      out.gamma[l] += scale * (w0 * w0 + w1 * w1 + w2 * w2);
      out.tip_mass[l] += volume / 4;
    }
  }
  for (int i = 0; i < valence; ++i) {
    const int h = i == 0 ? valence - 1 : i - 1;
    for (int l = 0; l < kLanes; ++l) {
      out.spoke[i][l] = lanes.spoke_b[h][l] + lanes.spoke_a[i][l];
      out.diagonal[i][l] =
          (out.side[h][l] + lanes.spoke_b[h][l]) + (out.side[i][l] + lanes.spoke_a[i][l]);
      out.tip[i][l] = lanes.tip_b[h][l] + lanes.tip_a[i][l];
      out.mass[i][l] = lanes.mass[h][l] + lanes.mass[i][l];
    }
  }
}

}  // namespace

unsigned face_diamond_block(int valence, const double* points, const FaceDiamondInput* faces,
                            double eps_rel, FaceDiamonds& result) {
  Lanes lanes;
  for (int l = 0; l < kLanes; ++l) {
    const FaceDiamondInput& face = faces[l];
    for (int i = 0; i < valence; ++i) {
      const double* const x = points + 3 * static_cast<std::ptrdiff_t>(face.vertices[i]);
      for (int k = 0; k < 3; ++k) lanes.x[i][k][l] = x[k];
    }
    for (int k = 0; k < 3; ++k) {
      lanes.point[k][l] = face.face_point[k];
      lanes.axis[k][l] = face.above[k] - face.below[k];
    }
    lanes.share[l] = face.share;
  }
  const double limit = 6 * eps_rel;  // |D| = det / 6
  compute(valence, limit * limit, lanes, result);
  unsigned degenerate = 0;
  for (int l = 0; l < kLanes; ++l)
    degenerate |= static_cast<unsigned>(!(lanes.degenerate[l] == 0)) << l;
  return degenerate;
}

}  // namespace carat
