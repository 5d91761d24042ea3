// Parts of a mesh assemble what they own; the sum is the matrix of the whole mesh.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/operators/part_discretization.h"
#include "carat/operators/registry.h"
#include "support/mesh_parts.h"

namespace carat::test {
namespace {

const std::vector<const SurfaceOperator*>& operators_on(const PolygonMesh&) {
  return surface_operators();
}
const std::vector<const VolumeOperator*>& operators_on(const PolyhedralMesh&) {
  return volume_operators();
}

/// The matrix of the whole mesh, from those of its parts.
class Sum {
 public:
  void add(const SparseMatrix& matrix, const Array<Index>& number) {
    for (Index row = 0; row < matrix.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
        entries_.emplace_back(number[row], number[entry.col()], entry.value());
  }
  /// Largest difference to the matrix beside its largest entry.
  double difference(const SparseMatrix& whole) const {
    SparseMatrix::Plain sum(whole.rows(), whole.cols());
    sum.setFromTriplets(entries_.begin(), entries_.end());
    const SparseMatrix::Plain difference = whole - sum;
    return difference.coeffs().abs().maxCoeff() / whole.coeffs().abs().maxCoeff();
  }

 private:
  std::vector<Eigen::Triplet<double, Index>> entries_;
};

/// The rows of a cell coefficient that are the part's.
Matrix select(const Matrix& whole, const Array<Index>& elements) {
  Matrix own(whole.rows() > 0 ? static_cast<Index>(elements.size()) : 0, whole.cols());
  for (Index e = 0; e < own.rows(); ++e) own.row(e) = whole.row(elements[e]);
  return own;
}

template <class Mesh>
void check_sum(const Mesh& mesh, const MeshDivision& division, const std::string& name,
               const DiscretizationOptions& options) {
  const Discretization whole = discretize(mesh, name, options);
  Sum stiffness, mass, sparser;
  Vector u(mesh.n_vertices());
  for (Index v = 0; v < u.size(); ++v) u[v] = std::sin(3.0 * v);
  Vector divergence = Vector::Zero(u.size());
  double measure = 0;
  Index n_excluded = 0;
  for (Index p = 0; p < division.n_parts; ++p) {
    const MeshPart<Mesh> part = part_of(mesh, division, p);
    const Array<Index>& number = part.numbers.vertices;
    DiscretizationOptions own = options;
    own.cell_coefficient = select(options.cell_coefficient, part.numbers.elements);
    const Discretization d = discretize_part(part, name, own);
    stiffness.add(d.stiffness, number);
    mass.add(d.mass, number);
    sparser.add(sparser_part_stiffness(part, d), number);
    measure += d.sample_measure.sum();
    n_excluded += d.diagnostics.count("excluded_samples");
    if (d.gradient_dimension == 0) continue;
    Vector here(part.mesh.n_vertices());
    for (Index v = 0; v < here.size(); ++v) here[v] = u[number[v]];
    const Vector added = d.apply_divergence(d.gradient * here);
    for (Index v = 0; v < here.size(); ++v) divergence[number[v]] += added[v];
  }
  EXPECT_LT(stiffness.difference(whole.stiffness), 1e-13);
  EXPECT_LT(mass.difference(whole.mass), 1e-13);
  // Triangles and other faces sample a coefficient at different points.
  if (const auto assemble = sparser_stiffness(mesh, whole); assemble && !options.coefficient) {
    EXPECT_LT(sparser.difference(assemble()), 1e-13);
  }
  EXPECT_EQ(n_excluded, whole.diagnostics.count("excluded_samples"));
  if (whole.gradient_dimension == 0) return;
  EXPECT_NEAR(measure / whole.sample_measure.sum(), 1, 1e-13);
  const Vector expected = whole.apply_divergence(whole.gradient * u);
  EXPECT_LT((divergence - expected).template lpNorm<Eigen::Infinity>(),
            1e-13 * expected.template lpNorm<Eigen::Infinity>());
}

template <class Mesh>
void check_sums(const Mesh& mesh, const std::string& name, const DiscretizationOptions& options) {
  SCOPED_TRACE(name + " " + mass_kind_name(options.mass));
  for_divisions(mesh,
                [&](const MeshDivision& division) { check_sum(mesh, division, name, options); });
}

/// All operators that can be had in parts, with their own defaults.
template <class Mesh>
void check_operators(const std::vector<std::pair<std::string, Mesh>>& meshes) {
  int n_cases = 0;
  for (const auto& [family, mesh] : meshes) {
    SCOPED_TRACE(family);
    for (const auto* entry : operators_on(mesh)) {
      if (!entry->options.own_interfaces && !entry->claims.face_local) continue;
      if (!entry->claims.vertex_unknowns) continue;
      try {
        entry->prepare(mesh, {.parts = DiscretizationParts::Matrices});
      } catch (const InvalidMesh&) {
        continue;  // of simplices alone
      }
      check_sums(mesh, entry->name, {});
      ++n_cases;
    }
  }
  EXPECT_GT(n_cases, 3 * static_cast<int>(meshes.size()));
}

TEST(PartDiscretization, operators_of_surfaces_add_up) { check_operators(surfaces_to_divide()); }

TEST(PartDiscretization, operators_of_volumes_add_up) { check_operators(volumes_to_divide()); }

TEST(PartDiscretization, masses_and_coefficients_add_up) {
  const auto k = [](const Vec3& x) { return 2 + std::sin(x.sum()); };
  const std::vector<std::pair<std::string, DiscretizationOptions>> cases = {
      {"diamond", {.mass = MassKind::MomentExact, .coefficient = k}},
      {"stabilized_diamond", {.mass = MassKind::Lumped, .coefficient = k}},
      {"bunge", {.mass = MassKind::Full, .coefficient = k}}};
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    for (const auto& [op, options] : cases) check_sums(mesh, op, options);
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    for (const auto& [op, options] : cases) check_sums(mesh, op, options);
    DiscretizationOptions tensors;
    tensors.cell_coefficient.resize(mesh.n_cells(), 6);
    for (Index c = 0; c < mesh.n_cells(); ++c)
      tensors.cell_coefficient.row(c) << 1 + c % 3, 2, 3, 0.2, -0.1, 0.3;
    check_sums(mesh, "diamond", tensors);
    check_sums(mesh, "bunge", tensors);
  }
}

TEST(PartDiscretization, what_does_not_fit_is_refused) {
  const PolygonMesh quads = quad_grid(2, 2);
  const PolyhedralMesh hexes = hex_grid(2);
  const DiscretizationOptions one{.own_interfaces = {true}};
  EXPECT_THROW(discretize(quads, "diamond", one), InvalidOption);
  EXPECT_THROW(discretize(hexes, "stabilized_diamond", one), InvalidOption);
  EXPECT_THROW(
      discretize(quads, "bunge",
                 {.own_interfaces = std::vector<bool>(static_cast<std::size_t>(quads.n_edges()))}),
      InvalidOption);
  const auto part = part_of(hexes, divide(hexes, 1, in_blocks(8, 1)), 0);
  EXPECT_THROW(discretize_part(part, "ceve"), InvalidOption);
}

TEST(PartDiscretization, what_is_sent_is_what_crosses_the_cut) {
  // Halves of a grid: the cut has n interfaces.
  const auto shares = [](Index n) {
    const PolygonMesh mesh = quad_grid(n, n);
    const MeshDivision division = divide(mesh, 2, in_blocks(mesh.n_faces(), 2));
    PartShare sum;
    for (Index p = 0; p < 2; ++p) {
      const auto part = part_of(mesh, division, p);
      const SparseMatrix stiffness = discretize_part(part, "diamond").stiffness;
      const PartShare share = share_of(stiffness, part.numbers);
      std::int64_t entries = 0, of_others = 0;
      for (Index v = 0; v < stiffness.rows(); ++v)
        for (SparseMatrix::InnerIterator entry(stiffness, v); entry; ++entry) {
          entries += entry.value() != 0;
          of_others += entry.value() != 0 && !part.numbers.own_vertex(v);
        }
      EXPECT_EQ(share.entries, entries);
      EXPECT_EQ(share.sent, of_others);
      EXPECT_EQ(share.bytes_sent(), 16 * of_others);
      sum.entries += share.entries;
      sum.sent += share.sent;
    }
    return sum;
  };
  const PartShare small = shares(16), large = shares(32);
  EXPECT_GT(small.sent, 0);
  EXPECT_NEAR(static_cast<double>(large.sent) / static_cast<double>(small.sent), 2, 0.2);
  EXPECT_NEAR(static_cast<double>(large.entries) / static_cast<double>(small.entries), 4, 0.4);
  // Alone, a part sends nothing.
  const PolygonMesh mesh = quad_grid(4, 4);
  const auto whole = part_of(mesh, divide(mesh, 1, std::vector<Index>(16, 0)), 0);
  EXPECT_EQ(share_of(discretize_part(whole, "diamond").stiffness, whole.numbers).sent, 0);
}

}  // namespace
}  // namespace carat::test
