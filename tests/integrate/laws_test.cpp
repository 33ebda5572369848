#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

// Laws of model/laws in structures: against what they are in closed form, and against the same structure said in other
// words.
namespace rubato::integrate {
namespace {

std::shared_ptr<const model::Law> law(const char* table, std::vector<model::Quantity> values) {
  model::LawDescription description;
  description.kind = table;
  description.values = std::move(values);
  return model::law_kind(table).make(description, {}, table);
}

/// Jenkins' element as a user would write it: a law with its force as memory.
class JenkinsByHand final : public model::Law {
 public:
  JenkinsByHand(double stiffness, double limit) : stiffness_(stiffness), limit_(limit) {}
  Index memory_size() const override { return 1; }
  model::LawAnswer advance(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                           double* next) const override {
    const double trial = memory[0] + stiffness_ * (to.u - from.u);
    next[0] = std::clamp(trial, -limit_, limit_);
    return {next[0], std::abs(trial) <= limit_ ? stiffness_ : 0.0, 0.0};
  }
  model::LawAnswer at(const model::LawPoint& point, const double* memory) const override {
    return {memory[0], memory[0] * point.rate < limit_ * std::abs(point.rate) ? stiffness_ : 0.0, 0.0};
  }
  double stored_energy(double, const double* memory) const override { return 0.5 * memory[0] * memory[0] / stiffness_; }
  double dissipated(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                    const double* next) const override {
    return 0.5 * (memory[0] + next[0]) * (to.u - from.u - (next[0] - memory[0]) / stiffness_);
  }

