#include "carat/kernels/triangle_diamond_block.h"

#include <cmath>

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

// Twice the bound on |area vector| / longest side^2 below which VirtualVertexKernel calls a
// triangle degenerate: the same with a margin for rounding.
constexpr double kThin = 4e-13;

inline double larger(double a, double b) { return a > b ? a : b; }

template <bool kCrossing>
[[gnu::always_inline]] inline void compute(TriangleDiamondBlock& block, double eps_rel,
                                           [[maybe_unused]] TriangleCrossingBlock* crossing) {
  for (int k = 0; k < kBlockDiamonds; ++k) {
    const double x = block.x[0][0][k], y = block.x[0][1][k], z = block.x[0][2][k];
    const double ex = block.x[1][0][k] - x, ey = block.x[1][1][k] - y, ez = block.x[1][2][k] - z;
    const double lx = block.x[2][0][k] - x, ly = block.x[2][1][k] - y, lz = block.x[2][2][k] - z;
    const bool inner = block.inner[k] > 0;
    const double rx = inner ? block.x[3][0][k] - x : 0.5 * ex;
    const double ry = inner ? block.x[3][1][k] - y : 0.5 * ey;
    const double rz = inner ? block.x[3][2][k] - z : 0.5 * ez;
    const double length2 = ex * ex + ey * ey + ez * ez;
    const double nlx = ey * lz - ez * ly, nly = ez * lx - ex * lz, nlz = ex * ly - ey * lx;
    const double nrx = ey * rz - ez * ry, nry = ez * rx - ex * rz, nrz = ex * ry - ey * rx;
    const double left = std::sqrt(nlx * nlx + nly * nly + nlz * nlz);
    const double right = std::sqrt(nrx * nrx + nry * nry + nrz * nrz);
    const double a2 = (left + right) / 3;  // 2 |D|
    const double q = ((lx - rx) * ex + (ly - ry) * ey + (lz - rz) * ez) / 3;
    // Nine times the squared distances of the virtual vertices from x1.
    const double sx = ex + lx, sy = ey + ly, sz = ez + lz;
    const double tx = ex + rx, ty = ey + ry, tz = ez + rz;
    const double size2 =
        larger(length2, larger(sx * sx + sy * sy + sz * sz, tx * tx + ty * ty + tz * tz) / 9);
    const bool sound = length2 > 0 && a2 > 2 * eps_rel * size2;
    const double half = 0.5 / a2, inverse = 1 / length2;
    const double beta = q * half;
    block.gamma[k] = sound ? length2 * half : 0.0;
    block.beta[k] = sound ? beta : 0.0;
    block.alpha[k] = sound ? (0.5 * a2 + q * beta) * inverse : 0.0;
    block.area[k] = sound ? 0.5 * a2 : 0.0;
    block.thin[k] = (left <= kThin * length2) | (inner & (right <= kThin * length2)) ? 1.0 : 0.0;
    if constexpr (kCrossing) {
      const double sum = left + right, l = left / sum, r = right / sum;
      crossing->left_fraction[k] = l;
      crossing->right_fraction[k] = r;
      crossing->foot[k] =
          (r * (ex * sx + ey * sy + ez * sz) + l * (ex * tx + ey * ty + ez * tz)) * inverse / 3;
      const bool jumps = sound & inner & (l > eps_rel) & (r > eps_rel);
      crossing->stiffness[k] = jumps ? length2 * half / (l * r) : 0.0;
    }
  }
}

}  // namespace

CARAT_MULTIVERSION void triangle_diamond_block(TriangleDiamondBlock& block, double eps_rel) {
  compute<false>(block, eps_rel, nullptr);
}

CARAT_MULTIVERSION void triangle_diamond_block(TriangleDiamondBlock& block, double eps_rel,
                                               TriangleCrossingBlock& crossing) {
  compute<true>(block, eps_rel, &crossing);
}

}  // namespace carat
