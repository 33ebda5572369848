#include <rubato/numerics/eigen_damped.hpp>
#include <rubato/numerics/eigen_graded.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/numerics/eigen_unsymmetric.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

// Stiffnesses and masses that differ by many orders of magnitude: what is light and stiff must not hide what is slow.
namespace rubato::numerics {
namespace {

using std::numbers::pi;
using testing::sparse;
using Triplets = std::vector<Eigen::Triplet<double>>;

void add_spring(Triplets& entries, Index a, Index b, double stiffness) {
  for (const Index i : {a, b})
    if (i >= 0) entries.emplace_back(i, i, stiffness);
  if (a < 0 || b < 0) return;
  entries.emplace_back(a, b, -stiffness);
  entries.emplace_back(b, a, -stiffness);
}

/// Masses of 1 kg on springs of 1e4 N/m in a row, and a light mass of 1e-6 kg behind them.
struct Chain {
  SparseMatrix stiffness, mass;
  /// @param held  the first spring goes to the ground   @param light_to  what the light mass is joined to; -1: the
  /// ground
  Chain(Index n, bool held, Index light_to, double stiff) : stiffness(n + 1, n + 1), mass(n + 1, n + 1) {
    Triplets k, m;
    for (Index i = held ? 0 : 1; i < n; ++i) add_spring(k, i - 1, i, 1e4);
    add_spring(k, light_to, n, stiff);
    for (Index i = 0; i < n; ++i) m.emplace_back(i, i, 1.0);
    m.emplace_back(n, n, 1e-6);
    stiffness.setFromTriplets(k.begin(), k.end());
    mass.setFromTriplets(m.begin(), m.end());
  }
};

/// Of the chain from the ground to a free end, without the light mass [rad/s].
double held_frequency(Index n, Index j) { return 200.0 * std::sin(0.5 * pi * double(2 * j + 1) / double(2 * n + 1)); }

TEST(GradedModes, KeepTheChainBesideALightMassOnAStiffSpringToTheGround) {
  for (const Index n : {300, 1800}) {
    const Chain chain(n, true, -1, 1e16);
    const SymmetricModes modes = lowest_modes(chain.stiffness, chain.mass, 6);
    EXPECT_TRUE(modes.has_converged);
    EXPECT_EQ(modes.missing, 0) << n;
    // omega^2 of n masses is known to eps phi^T |K| phi / omega^2 = 4 eps (n / 1.6)^2, 6e-10 of the longer chain.
    for (Index j = 0; j < 6; ++j)
      EXPECT_NEAR(std::sqrt(modes.eigenvalues[j]), held_frequency(n, j), 1e-9 * held_frequency(n, j)) << n << " " << j;
  }
}

// The mass of the end is 1 + 1e-6 then: omega falls by half of 1e-6 phi^2, with phi^2 = 4/(2 n + 1) at the end of the
// chain (the next term is its square). 1e16 N/m rounds to 2 N/m, and yet the entries of this K are exact.
TEST(GradedModes, KeepTheChainWithALightMassOnAStiffLink) {
  const auto expect_chain = [](Index n, double stiff, double tolerance) {
    const Chain chain(n, true, n - 1, stiff);
    const SymmetricModes modes = lowest_modes(chain.stiffness, chain.mass, 6);
    EXPECT_TRUE(modes.has_converged);
    for (Index j = 0; j < 6; ++j) {
      const double omega = held_frequency(n, j) * (1.0 - 0.5e-6 * 4.0 / double(2 * n + 1));
      EXPECT_NEAR(std::sqrt(modes.eigenvalues[j]), omega, tolerance * omega) << n << " " << stiff << " " << j;
      EXPECT_LT(modes.round_off[j], modes.eigenvalues[j]);
    }
  };
  expect_chain(300, 1e16, 1e-6);  // shapes are known to 1e-3: eps 1e16 beside the 33 N/m of the chain, squared
  expect_chain(300, 1e12, 1e-9);
  expect_chain(1800, 1e12, 1e-9);
}

TEST(GradedModes, OfAFreeChainBeginWithItsRigidMotion) {
  for (const Index n : {300, 1800}) {
    const Chain chain(n, false, n - 1, 1e12);
    const SymmetricModes modes = lowest_modes(chain.stiffness, chain.mass, 4);
    EXPECT_TRUE(modes.has_converged);
    EXPECT_EQ(modes.eigenvalues[0], 0.0);
    for (Index j = 1; j < 4; ++j) {
      const double omega = 200.0 * std::sin(0.5 * pi * double(j) / double(n));
      EXPECT_NEAR(std::sqrt(modes.eigenvalues[j]), omega, 1e-6 * omega);  // 1e-6 kg at an end, of n kg
    }
  }
}

// Where nothing is left of the digits, a failure is told: K of 1e16 N/m beside the 5.6 N/m by which 1,800 springs hold.
TEST(GradedModes, AreRightOrAFailureWhereRoundOffHidesThem) {
  const Index n = 1800;
  const Chain chain(n, true, n - 1, 1e16);
  SparseMatrix damping(n + 1, n + 1);
  damping.insert(0, 0) = 1.0;
  for (const SparseMatrix& c : {SparseMatrix(n + 1, n + 1), damping}) {
    const DampedModes found = lowest_damped_modes(chain.stiffness, c, chain.mass, 6);
    if (!found.has_converged) continue;
    ASSERT_EQ(found.modes.size(), 6u);
    for (Index j = 0; j < 6; ++j)
      EXPECT_NEAR(found.modes[std::size_t(j)].angular_frequency, held_frequency(n, j), 1e-3 * held_frequency(n, j));
  }
}

// A dashpot at the held end turns by c omega phi_1^2 / 2 of each mode: zeta = c phi_1^2 / (2 omega), to first order of
// 1e-6. It couples modes: they are complex, and iterated on the full matrices.
TEST(GradedModes, WithADashpotHaveItsDamping) {
  for (const Index n : {300, 1800}) {
    const Chain chain(n, true, -1, 1e16);
    SparseMatrix damping(n + 1, n + 1);
    damping.insert(0, 0) = 1.0;
    const DampedModes found = lowest_damped_modes(chain.stiffness, damping, chain.mass, 4);
    EXPECT_TRUE(found.has_converged) << found.residual;
    for (Index j = 0; j < 4; ++j) {
      const double omega = held_frequency(n, j);
      const double end = std::sin(pi * double(2 * j + 1) / double(2 * n + 1));
      const auto& mode = found.modes[std::size_t(j)];
      EXPECT_NEAR(mode.angular_frequency, omega, 1e-6 * omega);
      const double ratio = 0.5 * end * end * 4.0 / double(2 * n + 1) / omega;
      EXPECT_NEAR(mode.damping_ratio, ratio, 1e-2 * ratio) << n << " " << j;
    }
  }
}

// K = D A D, M = 1, A = tridiagonal (-1, 2, -1): det A = n + 1 and (A^-1)_ii = i (n + 1 - i)/(n + 1). The sum of all
// 1/omega^2 is a matter of the lowest, the product one of all.
TEST(GradedModes, HaveTheProductAndTheSumOfInversesOfAGradedMatrix) {
  const Index n = 24;
  Matrix a = Matrix::Zero(n, n);
  a.diagonal().setConstant(2.0);
  a.diagonal(1).setConstant(-1.0);
  a.diagonal(-1).setConstant(-1.0);
  Vector d(n);
  double sum = 0.0, logarithm = std::log(double(n + 1));
  for (Index i = 0; i < n; ++i) {
    d[i] = std::exp2(double((17 * i) % n));  // out of order, up to 2^23: K spans 14 decades; exact
    sum += double((i + 1) * (n - i)) / double(n + 1) / (d[i] * d[i]);
    logarithm += 2.0 * std::log(d[i]);
  }
  const Matrix k = d.asDiagonal() * a * d.asDiagonal(), m = Matrix::Identity(n, n);
  const auto shapes = graded_shapes(k, m);
  ASSERT_TRUE(shapes);
  EXPECT_LT((shapes->transpose() * *shapes - m).cwiseAbs().maxCoeff(), 1e-14);
  const SymmetricModes modes = all_modes(sparse(k), sparse(m));
  // The condition of A, (2 n/pi)^2 = 230, times round-off.
  EXPECT_NEAR(modes.eigenvalues.cwiseInverse().sum() / sum, 1.0, 1e-13);
  EXPECT_NEAR(modes.eigenvalues.array().log().sum(), logarithm, 1e-12);
  EXPECT_LT(modes.defect, 1e-8);
}

// A consistent mass couples what is stiff and light to what is heavy.
TEST(GradedModes, OfACoupledMassAreThoseOfItsStaticCondensation) {
  // q3 rides on q2 by 1e16 N/m: together they are one mass of m22 + 2 m23 + m33, to 1e-14.
  Matrix k = Matrix::Zero(3, 3), m = Matrix::Zero(3, 3);
  k << 300, -100, 0, -100, 1e16, -1e16, 0, -1e16, 1e16;
  m << 2, 0.1, 0, 0.1, 1, 2e-7, 0, 2e-7, 1e-6;
  k(1, 1) += 128;  // a multiple of the rounding of 1e16
  Matrix joined = Matrix::Zero(3, 2);
  joined(0, 0) = joined(1, 1) = joined(2, 1) = 1.0;
  Matrix small = Matrix::Zero(2, 2);
  small << 300, -100, -100, 128;
  const Eigen::Matrix2d heavy = joined.transpose() * m * joined;
  const double half = 0.5 * (heavy.inverse() * small).trace(), product = (heavy.inverse() * small).determinant();
  const double low = product / (half + std::sqrt(half * half - product));
  const SymmetricModes modes = lowest_modes(sparse(k), sparse(m), 2);
  EXPECT_TRUE(modes.has_converged);
  EXPECT_NEAR(modes.eigenvalues[0] / low, 1.0, 1e-9);
  EXPECT_NEAR(modes.eigenvalues[1] / (product / low), 1.0, 1e-9);
}

// [2, b; -b, 2] without damping has omega^2 = 2 +- i b: flutter. A light mass on 1e16 N/m beside it changes nothing.
TEST(GradedModes, OfLoadsWithoutAPotentialKeepTheirFlutter) {
  Matrix k = Matrix::Zero(4, 4), m = Matrix::Identity(4, 4);
  k << 2, 0.5, 0, 0, -0.5, 2, 0, 0, 0, 0, 9, 0, 0, 0, 0, 1e16;
  m(3, 3) = 1e-6;
  k(2, 3) = k(3, 2) = -8.0;
  for (const bool is_damped : {false, true}) {
    Matrix c = Matrix::Zero(4, 4);
    if (is_damped) c(2, 2) = 0.6;
    const DampedModes found = lowest_unsymmetric_modes(k, c, m, 3);
    EXPECT_TRUE(found.has_converged);
    ASSERT_EQ(found.modes.size(), 3u);
    for (int i = 0; i < 2; ++i) {
      const std::complex<double> square =
          -found.modes[std::size_t(i)].eigenvalue * found.modes[std::size_t(i)].eigenvalue;
      EXPECT_NEAR(square.real(), 2.0, 1e-9);
      EXPECT_NEAR(std::abs(square.imag()), 0.5, 1e-9);
    }
    EXPECT_NEAR(found.modes[2].angular_frequency, 3.0, 1e-9);
    EXPECT_NEAR(found.modes[2].damping_ratio, is_damped ? 0.1 : 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace rubato::numerics
