#include "carat/kernels/tet_diamond_block.h"

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

// Volumes below this part of the cubed size are near rounding noise.
constexpr double kThin = 1e-11;

struct alignas(64) Lanes {
  double x[8][3][kBlockTets], sign[kBlockTets];
  double boundary[4][kBlockTets];  // of faces: 1, inner ones 0, those that are left out -1
  double pair[6][kBlockTets], across[4][kBlockTets], face_mass[4][kBlockTets];
  double cell_mass[kBlockTets], volume[4][kBlockTets], thick[kBlockTets];
  double vertex_mass[4][kBlockTets];
};

constexpr int kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

/// Masses of the three diamonds of a face, as fractions of one diamond.
struct FaceMasses {
  double corner[3];  // of its vertices
  double face_point;
  double own, other;  // of the tips
};

inline double larger(double a, double b) { return a > b ? a : b; }
inline double smaller(double a, double b) { return a < b ? a : b; }

/// As moment_exact_mass.
/// \param at    barycentric coordinates of the axis in the face
/// \param part  of the volume, on the side of the own tip
[[gnu::always_inline]] inline FaceMasses moment_exact_masses(const double (&at)[3], double part,
                                                             double other_part, double tau) {
  FaceMasses masses{};
  const double less = smaller(part, other_part);
  const double least = less < 0 ? -less / (1 - less) : 0.0;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    // Between vertices i and j = i + 1 and the face point, whose weights are 1/3.
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double at_i = at[i] - at[k], at_j = at[j] - at[k], at_point = 3 * at[k];
    const double most = 1 / larger(1.0, larger(larger(at_i, at_j), at_point));
    const bool serves = !(least > most);
    const double t = larger(least, smaller(most, tau));
    const auto share = [&](double value) { return serves ? larger(0.0, 0.25 * value) : 0.2; };
    masses.corner[i] += share(1 - t * at_i);
    masses.corner[j] += share(1 - t * at_j);
    masses.face_point += share(1 - t * at_point);
    masses.own += share(t + (1 - t) * part);
    masses.other += share(t + (1 - t) * other_part);
  }
  return masses;
}

/// Adds the diamonds of the face opposite to vertex K, its vertices ascending.
template <int K, bool kHalves, bool kMomentExact>
[[gnu::always_inline]] inline void add_face(Lanes& lanes, double limit2,
                                            [[maybe_unused]] double eps_rel,
                                            [[maybe_unused]] const TetHalves& halves) {
  [[maybe_unused]] const double jump_part = halves.jump, tau = halves.tau;
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
    const bool sound =
        (det > 0) & (det * det > limit2 * (size2 * size2 * size2)) & (lanes.boundary[K][l] >= 0);
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
    lanes.volume[K][l] = volume;
    if constexpr (kHalves) {
      // Heights of the tips above and below the face, of which both cells compute the same bits.
      double own[3], other[3];
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        own[i] = lanes.x[K][i][l] - lanes.x[A][i][l];
        other[i] = lanes.x[4 + K][i][l] - lanes.x[A][i][l];
      }
      const double own_height = side * (w0 * own[0] + w1 * own[1] + w2 * own[2]);
      const double other_height = -side * (w0 * other[0] + w1 * other[1] + w2 * other[2]);
      const double heights = own_height + other_height;
      const double part = own_height / heights, other_part = other_height / heights;
      double q[3];  // where the axis meets the face, from its first vertex
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        q[i] = 0.25 * (ab[i] + ac[i] + (other_part * own[i] + part * other[i]));
      const double inverse = 1 / (w0 * w0 + w1 * w1 + w2 * w2);
      const double at_b =
          inverse * (w0 * (q[1] * ac[2] - q[2] * ac[1]) + w1 * (q[2] * ac[0] - q[0] * ac[2]) +
                     w2 * (q[0] * ac[1] - q[1] * ac[0]));
      const double at_c =
          inverse * (w0 * (ab[1] * q[2] - ab[2] * q[1]) + w1 * (ab[2] * q[0] - ab[0] * q[2]) +
                     w2 * (ab[0] * q[1] - ab[1] * q[0]));
      const double at[3] = {1 - at_b - at_c, at_b, at_c};
      // The jump is c . u over the face and the two opposite vertices.
      const bool jumps = sound & !boundary & (part > eps_rel) & (other_part > eps_rel);
      const double whole_jump = jump_part * gamma / (part * other_part);
      const double jump = jumps ? whole_jump : 0.0;
      double c[3];
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        const double value = 0.25 - at[i];
        c[i] = jumps ? value : 0.0;
      }
      const double c_own = jumps ? 0.25 * other_part : 0.0, c_other = jumps ? 0.25 * part : 0.0;
      lanes.pair[kPair[A][B]][l] -= 0.5 * jump * (c[0] * c[1]);
      lanes.pair[kPair[A][C]][l] -= 0.5 * jump * (c[0] * c[2]);
      lanes.pair[kPair[B][C]][l] -= 0.5 * jump * (c[1] * c[2]);
      lanes.pair[kPair[A][K]][l] -= jump * (c[0] * c_own);
      lanes.pair[kPair[B][K]][l] -= jump * (c[1] * c_own);
      lanes.pair[kPair[C][K]][l] -= jump * (c[2] * c_own);
      lanes.across[K][l] -= jump * (c_own * c_other);
      if constexpr (kMomentExact) {
        const FaceMasses exact = moment_exact_masses(at, part, other_part, tau);
        const bool split = sound & !boundary;
        const double quarter = boundary ? volume * 0.5 : 0.0;  // of two diamonds at the boundary
        const double half = 0.5 * volume;                      // the other cell adds as much
        lanes.vertex_mass[A][l] += split ? half * exact.corner[0] : quarter;
        lanes.vertex_mass[B][l] += split ? half * exact.corner[1] : quarter;
        lanes.vertex_mass[C][l] += split ? half * exact.corner[2] : quarter;
        lanes.face_mass[K][l] = split ? half * exact.face_point / 9 : volume / 12;
        lanes.cell_mass[l] += split ? volume * exact.own / 16 : 3 * volume / 64;
      }
    }
    if constexpr (!kMomentExact) {
      // Each minimal diamond: 1/6 to a vertex, 1/4 to a tip; 1/4 throughout at the boundary. The
      // face point's part has weights 1/9 over the pairs.
      lanes.face_mass[K][l] = volume * (boundary ? 1.0 / 12 : 1.0 / 36);
      lanes.cell_mass[l] += 3 * volume / 64;
      if constexpr (kHalves) {
        lanes.vertex_mass[A][l] += 6 * lanes.face_mass[K][l];
        lanes.vertex_mass[B][l] += 6 * lanes.face_mass[K][l];
        lanes.vertex_mass[C][l] += 6 * lanes.face_mass[K][l];
      }
    }
  }
}

