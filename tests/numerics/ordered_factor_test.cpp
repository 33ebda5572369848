#include <rubato/numerics/ordered_factor.hpp>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace rubato::numerics {
namespace {

// Nodes of a grid with three unknowns each, coupled to those of all nodes within reach: definite by its diagonal.
SparseMatrix grid(int columns, int rows, int reach) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const int n = 3 * columns * rows;
  std::vector<Eigen::Triplet<double>> entries;
  const auto couple = [&](int a, int b) {
    const double c = value(random);
    entries.emplace_back(a, b, c);
    entries.emplace_back(b, a, c);
    entries.emplace_back(a, a, std::abs(c));
    entries.emplace_back(b, b, std::abs(c));
  };
  const auto join = [&](int first, int second) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) couple(3 * first + i, 3 * second + j);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      for (int other = std::max(0, row - reach); other <= row; ++other)
        for (int beside = std::max(0, column - reach); beside <= std::min(columns - 1, column + reach); ++beside)
          if (other < row || beside < column) join(other * columns + beside, row * columns + column);
    }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.1);
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

double residual(const OrderedFactor& factor, const SparseMatrix& matrix) {
  const Vector b = Vector::LinSpaced(matrix.rows(), -1.0, 2.0);
  Vector x;
  factor.solve(b, x);
  return (matrix * x - b).cwiseAbs().maxCoeff() / x.cwiseAbs().maxCoeff();
}

// Columns on a narrow grid, panels on a wide one.
struct Case {
  int columns, rows, reach;
  bool has_panels;
};

class OrderedFactorOf : public ::testing::TestWithParam<Case> {
 protected:
  SparseMatrix matrix = grid(GetParam().columns, GetParam().rows, GetParam().reach);
};

TEST_P(OrderedFactorOf, ThePatternChoosesBetweenColumnsAndPanels) {
  OrderedFactor factor;
  factor.analyse(matrix);
  EXPECT_EQ(factor.has_panels(), GetParam().has_panels);
}

// Bound: round-off of the products, n eps of rows with 75 entries of size one at most.
TEST_P(OrderedFactorOf, SolvesAndFactorisesAnotherMatrixOfThePattern) {
  OrderedFactor factor;
  factor.analyse(matrix);
  ASSERT_TRUE(factor.factorise(matrix));
  EXPECT_LT(residual(factor, matrix), 1e-12);
  const SparseMatrix other = 3.0 * matrix + SparseMatrix(Vector::LinSpaced(matrix.rows(), 1.0, 5.0).asDiagonal());
  ASSERT_TRUE(factor.factorise(other));
  EXPECT_LT(residual(factor, other), 1e-12);
}

TEST_P(OrderedFactorOf, ForcesOnTheLastRowsEnterBetweenTheSubstitutions) {
  const Index n = matrix.rows();
  const std::vector<Index> last{0, 4, n / 2, n - 1};
  OrderedFactor factor;
  factor.analyse(matrix, last);
  ASSERT_TRUE(factor.factorise(matrix));
  ASSERT_EQ(factor.last_count(), 4);
  for (const Index row : last) EXPECT_GE(factor.permuted(row), n - 4);

  Vector b = Vector::LinSpaced(n, -1.0, 1.0), x(n), expected;
  factor.solve(b, expected);
  // The right-hand side is completed row by row on the way.
  x.setZero();
  factor.forward(x, [&](Index place) { x[place] += b[factor.original(place)]; });
  Vector free(4);
  factor.last_solution(x, free);
  for (Index i = 0; i < 4; ++i) EXPECT_NEAR(free[i], expected[factor.original(n - 4 + i)], 1e-12);

  Vector force(4);
  force << 0.3, -0.2, 0.5, 0.1;
  const Vector change = factor.last_inverse() * force;
  Vector push = force;
  factor.subtract_from_last(push, x);
  std::vector<Index> taken;
  factor.backward(x, [&](Index place, double value) {
    taken.push_back(place);
    EXPECT_EQ(value, x[place]);
  });
  for (Index i = 0; i < n; ++i) EXPECT_EQ(taken[static_cast<std::size_t>(i)], n - 1 - i);
  for (Index i = 0; i < 4; ++i) {
    b[factor.original(n - 4 + i)] -= force[i];
    EXPECT_NEAR(x[n - 4 + i], free[i] - change[i], 1e-12);
  }
  factor.solve(b, expected);
  for (Index place = 0; place < n; ++place) EXPECT_NEAR(x[place], expected[factor.original(place)], 1e-11);
}

// Sylvester: as many negative pivots as negative eigenvalues.
TEST_P(OrderedFactorOf, PivotsOfAnIndefiniteMatrixCountItsNegativeEigenvalues) {
  const SparseMatrix moved = matrix - SparseMatrix(Vector::Constant(matrix.rows(), 20.0).asDiagonal());
  OrderedFactor factor;
  factor.analyse(moved);
  EXPECT_FALSE(factor.factorise(moved));
  ASSERT_TRUE(factor.factorise(moved, Pivots::nonzero));
  const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(Matrix(moved), Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_EQ((factor.pivots().array() < 0.0).count(), (eigenvalues.array() < 0.0).count());
  EXPECT_LT(residual(factor, moved), 1e-8);
}

TEST_P(OrderedFactorOf, NotANumberIsNoPivot) {
  OrderedFactor factor;
  factor.analyse(matrix);
  matrix.coeffRef(5, 5) = std::nan("");
  EXPECT_FALSE(factor.factorise(matrix));
  EXPECT_FALSE(factor.factorise(matrix, Pivots::nonzero));
}

INSTANTIATE_TEST_SUITE_P(Grids, OrderedFactorOf,
                         ::testing::Values(Case{2, 3, 1, false}, Case{2, 60, 1, false}, Case{14, 14, 2, true}));

TEST(OrderedFactor, PartsWithoutConnectionStandSideBySide) {
  const SparseMatrix one = grid(14, 14, 2);
  const Index n = one.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index column = 0; column < n; ++column)
    for (SparseMatrix::InnerIterator entry(one, column); entry; ++entry)
      for (const Index offset : {Index{0}, n + 1})
        entries.emplace_back(entry.row() + offset, column + offset, entry.value());
  entries.emplace_back(n, n, 2.0);  // and a row of its own between them
  SparseMatrix both(2 * n + 1, 2 * n + 1);
  both.setFromTriplets(entries.begin(), entries.end());
  OrderedFactor factor;
  const std::vector<Index> last{3, n + 7};
  factor.analyse(both, last);
  ASSERT_TRUE(factor.has_panels());
  ASSERT_TRUE(factor.factorise(both));
  EXPECT_LT(residual(factor, both), 1e-12);
}

}  // namespace
}  // namespace rubato::numerics
