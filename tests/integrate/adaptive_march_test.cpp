#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>

#include "support/free_vibration.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace rubato::integrate {
namespace {

using Truth = std::function<Vector(double)>;

struct Marched {
  AdaptiveReport report;
  system::State state;
};

Marched run(const system::LocallyNonlinear& system, const Method& method, const EstimatorKind& kind,
            const StepPlan& plan, double end, Observer* observer = nullptr, TryLog* log = nullptr) {
  const auto stepper = make_stepper(method, system);
  const auto estimator = make_estimator(kind, method, system, *stepper, end);
  Marched marched{{}, consistent_start(system, system.start())};
  marched.report = march(*stepper, *estimator, plan, system, marched.state, end, observer, log);
  return marched;
}

struct Oscillator {
  double tolerance, omega_h;
  long accepted, rejected;
};

// Cardona and Cassano 1991, section 5.1, as the reference page completes it (its section 2): alpha = -0.05, h0 =
// 0.05/omega, 20 periods. omega times the mean step to the digits printed there; for TOL = 1 the counts as well. The
// last step of the reference is not shortened: up to one step in the mean.
class PublishedOscillator : public ::testing::TestWithParam<Oscillator> {};

TEST_P(PublishedOscillator, TakesTheStepsOfThePaper) {
  const Oscillator row = GetParam();
  for (const double omega_squared : {1000.0, 100.0}) {
    const double omega = std::sqrt(omega_squared), end = 40.0 * std::numbers::pi / omega;
    StepPlan plan;
    plan.controller = CardonaCassano{};
    plan.first = 0.05 / omega;
    plan.rebuild = false;
    const Marched marched = run(testing::oscillator(omega_squared), make_method("hht", {{"alpha", -0.05}}),
                                InertiaJump{row.tolerance, 0.0, true}, plan, end);
    const double mean = omega * end / static_cast<double>(marched.report.march.steps);
    const double half_digit = 0.0005;
    EXPECT_NEAR(mean, row.omega_h, half_digit + mean * mean / (omega * end)) << omega_squared;
    if (row.accepted == 0) continue;
    EXPECT_EQ(marched.report.march.steps, row.accepted);
    EXPECT_EQ(marched.report.rejected, row.rejected);
  }
}

INSTANTIATE_TEST_SUITE_P(Tolerances, PublishedOscillator,
                         ::testing::Values(Oscillator{10.0, 0.785, 0, 0}, Oscillator{1.0, 0.393606, 320, 28},
                                           Oscillator{0.1, 0.180, 0, 0}, Oscillator{1e-2, 0.095, 0, 0},
                                           Oscillator{1e-3, 0.044, 0, 0}, Oscillator{1e-4, 0.020, 0, 0}));

struct Linear {
  std::string name;
  system::LocallyNonlinear system;
  double end;
  Truth truth;
};

// x'' + x' + x = cos 2t from rest.
Vector forced_mass(double t) {
  const std::complex<double> x = 1.0 / std::complex<double>(-3.0, 2.0);
  const double a = -x.real(), w = std::sqrt(0.75), b = (2.0 * x.imag() + 0.5 * a) / w;
  return Vector::Constant(1, std::exp(-0.5 * t) * (a * std::cos(w * t) + b * std::sin(w * t)) +
                                 (x * std::exp(std::complex<double>(0.0, 2.0 * t))).real());
}

Linear linear_model(const std::string& name) {
  const auto free = [&](const system::LocallyNonlinear& system, double end) {
    const testing::FreeVibration truth(system);
    return Linear{name, system, end, [truth](double t) { return truth.at(t); }};
  };
  if (name == "oscillator") return free(testing::oscillator(1000.0), 0.4);
  if (name == "damped_mass") return {name, testing::single_mass(), 20.0, forced_mass};
  Matrix k = Matrix::Zero(8, 8);
  for (Index i = 0; i < 8; ++i) {
    k(i, i) = 2.0;
    if (i > 0) k(i, i - 1) = k(i - 1, i) = -1.0;
  }
  Vector q0 = Vector::Zero(8), v0 = Vector::Zero(8);
  q0[2] = 1.0;
  v0[5] = 0.3;
  return free(testing::released(Matrix::Identity(8, 8), k, q0, v0), 10.0);
}

class GlobalError : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};

