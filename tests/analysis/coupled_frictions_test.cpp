#include <support/laid_steps.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Dry joints of which one presses another: a block of 2 kg in a guide that rubs with its reaction, and struts that rub
// with a constant force. What they carry at rest nothing tells but this: they hold while there are forces within their
// limits that do. A strut at rest may press the block down, and its friction turns round as the block departs.
namespace rubato {
namespace {

using testing::Laid;
using testing::MechanismStudy;

constexpr double mass = 2.0, weight = mass * 9.81;

struct Strut {
  double x, y;   // its end on the ground; the other is on the block [m]
  double limit;  // [N]
};

struct DryBlock {
  double coefficient;
  std::vector<Strut> struts;

  std::string text(const Laid& laid, const std::string& force) const {
    std::string all = testing::block_in_guide(
        laid, 0.0, fmt::format("friction = {{ coefficient = {}, normal_load = \"reaction\" }}", coefficient));
    for (std::size_t i = 0; i < struts.size(); ++i)
      all += fmt::format(
          "[[joint]]\nname = \"strut {}\"\ntype = \"strut\"\nbetween = [\"ground\", \"block\"]\n"
          "at = {}\nto = {}\nfriction = {{ coefficient = 1.0, preload = {} }}\n",
          i, laid.point(struts[i].x, struts[i].y), laid.point(0.0, 0.0), struts[i].limit);
    return all + laid.gravity() + "[[force]]\non = \"block.x\"\nfollowing = true\nexpression = \"" + force + "\"\n";
  }

  /// Where a strut pushes the block that stands at x, of length one.
  static std::pair<double, double> way(const Strut& strut, double x) {
    const double length = std::hypot(x - strut.x, strut.y);
    return {(x - strut.x) / length, -strut.y / length};
  }

  /// The acceleration of the block that slides, or begins to, in a direction.
  double acceleration(double x, double force, double direction) const {
    double normal = weight;
    for (const Strut& strut : struts) {
      const auto [along, across] = way(strut, x);
      const double push = -strut.limit * std::copysign(1.0, along * direction);
      force += push * along;
      normal -= push * across;
    }
    return (force - coefficient * std::abs(normal) * direction) / mass;
  }

  /// Whether there are forces that hold it: |F + sum S along| - mu |W - sum S across| takes its least value where all S
  /// are at their limits, or all but one and the first term is zero.
  bool stands(double x, double force) const {
    const std::size_t count = struts.size();
    for (std::size_t signs = 0; signs < (1u << count); ++signs) {
      std::vector<double> push(count);
      for (std::size_t i = 0; i < count; ++i) push[i] = (signs >> i & 1u) ? struts[i].limit : -struts[i].limit;
      if (exceeds(x, force, push) <= 0.0) return true;
      for (std::size_t i = 0; i < count; ++i) {
        std::vector<double> balanced = push;
        balanced[i] = 0.0;
        balanced[i] = -along(x, force, balanced) / way(struts[i], x).first;
        if (std::abs(balanced[i]) <= struts[i].limit && exceeds(x, force, balanced) <= 0.0) return true;
      }
    }
    return false;
  }

