#include <rubato/analysis/method_study_comparison.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

/// The extremum inside a step of the cubic through (x0, v0) and (x1, v1), whose velocities differ in sign.
double extremum(double h, double x0, double v0, double x1, double v1) {
  // x'(s) = v0 + b s + a s^2 over s = 0..1, with the mean velocity d.
  const double d = (x1 - x0) / h, a = 3.0 * (v0 + v1) - 6.0 * d, b = 6.0 * d - 4.0 * v0 - 2.0 * v1;
  const double q = -0.5 * (b + std::copysign(std::sqrt(std::max(0.0, b * b - 4.0 * a * v0)), b));
  double s = q != 0.0 ? v0 / q : 0.0;
  if (!(s >= 0.0 && s <= 1.0)) s = q / a;
  return x0 + h * s * (v0 + s * (b / 2.0 + s * a / 3.0));
}

struct Sampler final : integrate::ExactVisitor {
  Sampler(const Observed& observed, ExactResponse& response) : observed_(observed), response_(response) {}

  bool sample(const system::State& state, const integrate::ExactWork&) override {
    const double x = observed_.of(state.q), v = observed_.of(state.v);
    response_.largest = std::max(response_.largest, std::abs(x));
    if (!response_.values.empty() && v * v_ < 0.0)
      response_.largest =
          std::max(response_.largest, std::abs(extremum(state.t - t_, response_.values.back(), v_, x, v)));
    response_.values.push_back(x);
    t_ = state.t;
    v_ = v;
    return true;
  }
  bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
    return true;
  }

 private:
  const Observed& observed_;
  ExactResponse& response_;
  double t_ = 0.0, v_ = 0.0;
};

}  // namespace

ExactResponse exact_response(const MethodStudyPlan& plan, const system::LocallyNonlinear& system, double step) {
  const integrate::StepCount count = integrate::count_steps(plan.duration, step);
  std::vector<double> times;
  for (long i = 0; i <= count.full; ++i) times.push_back(std::min(static_cast<double>(i) * step, plan.duration));
  ExactResponse response;
  Sampler sampler(plan.observed, response);
  integrate::ExactFlow flow(system);
  system::State state = system.start();
  flow.advance(state, plan.duration, times, sampler);
  return response;
}

}  // namespace rubato::analysis