 private:
  double stiffness_, limit_;
};

system::LocallyNonlinear oscillator(std::vector<model::LawBetween> laws, double stiffness, double damping,
                                    double start = 0.0, std::vector<system::LoadTerm> loads = {}) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.stiffness = testing::sparse(Matrix::Constant(1, 1, stiffness));
  parts.damping = testing::sparse(Matrix::Constant(1, 1, damping));
  parts.laws = std::move(laws);
  parts.start.q = Vector::Constant(1, start);
  parts.loads = system::Loads(std::move(loads));
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

struct End final : Observer {
  bool accepted(const system::State&, const system::State& after) override {
    largest = std::max(largest, std::abs(after.q[0]));
    return true;
  }
  double largest = 0.0;
};

system::State march(const system::LocallyNonlinear& system, const std::string& method, double step, double duration) {
  const auto stepper = make_stepper(make_method(method), system);
  system::State state = consistent_start(system, system.start());
  const MarchReport report = march(*stepper, state, step, duration, nullptr, nullptr);
  EXPECT_EQ(report.end, MarchEnd::reached) << method;
  return state;
}

const char* const methods[] = {
    "generalized_alpha",  "average_acceleration", "hht",           "wbz",  "linear_acceleration",
    "galerkin",           "backward_difference",  "rk4",           "heun", "wilson_theta",
    "central_difference", "exponential",          "dormand_prince"};

TEST(Laws, MakeASpringAndADamperOfALinearFormulaWhateverTheMethod) {
  const std::vector<system::LoadTerm> loads{testing::harmonic(0, 1.0, 2.3)};
  const auto plain = oscillator({}, 4.0, 0.3, 0.2, loads);
  const auto by_law = oscillator({{"law", "nonlinear_spring", 0, ground, law("nonlinear_spring", {"3*u + 0.2*rate"})}},
                                 1.0, 0.1, 0.2, loads);
  for (const char* method : methods) {
    SCOPED_TRACE(method);
    const std::string name = method;
    const double h = name == "exponential" ? 5e-4 : 0.01;  // which takes forces of contacts as linear in a step
    const system::State expected = march(plain, method, h, 6.0), found = march(by_law, method, h, 6.0);
    const double allowed = name == "exponential" ? 1e-6 : name == "wilson_theta" ? 2e-4 : 1e-12;
    EXPECT_NEAR(found.q[0], expected.q[0], allowed);
    EXPECT_NEAR(found.v[0], expected.v[0], 3.0 * allowed);
  }
}

TEST(Laws, MakeASliderOfALawWithMemory) {
  system::LocallyNonlinear::Parts parts;
  for (const char* method : methods) {
    SCOPED_TRACE(method);
    const std::vector<system::LoadTerm> loads{testing::harmonic(0, 1.0, 2.0)};
    auto slider = testing::single_mass(0.15);
    const auto by_law =
        oscillator({{"law", "jenkins", 0, ground, std::make_shared<JenkinsByHand>(1.0, 0.15)}}, 1.0, 1.0, 0.0, loads);
    const system::State expected = march(slider, method, 0.02, 20.0), found = march(by_law, method, 0.02, 20.0);
    EXPECT_NEAR(found.q[0], expected.q[0], 1e-12);
    EXPECT_NEAR(found.slider_force[0], expected.slider_force[0], 1e-12);
  }
}

// A slider in the closed form of the contact problem beside the same one as a law, on two masses of a chain; dense and
// with sparse factors.
TEST(Laws, StandBesideSlidersAndStops) {
  for (const Index n : {5, 80}) {
    SCOPED_TRACE(n);
    const auto build = [n](bool by_law) {
      system::LocallyNonlinear::Parts parts;
      const system::LocallyNonlinear chain = testing::chain(n, 1, 0.5);
      parts.mass = chain.mass();
      parts.damping = chain.damping();
      parts.stiffness = chain.stiffness();
      parts.loads = chain.loads();
      parts.coordinates = chain.coordinates();
      parts.sliders = {{"kept", n / 3, n / 2, 2.0, 0.4}};
      parts.stops = {{"stop", n / 2, ground, 0.3, 50.0, 0.2}};
      if (by_law)
        parts.laws = {{"law", "jenkins", n / 2 + 1, ground, std::make_shared<JenkinsByHand>(3.0, 0.7)},
                      {"other", "jenkins", n / 3, ground, std::make_shared<JenkinsByHand>(1.0, 0.2)}};
      else {
        parts.sliders.push_back({"law", n / 2 + 1, ground, 3.0, 0.7});
        parts.sliders.push_back({"other", n / 3, ground, 1.0, 0.2});
      }
      return system::LocallyNonlinear(std::move(parts));
    };
    const auto by_law = build(true), by_slider = build(false);
    const system::State expected = march(by_slider, "generalized_alpha", 0.02, 40.0);
    const system::State found = march(by_law, "generalized_alpha", 0.02, 40.0);
    EXPECT_LT((found.q - expected.q).norm(), 1e-10 * expected.q.norm());
    EXPECT_GT(expected.q.norm(), 0.1);
  }
}

// x'' + x^3 = 0 from x = a: quarter of a period K(1/sqrt 2) / a (elliptic integral), so that x is -a after half of it.
TEST(Laws, SwingOnACubicSpringAsTheEllipticFunctionDoes) {
  const double a = 1.3, quarter = 1.8540746773013719 / a;
  const auto system =
      oscillator({{"cubic", "nonlinear_spring", 0, ground, law("nonlinear_spring", {"u^3"})}}, 0.0, 0.0, a);
  const int steps = 400;
  EXPECT_NEAR(march(system, "rk4", 2.0 * quarter / steps, 2.0 * quarter).q[0], -a, 1e-8);
  // Of second order: four times less error with half the step.
  const double coarse = march(system, "average_acceleration", quarter / steps, quarter).q[0];
  const double fine = march(system, "average_acceleration", 0.5 * quarter / steps, quarter).q[0];
  EXPECT_NEAR(coarse / fine, 4.0, 0.05);
}

// Bouc-Wen: max u 1.3257405138 in the steady state under 0.3 cos(0.85 t), n = 1, and the work of a cycle 1.12861316178
// (m = k = 1, c = 0.02, alpha = 0.1, A = 1, beta = gamma = 0.5).
TEST(Laws, ReachTheSteadyStateOfABoucWenOscillator) {
  const auto system =
      oscillator({{"hysteresis", "bouc_wen", 0, ground, law("bouc_wen", {1.0, 0.1, 1.0, 0.5, 0.5, 1.0})}}, 0.0, 0.02,
                 0.0, {testing::harmonic(0, 0.3, 0.85)});
  const double period = 2.0 * std::numbers::pi / 0.85;
  const auto stepper = make_stepper(make_method("rk4"), system);
  system::State state = consistent_start(system, system.start());
  march(*stepper, state, period / 500, 150 * period, nullptr, nullptr);
  End end;
  march(*stepper, state, period / 500, 152 * period, &end, nullptr);
  EXPECT_NEAR(end.largest, 1.3257405138, 3e-5);
}

// What a law of time pushes is what the same load does, its jump included.
TEST(Laws, JumpWithTimeAsLoadsDo) {
  const numerics::Formula formula("0.5*(t > 1)", {}, true);
  const auto by_load = oscillator({}, 3.0, 0.2, 0.0, {{{0}, {1.0}, model::FormulaLaw{formula}}});
  const auto by_law =
      oscillator({{"law", "nonlinear_spring", 0, ground, law("nonlinear_spring", {"-0.5*(t > 1)"})}}, 3.0, 0.2);
  for (const auto* system : {&by_load, &by_law}) ASSERT_EQ(system->size(), 1);
  const StepPlan plan;
  std::vector<double> ends;
  for (const auto* system : {&by_load, &by_law}) {
    const auto stepper = make_stepper(make_method("generalized_alpha"), *system);
    const auto estimator =
        make_estimator(LocalError{1e-5}, make_method("generalized_alpha"), *system, *stepper, 5.0, {});
    system::State state = consistent_start(*system, system->start());
    const AdaptiveReport report = march(*stepper, *estimator, plan, *system, state, 5.0, nullptr, nullptr);
    EXPECT_EQ(report.march.end, MarchEnd::reached);
    ends.push_back(state.q[0]);
  }
  EXPECT_NEAR(ends[0], ends[1], 1e-5);
  // 0.5/3 (1 - exp(-0.1 s)(cos w s + 0.1/w sin w s)), s = 4, w^2 = 3 - 0.01
  const double w = std::sqrt(2.99);
  EXPECT_NEAR(ends[1], 0.5 / 3.0 * (1.0 - std::exp(-0.4) * (std::cos(4 * w) + 0.1 / w * std::sin(4 * w))), 2e-5);
}

}  // namespace
}  // namespace rubato::integrate
