#include <rubato/steady/linear/fourier_series.hpp>
#include <rubato/steady/linear/linear_response.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

namespace rubato::steady {
namespace {

using Complex = std::complex<double>;

SteadyRequest observing(std::vector<SteadyRequest::Observed> observed, std::vector<int> harmonics = {1}) {
  return {std::move(observed), std::move(harmonics), true};
}

SteadyResponse solve(LinearResponse& solver, const system::Excitation& excitation) {
  SteadyResponse response;
  solver.solve(excitation, SteadyStart::unloaded, response);
  return response;
}

system::LocallyNonlinear undamped(const Matrix& mass, const Matrix& stiffness, std::vector<system::LoadTerm> loads) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(mass);
  parts.stiffness = testing::sparse(stiffness);
  parts.damping = SparseMatrix(mass.rows(), mass.rows());
  parts.loads = system::Loads(std::move(loads));
  return system::LocallyNonlinear(std::move(parts));
}

// x = f / (k - m omega^2 + i c omega), with k = 2 while the slider (kT = 1) sticks.
TEST(LinearResponse, OfOneMassIsItsReceptance) {
  for (const double omega : {0.3, std::sqrt(0.5), 1.0, 2.0, 40.0}) {
    const auto system = testing::single_mass(0.15, omega);
    for (const double stiffness : {1.0, 2.0}) {
      LinearResponse solver =
          stiffness == 1.0 ? free_limit(system, observing({{0}})) : stuck_limit(system, observing({{0}}));
      const SteadyResponse r = solve(solver, excitation_of(system));
      const Complex x = 1.0 / Complex(stiffness - omega * omega, omega);
      // Round-off of k - m omega^2 alone: a few units of the largest term over the receptance.
      const double tolerance = 1e-15 * (stiffness + omega * omega + omega) * std::norm(x) * 4.0;
      EXPECT_EQ(r.status, SteadyStatus::converged);
      EXPECT_NEAR(std::abs(r.harmonics(0, 0) - x), 0.0, tolerance);
      EXPECT_NEAR(r.amplitude[0], std::abs(x), tolerance);
      EXPECT_NEAR(r.velocity_amplitude[0], omega * std::abs(x), omega * tolerance);
      EXPECT_NEAR(r.acceleration_amplitude[0], omega * omega * std::abs(x), omega * omega * tolerance);
      EXPECT_NEAR(r.rms[0], std::abs(x) / std::sqrt(2.0), tolerance);
      // pi c omega |x|^2, which the load puts in.
      EXPECT_NEAR(r.viscous_work, std::numbers::pi * omega * std::norm(x), 1e-12 * r.viscous_work);
      EXPECT_NEAR(r.input_work, r.viscous_work, 1e-12 * r.viscous_work);
      EXPECT_EQ(r.slip_share[0], stiffness == 1.0 ? 1.0 : 0.0);
      EXPECT_LT(r.residual, 1e-15);
    }
  }
}

// Reference page, section 3: 1.15470053838 at 0.707106781 rad/s free, 0.755928946018 at 1.22474487 in full stick.
// Section 4: 7.76688168051 at 7.48704693 and 7.54682234372 at 8.06013273. The frequencies have 9 digits; a peak is
// flat.
TEST(LinearResponse, HasThePeaksOfTheThesisInBothLimits) {
  const auto at = [](double omega, bool stuck) {
    const auto system = testing::single_mass(0.15, omega);
    LinearResponse solver = stuck ? stuck_limit(system, observing({{0}})) : free_limit(system, observing({{0}}));
    return solve(solver, excitation_of(system)).amplitude[0];
  };
  EXPECT_NEAR(at(0.707106781, false), 1.15470053838, 5e-12);
  EXPECT_NEAR(at(1.22474487, true), 0.755928946018, 5e-13);
  const auto damper_at = [](double omega, bool stuck) {
    const auto system = testing::damper_model(10.0, omega);
    LinearResponse solver = stuck ? stuck_limit(system, observing({{3}})) : free_limit(system, observing({{3}}));
    return solve(solver, excitation_of(system)).amplitude[0];
  };
  EXPECT_NEAR(damper_at(7.48704693, false), 7.76688168051, 5e-11);
  EXPECT_NEAR(damper_at(8.06013273, true), 7.54682234372, 5e-11);
}

TEST(LinearResponse, SumsHarmonicsWithTheirMean) {
  auto base = testing::damper_model();
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  parts.damping = base.damping();
  parts.stiffness = base.stiffness();
  parts.sliders = base.sliders();
  parts.coordinates = base.coordinates();
  parts.loads = system::Loads(
      {testing::harmonic(1, 20.0, 2.5, 0.3), testing::harmonic(3, -8.0, 7.5, 1.1), testing::harmonic(0, 3.0, 0.0)});
  const system::LocallyNonlinear system(std::move(parts));
  const std::vector<bool> stuck{true, false};
  LinearResponse solver(system, stuck, observing({{1, 4}, {2}}, {1, 2, 3}));
  const SteadyResponse r = solve(solver, excitation_of(system));

  Matrix k = Matrix(system.stiffness());
  k(1, 1) += 10.0, k(4, 4) += 10.0, k(1, 4) -= 10.0, k(4, 1) -= 10.0;
  const auto response = [&](double omega, Index on, Complex load) {
    ComplexVector f = ComplexVector::Zero(5);
    f[on] = load;
    const Eigen::MatrixXcd s = k.cast<Complex>() - omega * omega * Matrix(system.mass()).cast<Complex>() +
                               Complex(0.0, omega) * Matrix(system.damping()).cast<Complex>();
    return ComplexVector(s.fullPivLu().solve(f));
  };
  const ComplexVector x0 = response(0.0, 0, 3.0), x1 = response(2.5, 1, std::polar(20.0, 0.3)),
                      x3 = response(7.5, 3, std::polar(-8.0, 1.1));
  EXPECT_NEAR(r.mean[0], (x0[1] - x0[4]).real(), 1e-14);
  EXPECT_NEAR(std::abs(r.harmonics(0, 0) - (x1[1] - x1[4])), 0.0, 1e-13);
  EXPECT_EQ(r.harmonics(0, 1), 0.0);
  EXPECT_NEAR(std::abs(r.harmonics(1, 2) - x3[2]), 0.0, 1e-13);
  // Half peak to peak by brute force: 200,000 samples miss the peak by (3 pi / 2e5)^2 / 2 of the amplitude, 1e-9.
  double high = -1e9, low = 1e9;
  for (int i = 0; i < 200'000; ++i) {
    const double theta = 2.0 * std::numbers::pi * i / 200'000;
    const double x = ((x1[1] - x1[4]) * std::polar(1.0, theta) + (x3[1] - x3[4]) * std::polar(1.0, 3.0 * theta)).real();
    high = std::max(high, x), low = std::min(low, x);
  }
  EXPECT_NEAR(r.amplitude[0], 0.5 * (high - low), 1e-8 * r.amplitude[0]);
  EXPECT_NEAR(r.input_work, r.viscous_work, 1e-12 * r.input_work);

  const Waveform wave = solver.waveform(64);
  EXPECT_NEAR(wave.position(1, 0), (x0[1] + x1[1] + x3[1]).real(), 1e-13);
  EXPECT_NEAR(wave.slider_force(0, 5), 10.0 * (wave.position(1, 5) - wave.position(4, 5)), 1e-13);
  EXPECT_EQ(wave.slider_force(1, 5), 0.0);
}

TEST(LinearResponse, SaysThatAResonanceWithoutDampingIsUnbounded) {
  Matrix stiffness(2, 2);
  stiffness << 3, -1, -1, 3;  // omega^2 = 2 with equal motions, 4 with opposite ones
  for (const double omega : {std::sqrt(2.0), 2.0}) {
    const auto system = undamped(Matrix::Identity(2, 2), stiffness, {testing::harmonic(0, 1.0, omega)});
    LinearResponse solver(system, {}, observing({{0}, {1}}));
    const SteadyResponse r = solve(solver, excitation_of(system));
    EXPECT_EQ(r.status, SteadyStatus::unbounded);
    for (const Index i : {0, 1}) {
      EXPECT_TRUE(std::isinf(r.amplitude[i]));
      EXPECT_TRUE(std::isinf(std::abs(r.harmonics(i, 0))));
    }
    EXPECT_TRUE(std::isinf(r.error));
  }
  // A part in 1e9 beside it the response is large and known: 1 / (4 delta) in each mass, to about 1e-7 (round-off
  // 2e-16 of a relative distance of 1e-9).
  const double beside = 2.0 * (1.0 + 1e-9);
  const auto system = undamped(Matrix::Identity(2, 2), stiffness, {testing::harmonic(0, 1.0, beside)});
  LinearResponse solver(system, {}, observing({{0}}));
  const SteadyResponse r = solve(solver, excitation_of(system));
  EXPECT_EQ(r.status, SteadyStatus::converged);
  EXPECT_NEAR(r.amplitude[0], 0.5 / (beside * beside - 4.0), 1e-6 * r.amplitude[0]);
  EXPECT_GT(r.error, 1e-9);
  EXPECT_LT(r.error, 1e-5);
}

// Two masses on a link of 1e13 k, at the resonance of both: round-off of the link is a hundredth of k, and hides what
// is left of k - w^2 m; the dashpot bounds the motion all the same, to f / (w c) but for that hundredth.
TEST(LinearResponse, IsNotInfiniteWhereADashpotBoundsAMotionBesideStiffLinks) {
  const double link = 1e13;
  system::LocallyNonlinear::Parts parts;
  Matrix k(2, 2), c = Matrix::Zero(2, 2);
  k << 1.0 + link, -link, -link, link;
  c(0, 0) = 0.1;
  parts.mass = testing::sparse(0.5 * Matrix::Identity(2, 2));
  parts.damping = testing::sparse(c);
  parts.stiffness = testing::sparse(k);
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 1.0)});
  parts.coordinates = {"a", "b"};
  const system::LocallyNonlinear system(std::move(parts));
  SteadyRequest request;
  request.observed = {{0, ground}};
  LinearResponse limit = free_limit(system, request);
  SteadyResponse r;
  limit.solve(excitation_of(system), SteadyStart::unloaded, r);
  EXPECT_EQ(r.status, SteadyStatus::not_converged);
  EXPECT_NEAR(r.amplitude[0], 10.0, 10.0 * r.error);
  EXPECT_LT(r.error, 0.2);
}

