#include "carat/kernels/virtual_cell_block.h"

#include <cmath>

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

// As in VirtualCellKernel, whose sums have the same order.
constexpr double kNoise = 1e-13;

// One element a cell, whatever the width of registers; comparisons give masks.
using Lanes [[gnu::vector_size(kBlockCells * sizeof(double))]] = double;
using Mask = decltype(Lanes{} < Lanes{});

struct Three {
  Lanes x, y, z;
};

[[gnu::always_inline]] inline Lanes dot(const Three& a, const Three& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Three cross(const Three& a, const Three& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Solves for symmetric a = (xx, yy, zz, xy, xz, yz).
[[gnu::always_inline]] inline Mask solve(const Lanes (&a)[6], const Three& b, Three& x) {
  const Three r0{a[0], a[3], a[4]}, r1{a[3], a[1], a[5]}, r2{a[4], a[5], a[2]};
  const Three c12 = cross(r1, r2), c20 = cross(r2, r0), c01 = cross(r0, r1);
  const Lanes det = dot(r0, c12);
  const Lanes trace = a[0] + a[1] + a[2];
  x = {(c12.x * b.x + c20.x * b.y + c01.x * b.z) / det,
       (c12.y * b.x + c20.y * b.y + c01.y * b.z) / det,
       (c12.z * b.x + c20.z * b.y + c01.z * b.z) / det};
  return det > kNoise * trace * trace * trace;
}

[[gnu::always_inline]] inline void compute(HexahedronBlock& block, bool centroid, Mask& sound) {
  constexpr int kVertices = HexahedronBlock::kVertices, kFaces = HexahedronBlock::kFaces,
                kCorners = HexahedronBlock::kCorners, kAll = kVertices + kFaces;
  const auto at = [](const double(&lanes)[kBlockCells]) {
    return *reinterpret_cast<const Lanes*>(lanes);
  };
  {
    Three mean{};
#pragma GCC unroll 14
    for (int i = 0; i < kAll; ++i) {
      mean.x += at(block.position[i][0]);
      mean.y += at(block.position[i][1]);
      mean.z += at(block.position[i][2]);
    }
    mean = {mean.x / kAll, mean.y / kAll, mean.z / kAll};
    Lanes size2{};
#pragma GCC unroll 8
    for (int i = 0; i < kVertices; ++i) {
      const Three x{at(block.position[i][0]) - mean.x, at(block.position[i][1]) - mean.y,
                    at(block.position[i][2]) - mean.z};
      const Lanes r2 = dot(x, x);
      size2 = size2 < r2 ? r2 : size2;
    }
    Mask is_sound = size2 > 0;
    Lanes scale;
    for (int l = 0; l < kBlockCells; ++l) scale[l] = std::sqrt(size2[l]);
    scale = 1 / scale;
    const Lanes scale2 = scale * scale, scale4 = scale2 * scale2;
    // (sum a a^T) x_c = sum a (a . x_f)     [BBA21 (29)]
    Lanes a[6] = {}, c[6] = {};
    Three b{};
    const auto scaled = [&](int i) {
      return Three{scale * (at(block.position[i][0]) - mean.x),
                   scale * (at(block.position[i][1]) - mean.y),
                   scale * (at(block.position[i][2]) - mean.z)};
    };
#pragma GCC unroll 6
    for (int f = 0; f < kFaces; ++f) {
      Lanes m[6];
#pragma GCC unroll 6
      for (int k = 0; k < 6; ++k) {
        m[k] = scale4 * at(block.moment[f][k]);
        a[k] += m[k];
      }
      const Three x = scaled(kVertices + f);
      b.x += m[0] * x.x + m[3] * x.y + m[4] * x.z;
      b.y += m[3] * x.x + m[1] * x.y + m[5] * x.z;
      b.z += m[4] * x.x + m[5] * x.y + m[2] * x.z;
    }
    Three offset;
    const Mask minimised = solve(a, b, offset);
    if (centroid)
      offset = Three{Lanes{}, Lanes{}, Lanes{}};
    else
      is_sound = is_sound & minimised;
#pragma GCC unroll 14
    for (int i = 0; i < kAll; ++i) {
      const Three y = scaled(i);
      c[0] += y.x * y.x;
      c[1] += y.y * y.y;
      c[2] += y.z * y.z;
      c[3] += y.x * y.y;
      c[4] += y.x * y.z;
      c[5] += y.y * y.z;
    }
    Three w;
    is_sound = is_sound & solve(c, offset, w);
#pragma GCC unroll 14
    for (int i = 0; i < kAll; ++i)
      *reinterpret_cast<Lanes*>(block.weight[i]) = 1.0 / kAll + dot(scaled(i), w);
    const Three point{mean.x + offset.x / scale, mean.y + offset.y / scale,
                      mean.z + offset.z / scale};
#pragma GCC unroll 6
    for (int f = 0; f < kFaces; ++f) {
      const Three xf{at(block.position[kVertices + f][0]), at(block.position[kVertices + f][1]),
                     at(block.position[kVertices + f][2])};
      const Lanes sign = at(block.sign[f]);
      const auto corner = [&](int i) {
        return Three{at(block.corner[f][i][0]), at(block.corner[f][i][1]),
                     at(block.corner[f][i][2])};
      };
#pragma GCC unroll 4
      for (int i = 0; i < kCorners; ++i) {
        const Three area = cross(corner(i == 0 ? kCorners - 1 : i - 1), corner(i));
        const Three normal{sign * area.x, sign * area.y, sign * area.z};
        const Lanes depth = dot(normal, xf) - dot(normal, point), area2 = dot(normal, normal);
        const Mask flips = (area2 > kNoise * kNoise * size2 * size2) &
                           ~((depth > 0) & (depth * depth > kNoise * kNoise * size2 * area2));
        is_sound = is_sound & ~flips;
      }
    }
    sound = is_sound;
  }
}

CARAT_MULTIVERSION void compute_versions(HexahedronBlock& block, bool centroid, Mask& sound) {
  compute(block, centroid, sound);
}

}  // namespace

unsigned virtual_cell_block(HexahedronBlock& block, bool centroid) {
  Mask sound;
  compute_versions(block, centroid, sound);
  unsigned unsound = 0;
  for (int l = 0; l < kBlockCells; ++l) unsound |= static_cast<unsigned>(sound[l] == 0) << l;
  return unsound;
}

}  // namespace carat
