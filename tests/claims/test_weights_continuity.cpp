// Weights of nearly planar faces: those in the plane change no faster than the vertices; those of
// minimum norm in space jump where a face becomes planar, as the choice between them documents.

#include <random>

#include "support/claim_cases.h"
#include "support/measures.h"

namespace carat::test {
namespace {

PolygonMesh out_of_plane(const PolygonMesh& mesh, double amount) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  const double length = mesh_statistics(mesh).edge_length.mean;
  Points points = mesh.points();
  for (Index v = 0; v < mesh.n_vertices(); ++v) points(v, 2) += amount * length * number(random);
  return mesh.with_points(points);
}

SparseMatrix stiffness(const PolygonMesh& mesh, AffineWeights weights) {
  DiscretizationOptions options;
  options.virtual_vertex.weights = weights;
  return discretize(mesh, "diamond", options).stiffness;
}

class WeightsContinuity : public testing::TestWithParam<const char*> {};

TEST_P(WeightsContinuity, in_plane_weights_are_lipschitz) {
  for (const double jitter : {0.0, 0.2}) {
    const PolygonMesh flat = generate_mesh(GetParam(), {.level = 0, .jitter = jitter});
    const SparseMatrix reference = stiffness(flat, AffineWeights::InPlane);
    const double steepness = condition(flat);
    double worst = 0;
    for (int exponent = -16; exponent <= -1; ++exponent) {
      const double amount = std::pow(10.0, exponent);
      const double change =
          difference(stiffness(out_of_plane(flat, amount), AffineWeights::InPlane), reference);
      // To first order the change vanishes, by symmetry about the plane; rounding remains.
      worst = std::max(worst, change / (amount + 100 * kEps * steepness));
    }
    RecordProperty("lipschitz", std::to_string(worst));
    EXPECT_LT(worst, 2 * std::max(1.0, steepness / 10));
  }
}

TEST_P(WeightsContinuity, minimum_norm_in_space_jumps) {
  const PolygonMesh flat = generate_mesh(GetParam(), {.level = 0, .jitter = 0.2});
  const SparseMatrix reference = stiffness(flat, AffineWeights::MinimumNorm);
  EXPECT_LT(difference(reference, stiffness(flat, AffineWeights::InPlane)), 1e-12)
      << "both rules agree on planar faces";
  // Above the rank cut, of relative height 1e-7.
  const double amount = 1e-5;
  const double change =
      difference(stiffness(out_of_plane(flat, amount), AffineWeights::MinimumNorm), reference);
  RecordProperty("jump", std::to_string(change));
  EXPECT_GT(change, 100 * amount);
}

// Faces of more than three vertices; triangles have no choice.
INSTANTIATE_TEST_SUITE_P(Families, WeightsContinuity,
                         testing::Values("plane-quads", "plane-voronoi", "plane-concave",
                                         "plane-lshape"),
                         [](const testing::TestParamInfo<const char*>& family) {
                           std::string name = family.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace carat::test