TEST(LinearResponse, IsFiniteWhereTheResonantPartIsNotJoined) {
  Matrix stiffness(2, 2);
  stiffness << 4, 0, 0, 9;
  const auto system =
      undamped(Matrix::Identity(2, 2), stiffness, {testing::harmonic(0, 1.0, 2.0), testing::harmonic(1, 1.0, 2.0)});
  LinearResponse solver(system, {}, observing({{0}, {1}}));
  const SteadyResponse r = solve(solver, excitation_of(system));
  EXPECT_EQ(r.status, SteadyStatus::unbounded);
  EXPECT_TRUE(std::isinf(r.amplitude[0]));
  EXPECT_NEAR(r.amplitude[1], 0.2, 1e-15);
}

TEST(LinearResponse, OfAFreeBodyUnderAStaticLoadIsUnbounded) {
  Matrix stiffness(2, 2);
  stiffness << 1, -1, -1, 1;
  const auto system =
      undamped(Matrix::Identity(2, 2), stiffness, {testing::harmonic(0, 1.0, 3.0), testing::harmonic(1, 1.0, 0.0)});
  LinearResponse solver(system, {}, observing({{0}}));
  EXPECT_EQ(solve(solver, excitation_of(system)).status, SteadyStatus::unbounded);
  // Without the static load it only swings.
  const auto swinging = undamped(Matrix::Identity(2, 2), stiffness, {testing::harmonic(0, 1.0, 3.0)});
  LinearResponse other(swinging, {}, observing({{0}}));
  const SteadyResponse r = solve(other, excitation_of(swinging));
  EXPECT_EQ(r.status, SteadyStatus::converged);
  EXPECT_NEAR(r.amplitude[0], std::abs(0.5 / -9.0 + 0.5 / (2.0 - 9.0)), 1e-15);
}

