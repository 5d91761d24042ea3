#include "carat/kernels/tet_diamond_block.h"

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

// Volumes below this part of the cubed size are near rounding noise.
constexpr double kThin = 1e-11;

struct alignas(64) Lanes {
  double x[8][3][kBlockTets], sign[kBlockTets], boundary[4][kBlockTets];
  double pair[6][kBlockTets], across[4][kBlockTets], face_mass[4][kBlockTets];
  double cell_mass[kBlockTets], volume[4][kBlockTets], thick[kBlockTets];
};

constexpr int kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

/// Adds the diamonds of the face opposite to vertex K, its vertices ascending.
template <int K>
[[gnu::always_inline]] inline void add_face(Lanes& lanes, double limit2) {
  constexpr int A = K == 0 ? 1 : 0, B = K <= 1 ? 2 : 1, C = K == 3 ? 2 : 3;
  for (int l = 0; l < kBlockTets; ++l) {
    // Seen from above the face runs counter-clockwise; + if the cell is above.
    const double side = (K % 2 == 1 ? 1.0 : -1.0) * lanes.sign[l];
    const bool boundary = lanes.boundary[K][l] > 0;
    double ab[3], ac[3], d[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const double a = lanes.x[A][i][l];
      ab[i] = lanes.x[B][i][l] - a;
      ac[i] = lanes.x[C][i][l] - a;
      const double middle = a + (ab[i] + ac[i]) / 3;
      d[i] = 0.25 * side * (lanes.x[K][i][l] - (boundary ? middle : lanes.x[4 + K][i][l]));
    }
    const double s0 = ac[1] * d[2] - ac[2] * d[1], s1 = ac[2] * d[0] - ac[0] * d[2],
                 s2 = ac[0] * d[1] - ac[1] * d[0];
    const double t0 = d[1] * ab[2] - d[2] * ab[1], t1 = d[2] * ab[0] - d[0] * ab[2],
                 t2 = d[0] * ab[1] - d[1] * ab[0];
    const double w0 = ab[1] * ac[2] - ab[2] * ac[1], w1 = ab[2] * ac[0] - ab[0] * ac[2],
                 w2 = ab[0] * ac[1] - ab[1] * ac[0];
    // Of one minimal diamond, whose base is a third of the face.
    const double det = (w0 * d[0] + w1 * d[1] + w2 * d[2]) / 3;
    const double b0 = ac[0] - ab[0], b1 = ac[1] - ab[1], b2 = ac[2] - ab[2];
    double size2 = ab[0] * ab[0] + ab[1] * ab[1] + ab[2] * ab[2];
    const double ac2 = ac[0] * ac[0] + ac[1] * ac[1] + ac[2] * ac[2];
    const double bc2 = b0 * b0 + b1 * b1 + b2 * b2;
    const double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    size2 = ac2 > size2 ? ac2 : size2;
    size2 = bc2 > size2 ? bc2 : size2;
    size2 = d2 > size2 ? d2 : size2;
    const bool sound = (det > 0) & (det * det > limit2 * (size2 * size2 * size2));
    // |D| |g|^2 with g = (s du_ab + t du_ac + w du_tip) / (3 det), |D| = det / 2 for all three
    const double scale = sound ? 1 / (18 * det) : 0.0;
    const double volume = sound ? det / 6 : 0.0;
    const double ss = scale * (s0 * s0 + s1 * s1 + s2 * s2);
    const double tt = scale * (t0 * t0 + t1 * t1 + t2 * t2);
    const double st = scale * (s0 * t0 + s1 * t1 + s2 * t2);
    const double sw = side * scale * (s0 * w0 + s1 * w1 + s2 * w2);
    const double tw = side * scale * (t0 * w0 + t1 * w1 + t2 * w2);
    const double gamma = scale * (w0 * w0 + w1 * w1 + w2 * w2);
    const double alpha_a = -(sw + tw), alpha_b = sw, alpha_c = tw;
    // Both cells of a face add half of what lies within it. At the boundary u_f, the mean of the
    // face's vertices, stands for u_across.
    const double share = boundary ? 1.0 : 0.5, folded = boundary ? 1.0 : 0.0;
    const double common = gamma / 144, to_own = folded * gamma / 48;
    lanes.pair[kPair[A][B]][l] += share * (ss + st) + folded * ((alpha_a + alpha_b) / 12 - common);
    lanes.pair[kPair[A][C]][l] += share * (tt + st) + folded * ((alpha_a + alpha_c) / 12 - common);
    lanes.pair[kPair[B][C]][l] += folded * ((alpha_b + alpha_c) / 12 - common) - share * st;
    lanes.pair[kPair[A][K]][l] += to_own - alpha_a / 4;
    lanes.pair[kPair[B][K]][l] += to_own - alpha_b / 4;
    lanes.pair[kPair[C][K]][l] += to_own - alpha_c / 4;
    lanes.across[K][l] = boundary ? 0.0 : gamma / 16;
    // Each minimal diamond: 1/6 to a vertex, 1/4 to a tip; 1/4 throughout at the boundary. The face
    // point's part has weights 1/9 over the pairs.
    lanes.face_mass[K][l] = volume * (boundary ? 1.0 / 12 : 1.0 / 36);
    lanes.cell_mass[l] += 3 * volume / 64;
    lanes.volume[K][l] = volume;
  }
}

