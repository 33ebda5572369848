#include <rubato/steady/harmonic_balance/harmonic_balance_parts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

// Where Newton's method starts, and what is tried where it fails.
namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int most_iterations = 30;  // of Newton from one start
constexpr int most_steps = 100;      // of a continuation
// Stiffness that a contact is given, times its receptance at the highest orders balanced ("firmness"): at 1 the contact
// resonates there. Contacts up to `soft` are taken as they are. Measured on one mass with kT of 1e3 to 1e12 k: from 1
// on Newton's method solves every balance; what begins firmer (10) fails at some, and what stays at 1 errs three times
// more.
constexpr double soft = 100.0, first_firmness = 1.0, least_firmness = 0.01, softer = 0.2, firmer = 4.0;
constexpr int most_before_shooting = 300;  // iterations, where there is another way
constexpr int easy = 8;                    // iterations after which the next orders are balanced with firmer contacts

}  // namespace

// False where nothing is known of other points.
bool HarmonicBalanceSolver::Implementation::predict(double w, const Orders& orders, bool with_mean) {
  const Index m = stiffness.size();
  usable.clear();
  for (const Past& p : past) {
    const SliderSeries& known = p.motion.displacement;
    const bool fits = known.orders.stride == orders.stride && known.has_mean == with_mean;
    if (!fits) break;
    // Extrapolation beyond the width of what is known does harm.
    if (!usable.empty() && (std::abs(p.angular_frequency - usable.back()->angular_frequency) <
                                0.3 * std::abs(w - usable.front()->angular_frequency) ||
                            p.angular_frequency == usable.back()->angular_frequency))
      break;
    usable.push_back(&p);
  }
  for (SliderSeries* part : {&guess.displacement, &guess.force}) {
    part->orders = orders;
    part->has_mean = with_mean;
    part->mean.setZero(m);
    part->coefficients.setZero(orders.count, m);
  }
  for (std::size_t a = 0; a < usable.size(); ++a) {
    double weight = 1.0;
    for (std::size_t b = 0; b < usable.size(); ++b)
      if (b != a)
        weight *= (w - usable[b]->angular_frequency) / (usable[a]->angular_frequency - usable[b]->angular_frequency);
    const auto add = [&](const SliderSeries& known, SliderSeries& out) {
      const int common = std::min(orders.count, known.orders.count);
      out.coefficients.topRows(common) += weight * known.coefficients.topRows(common);
      out.mean += weight * known.mean;
    };
    add(usable[a]->motion.displacement, guess.displacement);
    add(usable[a]->motion.force, guess.force);
  }
  return !usable.empty();
}

// Geometric mean of |R_k| of each slider over the upper half of the orders that are balanced [m] [m/N].
Vector HarmonicBalanceSolver::Implementation::slider_receptances() const {
  const Index m = stiffness.size();
  const int count = series.orders.count;
  Vector logarithms = Vector::Zero(m), receptances(m);
  int taken = 0;
  for (int i = count / 2; i < count; ++i) {
    const CondensedHarmonic& harmonic = harmonics[static_cast<std::size_t>(i) + 1];
    if (harmonic.held > 0.0) continue;
    ++taken;
    for (Index j = 0; j < m; ++j) logarithms[j] += std::log(std::abs(harmonic.receptance(j, j)));
  }
  for (Index j = 0; j < m; ++j)
    receptances[j] = taken > 0 ? std::exp(logarithms[j] / taken) : 1.0 / structure.holding_stiffness()[j];
  return receptances;
}

// Adds compliance to contacts that are stiff beside the structure, so much that their stiffness is `firmness` over its
// receptance. That changes the truncation and not what it tends to; contacts much stiffer than what moves in the
// highest orders would break from stick to slip within every wave of them, which nothing converges to. Returns whether
// any is softer than it is by itself.
bool HarmonicBalanceSolver::Implementation::soften(const Vector& receptances) {
  Vector added = Vector::Zero(stiffness.size());
  for (Index j = 0; j < added.size(); ++j)
    if (j < sliders && last.limits[j] > 0.0) added[j] = std::max(0.0, receptances[j] / firmness - 1.0 / stiffness[j]);
  equations.front().join(harmonics, added);
  return (added.array() > 0.0).any();
}

// The linear answer with all sliders stuck at their offsets: one Newton step from rest takes it, since a loop that does
// not slip is linear.
void HarmonicBalanceSolver::Implementation::start_stuck() {
  series.coefficients.setZero();
  series.mean.setZero();
  Vector unlimited = Vector::Constant(stiffness.size(), 0.0);
  for (Index j = 0; j < unlimited.size(); ++j)
    if (limits[j] > 0.0) unlimited[j] = infinity;
  equations.front().set(unlimited, offsets);
  equations.front().set_stuck_share(1.0);
  equations.front().solve(series, options.residual_tolerance, 3);
  equations.front().set_stuck_share(0.0);
}