// The chain of identical masses between walls has the modes sin(j pi i / (n + 1)), omega_j = 2 sin(j pi / (2 (n + 1))),
// and C = a M + b K keeps them: its receptance is a sum over modes.
TEST(LinearResponse, OfASparseChainIsTheSumOverItsModes) {
  const Index n = 400;
  const auto system = testing::chain(n, 3);
  for (const double omega : {0.05, 0.7, 1.9, 2.5}) {
    system::Excitation excitation{omega, Vector::Zero(n), {{1, ComplexVector::Zero(n)}}, Vector::Constant(3, 0.5)};
    excitation.harmonics[0].amplitude[n / 3] = Complex(2.0, -1.0);
    LinearResponse solver = free_limit(system, observing({{n / 4}, {n / 3}}));
    const SteadyResponse r = solve(solver, excitation);
    Complex expected[2] = {0.0, 0.0};
    for (Index j = 1; j <= n; ++j) {
      const double angle = std::numbers::pi * static_cast<double>(j) / static_cast<double>(n + 1);
      const double square = 4.0 * std::pow(std::sin(0.5 * angle), 2);
      const Complex denominator(square - omega * omega, omega * (0.02 + 0.01 * square));
      const auto shape = [&](Index i) { return std::sin(angle * static_cast<double>(i + 1)); };
      for (int o = 0; o < 2; ++o)
        expected[o] += 2.0 / static_cast<double>(n + 1) * shape(o == 0 ? n / 4 : n / 3) * shape(n / 3) *
                       Complex(2.0, -1.0) / denominator;
    }
    for (Index o = 0; o < 2; ++o) EXPECT_NEAR(std::abs(r.harmonics(o, 0) - expected[o]), 0.0, 1e-11) << omega;
  }
}