// Error per unit of time: the largest error of the whole march is proportional to the tolerance over six decades, and
// within a factor of ten of it.
TEST_P(GlobalError, IsProportionalToTheTolerance) {
  const auto& [name, method_name] = GetParam();
  const Linear model = linear_model(name);
  const Method method = make_method(method_name);
  double sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
  for (double tolerance = 1e-2; tolerance > 0.5e-8; tolerance *= 0.1) {
    testing::LargestError<Truth> errors(model.system, model.truth);
    const Marched marched =
        run(model.system, method, default_estimator(method, tolerance, model.system.stop_count() > 0), {}, model.end,
            &errors);
    ASSERT_EQ(marched.report.march.end, MarchEnd::reached);
    EXPECT_EQ(marched.state.t, model.end);
    EXPECT_GT(errors.relative(), 0.1 * tolerance) << tolerance;
    EXPECT_LT(errors.relative(), 10.0 * tolerance) << tolerance;
    const double x = std::log10(tolerance), y = std::log10(errors.relative());
    sx += x, sy += y, sxx += x * x, sxy += x * y, n += 1;
  }
  EXPECT_NEAR((n * sxy - sx * sy) / (n * sxx - sx * sx), 1.0, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Linear, GlobalError,
                         ::testing::Combine(::testing::Values("oscillator", "damped_mass", "chain"),
                                            ::testing::Values("generalized_alpha", "hht", "wbz", "average_acceleration",
                                                              "wilson_theta", "bogacki_shampine", "dormand_prince")),
                         [](const auto& info) { return std::get<0>(info.param) + "_" + std::get<1>(info.param); });

/// Keeps the bits of every start of a try.
class Watched final : public Stepper {
 public:
  explicit Watched(std::unique_ptr<Stepper> inner) : inner_(std::move(inner)) {}
  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    starts.push_back(from);
    if (fails_at == starts.size()) return {StepOutcome::not_converged, 0};
    return inner_->attempt(from, h, t1, to);
  }
  void step_changes(system::State& state, double ratio) override { inner_->step_changes(state, ratio); }

  std::vector<system::State> starts;
  std::size_t fails_at = 0;

 private:
  std::unique_ptr<Stepper> inner_;
};

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

struct Tries final : TryLog {
  void tried(const StepTry& step_try) override { all.push_back(step_try); }
  std::vector<StepTry> all;
};

struct States final : Observer {
  bool accepted(const system::State&, const system::State& after) override {
    all.push_back(after);
    return true;
  }
  std::vector<system::State> all;
};

// The paper's controller rejects often: after each rejection the next try must start from the state accepted last, and
// its auxiliary acceleration may only be that state's, remade for the other step.
TEST(RejectedStep, RestoresTheStateBitForBit) {
  const auto system = testing::damper_model(10.0, 7.7, -8.0);
  const Method method = make_method("generalized_alpha");
  Watched stepper(make_stepper(method, system));
  const auto estimator = make_estimator(InertiaJump{1e-4, 1.0, false}, method, system, stepper, 20.0);
  StepPlan plan;
  plan.controller = CardonaCassano{};
  plan.first = 0.5;
  States states;
  Tries tries;
  system::State state = consistent_start(system, system.start());
  states.all.push_back(state);
  const AdaptiveReport report = march(stepper, *estimator, plan, system, state, 20.0, &states, &tries);
  ASSERT_GT(report.rejected, 5);
  ASSERT_EQ(tries.all.size(), stepper.starts.size());
  std::size_t last = 0;
  for (std::size_t i = 0; i < tries.all.size(); ++i) {
    ASSERT_EQ(tries.all[i].t, states.all[last].t);
    ASSERT_TRUE(same_bits(stepper.starts[i].q, states.all[last].q));
    ASSERT_TRUE(same_bits(stepper.starts[i].v, states.all[last].v));
    ASSERT_TRUE(same_bits(stepper.starts[i].slider_force, states.all[last].slider_force));
    if (tries.all[i].outcome == TryOutcome::accepted) ++last;
  }
}

TEST(FailedStep, IsHalvedCountedAndLeavesNoTrace) {
  const auto system = testing::oscillator(1000.0);
  const Method method = make_method("hht");
  Watched stepper(make_stepper(method, system));
  stepper.fails_at = 3;
  const auto estimator = make_estimator(LocalError{1e-2}, method, system, stepper, 0.2);
  StepPlan plan;
  plan.first = 1e-3;
  plan.controller = FixedStep{};
  Tries tries;
  system::State state = consistent_start(system, system.start());
  const AdaptiveReport report = march(stepper, *estimator, plan, system, state, 0.2, nullptr, &tries);
  EXPECT_EQ(report.failed, 1);
  EXPECT_EQ(tries.all[2].outcome, TryOutcome::not_converged);
  EXPECT_TRUE(std::isnan(tries.all[2].error));
  EXPECT_EQ(tries.all[3].step, 0.5e-3);
  EXPECT_TRUE(same_bits(stepper.starts[2].q, stepper.starts[3].q));
  EXPECT_EQ(report.march.end, MarchEnd::reached);
}