// Newton's method from the start, with the compliances joined last.
bool HarmonicBalanceSolver::Implementation::solve_from(bool has_start, bool has_solution, int& iterations) {
  auto& eq = equations.front();
  if (has_start)
    series = eq.balanced(guess.displacement, guess.force);
  else
    start_stuck();
  eq.set(limits, offsets);
  auto outcome = eq.solve(series, options.residual_tolerance, most_iterations);
  iterations += outcome.iterations;
  if (!outcome.has_converged && has_solution) {
    series = eq.balanced(guess.displacement, guess.force);
    if (add_orders(iterations)) {
      outcome = eq.solve(series, options.residual_tolerance, most_iterations);
      iterations += outcome.iterations;
    }
  }
  residual = outcome.residual;
  return outcome.has_converged;
}

// @param has_start     `guess` is one   @param has_solution  it is that with fewer orders
bool HarmonicBalanceSolver::Implementation::newton(const system::Excitation& excitation, bool has_start,
                                                   bool has_solution, Effort effort, SteadyResponse& response) {
  auto& eq = equations.front();
  const Vector receptances = slider_receptances();
  const bool all_soft = (stiffness.cwiseProduct(receptances).head(sliders).array() <= soft).all();
  const bool is_as_it_is = options.orders > 0;
  if (firmness == 0.0) firmness = all_soft || is_as_it_is ? infinity : first_firmness;
  for (;; firmness = std::isinf(firmness) ? soft : softer * firmness) {
    const bool is_softened = soften(receptances);
    firmness_used = firmness;
    const int before = response.iterations;
    bool has_converged = solve_from(has_start, has_solution, response.iterations);
    if (has_converged && is_softened && response.iterations - before <= easy) firmness *= firmer;
    const bool is_last = firmness <= least_firmness || sliders == 0 || is_as_it_is || effort == Effort::brief ||
                         (effort == Effort::limited && response.iterations > most_before_shooting);
    if (!has_converged && effort != Effort::brief && (is_last || std::isinf(firmness))) {
      if (!eq.groups().empty()) start_stuck();
      const bool is_released = !eq.groups().empty() && release(response.iterations);
      if (!is_released) start_stuck();
      if (is_released ||
          (has_laws() ? raise_the_loads(response.iterations) : lower_the_limits(excitation, response.iterations))) {
        eq.set(limits, offsets);
        const auto outcome = eq.solve(series, options.residual_tolerance, most_iterations);
        response.iterations += outcome.iterations;
        residual = outcome.residual;
        has_converged = outcome.has_converged;
      }
    }
    response.residual = residual;
    if (has_converged || is_last) return has_converged;
  }
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
bool HarmonicBalanceSolver::Implementation::lower_the_limits(const system::Excitation& excitation, int& iterations) {
  auto& eq = equations.front();
  double factor = 1.0;
  for (const Index j : eq.active())
    if (excitation.limits[j] > 0.0) {
      const double effective = stiffness[j] / (1.0 + eq.added_compliance()[j] * stiffness[j]);
      factor =
          std::max(factor, effective * eq.loops()[static_cast<std::size_t>(j)].range() / (2.0 * excitation.limits[j]));
    }
  const double logarithm = std::log(factor);
  return follow(logarithm, std::min(0.25 * logarithm, 1.0), iterations,
                [&](double power) { eq.set(std::exp(power) * excitation.limits, offsets); });
}

// The contacts of groups, from springs to what they are.
bool HarmonicBalanceSolver::Implementation::release(int& iterations) {
  auto& eq = equations.front();
  eq.set(limits, offsets);
  const bool done = follow(1.0, 0.25, iterations, [&](double share) { eq.set_stuck_share(share); });
  eq.set_stuck_share(0.0);
  return done;
}

// All loads, multiplied by a factor that rises from where nothing slips and laws are linear to one.
bool HarmonicBalanceSolver::Implementation::raise_the_loads(int& iterations) {
  constexpr double first_share = 1e-4;
  auto& eq = equations.front();
  series.coefficients.setZero();
  series.mean.setZero();
  eq.set(limits, offsets);
  eq.set_load_factor(first_share);
  const auto outcome = eq.solve(series, options.residual_tolerance, most_iterations);
  iterations += outcome.iterations;
  const double logarithm = -std::log(first_share);
  const bool done = outcome.has_converged && follow(logarithm, 0.25 * logarithm, iterations,
                                                    [&](double power) { eq.set_load_factor(std::exp(-power)); });
  eq.set_load_factor(1.0);
  return done;
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

}  // namespace rubato::steady
