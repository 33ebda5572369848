#include <rubato/numerics/eigen_symmetric.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace rubato::numerics {
namespace {

using std::numbers::pi;

SparseMatrix identity(Index n) {
  SparseMatrix m(n, n);
  m.setIdentity();
  return m;
}

// Masses between springs of stiffness 1; the ends are held by a spring, or free.
SparseMatrix chain(Index n, bool is_held) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    const bool is_end = i == 0 || i == n - 1;
    entries.emplace_back(i, i, is_end && !is_held ? 1.0 : 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  SparseMatrix k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

// A square membrane of `side` by `side` masses: omega^2 = 4 sin^2(i pi / (2 (side + 1))) + the same with j.
SparseMatrix membrane(Index side) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < side * side; ++i) {
    entries.emplace_back(i, i, 4.0);
    const auto join = [&](Index j) {
      entries.emplace_back(i, j, -1.0);
      entries.emplace_back(j, i, -1.0);
    };
    if (i % side > 0) join(i - 1);
    if (i >= side) join(i - side);
  }
  SparseMatrix k(side * side, side * side);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

std::vector<double> membrane_eigenvalues(Index side) {
  std::vector<double> values;
  for (Index i = 1; i <= side; ++i)
    for (Index j = 1; j <= side; ++j) {
      const auto part = [&](Index k) { return 4.0 * std::pow(std::sin(0.5 * pi * double(k) / double(side + 1)), 2); };
      values.push_back(part(i) + part(j));
    }
  std::sort(values.begin(), values.end());
  return values;
}

double orthogonality_error(const SymmetricModes& modes, const SparseMatrix& mass) {
  const Index k = modes.shapes.cols();
  return (modes.shapes.transpose() * (mass * modes.shapes) - Matrix::Identity(k, k)).cwiseAbs().maxCoeff();
}

// omega_j = 2 sin(j pi / (2 (n + 1))), phi_i = sin(i j pi / (n + 1)) sqrt(2 / (n + 1)).
TEST(SymmetricModes, OfAChainAreSines) {
  for (const Index n : {1, 5, 1000}) {
    const Index count = std::min<Index>(n, 7);
    const SymmetricModes modes = lowest_modes(chain(n, true), identity(n), count);
    ASSERT_EQ(modes.eigenvalues.size(), count);
    EXPECT_TRUE(modes.has_converged);
    EXPECT_EQ(modes.missing, 0);
    EXPECT_LT(modes.residual, 1e-12);
    EXPECT_LT(orthogonality_error(modes, identity(n)), 1e-12);
    for (Index j = 0; j < count; ++j) {
      const double angle = pi * double(j + 1) / double(n + 1);
      const double exact = 4.0 * std::pow(std::sin(0.5 * angle), 2);
      // The quotient sums n terms of up to 4 phi^2: round-off 2e-16 * 4.
      EXPECT_NEAR(modes.eigenvalues[j], exact, 4e-15) << n << ", mode " << j + 1;
      EXPECT_NEAR(std::abs(modes.shapes(n / 3, j)),
                  std::sqrt(2.0 / double(n + 1)) * std::abs(std::sin(angle * double(n / 3 + 1))), 1e-9);
    }
  }
}

TEST(SymmetricModes, FindRepeatedModesAsOftenAsTheyAre) {
  const Index side = 30;  // 900 coordinates: beyond the dense solver
  const auto exact = membrane_eigenvalues(side);
  const SparseMatrix k = membrane(side);
  for (const Index count : {2, 3, 12, 40}) {
    const SymmetricModes modes = lowest_modes(k, identity(side * side), count);
    ASSERT_EQ(modes.eigenvalues.size(), count);
    EXPECT_TRUE(modes.has_converged);
    EXPECT_EQ(modes.missing, 0);
    EXPECT_LT(orthogonality_error(modes, identity(side * side)), 1e-11);
    for (Index j = 0; j < count; ++j) EXPECT_NEAR(modes.eigenvalues[j], exact[std::size_t(j)], 1e-13) << count;
  }
}

// Many equal chains side by side: every eigenvalue is there as often, and a Krylov space of one start vector holds each
// once in exact arithmetic. Of 50 chains the first search returns copies of higher modes instead.
TEST(SymmetricModes, FindEveryOneOfManyEqualParts) {
  for (const Index parts : {8, 50}) {
    const Index length = 50, n = parts * length;
    SparseMatrix one = chain(length, true), k(n, n);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index p = 0; p < parts; ++p)
      for (Index column = 0; column < length; ++column)
        for (SparseMatrix::InnerIterator entry(one, column); entry; ++entry)
          entries.emplace_back(p * length + entry.row(), p * length + column, entry.value());
    k.setFromTriplets(entries.begin(), entries.end());
    for (const Index wanted : {10, 20}) {
      const SymmetricModes modes = lowest_modes(k, identity(n), wanted);
      ASSERT_EQ(modes.eigenvalues.size(), wanted);
      EXPECT_EQ(modes.missing, 0);
      for (Index j = 0; j < wanted; ++j)
        EXPECT_NEAR(modes.eigenvalues[j],
                    4.0 * std::pow(std::sin(0.5 * pi * double(j / parts + 1) / double(length + 1)), 2), 1e-14)
            << j;
      EXPECT_LT(orthogonality_error(modes, identity(n)), 1e-11);
    }
  }
}