// At omega^2 = k / m of a mass between two springs the first pivot vanishes, though the structure is far from a
// resonance: elimination without exchange of rows fails there.
TEST(LinearResponse, SurvivesPartsInResonanceOfTheirOwn) {
  const Index n = 61;
  const auto base = testing::chain(n, 0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  parts.stiffness = base.stiffness();
  parts.damping = SparseMatrix(n, n);
  const double omega = std::sqrt(2.0);  // every diagonal entry of S is round-off
  parts.loads = system::Loads({testing::harmonic(0, 1.0, omega)});
  const system::LocallyNonlinear system(std::move(parts));
  // n odd has the mode of omega^2 = 2; a chain of 60 does not.
  LinearResponse resonant(system, {}, observing({{0}}));
  EXPECT_EQ(solve(resonant, excitation_of(system)).status, SteadyStatus::unbounded);

  const auto even_base = testing::chain(60, 0);
  system::LocallyNonlinear::Parts even;
  even.mass = even_base.mass();
  even.stiffness = even_base.stiffness();
  even.damping = SparseMatrix(60, 60);
  even.loads = system::Loads({testing::harmonic(0, 1.0, omega)});
  const system::LocallyNonlinear even_system(std::move(even));
  LinearResponse solver(even_system, {}, observing({{1}, {0}}));
  const SteadyResponse r = solve(solver, excitation_of(even_system));
  // S = tridiag(-1, 0, -1): x_2 = -f_1 = -1, x_1 = 0 but for the round-off of 2 - omega^2, times 30.
  EXPECT_EQ(r.status, SteadyStatus::converged);
  EXPECT_NEAR(r.harmonics(0, 0).real(), -1.0, 1e-12);
  EXPECT_NEAR(r.amplitude[1], 0.0, 1e-12);
}

// A membrane of 12 by 10 masses, each between four springs, at omega^2 = 4: no diagonal entry is left, yet no mode is
// near, for cos(i pi / 13) + cos(j pi / 11) is never zero.
TEST(DynamicStiffness, ExchangesRowsWhereItMust) {
  const Index width = 12, height = 10, n = width * height;
  Matrix stiffness = 4.0 * Matrix::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    if (i % width > 0) stiffness(i, i - 1) = stiffness(i - 1, i) = -1.0;
    if (i >= width) stiffness(i, i - width) = stiffness(i - width, i) = -1.0;
  }
  const auto system = undamped(Matrix::Identity(n, n), stiffness, {});
  DynamicStiffness solver(system, StuckSliders{});
  ComplexVector x;
  for (const double omega : {1.1, 2.0}) {
    solver.factorise(omega);
    const double residual = solver.solve(ComplexVector::Unit(n, 5), x).residual;
    EXPECT_LT(residual, 2e-14);
    const Vector expected = (stiffness - omega * omega * Matrix::Identity(n, n)).fullPivLu().solve(Vector::Unit(n, 5));
    EXPECT_LT((x.real() - expected).norm(), 1e-12 * expected.norm());  // condition 100
    EXPECT_EQ(solver.pivoted(), omega == 2.0 ? 1 : 0);
  }
}

