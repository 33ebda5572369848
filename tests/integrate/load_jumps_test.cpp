#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/load_jumps.hpp>

#include "support/exact_errors.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato::integrate {
namespace {

constexpr double jump = 0.75, end = 3.0;

/// Falls from one to minus a half.
model::TableLaw falling_table(double at = jump) {
  model::TableLaw table;
  table.times = {0.0, at, at, end};
  table.values = {1.0, 1.0, -0.5, -0.5};
  return table;
}

model::FormulaLaw falling_formula() { return {numerics::Formula("t < 0.75 ? 1 : -0.5", {}, true)}; }

/// A chain under a load on its first mass that jumps, from rest: of one mass, or of so many that its steps are sparse.
system::LocallyNonlinear struck_chain(Index n, const model::TimeLaw& law, Index sliders = 0) {
  const auto chain = testing::chain(n, sliders, 100.0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = chain.mass();
  parts.stiffness = 4.0 * chain.stiffness();
  parts.damping = 0.1 * chain.mass();
  parts.sliders = chain.sliders();
  parts.loads = system::Loads({system::LoadTerm{{0}, {10.0}, law}});
  parts.coordinates = chain.coordinates();
  return system::LocallyNonlinear(std::move(parts));
}

/// The largest error of q against the exact flow, over the largest |q|.
double error_of(const std::string& method, const system::LocallyNonlinear& system, double step) {
  const auto stepper = make_stepper(make_method(method), system);
  system::State state = consistent_start(system, system.start());
  testing::ExactErrors errors(system, state);
  LoadJumps jumps(system, state.t, end);
  EXPECT_EQ(march(*stepper, state, step, end, &errors, &jumps).end, MarchEnd::reached);
  EXPECT_EQ(jumps.missed(), 0);
  errors.finish();
  return errors.relative();
}

struct Row {
  const char* method;
  int order;
};

std::ostream& operator<<(std::ostream& out, const Row& row) { return out << row.method; }

class MethodsAcrossAJump : public ::testing::TestWithParam<Row> {};

// The step that ends at the jump sees the load before it, the next step the load after it: without the acceleration
// that belongs to the latter the velocity loses h/2 M^-1 df, an error of first order.
TEST_P(MethodsAcrossAJump, OfALoadKeepTheirOrder) {
  const Row row = GetParam();
  for (const Index n : {1, 70}) {  // dense and sparse
    const auto system = struck_chain(n, falling_table());
    const double coarse = error_of(row.method, system, 1.0 / 128.0), fine = error_of(row.method, system, 1.0 / 256.0);
    EXPECT_NEAR(std::log2(coarse / fine), row.order, 0.15) << n << ": " << coarse << ", " << fine;
  }
}

// A slider that sticks throughout is a spring.
TEST_P(MethodsAcrossAJump, OfALoadKeepTheirOrderBesideASliderThatSticks) {
  const Row row = GetParam();
  const auto system = struck_chain(3, falling_table(), 1);
  const double coarse = error_of(row.method, system, 1.0 / 128.0), fine = error_of(row.method, system, 1.0 / 256.0);
  EXPECT_NEAR(std::log2(coarse / fine), row.order, 0.15) << coarse << ", " << fine;
}

INSTANTIATE_TEST_SUITE_P(All, MethodsAcrossAJump,
                         ::testing::Values(Row{"central_difference", 2}, Row{"fox_goodwin", 2},
                                           Row{"linear_acceleration", 2}, Row{"average_acceleration", 2},
                                           Row{"damped_newmark", 1}, Row{"hht", 2}, Row{"wbz", 2},
                                           Row{"generalized_alpha", 2}, Row{"wilson_theta", 2}, Row{"rk3", 3},
                                           Row{"rk4", 4}),
                         [](const auto& info) { return std::string(info.param.method); });

system::State end_of(const system::LocallyNonlinear& system, const char* method, double step) {
  const auto stepper = make_stepper(make_method(method), system);
  system::State state = consistent_start(system, system.start());
  LoadJumps jumps(system, state.t, end);
  EXPECT_EQ(march(*stepper, state, step, end, nullptr, &jumps).end, MarchEnd::reached);
  return state;
}

TEST(LoadJumps, OfAFormulaAreThoseOfTheTableThatItDescribes) {
  for (const char* method : {"average_acceleration", "generalized_alpha", "wilson_theta", "rk4", "exponential"}) {
    const system::State table = end_of(struck_chain(1, falling_table()), method, 1.0 / 64.0);
    const system::State formula = end_of(struck_chain(1, falling_formula()), method, 1.0 / 64.0);
    EXPECT_NEAR(table.q[0], formula.q[0], 1e-13) << method;
    EXPECT_NEAR(table.v[0], formula.v[0], 1e-13) << method;
  }
}

// 12 times 0.05 is a little more than 0.6: a step that ended there would have seen the load after the jump.
TEST(LoadJumps, AreMetThoughMultiplesOfTheStepAreRounded) {
  ASSERT_GT(12 * 0.05, 0.6);
  const auto system = struck_chain(1, falling_table(0.6));
  const double coarse = error_of("average_acceleration", system, 0.05);
  const double fine = error_of("average_acceleration", system, 0.025);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.15);
}

TEST(LoadJumps, WithinAStepAreCounted) {
  const auto system = struck_chain(1, falling_table());
  const auto stepper = make_stepper(make_method("average_acceleration"), system);
  system::State state = consistent_start(system, system.start());
  LoadJumps jumps(system, state.t, end);
  EXPECT_EQ(march(*stepper, state, 0.1, end, nullptr, &jumps).end, MarchEnd::reached);
  EXPECT_EQ(jumps.missed(), 1);
  EXPECT_EQ(jumps.first_missed(), jump);
}

// The zeros of sin are where the choice changes its mind, and the sine is 1e-16 there on one side.
TEST(LoadJumps, AreNotTheKinksOfARectifiedSine) {
  const model::FormulaLaw law{numerics::Formula("sin(7*t) > 0 ? sin(7*t) : 0", {}, true)};
  const system::Loads loads({system::LoadTerm{{0}, {1.0}, law}});
  EXPECT_FALSE(loads.breakpoints(0.0, end).empty());
  EXPECT_TRUE(jumps_of(loads, 0.0, end).empty());
}

}  // namespace
}  // namespace rubato::integrate
