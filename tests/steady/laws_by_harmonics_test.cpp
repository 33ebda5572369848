#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/harmonic_balance/law_by_samples.hpp>
#include <rubato/steady/marching/time_marching.hpp>

#include <support/harmonic_response.hpp>
#include <support/laws.hpp>
#include <support/models.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato::steady {
namespace {

using testing::bouc_wen_mass;
using testing::duffing;
using testing::JenkinsLaw;
using testing::mass_on;
using testing::observing;
using testing::respond;
using testing::single_mass;
using testing::single_mass_on;
using testing::spring;

void expect_balance_with_laws(const SteadyResponse& r, double tolerance) {
  EXPECT_NEAR(r.input_work, r.viscous_work + r.dissipated.sum() + r.law_dissipated.sum(), tolerance * r.input_work);
}

// friction-family reference, section 6: folds and branches by shooting, confirmed by harmonic balance.
TEST(LawsByHarmonics, MeetTheBranchesOfADuffingOscillator) {
  const auto system = duffing(1.2);
  HarmonicBalanceSolver solver(system, observing({0}), {.tolerance = 1e-9});
  SteadyResponse r;
  system::Excitation excitation = excitation_of(system);
  for (double w = 0.8; w < 1.21; w += 0.02) {
    excitation.angular_frequency = w > 1.19 ? 1.2 : w;
    solver.solve(excitation, SteadyStart::unloaded, r);
    ASSERT_EQ(r.status, SteadyStatus::converged) << w;
  }
  EXPECT_NEAR(r.amplitude[0], 2.54557670058, 1e-9);
  EXPECT_NEAR(std::abs(r.harmonics(0, 0)), 2.50919758111, 1e-9);
  expect_balance_with_laws(r, 1e-9);
  solver.forget();
  for (double w = 1.6; w > 1.19; w -= 0.02) {
    excitation.angular_frequency = w < 1.21 ? 1.2 : w;
    solver.solve(excitation, SteadyStart::unloaded, r);
    ASSERT_EQ(r.status, SteadyStatus::converged) << w;
  }
  EXPECT_NEAR(r.amplitude[0], 0.417672948936, 1e-10);
  EXPECT_NEAR(std::abs(r.harmonics(0, 0)), 0.417520453585, 1e-10);
}

// Section 9. The series is truncated at an estimated 1e-5 of the amplitude.
TEST(LawsByHarmonics, MeetTheSteadyMotionOfABoucWenElement) {
  for (const auto& point : testing::bouc_wen_points) {
    SCOPED_TRACE(::testing::Message() << point.n << " " << point.angular_frequency);
    const SteadyResponse r = respond(bouc_wen_mass(point.n, point.angular_frequency), observing({0}), 1e-5);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, r.error * point.amplitude);
    EXPECT_LT(r.error, 1e-5);
    // Works follow the square of the amplitude and more: the loop begins to yield.
    EXPECT_NEAR(r.law_dissipated[0], point.work, 1e-4 * point.work);
    expect_balance_with_laws(r, 1e-4);
  }
}

// The slider has a closed form (HysteresisLoop); a law that does the same is sampled. At the same orders the answers
// differ by the sums over samples alone.
TEST(LawsByHarmonics, GiveASliderWrittenAsALawTheMotionOfTheSlider) {
  for (const double limit : {0.05, 0.15, 0.4}) {
    SCOPED_TRACE(limit);
    const SteadyResponse closed = respond(single_mass(limit), observing({0}), 1e-6);
    const SteadyResponse sampled =
        respond(single_mass_on(std::make_shared<JenkinsLaw>(1.0, limit)), observing({0}), 1e-6);
    EXPECT_NEAR(sampled.amplitude[0], closed.amplitude[0], 2e-6 * closed.amplitude[0]);
    EXPECT_NEAR(sampled.law_dissipated[0], closed.dissipated[0], 1e-5 * closed.input_work);
    EXPECT_NEAR(sampled.input_work, closed.input_work, 1e-5 * closed.input_work);
  }
}

