#include <rubato/numerics/eigen_damped.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <numbers>

namespace rubato::numerics {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;
using testing::sparse;

DampedModes modes_of(const Matrix& mass, const Matrix& damping, const Matrix& stiffness) {
  return lowest_damped_modes(sparse(stiffness), sparse(damping), sparse(mass), mass.rows());
}

// The factors of det(s^2 M + s C + K), evaluated by elimination: zero at every eigenvalue, relative to the product of
// the sizes of its rows.
double characteristic(Complex s, const Matrix& mass, const Matrix& damping, const Matrix& stiffness) {
  const Eigen::MatrixXcd matrix =
      s * s * mass.cast<Complex>() + s * damping.cast<Complex>() + stiffness.cast<Complex>();
  const Vector rows =
      (std::norm(s) * mass.cwiseAbs() + std::abs(s) * damping.cwiseAbs() + stiffness.cwiseAbs()).rowwise().sum();
  return std::abs(matrix.determinant()) / rows.prod();
}

// m x'' + c x' + k x = 0, m = 2, k = 8: omega = 2, ratio c / 8.
TEST(DampedModes, OfOneMassHaveItsRatioAlsoWhereItDoesNotOscillate) {
  const auto mode = [](double c) {
    const DampedModes modes =
        modes_of(Matrix::Constant(1, 1, 2.0), Matrix::Constant(1, 1, c), Matrix::Constant(1, 1, 8.0));
    EXPECT_EQ(modes.modes.size(), 1u);
    return modes.modes.at(0);
  };
  for (const double ratio : {0.0, 0.3, 1.0, 1.25, 1e6}) {
    const DampedMode m = mode(8.0 * ratio);
    EXPECT_NEAR(m.angular_frequency, 2.0, 4e-16);
    EXPECT_NEAR(m.damping_ratio, ratio, 1e-15 * (1.0 + ratio));
    EXPECT_FALSE(m.is_complex);
    EXPECT_NEAR(m.shape[0].real(), std::sqrt(0.5), 1e-15);
  }
  EXPECT_NEAR(std::abs(mode(2.4).eigenvalue - Complex(-0.6, 2.0 * std::sqrt(1.0 - 0.09))), 0.0, 1e-15);
  // s = -2 (1.25 - 0.75): the slower of -1 and -4; with ratio 1e6 it is -1e-6 (1 + 2.5e-13).
  EXPECT_NEAR(mode(10.0).eigenvalue.real(), -1.0, 1e-15);
  EXPECT_EQ(mode(10.0).eigenvalue.imag(), 0.0);
  EXPECT_NEAR(mode(8e6).eigenvalue.real(), -1e-6 * (1.0 + 2.5e-13), 1e-21);
}

// Reference page, section 4: modes without sliders 2.985807624388833 (twice), 3.162277660168379, 7.488988772200257
// (twice), all of 2 %.
TEST(DampedModes, OfTheUnderplatformDamperAreThoseOfTheThesis) {
  const auto system = testing::damper_model();
  const DampedModes modes = lowest_damped_modes(system.stiffness(), system.damping(), system.mass(), 5);
  const double expected[] = {2.985807624388833, 2.985807624388833, 3.162277660168379, 7.488988772200257,
                             7.488988772200257};
  ASSERT_EQ(modes.modes.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(modes.modes[i].angular_frequency, expected[i], 4e-15);
    EXPECT_NEAR(modes.modes[i].damping_ratio, 0.02, 2e-15);  // a, b of the reference page have 15 digits
    EXPECT_FALSE(modes.modes[i].is_complex);
  }
  // In full stick, undamped: the frequencies of the reference page.
  const double stuck[] = {2.996205323187844, 3.162277660168379, 5.137956574909118, 8.062257748298550,
                          8.344109053436982};
  const DampedModes undamped = lowest_damped_modes(system.stuck_stiffness(), SparseMatrix(5, 5), system.mass(), 5);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(undamped.modes[i].angular_frequency, stuck[i], 4e-15);
}

// The damping of the free modes couples those of full stick: complex modes, held to the determinant and to the
// companion form in (q, v), a route of its own.
TEST(DampedModes, OfNonProportionalDampingAreRootsOfTheCharacteristicPolynomial) {
  const auto system = testing::damper_model();
  const Matrix m(system.mass()), c(system.damping()), k(system.stuck_stiffness());
  const DampedModes modes = modes_of(m, c, k);
  ASSERT_EQ(modes.modes.size(), 5u);
  EXPECT_LT(modes.residual, 1e-14);
  Matrix companion = Matrix::Zero(10, 10);
  companion.topRightCorner(5, 5).setIdentity();
  companion.bottomLeftCorner(5, 5) = -m.inverse() * k;
  companion.bottomRightCorner(5, 5) = -m.inverse() * c;
  const Eigen::VectorXcd eigenvalues = companion.eigenvalues();
  for (const DampedMode& mode : modes.modes) {
    EXPECT_LT(characteristic(mode.eigenvalue, m, c, k), 1e-15);
    double nearest = 1.0;
    for (const Complex s : eigenvalues) nearest = std::min(nearest, std::abs(s - mode.eigenvalue));
    EXPECT_LT(nearest, 1e-13);
    EXPECT_NEAR(mode.angular_frequency, std::abs(mode.eigenvalue), 1e-14);
    EXPECT_NEAR(mode.shape.dot(m * mode.shape).real(), 1.0, 1e-14);
    Index largest = 0;  // the first of those that are as large but for round-off
    while (std::abs(mode.shape[largest]) < (1.0 - 1e-6) * mode.shape.cwiseAbs().maxCoeff()) ++largest;
    EXPECT_GT(mode.shape[largest].real(), 0.0);
    EXPECT_EQ(mode.shape[largest].imag(), 0.0);
  }
  // Opposite and equal motions of the blades stay apart, and some of them are complex.
  EXPECT_TRUE(std::any_of(modes.modes.begin(), modes.modes.end(), [](const DampedMode& mode) {
    return mode.is_complex && mode.shape.imag().cwiseAbs().maxCoeff() > 1e-3;
  }));
}

// One dashpot between two masses: strong enough, it makes two real roots without a partner.
TEST(DampedModes, OfAStrongDashpotAreSingleRealRoots) {
  Matrix m = Matrix::Identity(2, 2), c = Matrix::Zero(2, 2), k(2, 2);
  c(0, 0) = 20.0;
  k << 2, -1, -1, 2;
  const DampedModes modes = lowest_damped_modes(sparse(k), sparse(c), sparse(m), 2);
  // Round-off of the form of first order: 2e-16 of its norm, 20.
  for (const DampedMode& mode : modes.modes) EXPECT_LT(characteristic(mode.eigenvalue, m, c, k), 5e-15);
  // The slow root: 20 s + 2 - 1/2 = 0 nearly; then the second mass alone on its springs, omega^2 = 2.
  EXPECT_NEAR(modes.modes[0].eigenvalue.real(), -0.075, 1e-3);
  EXPECT_EQ(modes.modes[0].eigenvalue.imag(), 0.0);
  EXPECT_EQ(modes.modes[0].damping_ratio, 1.0);
  EXPECT_NEAR(modes.modes[1].angular_frequency, std::sqrt(2.0), 0.01);
}

// Two free masses with a spring and a dashpot between them drift together, undamped, and swing with ratio
// c / sqrt(2 k); a dashpot to the ground instead makes the drift a root of its own beside s = 0.
TEST(DampedModes, OfAFreeBodyHaveARootAtZero) {
  Matrix m = Matrix::Identity(2, 2), k(2, 2), between(2, 2), grounded = Matrix::Zero(2, 2);
  k << 2, -2, -2, 2;
  between << 0.1, -0.1, -0.1, 0.1;
  grounded(0, 0) = 0.1;
  const DampedModes drift = modes_of(m, between, k);
  EXPECT_EQ(drift.modes[0].angular_frequency, 0.0);
  EXPECT_EQ(drift.modes[0].damping_ratio, 0.0);
  EXPECT_NEAR(drift.modes[1].angular_frequency, 2.0, 1e-15);
  EXPECT_NEAR(drift.modes[1].damping_ratio, 0.05, 1e-15);

  const DampedModes held = lowest_damped_modes(sparse(k), sparse(grounded), sparse(m), 2);
  EXPECT_EQ(held.modes[0].eigenvalue, 0.0);
  EXPECT_NEAR(held.modes[0].shape[0].real(), std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(held.modes[0].shape[1].real(), std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(held.modes[1].eigenvalue.real(), -0.05, 1e-4);  // 0.1 over the mass of both, nearly
  EXPECT_LT(characteristic(held.modes[1].eigenvalue, m, grounded, k), 1e-15);
}

// Two masses on a spring, and a damper from one of them to the ground: their common motion stays where it is put. It
// was found as 1e-11, of which no digit is right, and refused.
TEST(DampedModes, OfABrakedFreeBodyHaveARootAtZero) {
  Matrix mass = Matrix::Zero(2, 2), damping = Matrix::Zero(2, 2), stiffness(2, 2);
  mass.diagonal() << 3493.9091, 3741.3434;
  damping(0, 0) = 1493754.8;
  stiffness << 955193850.0, -955193850.0, -955193850.0, 955193850.0;
  const DampedModes modes = modes_of(mass, damping, stiffness);
  EXPECT_TRUE(modes.has_converged);
  ASSERT_EQ(modes.modes.size(), 2u);
  EXPECT_EQ(modes.modes[0].angular_frequency, 0.0);
  EXPECT_NEAR(std::abs(modes.modes[0].shape[1] / modes.modes[0].shape[0] - 1.0), 0.0, 1e-12);
  EXPECT_LT(characteristic(modes.modes[1].eigenvalue, mass, damping, stiffness), 1e-12);
}

// Two equal oscillators, damped differently: modes of one frequency, each with its own ratio.
TEST(DampedModes, OfEqualFrequencyKeepTheirOwnDamping) {
  Matrix m = Matrix::Identity(2, 2), k = 4.0 * m, c(2, 2);
  c << 0.3, 0.1, 0.1, 0.3;  // 0.4 in equal motion, 0.2 in opposite
  const DampedModes modes = modes_of(m, c, k);
  double ratios[] = {modes.modes[0].damping_ratio, modes.modes[1].damping_ratio};
  std::sort(ratios, ratios + 2);
  EXPECT_NEAR(ratios[0], 0.05, 1e-15);
  EXPECT_NEAR(ratios[1], 0.1, 1e-15);
  for (const DampedMode& mode : modes.modes) EXPECT_FALSE(mode.is_complex);
}

// A chain of 600 masses with a dashpot at one end. With q_i = sinh(i mu), the rows inside give s^2 = 2 cosh mu - 2 and
// the last one sinh((n + 1) mu) + s c sinh(n mu) = 0: Newton from what was found must stay there.
TEST(DampedModes, OfALargeStructureAreIteratedToRoundOff) {
  const Index n = 600;
  auto base = testing::chain(n, 0);
  SparseMatrix c(n, n);
  c.insert(n - 1, n - 1) = 0.7;
  const DampedModes modes = lowest_damped_modes(base.stiffness(), c, base.mass(), 12);
  ASSERT_EQ(modes.modes.size(), 12u);
  EXPECT_TRUE(modes.is_refined);
  EXPECT_TRUE(modes.has_converged);
  EXPECT_LT(modes.residual, 1e-12);
  for (std::size_t j = 0; j < 12; ++j) {
    const Complex s = modes.modes[j].eigenvalue;
    const auto defect = [&](Complex at) {
      const Complex mu = std::acosh(1.0 + 0.5 * at * at);
      return (std::sinh(double(n + 1) * mu) + 0.7 * at * std::sinh(double(n) * mu)) / std::sinh(double(n) * mu);
    };
    const Complex h = 1e-6 * s;
    const Complex step = defect(s) / ((defect(s + h) - defect(s - h)) / (2.0 * h));
    EXPECT_LT(std::abs(step), 1e-10 * std::abs(s)) << j;  // s^2 of 2e-5 from terms of 4: 1e-11
    // One of them for each half wave, in order.
    EXPECT_NEAR(s.imag(), 2.0 * std::sin(0.5 * pi * double(j + 1) / double(n + 1)), 0.5 * pi / double(n));
  }
}

// Rayleigh damping: ratio = (a / omega + b omega) / 2, and no mode is complex.
TEST(DampedModes, OfALargeStructureWithProportionalDampingAreReal) {
  const Index n = 600;
  const auto system = testing::chain(n, 0);
  const DampedModes modes = lowest_damped_modes(system.stiffness(), system.damping(), system.mass(), 8);
  EXPECT_FALSE(modes.is_refined);
  for (std::size_t j = 0; j < 8; ++j) {
    const double omega = 2.0 * std::sin(0.5 * pi * double(j + 1) / double(n + 1));
    EXPECT_FALSE(modes.modes[j].is_complex);
    EXPECT_NEAR(modes.modes[j].angular_frequency, omega, 1e-10 * omega);
    EXPECT_NEAR(modes.modes[j].damping_ratio, 0.5 * (0.02 / omega + 0.01 * omega), 1e-9);
  }
}

}  // namespace
}  // namespace rubato::numerics
