#include "carat/kernels/tetrahedron_block.h"

#include "carat/kernels/multiversion.h"

namespace carat {
namespace {

struct alignas(64) Lanes {
  double x[4][3][kBlockTets], sign[kBlockTets];
  double pair[6][kBlockTets], volume[kBlockTets], longest2[kBlockTets];
};

CARAT_MULTIVERSION void compute(Lanes& lanes) {
  for (int l = 0; l < kBlockTets; ++l) {
    double e[3][3], n[4][3], edge2[6];  // edges from the fourth vertex; normals as in Tetrahedron
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) e[i][k] = lanes.x[i][k][l] - lanes.x[3][k][l];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      n[i][0] = e[a][1] * e[b][2] - e[a][2] * e[b][1];
      n[i][1] = e[a][2] * e[b][0] - e[a][0] * e[b][2];
      n[i][2] = e[a][0] * e[b][1] - e[a][1] * e[b][0];
      const double d0 = e[a][0] - e[b][0], d1 = e[a][1] - e[b][1], d2 = e[a][2] - e[b][2];
      edge2[i] = d0 * d0 + d1 * d1 + d2 * d2;
      edge2[3 + i] = e[i][0] * e[i][0] + e[i][1] * e[i][1] + e[i][2] * e[i][2];
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) n[3][k] = -(n[0][k] + n[1][k] + n[2][k]);
    double longest2 = edge2[0];
#pragma GCC unroll 6
    for (int i = 1; i < 6; ++i) longest2 = edge2[i] > longest2 ? edge2[i] : longest2;
    const double det = lanes.sign[l] * (e[0][0] * n[0][0] + e[0][1] * n[0][1] + e[0][2] * n[0][2]);
    const double scale = -1 / (6 * det);
    const auto dot = [&](int a, int b) {
      return scale * (n[a][0] * n[b][0] + n[a][1] * n[b][1] + n[a][2] * n[b][2]);
    };
    lanes.pair[0][l] = dot(0, 1);
    lanes.pair[1][l] = dot(0, 2);
    lanes.pair[2][l] = dot(0, 3);
    lanes.pair[3][l] = dot(1, 2);
    lanes.pair[4][l] = dot(1, 3);
    lanes.pair[5][l] = dot(2, 3);
    lanes.volume[l] = det / 6;
    lanes.longest2[l] = longest2;
  }
}

}  // namespace

void linear_tet_block(const double* points, const Index* const* vertices, const double* sign,
                      LinearTet* const* tets) {
  Lanes lanes;
  for (int l = 0; l < kBlockTets; ++l) {
    for (int i = 0; i < 4; ++i) {
      const double* const x = points + 3 * static_cast<std::ptrdiff_t>(vertices[l][i]);
      for (int k = 0; k < 3; ++k) lanes.x[i][k][l] = x[k];
    }
    lanes.sign[l] = sign[l];
  }
  compute(lanes);
  for (int l = 0; l < kBlockTets; ++l) {
    LinearTet& tet = *tets[l];
    for (int p = 0; p < 6; ++p) tet.pair[p] = lanes.pair[p][l];
    tet.volume = lanes.volume[l];
    tet.longest2 = lanes.longest2[l];
  }
}

}  // namespace carat
