#include <rubato/numerics/kkt_factor.hpp>

#include <Eigen/LU>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace rubato {
namespace {

using numerics::KktFactor;

/// A chain of blocks of three unknowns, each joined to the next by two rows of G; values are random.
struct Chain {
  Chain(int blocks, bool is_symmetric, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-1.0, 1.0);
    const Index n = 3 * blocks, rows = 2 * (blocks - 1);
    first_row = n;
    matrix = Matrix::Zero(n + rows, n + rows);
    const auto set = [&](Index i, Index j, double value) {
      entries.emplace_back(i, j);
      matrix(i, j) = matrix(j, i) = value;
      if (!is_symmetric && i != j && i < n) matrix(j, i) += 0.2 * draw(random);
    };
    for (Index b = 0; b < blocks; ++b)
      for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j <= i; ++j) set(3 * b + i, 3 * b + j, (i == j ? 3.0 : 0.0) + draw(random));
    for (Index b = 0; b + 1 < blocks; ++b)
      for (Index r = 0; r < 2; ++r) {
        for (Index i = 0; i < 6; ++i) set(n + 2 * b + r, 3 * b + i, draw(random));
        set(n + 2 * b + r, n + 2 * b + r, -1e-10);
      }
  }
  Matrix matrix;
  Index first_row = 0;
  std::vector<KktFactor::Entry> entries;
};

void fill(KktFactor& factor, const Chain& chain) {
  factor.set_zero();
  for (const auto& [i, j] : chain.entries) {
    factor.values()[factor.slot(i, j)] += chain.matrix(i, j);
    if (i != j && !factor.is_symmetric()) factor.values()[factor.slot(j, i)] += chain.matrix(j, i);
    if (i != j && factor.is_symmetric() && factor.slot(i, j) == factor.spare_slot())
      factor.values()[factor.slot(j, i)] += chain.matrix(j, i);
  }
}

class KktFactors : public ::testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(KktFactors, SolveAsALuWithPivotingDoes) {
  const auto [blocks, is_symmetric] = GetParam();
  const Chain chain(blocks, is_symmetric, 7u + unsigned(blocks));
  KktFactor factor;
  factor.analyse(chain.matrix.rows(), chain.first_row, chain.entries, is_symmetric);
  fill(factor, chain);
  ASSERT_TRUE(factor.factorise());
  const Vector right = Vector::LinSpaced(chain.matrix.rows(), -1.0, 2.0);
  Vector x = right;
  factor.solve(x.data());
  const Vector exact = chain.matrix.fullPivLu().solve(right);
  // Conditioned like 100: what the fixed order loses is a few digits.
  EXPECT_LT((x - exact).norm(), 1e-10 * exact.norm());
}

INSTANTIATE_TEST_SUITE_P(Chains, KktFactors, ::testing::Combine(::testing::Values(2, 3, 10, 40), ::testing::Bool()));

TEST(KktFactors, FillInProportionToALengthOfChain) {
  Index last = 0;
  for (const int blocks : {50, 100, 200}) {
    const Chain chain(blocks, true, 3);
    KktFactor factor;
    factor.analyse(chain.matrix.rows(), chain.first_row, chain.entries, true);
    if (last > 0) {
      EXPECT_LT(double(factor.factor_entries()) / double(last), 2.3);
    }
    last = factor.factor_entries();
  }
}

TEST(KktFactors, LeaveThePivotOfARowThatRepeatsAnotherAtItsShare) {
  // G of two equal rows on one unknown of mass 2: the second row's pivot is -E(2 - E/...), of the size of E.
  const std::vector<KktFactor::Entry> entries{{1, 0}, {2, 0}};
  KktFactor factor;
  factor.analyse(3, 1, entries, true);
  factor.values()[factor.slot(0, 0)] = 2.0;
  for (const Index row : {1, 2}) {
    factor.values()[factor.slot(row, 0)] += factor.slot(row, 0) == factor.spare_slot() ? 0.0 : 1.0;
    factor.values()[factor.slot(0, row)] += factor.slot(0, row) == factor.spare_slot() ? 0.0 : 1.0;
    factor.values()[factor.slot(row, row)] = -1e-10;
  }
  ASSERT_TRUE(factor.factorise());
  EXPECT_NEAR(factor.pivot(1), -0.5, 1e-9);
  EXPECT_NEAR(factor.pivot(2), -2e-10, 1e-15);
}

TEST(KktFactors, SayThatAMatrixWithAZeroPivotHasNone) {
  const std::vector<KktFactor::Entry> entries{{1, 0}};
  KktFactor factor;
  factor.analyse(2, 2, entries, true);
  EXPECT_FALSE(factor.factorise());
}

}  // namespace
}  // namespace rubato