// A membrane of 22 by 22 masses with Rayleigh damping and a dashpot to the ground that couples the modes; its mode
// route is held to the direct one.
system::LocallyNonlinear membrane(bool is_held) {
  const Index side = 22, n = side * side;
  std::vector<Eigen::Triplet<double>> k;
  for (Index i = 0; i < n; ++i) {
    double sum = is_held ? 4.0 : 0.0;
    const auto join = [&](Index j) {
      k.emplace_back(i, j, -1.0);
      if (!is_held) sum += 1.0;
    };
    if (i % side > 0) join(i - 1);
    if (i % side + 1 < side) join(i + 1);
    if (i >= side) join(i - side);
    if (i + side < n) join(i + side);
    k.emplace_back(i, i, sum);
  }
  system::LocallyNonlinear::Parts parts;
  parts.stiffness.resize(n, n);
  parts.stiffness.setFromTriplets(k.begin(), k.end());
  parts.mass.resize(n, n);
  parts.mass.setIdentity();
  SparseMatrix dashpot(n, n);
  dashpot.insert(n / 2 + 7, n / 2 + 7) = 0.3;
  parts.damping = SparseMatrix(0.002 * parts.mass + 0.01 * parts.stiffness) + dashpot;
  parts.sliders = {{"contact", 40, n - 45, 2.0, 1.0}};
  return system::LocallyNonlinear(std::move(parts));
}

TEST(ModalStiffness, AnswersWithinItsToleranceAndItsEstimate) {
  for (const bool is_held : {true, false})
    for (const double tolerance : {1e-4, 1e-9}) {
      const auto system = membrane(is_held);
      const Index n = system.size();
      const double highest = 0.6;
      ModalStiffness modal(system, {true}, highest, tolerance);
      ASSERT_TRUE(modal.is_usable());
      DynamicStiffness direct(system, {true});
      ComplexVector force = ComplexVector::Zero(n), x, exact;
      force[100] = 1.0;
      force[455] = Complex(-0.3, 0.8);
      for (int i = 1; i <= 20; ++i) {
        const double omega = highest * i / 20.0;
        const auto solution = modal.solve(omega, force, x);
        ASSERT_TRUE(solution.has_value()) << omega;
        direct.factorise(omega);
        direct.solve(force, exact);
        const double error = (x - exact).cwiseAbs().maxCoeff(), size = exact.cwiseAbs().maxCoeff();
        const double estimate = solution->uncertainty.cwiseAbs().maxCoeff();
        EXPECT_LT(error, 2.0 * tolerance * size) << omega;
        // Off by a factor of 1/4 + (s / omega_left_out^2) and the coupling by the dashpot, and by round-off of x.
        EXPECT_LT(error, 2.0 * estimate + 1e-11 * size) << omega;
      }
      // A sweep adds residual vectors at its first points, then few.
      EXPECT_GT(modal.basis_size(), modal.mode_count());
      EXPECT_LT(modal.basis_size(), modal.mode_count() + 40);
      EXPECT_FALSE(modal.solve(1.01 * highest, force, x).has_value());
    }
}

// At a resonance without damping the error of the basis cannot be told from the answer: the point is left to the direct
// solution, which says what it is.
TEST(ModalStiffness, LeavesAResonanceWithoutDampingToTheDirectSolution) {
  const auto damped = membrane(true);
  system::LocallyNonlinear::Parts parts;
  parts.mass = damped.mass();
  parts.stiffness = damped.stiffness();
  parts.damping = SparseMatrix(damped.size(), damped.size());
  const system::LocallyNonlinear system(std::move(parts));
  ModalStiffness modal(system, {}, 0.6, 1e-9);
  ComplexVector force = ComplexVector::Unit(system.size(), 100), x;
  const double resonance = std::sqrt(8.0) * std::sin(0.5 * std::numbers::pi / 23.0);
  EXPECT_FALSE(modal.solve(resonance, force, x).has_value());
  EXPECT_TRUE(modal.solve(1.01 * resonance, force, x).has_value());
}

TEST(FourierSeries, PeakToPeakOfTwoHarmonicsIsThatOfTheirWaveform) {
  // cos t - cos(2 t) / 4 has its extrema at cos t = 1 (3/4) and cos t = -1 (-5/4): 1. With + 1/2: at cos t = -1/2
  // (-3/4) and 1 (3/2): 9/8.
  const int orders[] = {1, 2};
  const Complex narrow[] = {1.0, -0.25}, wide[] = {1.0, 0.5};
  EXPECT_NEAR(half_peak_to_peak(orders, narrow), 1.0, 1e-15);
  EXPECT_NEAR(half_peak_to_peak(orders, wide), 1.125, 1e-15);
  const Complex turned[] = {std::polar(1.0, 0.37), std::polar(0.5, 0.74)};
  EXPECT_NEAR(half_peak_to_peak(orders, turned), 1.125, 1e-15);
}

}  // namespace
}  // namespace rubato::steady