// A free chain has omega_j = 2 sin(j pi / (2 n)), j from 0; two of them have two motions without stiffness.
TEST(SymmetricModes, OfFreeBodiesBeginWithZero) {
  for (const Index n : {4, 600}) {
    SparseMatrix one = chain(n, false), k(2 * n, 2 * n);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index column = 0; column < n; ++column)
      for (SparseMatrix::InnerIterator entry(one, column); entry; ++entry) {
        entries.emplace_back(entry.row(), column, 1e7 * entry.value());
        entries.emplace_back(n + entry.row(), n + column, 1e7 * entry.value());
      }
    k.setFromTriplets(entries.begin(), entries.end());
    const SparseMatrix m = 250.0 * identity(2 * n);
    const SymmetricModes modes = lowest_modes(k, m, 6);
    EXPECT_TRUE(modes.has_converged);
    EXPECT_EQ(modes.missing, 0);
    for (Index j = 0; j < 6; ++j) {
      const double exact = 4e4 * 4.0 * std::pow(std::sin(0.5 * pi * double(j / 2) / double(n)), 2);
      if (j < 2)
        EXPECT_EQ(modes.eigenvalues[j], 0.0);
      else
        EXPECT_NEAR(modes.eigenvalues[j], exact, 4e4 * 4e-15 * 4.0);
    }
    EXPECT_LT(orthogonality_error(modes, m), 1e-12);
  }
}

// K - 1e-3 M has the spectrum of K less 1e-3: some of it lies below zero.
// A point of unit mass that has none, and no stiffness, along one direction: with the round-off of the entries of M the
// square of the norm of that motion may come out below zero.
TEST(SymmetricModes, OfAMotionWithoutMassAreNotToldAsFound) {
  for (int i = 1; i <= 100; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(std::cos(i), std::sin(i), std::cos(2.3 * i)).normalized();
    const Matrix across = Matrix::Identity(3, 3) - direction * direction.transpose();
    const SymmetricModes modes = all_modes((2.0 * across).sparseView(), across.sparseView());
    if (modes.has_converged) {
      EXPECT_TRUE(modes.eigenvalues.allFinite()) << i;
      EXPECT_TRUE(modes.shapes.allFinite()) << i;
      EXPECT_TRUE(std::isfinite(modes.residual)) << i;
    } else {
      EXPECT_GT(modes.defect, 1e-4) << i;
    }
  }
}

TEST(SymmetricModes, OfAnUnstableStructureBeginBelowZero) {
  const Index n = 500;
  const SparseMatrix k = chain(n, true) - 1e-3 * identity(n);
  const SymmetricModes modes = lowest_modes(k, identity(n), 5);
  EXPECT_EQ(modes.missing, 0);
  for (Index j = 0; j < 5; ++j)
    EXPECT_NEAR(modes.eigenvalues[j], 4.0 * std::pow(std::sin(0.5 * pi * double(j + 1) / double(n + 1)), 2) - 1e-3,
                1e-14);
}

TEST(SymmetricModes, DoNotDependOnTheUnits) {
  const Index n = 450;
  const SymmetricModes plain = lowest_modes(chain(n, true), identity(n), 6);
  for (const double factor : {1e-14, 1e18}) {
    const SymmetricModes scaled = lowest_modes(SparseMatrix(factor * chain(n, true)), identity(n), 6);
    EXPECT_EQ(scaled.missing, 0);
    for (Index j = 0; j < 6; ++j)
      EXPECT_NEAR(scaled.eigenvalues[j] / factor, plain.eigenvalues[j], 1e-10 * plain.eigenvalues[j]);
  }
}

}  // namespace
}  // namespace rubato::numerics
