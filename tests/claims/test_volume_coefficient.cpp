// -div(K grad u) in volumes: K a function, a number a cell, or a symmetric tensor a cell.

#include <Eigen/Eigenvalues>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "support/volume_claim_cases.h"
#include "support/volume_measures.h"
#include "support/volume_transforms.h"

namespace carat::test {
namespace {

Matrix rows_of(Index n, const std::vector<double>& row) {
  return Eigen::Map<const Eigen::RowVectorXd>(row.data(), static_cast<Eigen::Index>(row.size()))
      .replicate(n, 1);
}

std::vector<double> components(const Eigen::Matrix3d& k) {
  return {k(0, 0), k(1, 1), k(2, 2), k(0, 1), k(1, 2), k(0, 2)};
}

class VolumeCoefficient : public testing::TestWithParam<const VolumeOperator*> {
 protected:
  PolyhedralMesh mesh(int level) const {
    return generate_volume(GetParam()->claims.simplices_only ? "cube-tets" : "cube-prisms",
                           {.level = level, .jitter = 0.2});
  }
  Discretization with_cells(const PolyhedralMesh& m, const Matrix& k) const {
    DiscretizationOptions options;
    options.cell_coefficient = k;
    return discretize(m, GetParam()->name, options);
  }
};

/// Symmetric positive definite, with eigenvalues 0.5, 1 and 4.
Eigen::Matrix3d some_tensor() {
  return some_rotation() * Vec3(0.5, 1, 4).asDiagonal() * some_rotation().transpose();
}

TEST_P(VolumeCoefficient, a_constant_of_two_doubles_the_stiffness_to_the_last_bit) {
  const PolyhedralMesh m = mesh(0);
  const Discretization one = discretize(m, GetParam()->name);
  DiscretizationOptions function;
  function.coefficient = [](const Vec3&) { return 2.0; };
  const Discretization with_function = discretize(m, GetParam()->name, function);
  const Matrix tensors = rows_of(m.n_cells(), {2, 2, 2, 0, 0, 0});
  for (const Discretization& two :
       {with_function, with_cells(m, rows_of(m.n_cells(), {2})), with_cells(m, tensors)}) {
    EXPECT_LT(difference(two.stiffness, SparseMatrix(one.stiffness * 2)), 10 * kEps);
    EXPECT_TRUE(same_bits(two.mass, one.mass));
    EXPECT_TRUE(same_bits(two.gradient, one.gradient));
  }
  EXPECT_TRUE(same_bits(with_function.stiffness, SparseMatrix(one.stiffness * 2)));
  // The function and the cells' values multiply.
  function.cell_coefficient = rows_of(m.n_cells(), {3});
  EXPECT_LT(difference(discretize(m, GetParam()->name, function).stiffness,
                       SparseMatrix(one.stiffness * 6)),
            10 * kEps);
}

TEST_P(VolumeCoefficient, the_stiffness_is_the_energy_of_the_gradient_in_the_tensor) {
  const PolyhedralMesh m = mesh(0);
  const Discretization d = with_cells(m, rows_of(m.n_cells(), components(some_tensor())));
  EXPECT_LT(asymmetry(d.stiffness), 200 * kEps);
  std::vector<Eigen::Triplet<double>> blocks;
  const Eigen::Matrix3d k = some_tensor();
  for (Index s = 0; s < d.n_samples(); ++s)
    for (Index a = 0; a < 3; ++a)
      for (Index b = 0; b < 3; ++b)
        blocks.emplace_back(d.first_row(s) + a, d.first_row(s) + b, d.sample_measure[s] * k(a, b));
  SparseMatrix middle(d.gradient.rows(), d.gradient.rows());
  middle.setFromTriplets(blocks.begin(), blocks.end());
  const SparseMatrix expected = SparseMatrix(d.gradient.transpose()) * middle * d.gradient;
  if (GetParam()->claims.divergence_of_gradient && d.jump_components == 0) {
    EXPECT_LT(difference(d.stiffness, expected), 200 * kEps * condition(m));
    return;
  }
  // What else there is (a stabilising term, jumps between halves of diamonds) vanishes on linear
  // functions and is never negative.
  const Matrix rest = Matrix(d.stiffness - expected);
  EXPECT_LT((rest * m.points()).cwiseAbs().maxCoeff(), 1e-12);
  const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(rest).eigenvalues();
  EXPECT_GT(values[0], -1e-13 * values[values.size() - 1]);
  EXPECT_GT(values[values.size() - 1], 0.1);
}

TEST_P(VolumeCoefficient, linear_functions_pass_the_patch_test) {
  // div(K grad u) = 0 for linear u where K is constant: u is found from its boundary values.
  const PolyhedralMesh m = mesh(1);
  const Discretization d = with_cells(m, rows_of(m.n_cells(), components(some_tensor())));
  EXPECT_LT(linear_precision_defect(d.stiffness, m.points(), inner_vertices(m)), 1e-11);
  const Vector exact = m.points() * Vec3(1, -2, 0.5);
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(m);
  for (Index v = 0; v < m.n_vertices(); ++v)
    if (boundary[v]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(exact[v]);
    }
  const Vector u = Poisson(m, d, conditions).solve(Vector::Zero(m.n_vertices())).values;
  EXPECT_LT((u - exact).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(VolumeCoefficient, turning_mesh_and_tensor_together_changes_nothing) {
  const PolyhedralMesh m = mesh(1);
  const Eigen::Matrix3d k = some_tensor();
  // A tensor of its own for every cell.
  Matrix here(m.n_cells(), 6), turned(m.n_cells(), 6);
  for (Index c = 0; c < m.n_cells(); ++c) {
    const Eigen::Matrix3d of_cell = (1 + 0.3 * std::sin(c)) * k + Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d after = some_rotation() * of_cell * some_rotation().transpose();
    here.row(c) = rows_of(1, components(of_cell));
    turned.row(c) = rows_of(1, components(after));
  }
  EXPECT_LT(
      difference(with_cells(move_rigidly(m), turned).stiffness, with_cells(m, here).stiffness),
      200 * kEps * condition(m));
}

TEST_P(VolumeCoefficient, stretching_the_mesh_is_a_tensor) {
  // With y = A x, the energy of u in y is det A times that of A^-1 A^-T in x. On tetrahedra, whose
  // virtual vertices are carried along.
  const PolyhedralMesh m = generate_volume("cube-tets", {.level = 0, .jitter = 0.2});
  Eigen::Matrix3d a;
  a << 1, 0.2, 0, 0, 1.5, -0.1, 0.3, 0, 0.7;
  const Eigen::Matrix3d k = a.determinant() * (a.transpose() * a).inverse();
  const PolyhedralMesh stretched = m.with_points(m.points() * a.transpose());
  EXPECT_LT(difference(discretize(stretched, GetParam()->name).stiffness,
                       with_cells(m, rows_of(m.n_cells(), components(k))).stiffness),
            1e-12);
}

TEST_P(VolumeCoefficient, a_variable_one_converges_at_second_order) {
  // u = sin 2x cos y + z^2 with K = 1 + x + y^2 / 2:
  // -div(K grad u) = 5 K sin 2x cos y - 2 K - 2 cos 2x cos y + y sin 2x sin y.
  const auto k = [](const Vec3& p) { return 1 + p.x() + p.y() * p.y() / 2; };
  std::vector<double> h, error;
  for (const int level : {0, 1, 2}) {
    const PolyhedralMesh m = mesh(level);
    DiscretizationOptions options;
    options.coefficient = k;
    const Discretization d = discretize(m, GetParam()->name, options);
    Vector exact(m.n_vertices()), f(m.n_vertices());
    BoundaryConditions conditions;
    const std::vector<bool> boundary = boundary_vertices(m);
    for (Index v = 0; v < m.n_vertices(); ++v) {
      const Vec3 p = m.point(v);
      const double wave = std::sin(2 * p.x()) * std::cos(p.y());
      exact[v] = wave + p.z() * p.z();
      f[v] = k(p) * (5 * wave - 2) - 2 * std::cos(2 * p.x()) * std::cos(p.y()) +
             p.y() * std::sin(2 * p.x()) * std::sin(p.y());
      if (!boundary[v]) continue;
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(exact[v]);
    }
    const Vector u = Poisson(m, d, conditions).solve(f).values;
    h.push_back(std::pow(0.5, level));
    // Over the inner vertices: the share of those whose error is 0 by definition shrinks.
    const double inner = static_cast<double>(std::count(boundary.begin(), boundary.end(), false));
    error.push_back((u - exact).norm() / std::sqrt(inner));
  }
  RecordProperty("slope", std::to_string(log_slope(h, error)));
  // Virtual elements, stiff in what is not linear, enter their range later: 1.66 on these levels.
  EXPECT_GE(log_slope(h, error), std::string(GetParam()->name) == "vem" ? 1.6 : 1.8);
}

TEST_P(VolumeCoefficient, bad_values_are_refused) {
  const PolyhedralMesh m = mesh(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    DiscretizationOptions options;
    options.coefficient = [bad](const Vec3& p) { return p.x() > 0.5 ? bad : 1.0; };
    EXPECT_THROW(discretize(m, GetParam()->name, options), InvalidOption) << bad;
  }
  const auto expect_refused = [&](const Matrix& k, const char* part) {
    try {
      with_cells(m, k);
      ADD_FAILURE() << "nothing was thrown: " << part;
    } catch (const InvalidOption& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  expect_refused(Matrix::Ones(m.n_cells() + 1, 1), "one row a cell");
  expect_refused(Matrix::Ones(m.n_cells(), 3), "one row a cell");
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    Matrix k = Matrix::Ones(m.n_cells(), 1);
    k(5, 0) = bad;
    expect_refused(k, "cell 5");
  }
  // Indefinite by its last minor only, by the second, by the first; not finite off the diagonal.
  for (const std::vector<double>& bad : {std::vector<double>{1, 1, -1, 0, 0, 0},
                                         {1, 1, 1, 2, 0, 0},
                                         {-1, 1, 1, 0, 0, 0},
                                         {1, 1, 1, 0, nan, 0},
                                         {1, 1, 1, 0, 0, 1}}) {
    Matrix k = rows_of(m.n_cells(), {1, 1, 1, 0, 0, 0});
    k.row(7) = rows_of(1, bad);
    expect_refused(k, "cell 7");
  }
}

INSTANTIATE_TEST_SUITE_P(Operators, VolumeCoefficient,
                         testing::ValuesIn(claimed_volume_operators()),
                         [](const testing::TestParamInfo<const VolumeOperator*>& entry) {
                           return std::string(entry.param->name);
                         });

}  // namespace
}  // namespace carat::test