// Force and derivatives of one loop, where the slider slips, where it sticks, and where the mean puts it at its limit.
TEST(LawsByHarmonics, SampleTheClosedFormOfASlider) {
  const double stiffness = 2.0, limit = 0.5;
  const JenkinsLaw law(stiffness, limit);
  const Orders orders{1, 3};
  const std::vector<Complex> slips{{1.0, 0.2}, {-0.1, 0.3}, {0.05, 0.1}}, sticks{{0.1, 0.02}, {0.01, 0.0}, {0.0, 0.0}};
  for (const auto& [u, mean] : {std::pair{slips, 0.0}, {slips, 0.7}, {sticks, 0.05}, {sticks, 0.6}}) {
    SCOPED_TRACE(::testing::Message() << u[0].real() << " mean " << mean);
    HysteresisLoop loop;
    loop.pass(stiffness, limit, mean, orders, u.data(), 0.0);
    loop.extend(3);
    SampleAngles angles;
    angles.prepare(4096, orders);
    LawBySamples sampled(law);
    sampled.pass(angles, 1.7, mean, orders, u.data());
    sampled.differentiate();
    ASSERT_TRUE(sampled.has_closed());
    // A kink between samples leaves (2 pi / N)^2 / 12 of the jump in slope, some four a period: below 1e-6.
    EXPECT_NEAR(sampled.mean_force(), loop.mean_force(), 1e-6);
    EXPECT_NEAR(sampled.dissipated(), loop.dissipated(), 1e-5);
    for (int k = 1; k <= 3; ++k) EXPECT_LT(std::abs(sampled.force(k) - loop.force(k)), 2e-6) << k;
    // Of a slider that its mean has put to its limit once, slopes to both sides differ.
    if (!loop.slips() && loop.offset() != 0.0) continue;
    EXPECT_NEAR(sampled.mean_derivative(), loop.mean_derivative(), 1e-6);
    for (int k = 1; k <= 3; ++k) {
      for (int l = 1; l <= 3; ++l) {
        Complex a, b, c, d;
        sampled.derivative(k, l, a, b);
        loop.derivative(k, l, c, d);
        // A slope that jumps between samples is known to the distance of two of them.
        EXPECT_LT(std::abs(a - c) + std::abs(b - d), 2e-2) << k << " " << l;
      }
      double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
      sampled.mean_derivative(k, a, b);
      loop.mean_derivative(k, c, d);
      EXPECT_LT(std::abs(a - c) + std::abs(b - d), 2e-2) << k;
    }
  }
}

// Newton's method needs the slopes of the sums themselves: against differences of the forces.
TEST(LawsByHarmonics, DifferentiateTheSumsOverSamplesExactly) {
  const Orders orders{1, 4};
  SampleAngles angles;
  angles.prepare(128, orders);
  const std::vector<std::shared_ptr<const model::Law>> laws{
      testing::made("bouc_wen", {1.0, 0.1, 1.0, 0.5, 0.5, 1.0}),
      testing::made("bouc_wen", {3.0, 0.0, 1.0, 0.9, -0.3, 2.5}), spring("u + 0.3*u^2 - u^3*rate + 0.1*abs(rate)*rate"),
      std::make_shared<JenkinsLaw>(2.0, 0.5), std::make_shared<testing::CreepLaw>(1.0, 0.3)};
  for (std::size_t which = 0; which < laws.size(); ++which) {
    SCOPED_TRACE(which);
    LawBySamples law(*laws[which]);
    std::vector<Complex> u{{0.9, 0.2}, {-0.1, 0.3}, {0.05, 0.1}, {0.02, -0.03}};
    const double mean = 0.11, step = 1e-6;
    const auto force_at = [&](double m) {
      law.pass(angles, 1.3, m, orders, u.data());
      EXPECT_TRUE(law.has_closed());
      std::vector<Complex> force{law.mean_force()};
      for (int k = 1; k <= 4; ++k) force.push_back(law.force(k));
      return force;
    };
    force_at(mean);
    law.differentiate();
    const LawBySamples told = law;
    const auto expect = [&](const std::vector<Complex>& high, const std::vector<Complex>& low, int k, Complex slope) {
      const auto i = static_cast<std::size_t>(k);
      // The creeping law knows time within a step; that the turns come sooner or later is left out.
      EXPECT_LT(std::abs((high[i] - low[i]) / (2.0 * step) - slope), which == 4 ? 5e-4 : 2e-6) << k;
    };
    const auto by_mean_high = force_at(mean + step), by_mean_low = force_at(mean - step);
    expect(by_mean_high, by_mean_low, 0, told.mean_derivative());
    for (int k = 1; k <= 4; ++k) expect(by_mean_high, by_mean_low, k, told.derivative_by_mean(k));
    for (int l = 1; l <= 4; ++l) {
      double mean_real = 0.0, mean_imaginary = 0.0;
      told.mean_derivative(l, mean_real, mean_imaginary);
      for (const bool is_real : {true, false}) {
        const Complex shift = is_real ? Complex(step, 0.0) : Complex(0.0, step);
        Complex& number = u[static_cast<std::size_t>(l - 1)];
        const Complex before = number;
        number = before + shift;
        const auto high = force_at(mean);
        number = before - shift;
        const auto low = force_at(mean);
        number = before;
        SCOPED_TRACE(::testing::Message() << "by " << l << (is_real ? " real" : " imaginary"));
        expect(high, low, 0, is_real ? mean_real : mean_imaginary);
        for (int k = 1; k <= 4; ++k) {
          Complex by_real, by_imaginary;
          told.derivative(k, l, by_real, by_imaginary);
          expect(high, low, k, is_real ? by_real : by_imaginary);
        }
      }
    }
  }
}