template <bool kHalves, bool kMomentExact>
[[gnu::always_inline]] inline void add_faces(Lanes& lanes, double limit2, double eps_rel,
                                             const TetHalves& halves) {
  for (int p = 0; p < 6; ++p)
    for (int l = 0; l < kBlockTets; ++l) lanes.pair[p][l] = 0;
  for (int l = 0; l < kBlockTets; ++l) lanes.cell_mass[l] = 0;
  if constexpr (kHalves)
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < kBlockTets; ++l) lanes.vertex_mass[k][l] = 0;
  add_face<0, kHalves, kMomentExact>(lanes, limit2, eps_rel, halves);
  add_face<1, kHalves, kMomentExact>(lanes, limit2, eps_rel, halves);
  add_face<2, kHalves, kMomentExact>(lanes, limit2, eps_rel, halves);
  add_face<3, kHalves, kMomentExact>(lanes, limit2, eps_rel, halves);
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

CARAT_MULTIVERSION void compute(Lanes& lanes, double limit2) {
  add_faces<false, false>(lanes, limit2, 0, {});
}

CARAT_MULTIVERSION void compute_halves(Lanes& lanes, double limit2, double eps_rel,
                                       const TetHalves& halves) {
  add_faces<true, false>(lanes, limit2, eps_rel, halves);
}

CARAT_MULTIVERSION void compute_moment_exact(Lanes& lanes, double limit2, double eps_rel,
                                             const TetHalves& halves) {
  add_faces<true, true>(lanes, limit2, eps_rel, halves);
}

void load(const double* points, const TetDiamondInput* input, Lanes& lanes) {
  for (int l = 0; l < kBlockTets; ++l) {
    const Index* const vertices = input[l].vertices;
    for (int i = 0; i < 8; ++i) {
      const Index v = vertices[i] >= 0 ? vertices[i] : vertices[0];
      const double* const x = points + 3 * static_cast<std::ptrdiff_t>(v);
      for (int k = 0; k < 3; ++k) lanes.x[i][k][l] = x[k];
    }
    for (int k = 0; k < 4; ++k)
      lanes.boundary[k][l] = (input[l].left_out >> k & 1U) ? -1.0 : vertices[4 + k] < 0 ? 1.0 : 0.0;
    lanes.sign[l] = input[l].sign;
  }
}

bool store(const Lanes& lanes, TetDiamonds* const* tets, double (*volumes)[4]) {
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

/// |D| <= eps_rel size^3 with |D| = det / 6, squared.
double limit2(double eps_rel) { return 36 * eps_rel * eps_rel; }

}  // namespace

bool tet_diamond_block(const double* points, const TetDiamondInput* input, double eps_rel,
                       TetDiamonds* const* tets, double (*volumes)[4]) {
  Lanes lanes;
  load(points, input, lanes);
  compute(lanes, limit2(eps_rel));
  return store(lanes, tets, volumes);
}

bool tet_diamond_block(const double* points, const TetDiamondInput* input, double eps_rel,
                       const TetHalves& halves, TetDiamonds* const* tets,
                       double* const* vertex_masses, double (*volumes)[4]) {
  Lanes lanes;
  load(points, input, lanes);
  if (halves.moment_exact)
    compute_moment_exact(lanes, limit2(eps_rel), eps_rel, halves);
  else
    compute_halves(lanes, limit2(eps_rel), eps_rel, halves);
  for (int l = 0; l < kBlockTets; ++l)
    for (int k = 0; k < 4; ++k) vertex_masses[l][k] = lanes.vertex_mass[k][l];
  return store(lanes, tets, volumes);
}

}  // namespace carat
