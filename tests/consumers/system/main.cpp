// A system of one's own: a pendulum in Cartesian coordinates (index 3) that hits a wall and comes back, marched with
// automatic steps. Only the equations are written here.
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/constrained/guard_timeline.hpp>
#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/own_system.hpp>

#include <cmath>
#include <cstdio>

using namespace rubato;

constexpr double weighs = 2.0, gravity = 9.81, wall = 0.0, restitution = 0.8;

struct Pendulum final : system::OwnSystem {
  Pendulum()
      : OwnSystem({"x", "y"}, weighs * Matrix::Identity(2, 2).sparseView(), Eigen::Vector2d(1.0, 0.0), Vector::Zero(2),
                  {"length"}) {}
  void force(const system::State&, model::Side, Vector& f) const override { f << 0.0, weighs * gravity; }
  void constraint(const system::State& at, Vector& g) const override { g << 0.5 * (at.q.squaredNorm() - 1.0); }
  void jacobian(const system::State& at, Matrix& G) const override { G = at.q.transpose(); }
  Index guard_count() const override { return 1; }
  system::GuardValue guard(Index, const system::State& at) const override { return {at.q[0] - wall, at.v[0]}; }
  system::Passage pass(Index, system::State& at) const override {
    at.v[0] = -restitution * at.v[0];
    return system::Passage::restarts;
  }
};

int main() {
  const Pendulum pendulum;
  const double end = 3.0, tolerance = 1e-6;
  const auto method = integrate::make_method("generalized_alpha", {{"rho_inf", 0.8}});
  integrate::NewtonPlan newton;
  newton.projects_velocities = true;
  const auto stepper = integrate::make_stepper(method, pendulum, newton);
  const auto equations = pendulum.equations();
  system::State state = integrate::make_consistent(*equations, pendulum.start()).state;
  const auto estimator =
      integrate::make_estimator(integrate::LocalError{tolerance}, std::get<integrate::GeneralizedAlpha>(method.formula),
                                integrate::make_error_space(pendulum, state, tolerance), state, end);
  integrate::StepPlan plan;
  plan.locate_events = true;
  integrate::GuardTimeline timeline(pendulum, 1e-12 * end);
  const auto report = integrate::march(*stepper, *estimator, plan, timeline, state, end);

  // From the horizontal it takes K(sin 45 degrees) sqrt(l/g) to the wall below. After each impact it is there again
  // after twice a quarter of a swing with the speed that is left, K(sin(amplitude/2)) each.
  const auto quarter = [](double height) { return std::comp_ellint_1(std::sqrt(0.5 * height)) / std::sqrt(gravity); };
  double height = 1.0, expected = quarter(height), worst = 0.0;
  for (const auto& event : timeline.events()) {
    worst = std::max(worst, std::abs(event.t - expected));
    height *= restitution * restitution;
    expected += 2.0 * quarter(height);
  }
  std::printf("%ld steps, %zu impacts, times right to %.1e s\n", report.march.steps, timeline.events().size(), worst);
  return report.march.end == integrate::MarchEnd::reached && timeline.events().size() == 3 && worst < 1e-5 ? 0 : 1;
}