TEST(LawsByHarmonics, FindTheMeanOfASpringThatIsNotOdd) {
  // x'' + x' + x + 0.3 x^2 = cos 2t + static, against a march of order four.
  for (const double static_load : {0.0, 0.2}) {
    const auto system = mass_on(spring("0.3*u^2"), 1.0, 1.0, 1.0, 2.0, static_load);
    const SteadyResponse r = respond(system, observing({0}), 1e-8);
    TimeMarchingOptions options;
    options.method = integrate::make_method("rk4");
    options.steps_per_period = 1000;
    options.tolerance = 1e-6;
    TimeMarchingSolver solver(system, options, observing({0}));
    SteadyResponse marched;
    solver.solve(excitation_of(system), SteadyStart::unloaded, marched);
    EXPECT_NEAR(r.mean[0], marched.mean[0], 1e-7);
    EXPECT_NEAR(r.amplitude[0], marched.amplitude[0], 1e-7);
    EXPECT_NEAR(r.rms[0], marched.rms[0], 1e-7);
  }
}

TEST(LawsByHarmonics, TellTheErrorOfASpringWithAKink) {
  // A one-sided spring of nine times the stiffness: its force has harmonics of all orders, falling as 1/k^2.
  const auto system = mass_on(spring("9*max(0, u - 0.5)"), 0.2, 1.0, 1.0, 0.8);
  const SteadyResponse fine = respond(system, observing({0}), 1e-6);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const SteadyResponse r = respond(system, observing({0}), tolerance);
    EXPECT_LT(r.error, tolerance);
    EXPECT_LE(std::abs(r.amplitude[0] / fine.amplitude[0] - 1.0), r.error + fine.error) << tolerance;
  }
}

TEST(LawsByHarmonics, TakeSlidersBesideLaws) {
  // The two contacts of the damper model, one of them written as a law: the others stay in closed form.
  auto parts_of = [](const system::LocallyNonlinear& model) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = model.mass();
    parts.damping = model.damping();
    parts.stiffness = model.stiffness();
    parts.sliders = model.sliders();
    parts.loads = model.loads();
    parts.coordinates = model.coordinates();
    return parts;
  };
  const auto model = testing::damper_model(34.7788, 7.777456595, 11.0);
  auto parts = parts_of(model);
  const model::Slider moved = parts.sliders.back();
  parts.sliders.pop_back();
  parts.laws.push_back(
      {"contact2", "jenkins", moved.first, moved.second, std::make_shared<JenkinsLaw>(moved.stiffness, moved.limit)});
  const SteadyResponse closed = respond(model, observing({0, 1, 3}), 1e-6),
                       mixed = respond(system::LocallyNonlinear(std::move(parts)), observing({0, 1, 3}), 1e-6);
  EXPECT_LT((closed.amplitude - mixed.amplitude).cwiseAbs().maxCoeff(), 2e-6 * closed.amplitude.maxCoeff());
  EXPECT_NEAR(mixed.law_dissipated[0], closed.dissipated[1], 1e-5 * closed.input_work);
  EXPECT_NEAR(mixed.dissipated[0], closed.dissipated[0], 1e-5 * closed.input_work);
}

