#include <rubato/core/error.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/double_pendulum.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato {
namespace {

using integrate::make_consistent;

struct Reached {
  system::State state;
  double largest_gap = 0.0;
};

class LargestGap final : public integrate::Observer {
 public:
  explicit LargestGap(const system::Mechanism& mechanism)
      : equations_(mechanism), force_(mechanism.size()), g_(mechanism.constraint_count()) {}
  bool accepted(const system::State&, const system::State& after) override {
    equations_.go_to(after, model::Side::left);
    equations_.residual(force_, g_);
    largest = std::max(largest, g_.cwiseAbs().maxCoeff());
    return true;
  }
  double largest = 0.0;

 private:
  system::MechanismEquations equations_;
  Vector force_, g_;
};

Reached march(const system::Mechanism& mechanism, const integrate::Method& method, double h, double end) {
  const auto stepper = integrate::make_stepper(method, mechanism);
  system::MechanismEquations equations(mechanism);
  const auto start = make_consistent(equations, mechanism.start());
  EXPECT_TRUE(start.is_consistent);
  system::State state = start.state;
  const auto& alpha = std::get<integrate::GeneralizedAlpha>(method.formula);
  integrate::shift_acceleration(equations, state, (alpha.alpha_m - alpha.alpha_f) * h);
  LargestGap gap(mechanism);
  const auto report = integrate::march(*stepper, state, h, end, &gap);
  EXPECT_EQ(report.end, integrate::MarchEnd::reached);
  return {state, gap.largest};
}

double position_error(const system::State& state, double t) {
  const auto exact = testing::double_pendulum_at(t);
  double largest = 0.0;
  for (int i = 0; i < 4; ++i)
    largest = std::max(largest, std::abs(testing::double_pendulum_position(state, i) - exact[std::size_t(i)]));
  return largest;
}

TEST(DoublePendulum, ConvergesWithSecondOrderToTheReferenceSolution) {
  const system::Mechanism mechanism(testing::double_pendulum());
  const auto method = integrate::make_method("hht", {{"alpha", -0.15}});
  double last = 0.0;
  for (const double h : {2e-3, 1e-3, 5e-4}) {
    const double error = position_error(march(mechanism, method, h, 5.0).state, 5.0);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 0.2) << h;  // the next term of the error is O(h^2) of the first
    }
    last = error;
  }
  EXPECT_LT(last, 2e-4);
}

TEST(DoublePendulum, KeepsItsLinksToRoundOff) {
  const system::Mechanism mechanism(testing::double_pendulum());
  const auto reached = march(mechanism, integrate::make_method("hht", {{"alpha", -0.15}}), 1e-3, 5.0);
  EXPECT_LT(reached.largest_gap, 1e-14);  // Newton leaves its last correction squared; lengths of 1 m round at 1e-16
}

TEST(DoublePendulum, HasTheTensionsAndTheEnergyOfTheReferenceSolution) {
  const system::Mechanism mechanism(testing::double_pendulum());
  // Second order: an error of 4e-5 m in positions comes with as much of the tensions, some hundred times larger here.
  const auto state = march(mechanism, integrate::make_method("hht", {{"alpha", -0.05}}), 1e-4, 5.0).state;
  EXPECT_NEAR(state.multiplier[0], 52.162984130446, 2e-3);
  EXPECT_NEAR(state.multiplier[1], 6.796575438025, 2e-3);
  Vector product;
  mechanism.times_mass(state.v, product);
  const double potential = 9.81 * (5.0 * state.q[4] + 2.0 * state.q[7]);
  EXPECT_NEAR(0.5 * state.v.dot(product) + potential, -43.1007348460207, 1e-4);
}

TEST(DoublePendulum, HasMultipliersOfSecondOrderWithAShiftedStart) {
  const system::Mechanism mechanism(testing::double_pendulum());
  const auto method = integrate::make_method("generalized_alpha", {{"rho_inf", 0.6}});
  double last = 0.0;
  for (const double h : {2e-3, 1e-3, 5e-4}) {
    const double error = std::abs(march(mechanism, method, h, 5.0).state.multiplier[0] - 52.162984130446);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 0.4) << h;
    }
    last = error;
  }
}