CARAT_MULTIVERSION void compute(Lanes& lanes, double limit2) {
  for (int p = 0; p < 6; ++p)
    for (int l = 0; l < kBlockTets; ++l) lanes.pair[p][l] = 0;
  for (int l = 0; l < kBlockTets; ++l) lanes.cell_mass[l] = 0;
  add_face<0>(lanes, limit2);
  add_face<1>(lanes, limit2);
  add_face<2>(lanes, limit2);
  add_face<3>(lanes, limit2);
  for (int l = 0; l < kBlockTets; ++l) {
    double e[3][3], size2 = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) e[i][k] = lanes.x[i + 1][k][l] - lanes.x[0][k][l];
      const double length2 = e[i][0] * e[i][0] + e[i][1] * e[i][1] + e[i][2] * e[i][2];
      size2 = length2 > size2 ? length2 : size2;
    }
    const double det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                       e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    lanes.thick[l] = det * det > kThin * kThin * (size2 * size2 * size2) ? 1.0 : 0.0;
  }
}

}  // namespace

bool tet_diamond_block(const double* points, const TetDiamondInput* input, double eps_rel,
                       TetDiamonds* const* tets, double (*volumes)[4]) {
  Lanes lanes;
  for (int l = 0; l < kBlockTets; ++l) {
    const Index* const vertices = input[l].vertices;
    for (int i = 0; i < 8; ++i) {
      const Index v = vertices[i] >= 0 ? vertices[i] : vertices[0];
      const double* const x = points + 3 * static_cast<std::ptrdiff_t>(v);
      for (int k = 0; k < 3; ++k) lanes.x[i][k][l] = x[k];
    }
    for (int k = 0; k < 4; ++k) lanes.boundary[k][l] = vertices[4 + k] < 0 ? 1.0 : 0.0;
    lanes.sign[l] = input[l].sign;
  }
  const double limit = 6 * eps_rel;
  compute(lanes, limit * limit);
  bool thick = true;
  for (int l = 0; l < kBlockTets; ++l) {
    TetDiamonds& tet = *tets[l];
    for (int p = 0; p < 6; ++p) tet.pair[p] = lanes.pair[p][l];
    for (int k = 0; k < 4; ++k) tet.across[k] = lanes.across[k][l];
    for (int k = 0; k < 4; ++k) tet.face_mass[k] = lanes.face_mass[k][l];
    tet.cell_mass = lanes.cell_mass[l];
    for (int k = 0; k < 4; ++k) volumes[l][k] = lanes.volume[k][l];
    thick = thick && lanes.thick[l] > 0;
  }
  return thick;
}

}  // namespace carat
