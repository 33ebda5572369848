#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

// Dry joints with steps so short that what constraints are apart by would make forces.
namespace rubato {
namespace {

using Law = std::function<double(double)>;

/// A mass on a line, m x'' + k x + friction = F(t), limit mu N(t): rk4 in steps of 1e-5 s, whose ends at transitions
/// are found by bisection.
class Block {
 public:
  Block(double mass, double stiffness, Law force, Law limit)
      : mass_(mass), stiffness_(stiffness), force_(std::move(force)), limit_(std::move(limit)) {}

  double position_at(double end) {
    constexpr double h = 1e-5;
    while (t_ < end) {
      const double step = std::min(h, end - t_);
      if (way_ == 0.0)
        stick(step);
      else
        slide(step);
    }
    return x_;
  }

 private:
  double pull(double t, double x) const { return force_(t) - stiffness_ * x; }
  double rate(double t, double x) const { return (pull(t, x) - way_ * limit_(t)) / mass_; }

  void advance(double h, double& x, double& v) const {
    const double k1 = v, l1 = rate(t_, x);
    const double k2 = v + 0.5 * h * l1, l2 = rate(t_ + 0.5 * h, x + 0.5 * h * k1);
    const double k3 = v + 0.5 * h * l2, l3 = rate(t_ + 0.5 * h, x + 0.5 * h * k2);
    const double k4 = v + h * l3, l4 = rate(t_ + h, x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    v += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }

  /// The part of a step after which what `happens` tells of it is so.
  static double first(double h, const std::function<bool(double)>& happens) {
    double low = 0.0, high = h;
    for (int i = 0; i < 60; ++i) (happens(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    return high;
  }

  void stick(double h) {
    const auto slips = [&](double part) { return std::abs(pull(t_ + part, x_)) > limit_(t_ + part); };
    if (!slips(h)) {
      t_ += h;
      return;
    }
    t_ += first(h, slips);
    way_ = pull(t_, x_) > 0.0 ? 1.0 : -1.0;
  }

  void slide(double h) {
    const auto turns = [&](double part) {
      double x = x_, v = v_;
      advance(part, x, v);
      return way_ * v < 0.0;
    };
    const bool ends = turns(h);
    const double part = ends ? first(h, turns) : h;
    advance(part, x_, v_);
    t_ += part;
    if (!ends) return;
    v_ = 0.0;
    const double wants = pull(t_, x_);
    way_ = std::abs(wants) <= limit_(t_) ? 0.0 : wants > 0.0 ? 1.0 : -1.0;
  }

  double mass_, stiffness_;
  Law force_, limit_;
  double t_ = 0.0, x_ = 0.0, v_ = 0.0, way_ = 0.0;
};

std::string guide(const std::string& friction, double stiffness, const std::string& along, const std::string& across,
                  double tolerance, double end) {
  constexpr const char* text = R"toml(
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 2.0
inertia = 0.1
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
stiffness = {}
friction = {{ {} }}
[[force]]
on = "block.x"
expression = "{}"
[[force]]
on = "block.y"
expression = "{}"
[[analysis]]
name = "rub"
type = "transient"
duration = {}
step = {{ tolerance = {} }}
)toml";
  return fmt::format(fmt::runtime(text), stiffness, friction, along, across, end, tolerance);
}

// The step before a joint let go was long, and left its guide apart by 1e-13 m, which the short steps after it closed:
// steps ended at a friction that was made of that, and the run as a crawl.
TEST(TightFriction, OfAReactionLetsGo) {
  Block block(
      2.0, 50.0, [](double t) { return 12.0 * std::sin(2.6 * M_PI * t); },
      [](double t) { return 0.3 * 20.0 * (1.0 + 0.5 * std::sin(5.0 * t)); });
  const double exact = block.position_at(1.0);
  for (const double tolerance : {1e-6, 1e-8}) {
    const testing::MechanismStudy ran(guide("coefficient = 0.3, normal_load = \"reaction\"", 50.0, "12*sin(2.6*pi*t)",
                                            "-20*(1 + 0.5*sin(5*t))", tolerance, 1.0),
                                      0);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("rub", "position", "block.x"), exact, 3.0 * tolerance);
  }
}

TEST(TightFriction, OfAPreloadLetsGo) {
  Block block(
      2.0, 20.0, [](double t) { return 6.0 * std::sin(3.0 * t) + std::tanh(std::sin(5.7 * t)); },
      [](double) { return 5.0; });
  const double exact = block.position_at(1.0);
  for (const double tolerance : {1e-6, 1e-8}) {
    const testing::MechanismStudy ran(guide("coefficient = 0.5, preload = 10.0", 20.0, "6*sin(3*t) + tanh(sin(5.7*t))",
                                            "2 + 5*sin(7*t)", tolerance, 1.0),
                                      0);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("rub", "position", "block.x"), exact, 3.0 * tolerance);
  }
}

}  // namespace
}  // namespace rubato
