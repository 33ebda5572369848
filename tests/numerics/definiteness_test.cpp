#include <rubato/numerics/definiteness.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace rubato::numerics {
namespace {

/// A chain of springs, of which the ground holds the first mass, with a spring of any sign on the last.
SparseMatrix chain(Index n, double ground, double last) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i + 1 < n; ++i)
    for (const auto& [row, column, value] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      entries.emplace_back(row, column, value);
  entries.emplace_back(0, 0, ground);
  entries.emplace_back(n - 1, n - 1, last);
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// The end of a chain of n - 1 unit springs behind one of stiffness g yields by 1/g + n - 1 under a unit force.
TEST(Definiteness, IsLostWhereASpringTakesMoreThanTheChainGives) {
  for (const Index n : {1, 2, 7, 500, 3000}) {
    const double critical = -1.0 / (1.0 / 3.0 + static_cast<double>(n - 1));
    EXPECT_FALSE(is_indefinite(chain(n, 3.0, 0.999 * critical))) << n;
    EXPECT_TRUE(is_indefinite(chain(n, 3.0, 1.001 * critical))) << n;
    EXPECT_FALSE(is_indefinite(chain(n, 0.0, 0.0))) << "free, of " << n;
    EXPECT_TRUE(is_indefinite(chain(n, 0.0, -1e-3))) << "free, of " << n;
  }
}

TEST(Definiteness, SeesSaddlesWithoutDiagonal) {
  SparseMatrix saddle(2, 2);
  saddle.insert(0, 1) = 1.0;
  saddle.insert(1, 0) = 1.0;
  EXPECT_TRUE(is_indefinite(saddle));
  EXPECT_FALSE(is_indefinite(SparseMatrix(3, 3)));
}

}  // namespace
}  // namespace rubato::numerics
