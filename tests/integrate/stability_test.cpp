#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/stability.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato::integrate {
namespace {

// Along the imaginary axis: |1 - y^2/2 + ...| <= 1 gives sqrt 3 and 2 sqrt 2 (Hairer and Wanner 1996, IV.2); Newmark:
// 1/sqrt(gamma/2 - beta) (Hughes 1987, 9.1.2).
TEST(StabilityLimit, IsThatOfTheory) {
  const std::pair<const char*, double> limits[] = {{"explicit_euler", 0.0},
                                                   {"heun", 0.0},
                                                   {"midpoint", 0.0},
                                                   {"ralston", 0.0},
                                                   {"rk3", std::sqrt(3.0)},
                                                   {"rk4", 2.0 * std::sqrt(2.0)},
                                                   {"bogacki_shampine", std::sqrt(3.0)},
                                                   {"central_difference", 2.0},
                                                   {"fox_goodwin", std::sqrt(6.0)},
                                                   {"linear_acceleration", std::sqrt(12.0)}};
  for (const auto& [method, limit] : limits) EXPECT_NEAR(stability_limit(make_method(method)), limit, 1e-9) << method;
  for (const char* method : {"average_acceleration", "galerkin", "backward_difference", "damped_newmark", "hht", "wbz",
                             "generalized_alpha", "wilson_theta"})
    EXPECT_TRUE(std::isinf(stability_limit(make_method(method)))) << method;
  EXPECT_TRUE(std::isfinite(stability_limit(make_method("wilson_theta", {{"theta", 1.3}}))));
}

TEST(StabilityLimit, IsWhatTheCatalogueSays) {
  for (const MethodInfo& info : catalogue()) {
    const std::string prefix = "omega h <= ";
    if (info.stability.rfind(prefix, 0) != 0) continue;
    EXPECT_NEAR(stability_limit(make_method(info.name)), std::stod(info.stability.substr(prefix.size())), 6e-5)
        << info.name;
  }
}

// Five percent beyond the limit a mode grows, five percent below it does not.
TEST(StabilityLimit, DividesGrowthFromNone) {
  const auto system = testing::single_mass(0.0, 0.1, 0.0);
  for (const char* method :
       {"rk3", "rk4", "dormand_prince", "central_difference", "fox_goodwin", "linear_acceleration"})
    for (const double factor : {0.95, 1.05}) {
      const double h = factor * stability_limit(make_method(method));
      const auto stepper = make_stepper(make_method(method), system);
      system::State state = consistent_start(system, system.start());
      march(*stepper, state, h, 1e6 * h);  // Dormand-Prince grows by 3e-5 a step only
      EXPECT_EQ(std::abs(state.q[0]) > 1e6, factor > 1.0) << method;
    }
}

// A dashpot on one of two masses couples their modes. By the damping of each mode alone the limit of explicit Euler
// came out 2.3 times too long, and its steps grew without a word.
TEST(StabilityLimit, OfTwoMassesWithOneDashpotDividesGrowthFromNone) {
  const auto matrix = [](double a, double b, double c) {
    Matrix full(2, 2);
    full << a, b, b, c;
    return SparseMatrix(full.sparseView());
  };
  for (const double dashpot : {0.3, 3.0, 30.0}) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = matrix(1.0, 0.0, 0.5);
    parts.stiffness = matrix(3.0, -1.0, 2.0);
    parts.damping = matrix(dashpot, 0.0, 0.01);
    parts.coordinates = {"damped", "free"};
    parts.start.q = Vector::Constant(2, 0.1);
    parts.start.v = Vector::Zero(2);
    const system::LocallyNonlinear system(std::move(parts));
    for (const char* method : {"explicit_euler", "heun", "rk3", "rk4", "dormand_prince"})
      for (const double factor : {0.95, 1.05}) {
        const double h = factor * stability_of(make_method(method), system).step;
        const auto stepper = make_stepper(make_method(method), system);
        system::State state = consistent_start(system, system.start());
        march(*stepper, state, h, 4e5 * h);                    // explicit Euler grows by 2e-5 a step only
        const bool has_grown = !(std::abs(state.q[1]) < 1.0);  // beyond all numbers, maybe
        EXPECT_EQ(has_grown, factor > 1.0) << method << ", dashpot " << dashpot;
      }
  }
}

TEST(SpectralRadius, AtInfinityIsWhatTheParametersAskFor) {
  for (const double rho : {0.0, 0.3, 0.8, 0.9}) {
    EXPECT_NEAR(spectral_radius_at_infinity(make_method("generalized_alpha", {{"rho_inf", rho}})), rho, 1e-4)
        << rho;  // round-off of a double root
    EXPECT_NEAR(spectral_radius_at_infinity(make_method("wbz", {{"rho_inf", rho}})), rho, 1e-4)
        << rho;  // round-off of a double root
  }
  for (const double alpha : {-0.3, -0.05})
    EXPECT_NEAR(spectral_radius_at_infinity(make_method("hht", {{"alpha", alpha}})), (1 + alpha) / (1 - alpha), 1e-4);
  EXPECT_NEAR(spectral_radius_at_infinity(make_method("average_acceleration")), 1.0, 1e-6);
}

// Average acceleration turns by 2 atan(omega h / 2) a step and adds no damping (Hughes 1987, 9.3).
TEST(ModeResponse, OfAverageAccelerationIsThatOfTheTrapezoidalRule) {
  for (const double x : {0.1, 1.0, 4.0}) {
    const ModeResponse mode = mode_response(make_method("average_acceleration"), x);
    EXPECT_NEAR(mode.spectral_radius, 1.0, 1e-13);
    EXPECT_NEAR(*mode.period_elongation, x / (2.0 * std::atan(0.5 * x)) - 1.0, 1e-12);
    EXPECT_NEAR(*mode.numerical_damping, 0.0, 1e-12);
  }
}

// HHT at omega h = 0.6, alpha = -0.3: 0.998092 (Cardona and Cassano 1991: 0.9981).
TEST(ModeResponse, OfHhtIsThatOfTheLiterature) {
  EXPECT_NEAR(mode_response(make_method("hht", {{"alpha", -0.3}}), 0.6).spectral_radius, 0.998092, 5e-7);
}

TEST(Family, MembersMeetWhereTheirParametersDo) {
  const auto system = testing::damper_model(20.0, 7.777, -8.0);
  const auto end = [&](const Method& method) {
    const auto stepper = make_stepper(method, system);
    system::State state = consistent_start(system, system.start());
    march(*stepper, state, 0.01, 10.0);
    return state.q;
  };
  const Vector average = end(make_method("average_acceleration"));
  EXPECT_EQ(end(make_method("hht", {{"alpha", 0.0}})), average);
  EXPECT_EQ(end(make_method("wbz", {{"rho_inf", 1.0}})), average);
  EXPECT_EQ(end(make_method("newmark", {{"beta", 0.25}, {"gamma", 0.5}})), average);
  EXPECT_GT((end(make_method("hht")) - average).norm(), 1e-4);  // the control
  const Vector linear = end(make_method("linear_acceleration"));
  EXPECT_LT((end(make_method("wilson_theta", {{"theta", 1.0}})) - linear).norm(), 1e-11);
}

}  // namespace
}  // namespace rubato::integrate
