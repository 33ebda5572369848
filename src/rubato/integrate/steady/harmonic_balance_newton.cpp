#include <rubato/integrate/steady/harmonic_balance_parts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

// Where Newton's method starts, and what is tried where it fails.
namespace rubato::integrate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int most_iterations = 30;  // of Newton from one start
constexpr int most_steps = 400;      // of a continuation

}  // namespace

void HarmonicBalanceSolver::Implementation::predict(double w, const Orders& orders, bool with_mean) {
  const Index m = stiffness.size();
  usable.clear();
  for (const Past& p : past) {
    const bool fits = p.series.orders.stride == orders.stride && p.series.has_mean == with_mean;
    if (!fits) break;
    // Extrapolation beyond the width of what is known does harm.
    if (!usable.empty() && (std::abs(p.angular_frequency - usable.back()->angular_frequency) <
                                0.3 * std::abs(w - usable.front()->angular_frequency) ||
                            p.angular_frequency == usable.back()->angular_frequency))
      break;
    usable.push_back(&p);
  }
  if (usable.empty()) {
    series.resize(orders, with_mean, m);
    start_stuck();
    return;
  }
  series.orders = orders;
  series.has_mean = with_mean;
  series.mean.setZero(m);
  series.coefficients.setZero(orders.count, m);
  for (std::size_t a = 0; a < usable.size(); ++a) {
    double weight = 1.0;
    for (std::size_t b = 0; b < usable.size(); ++b)
      if (b != a)
        weight *= (w - usable[b]->angular_frequency) / (usable[a]->angular_frequency - usable[b]->angular_frequency);
    const SliderSeries& part = usable[a]->series;
    const int common = std::min(orders.count, part.orders.count);
    series.coefficients.topRows(common) += weight * part.coefficients.topRows(common);
    series.mean += weight * part.mean;
  }
}

// The linear answer with all sliders stuck at their offsets: one Newton step from rest takes it, since a loop that does
// not slip is linear.
void HarmonicBalanceSolver::Implementation::start_stuck() {
  series.coefficients.setZero();
  series.mean.setZero();
  Vector unlimited = Vector::Constant(stiffness.size(), 0.0);
  for (Index j = 0; j < unlimited.size(); ++j)
    if (last.limits[j] > 0.0) unlimited[j] = infinity;
  equations.front().set(harmonics, unlimited, offsets);
  equations.front().solve(series, options.residual_tolerance, 3);
}

bool HarmonicBalanceSolver::Implementation::newton(const Excitation& excitation, bool has_solution,
                                                   SteadyResponse& response) {
  auto& eq = equations.front();
  eq.set(harmonics, excitation.limits, offsets);
  if (has_solution) start_series = series;
  auto outcome = eq.solve(series, options.residual_tolerance, most_iterations);
  response.iterations += outcome.iterations;
  if (!outcome.has_converged && has_solution) {
    series = start_series;
    if (add_orders(response.iterations)) outcome = eq.solve(series, options.residual_tolerance, most_iterations);
  }
  if (!outcome.has_converged) {
    start_stuck();
    const bool done = lower_the_limits(excitation, response.iterations);
    if (!done) start_stuck();
    eq.set(harmonics, excitation.limits, offsets);
    outcome = eq.solve(series, options.residual_tolerance, most_iterations);
    response.iterations += outcome.iterations;
  }
  response.residual = outcome.residual;
  return outcome.has_converged;
}

// Follows the solution of the balance as `apply(parameter)` sets it, from the series, which solves it at a value > 0,
// to zero.
template <class Apply>
bool HarmonicBalanceSolver::Implementation::follow(double parameter, double step, int& iterations, Apply&& apply) {
  auto& eq = equations.front();
  SliderSeries reached = series, before;
  double parameter_before = parameter;
  const double least_step = 1e-8 * parameter;
  for (int tries = 0; parameter > 0.0 && tries < most_steps; ++tries) {
    const double next = std::max(0.0, parameter - step);
    series = reached;
    if (before.coefficients.size() > 0 && parameter_before > parameter) {
      const double part = (parameter - next) / (parameter_before - parameter);
      series.coefficients += part * (reached.coefficients - before.coefficients);
      series.mean += part * (reached.mean - before.mean);
    }
    apply(next);
    const auto outcome = eq.solve(series, options.residual_tolerance, 12);
    iterations += outcome.iterations;
    if (outcome.has_converged) {
      before = std::move(reached);
      reached = series;
      parameter_before = parameter;
      parameter = next;
      if (outcome.iterations <= 6) step *= 1.7;
    } else {
      step *= 0.4;
      if (step < least_step) break;
    }
  }
  series = reached;
  return parameter <= 0.0;
}

// The friction limits, all multiplied by a factor that falls from where nothing slips to one.
bool HarmonicBalanceSolver::Implementation::lower_the_limits(const Excitation& excitation, int& iterations) {
  auto& eq = equations.front();
  double factor = 1.0;
  for (const Index j : eq.active())
    if (excitation.limits[j] > 0.0)
      factor = std::max(factor,
                        stiffness[j] * eq.loops()[static_cast<std::size_t>(j)].range() / (2.0 * excitation.limits[j]));
  const double logarithm = std::log(factor);
  return follow(logarithm, std::min(0.25 * logarithm, 1.0), iterations,
                [&](double power) { eq.set(harmonics, std::exp(power) * excitation.limits, offsets); });
}

// From the solution with fewer orders: what it leaves in the balance is taken away bit by bit, so that loops split and
// join one at a time.
bool HarmonicBalanceSolver::Implementation::add_orders(int& iterations) {
  auto& eq = equations.front();
  eq.keep_residual(series);
  const bool done = follow(1.0, 0.5, iterations, [&](double part) { eq.leave(part); });
  eq.leave(0.0);
  return done;
}

}  // namespace rubato::integrate