// Between two turns the force of a Bouc-Wen element is known exactly at every sample, however few there are; a turn
// that is passed over between two of 64 puts it off by a thousandth.
TEST(LawsByHarmonics, FindTheTurnsBetweenSamples) {
  const auto law = testing::made("bouc_wen", {1.0, 0.1, 1.0, 0.5, 0.5, 1.0});
  const Orders orders{1, 3};
  const std::vector<Complex> plain{{1.3, 0.4}, {0.0, 0.0}, {0.0, 0.0}}, waved{{1.3, 0.4}, {-0.2, 0.9}, {0.6, 0.1}};
  for (const auto& u : {plain, waved}) {
    SampleAngles few, many;
    few.prepare(64, orders);
    many.prepare(4096, orders);
    LawBySamples coarse(*law), fine(*law);
    coarse.pass(few, 1.7, 0.2, orders, u.data());
    fine.pass(many, 1.7, 0.2, orders, u.data());
    ASSERT_TRUE(coarse.has_closed() && fine.has_closed());
    for (int i = 0; i < 64; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 64;
      EXPECT_NEAR(coarse.force_at(angle), fine.force_at(angle), 1e-12) << i;
    }
    // By Gauss points in each stretch, which leave 3e-7 of long ones; turns that are missed take 6e-3.
    EXPECT_NEAR(coarse.dissipated(), fine.dissipated(), 1e-5 * fine.dissipated());
  }
}

TEST(LawsByHarmonics, SeeThatALawIsNotOddWhateverItSays) {
  struct Liar final : model::Law {
    model::LawAnswer advance(const model::LawPoint&, const double*, const model::LawPoint& to, double*) const override {
      return at(to, nullptr);
    }
    model::LawAnswer at(const model::LawPoint& p, const double*) const override {
      return {0.3 * p.u * p.u, 0.6 * p.u, 0.0};
    }
    double stored_energy(double u, const double*) const override { return 0.1 * u * u * u; }
    double dissipated(const model::LawPoint&, const double*, const model::LawPoint&, const double*) const override {
      return 0.0;
    }
    bool is_odd() const override { return true; }
  };
  const SteadyResponse r = respond(single_mass_on(std::make_shared<Liar>()), observing({0}), 1e-8),
                       honest = respond(single_mass_on(spring("0.3*u^2")), observing({0}), 1e-8);
  EXPECT_NEAR(r.mean[0], honest.mean[0], 1e-9);
  EXPECT_LT(honest.mean[0], -1e-3);
}

TEST(LawsByHarmonics, DoNotCallALoopSteadyThatDoesNotClose) {
  // A law that hardens with every metre travelled: there is no steady motion.
  struct Hardening final : model::Law {
    Index memory_size() const override { return 1; }
    model::LawAnswer advance(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                             double* next) const override {
      next[0] = memory[0] + std::abs(to.u - from.u);
      return at(to, next);
    }
    model::LawAnswer at(const model::LawPoint& p, const double* memory) const override {
      return {(1.0 + 0.1 * memory[0]) * p.u, 1.0 + 0.1 * memory[0], 0.0};
    }
    double stored_energy(double u, const double*) const override { return 0.5 * u * u; }
    double dissipated(const model::LawPoint&, const double*, const model::LawPoint&, const double*) const override {
      return 0.0;
    }
    bool is_odd() const override { return true; }
  };
  const auto system = single_mass_on(std::make_shared<Hardening>());
  HarmonicBalanceSolver solver(system, observing({0}));
  SteadyResponse r;
  solver.solve(excitation_of(system), SteadyStart::unloaded, r);
  EXPECT_EQ(r.status, SteadyStatus::not_converged);
}

}  // namespace
}  // namespace rubato::steady