TEST(SmallestStep, EndsTheMarchWithTheStateThatWasReached) {
  const auto system = testing::single_mass();
  StepPlan plan;
  plan.smallest = 0.01;
  const Marched marched = run(system, make_method("hht"), LocalError{1e-6}, plan, 20.0);
  EXPECT_EQ(marched.report.march.end, MarchEnd::failed);
  EXPECT_EQ(marched.report.march.step.outcome, StepOutcome::too_small);
  EXPECT_LT(marched.report.march.failed_step, 0.01);
}

/// The lengths of the accepted steps.
struct Lengths final : TryLog {
  void tried(const StepTry& step_try) override {
    if (step_try.outcome == TryOutcome::accepted) steps.push_back(step_try.step);
  }
  std::vector<double> steps;
};

struct Errors {
  double q = 0.0, v = 0.0, a = 0.0;
};

/// The largest errors when every step is taken in 2^splits equal parts.
Errors errors_of(const system::LocallyNonlinear& system, const Method& method, const std::vector<double>& steps,
                 int splits) {
  const testing::FreeVibration truth(system);
  const auto stepper = make_stepper(method, system);
  system::EquilibriumAcceleration equilibrium(system);
  Vector acceleration(system.size());
  system::State from = consistent_start(system, system.start()), to = from;
  Errors errors;
  double last = steps.front();
  for (const double step : steps) {
    if (step != last) stepper->step_changes(from, step / last);
    last = step;
    for (int part = 0; part < 1 << splits; ++part) {
      const double h = std::ldexp(step, -splits);
      EXPECT_EQ(stepper->attempt(from, h, from.t + h, to).outcome, StepOutcome::accepted);
      std::swap(from, to);
    }
    equilibrium(from, acceleration);
    errors.q = std::max(errors.q, (from.q - truth.at(from.t)).norm());
    errors.v = std::max(errors.v, (from.v - truth.at(from.t, 1)).norm());
    errors.a = std::max(errors.a, (acceleration - truth.at(from.t, 2)).norm());
  }
  return errors;
}

class SplitSteps : public ::testing::TestWithParam<std::string> {};

// The steps of a run whose lengths vary, each split in two, and again: displacement, velocity and the acceleration of
// equilibrium are of second order, each ratio within 8 % of 4 in the asymptotic range.
TEST_P(SplitSteps, LowerEveryErrorWithSecondOrder) {
  const Linear model = linear_model("chain");
  const Method method = make_method(GetParam());
  Lengths lengths;
  StepPlan plan;
  plan.controller = CardonaCassano{};
  plan.first = 0.02;
  (void)run(model.system, method, InertiaJump{3e-3, 0.0, false}, plan, model.end, nullptr, &lengths);
  ASSERT_GT(lengths.steps.size(), 50u);
  ASSERT_GT(*std::max_element(lengths.steps.begin(), lengths.steps.end()),
            1.3 * *std::min_element(lengths.steps.begin(), lengths.steps.end()));
  Errors last = errors_of(model.system, method, lengths.steps, 1);
  for (int splits = 2; splits <= 3; ++splits) {
    const Errors next = errors_of(model.system, method, lengths.steps, splits);
    EXPECT_NEAR(last.q / next.q, 4.0, 0.32);
    EXPECT_NEAR(last.v / next.v, 4.0, 0.32);
    EXPECT_NEAR(last.a / next.a, 4.0, 0.32);
    last = next;
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, SplitSteps,
                         ::testing::Values("average_acceleration", "hht", "wbz", "generalized_alpha", "wilson_theta"),
                         [](const auto& info) { return info.param; });

// A load by a table: from rest, 1 N from 1 s to 1.5 s, zero before and after.
TEST(TableLoad, IsNeverSteppedOverAndItsJumpsRestartTheMarch) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  model::TableLaw pulse{{0.0, 1.0, 1.0, 1.5, 1.5, 9.0}, {0, 0, 1, 1, 0, 0}, model::TableLaw::Beyond::hold, ""};
  parts.loads = system::Loads({{{0}, {1.0}, pulse}});
  parts.coordinates = {"x"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto exact = [](double t) {
    const double after = t < 1.5 ? 0.0 : 1.0 - std::cos(t - 1.5);
    return Vector::Constant(1, t < 1.0 ? 0.0 : 1.0 - std::cos(t - 1.0) - after);
  };
  testing::LargestError<Truth> errors(system, exact);
  struct Both final : Observer {
    bool accepted(const system::State& a, const system::State& b) override {
      for (const double jump : {1.0, 1.5}) EXPECT_FALSE(a.t < jump && b.t > jump);
      times.push_back(b.t);
      return errors->accepted(a, b);
    }
    testing::LargestError<Truth>* errors;
    std::vector<double> times;
  } observer;
  observer.errors = &errors;
  const Marched marched = run(system, make_method("generalized_alpha"), LocalError{1e-4}, {}, 8.0, &observer);
  EXPECT_EQ(marched.report.restarts, 2);
  EXPECT_EQ(std::count(observer.times.begin(), observer.times.end(), 1.0), 1);
  EXPECT_EQ(std::count(observer.times.begin(), observer.times.end(), 1.5), 1);
  EXPECT_LT(errors.relative(), 1e-3);
  EXPECT_GT(errors.relative(), 1e-5);
}

// 1 N from 1 s to 4.3 s by a table of two rows, zero beyond: both ends are jumps. The error was of first order in the
// step where the last row was taken for a corner, 10 tolerances at 1e-3 and 960 at 1e-7.
TEST(TableLoad, ThatBeginsAndEndsWithAValueJumpsThere) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads = system::Loads({{{0}, {1.0}, model::TableLaw{{1.0, 4.3}, {1, 1}, model::TableLaw::Beyond::zero, ""}}});
  parts.coordinates = {"x"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto exact = [](double t) {
    const double since = t < 1.0 ? 0.0 : 1.0 - std::cos(t - 1.0), after = t < 4.3 ? 0.0 : 1.0 - std::cos(t - 4.3);
    return Vector::Constant(1, since - after);
  };
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    testing::LargestError<Truth> errors(system, exact);
    const Marched marched = run(system, make_method("generalized_alpha"), LocalError{tolerance}, {}, 10.0, &errors);
    EXPECT_EQ(marched.report.restarts, 2);
    EXPECT_LT(errors.relative(), 10.0 * tolerance);
  }
}