 private:
  double along(double x, double force, const std::vector<double>& push) const {
    for (std::size_t i = 0; i < push.size(); ++i) force += push[i] * way(struts[i], x).first;
    return force;
  }
  double exceeds(double x, double force, const std::vector<double>& push) const {
    double normal = weight;
    for (std::size_t i = 0; i < push.size(); ++i) normal -= push[i] * way(struts[i], x).second;
    return std::abs(along(x, force, push)) - coefficient * std::abs(normal);
  }
};

class CoupledFrictions : public testing::LaidWithSteps {
 public:
  static std::string run(double duration) { return LaidWithSteps::run(duration, "0.001", "1e-6"); }
};
INSTANTIATE_TEST_SUITE_P(Laid, CoupledFrictions, CoupledFrictions::all_of_them(), CoupledFrictions::name);

// A force that grows by 20 N/s to either side. With 0.6 the block goes when all friction is against it; with 0.9 the
// strut can hold it longer by pressing it onto the guide with a force that would push it on.
TEST_P(CoupledFrictions, HoldWhileThereAreForcesThatDo) {
  for (const double coefficient : {0.6, 0.9})
    for (const double sign : {1.0, -1.0}) {
      const Strut strut{-0.5, 0.8, 30.0};
      const auto [along, across] = DryBlock::way(strut, 0.0);
      double most = 0.0;
      for (const double push : {strut.limit, -strut.limit})
        most = std::max(most, -sign * push * along + coefficient * std::abs(weight - push * across));
      const double all_against =
          strut.limit * std::abs(along) + coefficient * std::abs(weight + sign * strut.limit * across);
      EXPECT_EQ(most > all_against + 0.1, coefficient > 0.8 && sign > 0.0);
      const DryBlock block{coefficient, {strut}};
      const MechanismStudy ran(block.text(laid(), fmt::format("{}*t", sign * 20.0)) + run(1.1 * most / 20.0));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const auto& events = ran.table("run.events");
      ASSERT_EQ(events.rows.size(), 2u) << coefficient << ' ' << sign;
      for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(events.rows[i][0], most / 20.0, 1e-6);
      EXPECT_GT(sign * ran.last("run", "displacement", "guide"), 1e-4);
      EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3 * ran.last("run.energy", "friction_dissipated"));
    }
}

/// The way of the block under a force that swings, in tenths of a second; by Runge and Kutta's method, in steps of
/// 2e-5 s between which it is asked whether it stands.
std::vector<double> way_of(const DryBlock& block, double mean, double amplitude, double frequency, double duration) {
  constexpr double h = 2e-5;
  const auto force = [&](double t) { return mean + amplitude * std::sin(frequency * t); };
  const auto count = static_cast<int>(std::lround(duration / h)), every = static_cast<int>(std::lround(0.1 / h));
  double x = 0.0, v = 0.0;
  std::vector<double> way;
  for (int i = 0; i <= count; ++i) {
    if (i % every == 0) way.push_back(x);
    const double t = i * h;
    if (v == 0.0 && block.stands(x, force(t))) continue;
    const double direction = v != 0.0 ? std::copysign(1.0, v) : block.acceleration(x, force(t), 1.0) > 0.0 ? 1.0 : -1.0;
    const double a = block.acceleration(x, force(t), direction);
    const double b = block.acceleration(x + 0.5 * h * v, force(t + 0.5 * h), direction);
    const double c = block.acceleration(x + 0.5 * h * v + 0.25 * h * h * a, force(t + 0.5 * h), direction);
    const double d = block.acceleration(x + h * v + 0.5 * h * h * b, force(t + h), direction);
    const double next = v + h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    x += h * v + h * h / 6.0 * (a + b + c);
    v = next * direction > 0.0 ? next : 0.0;
  }
  return way;
}

// What the reference errs by is half a step at each event: 1e-5 s at 0.5 m/s.
TEST_P(CoupledFrictions, GoToAndFroAsASetOfForcesAllows) {
  struct Case {
    DryBlock block;
    double mean, amplitude, frequency;
  };
  const Case cases[] = {{{0.78, {{0.39, 0.83, 21.0}}}, -0.2, 36.0, 5.5},
                        {{0.84, {{0.46, 0.89, 35.0}}}, -9.0, 69.0, 12.0},
                        {{0.55, {{-0.3, 0.95, 21.0}, {0.35, -0.4, 7.0}}}, 2.3, 50.0, 8.7},
                        {{0.728, {{-0.3, 0.664, 9.14}}}, -4.23, 26.4, 10.1},
                        {{0.614, {{-0.3, 0.796, 7.37}}}, -0.03, 14.0, 11.4},
                        {{0.678, {{0.347, 0.391, 16.7}, {0.311, -0.945, 3.86}}}, 5.29, 31.4, 13.2},
                        {{0.744, {{-0.58, 0.422, 5.75}, {-0.49, -0.688, 13.6}}}, 1.36, 26.0, 8.62}};
  for (const Case& of : cases) {
    constexpr double duration = 2.0;
    const std::vector<double> expected = way_of(of.block, of.mean, of.amplitude, of.frequency, duration);
    const std::string force = fmt::format("{} + {}*sin({}*t)", of.mean, of.amplitude, of.frequency);
    const MechanismStudy ran(of.block.text(laid(), force) + run(duration) + "output = { interval = 0.1 }");
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& table = ran.table("run");
    ASSERT_EQ(table.rows.size(), expected.size());
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()) - *std::min_element(expected.begin(), expected.end()),
              0.02);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(table.rows[i][table.column("displacement", "guide")], expected[i], 3e-4) << i << ' ' << force;
  }
}

}  // namespace
}  // namespace rubato