TEST(MechanismStart, PutsPositionsAndVelocitiesOntoTheConstraints) {
  auto model = testing::double_pendulum();
  model.nodes[1].numbers[0] = 0.02;  // 2e-4 m off its circle
  model.nodes[2].velocity[0] = 1.0;
  model.nodes[2].velocity[1] = 0.5;  // along the link
  const system::Mechanism mechanism(std::move(model));
  system::MechanismEquations equations(mechanism);
  const auto start = make_consistent(equations, mechanism.start());
  ASSERT_TRUE(start.is_consistent);
  EXPECT_NEAR(start.position_moved, 4e-4, 1e-5);  // both links are too long by 2e-4 m, and the lower mass follows
  EXPECT_GE(start.most_moved, 0);
  const auto& q = start.state.q;
  EXPECT_NEAR(std::hypot(q[3], q[4]), 1.0, 1e-14);
  EXPECT_NEAR(std::hypot(q[6] - q[3], q[7] - q[4]), 1.0, 1e-14);
  EXPECT_GT(start.energy_lost, 0.0);
  Vector force(4), g(2), rate(2);
  equations.go_to(start.state, model::Side::right);
  equations.residual(force, g);
  equations.constraint_rate(start.state.v, rate);
  EXPECT_LT(rate.cwiseAbs().maxCoeff(), 1e-14);
  // M a + f + G^T multiplier = 0 and G a + second rate = 0.
  Vector balance;
  mechanism.times_mass(start.state.acceleration, balance);
  balance += force;
  equations.add_constraint_force(start.state.multiplier, 1.0, balance);
  EXPECT_LT(balance.cwiseAbs().maxCoeff(), 1e-12);
  equations.constraint_rate(start.state.acceleration, rate);
  Vector second(2);
  equations.second_rate(second);
  EXPECT_LT((rate + second).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(MechanismStart, TellsWhatCannotBeJoined) {
  auto model = testing::double_pendulum();
  // The second mass is also to stay within 0.5 m of a point 5 m away.
  model.joints.push_back(
      model::make_plane_distance("stay", model.plane_point(0, 5.0, 0.0), model.plane_point(2, 0.0, -2.0), 0.5));
  const system::Mechanism mechanism(std::move(model));
  system::MechanismEquations equations(mechanism);
  const auto start = make_consistent(equations, mechanism.start());
  EXPECT_FALSE(start.is_consistent);
  EXPECT_GT(start.gap, 0.1);
  EXPECT_GE(start.worst_row, 0);
}

TEST(MechanismStepper, RefusesAMethodThatDoesNotDampTheMultipliers) {
  const system::Mechanism mechanism(testing::double_pendulum());
  EXPECT_THROW(integrate::make_stepper(integrate::make_method("hht", {{"alpha", 0.0}}), mechanism), InvalidInput);
  EXPECT_THROW(integrate::make_stepper(integrate::make_method("generalized_alpha", {{"rho_inf", 1.0}}), mechanism),
               InvalidInput);
  EXPECT_THROW(integrate::make_stepper(integrate::make_method("rk4"), mechanism), InvalidInput);
  EXPECT_NO_THROW(integrate::make_stepper(integrate::make_method("hht", {{"alpha", 0.0}}), mechanism, {}, true));
}

TEST(MechanismStepper, KnowsTheSpectralRadiusThatTheFamilyIsNamedAfter) {
  for (const double rho : {0.0, 0.3, 0.6, 0.9, 1.0}) {
    const auto method = integrate::make_method("generalized_alpha", {{"rho_inf", rho}});
    // Roots of multiplicity three: round-off of 1e-16 moves them by 1e-5.
    EXPECT_NEAR(integrate::spectral_radius_at_infinity(std::get<integrate::GeneralizedAlpha>(method.formula)), rho,
                1e-5);
  }
}

TEST(MechanismStepper, AnswersTheSameWhateverItStartedNewtonFrom) {
  const system::Mechanism mechanism(testing::double_pendulum());
  const auto method = integrate::make_method("hht", {{"alpha", -0.15}});
  integrate::NewtonPlan tight;
  tight.tolerance = 1e-13;
  const auto loose_stepper = integrate::make_stepper(method, mechanism);
  const auto tight_stepper = integrate::make_stepper(method, mechanism, tight);
  system::MechanismEquations equations(mechanism);
  system::State loose = make_consistent(equations, mechanism.start()).state, exact = loose;
  integrate::march(*loose_stepper, loose, 1e-3, 2.0);
  integrate::march(*tight_stepper, exact, 1e-3, 2.0);
  EXPECT_LT((loose.q - exact.q).cwiseAbs().maxCoeff(), 1e-8);  // 2000 steps of at most 1e-10 sqrt(42)/sqrt(2) m each
}

TEST(MechanismStepper, StopsAtALoadThatIsNotANumberAndNamesItsCoordinate) {
  auto model = testing::double_pendulum();
  model.forces.push_back({0, model::FormulaLaw{numerics::Formula("t < 0.5 ? 0 : 1/(t-t)", {}, true)}});
  const system::Mechanism mechanism(std::move(model));
  const auto stepper = integrate::make_stepper(integrate::make_method("hht", {{"alpha", -0.15}}), mechanism);
  system::MechanismEquations equations(mechanism);
  system::State state = make_consistent(equations, mechanism.start()).state;
  const auto report = integrate::march(*stepper, state, 1e-2, 2.0);
  EXPECT_EQ(report.end, integrate::MarchEnd::failed);
  EXPECT_EQ(report.step.outcome, integrate::StepOutcome::not_finite);
  EXPECT_EQ(report.step.worst, 0);
  EXPECT_TRUE(state.q.allFinite());
}

}  // namespace
}  // namespace rubato