// Between rows at equal distances the steps are equal parts, of few lengths, and the matrices of a length that comes
// again are at hand: without either almost every change would cost a factorisation.
TEST(TableLoad, OfManyRowsNeedsFewFactorisations) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  model::TableLaw rows;
  for (int i = 0; i <= 600; ++i) {
    rows.times.push_back(0.1 * i);
    rows.values.push_back(std::sin(0.4 * i) + 0.3 * std::sin(1.1 * i));
  }
  parts.loads = system::Loads({{{0}, {1.0}, rows}});
  parts.coordinates = {"x"};
  const system::LocallyNonlinear system(std::move(parts));
  struct Changes final : Observer {
    bool accepted(const system::State& before, const system::State& after) override {
      const double step = after.t - before.t;
      count += std::abs(step - last) > 1e-9 * step;
      last = step;
      return true;
    }
    double last = 0.0;
    long count = 0;
  } changes;
  const Marched marched = run(system, make_method("generalized_alpha"), LocalError{1e-2}, {}, 60.0, &changes);
  ASSERT_EQ(marched.report.march.end, MarchEnd::reached);
  EXPECT_GT(marched.report.march.steps, 1200);
  EXPECT_LT(marched.report.factorisations, changes.count / 3);
  EXPECT_GT(changes.count, 80);
}

/// An error (h/allowed)^exponent, where what is allowed falls by a twentieth at half a second: less than a controller
/// leaves as a margin.
class SlowlyRisingError final : public Estimator {
 public:
  explicit SlowlyRisingError(int exponent) : exponent_(exponent) {}
  void start(const system::State&) override {}
  double error(const system::State& from, const system::State&, double h) override {
    return std::pow(h / (from.t < 0.5 ? 0.1 : 0.0951), exponent_);
  }
  void accept(const system::State&) override {}
  void forget() override {}
  int exponent() const override { return exponent_; }
  double first_step() const override { return 0.1; }

 private:
  int exponent_;
};

// Between the rows of a table a step that was rejected by a little was tried again as it was, for ever: the next length
// was within a fifth of the part of the way, which was kept. Of second order the controller's margin is larger.
TEST(TableLoad, NeverTriesTheStepAgainThatWasRejected) {
  struct Tries final : TryLog {
    void tried(const StepTry& now) override {
      if (last.outcome == TryOutcome::error_too_large && now.t == last.t) {
        EXPECT_LT(now.step, last.step);
      }
      last = now;
      if (++count > 1000) throw std::runtime_error("the march does not end");
    }
    StepTry last{};
    long count = 0;
  };
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads = system::Loads({{{0}, {1.0}, model::TableLaw{{0.0, 1.0, 2.0}, {0.0, 1.0, 1.0}}}});
  parts.coordinates = {"x"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto stepper = make_stepper(make_method("rk4"), system);
  for (const int exponent : {2, 3, 5}) {
    SlowlyRisingError estimator(exponent);
    system::State state = consistent_start(system, system.start());
    Tries tries;
    StepPlan plan;
    plan.largest = 1.0;
    const AdaptiveReport report = march(*stepper, estimator, plan, system, state, 2.0, nullptr, &tries);
    EXPECT_EQ(report.march.end, MarchEnd::reached) << exponent;
    EXPECT_GT(report.rejected, 0) << exponent;
  }
}

}  // namespace
}  // namespace rubato::integrate
