#include <rubato/core/error.hpp>
#include <rubato/integrate/steady/harmonic_balance.hpp>
#include <rubato/integrate/steady/harmonic_balance_equations.hpp>
#include <rubato/integrate/steady/orbit_search.hpp>
#include <rubato/integrate/steady/periodic_solver.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace rubato::integrate {
namespace {

using std::numbers::pi;
using Outcome = CondensedStructure::Outcome;

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
constexpr Index most_patterns = 32;  // of loads, before those of old points are forgotten
constexpr int most_left_out = 8;     // orders that the error estimate looks at
// The estimate is linear in what is left out, and ends somewhere. Errors over the bare estimate: at most 1.43 (median
// 0.26) on 10,000 random structures of two coordinates and one to four sliders, 1.5 (0.24) on 1,000 of random_model.
constexpr double safety = 2.0;
constexpr int most_iterations = 30;   // of Newton from one start
constexpr Index largest_cheap = 200;  // coordinates of a structure whose orders cost little to condense
// Of the largest displacement that is balanced, by the sums over modes: on 2,000 random structures of 2 to 40
// coordinates whose sliders never slip it was 3.5e-13 at most.
constexpr double round_off = 1e-12;
constexpr int most_steps = 400;    // of a continuation
constexpr double held_part = 0.5;  // of the sliders' springs, where the structure alone is near a resonance

// The orders a step adds: enough to pay for solving again.
int more(int count) { return count + std::max(1, count / 2); }

}  // namespace

struct HarmonicBalanceSolver::Implementation {
  Implementation(const system::LocallyNonlinear& s, SteadyRequest r, HarmonicBalanceOptions o)
      : system(s), request(std::move(r)), options(o), structure(s, request.observed), patterns(s.size(), 0) {
    stiffness.resize(s.slider_count());
    for (Index j = 0; j < stiffness.size(); ++j) stiffness[j] = s.sliders()[static_cast<std::size_t>(j)].stiffness;
    equations.emplace_back(stiffness);
    highest_frequency = structure.highest_frequency();
    forget();
  }

  /// A point solved, from which the next is predicted.
  struct Past {
    double angular_frequency = 0.0;
    SliderSeries series;
  };

  void forget() {
    past.clear();
    equations.front().forget();
    remembered_offsets = Vector::Zero(stiffness.size());
    count_wanted = 1;
    // The basis of the loads has grown with those before; what is kept of it would show in the last digits.
    patterns.resize(system.size(), 0);
    loads.clear();
    harmonics.clear();
  }

  void take_loads(const Excitation& excitation);
  bool condense(const Excitation& excitation, int stride, int places, bool with_mean);
  bool condense_one(CondensedHarmonic& harmonic, double angular_frequency, int order);
  bool is_driven_beyond_friction(const Excitation& excitation, double angular_frequency, const ComplexVector& load);
  int orders_to_probe(const Excitation& excitation, const Orders& orders) const;
  void predict(double angular_frequency, const Orders& orders, bool with_mean);
  bool newton(const Excitation& excitation, bool has_solution, SteadyResponse& response);
  template <class Apply>
  bool follow(double parameter, double step, int& iterations, Apply&& apply);
  bool lower_the_limits(const Excitation& excitation, int& iterations);
  bool add_orders(int& iterations);
  void start_stuck();
  double truncation_error(int probes);
  void recover();
  void fill(const Excitation& excitation, SteadyResponse& response);
  void fill_unbounded(SteadyResponse& response) const;
  bool walks(const Excitation& excitation, SteadyStart start, SteadyResponse& response);
  void load_on(int order, ComplexVector& load) const;

  const system::LocallyNonlinear& system;
  SteadyRequest request;
  HarmonicBalanceOptions options;
  CondensedStructure structure;
  double highest_frequency = 0.0;
  Vector stiffness;

  Matrix patterns;                                   ///< orthonormal [n x e]
  std::vector<std::pair<int, ComplexVector>> loads;  ///< order and shares in the patterns; order 0: static
  Excitation last_loads;                             ///< those that `loads` came from

  int harmonics_stride = 0;
  std::vector<CondensedHarmonic> harmonics;  ///< place 0: mean; place 1 + i: order i
  std::vector<HarmonicBalanceEquations> equations;
  SliderSeries series, start_series;
  Vector offsets, remembered_offsets;
  std::vector<Past> past;  ///< newest first
  std::vector<const Past*> usable;
  int count_wanted = 1;

  Excitation last;              ///< the point solved last, for its waveform
  ComplexMatrix column_forces;  ///< forces on the driven columns of each place [m + e x places]
  ComplexMatrix observed;       ///< [o x count]: X_k
  ComplexVector moved;          ///< of all columns, at one place
  double largest_moved = 0.0;   ///< of them
  Vector observed_mean;
  ComplexMatrix left_out, forces_left_out, force_change;
  TurningPoints turning;
  bool is_unbounded = false;
  std::optional<bool> may_walk;             ///< springs leave a motion free that sliders see; nothing: not yet known
  std::unique_ptr<PeriodicSolver> walking;  ///< the last point, where it drifts
};

// --- loads ----------------------------------------------------------------------------------------------------------

void HarmonicBalanceSolver::Implementation::take_loads(const Excitation& excitation) {
  const auto same = [&] {
    if (loads.empty() || last_loads.harmonics.size() != excitation.harmonics.size() ||
        last_loads.constant.size() != excitation.constant.size() || last_loads.constant != excitation.constant)
      return false;
    for (std::size_t i = 0; i < excitation.harmonics.size(); ++i)
      if (last_loads.harmonics[i].order != excitation.harmonics[i].order ||
          last_loads.harmonics[i].amplitude != excitation.harmonics[i].amplitude)
        return false;
    return true;
  };
  if (same()) return;
  for (auto& harmonic : harmonics) harmonic.load.resize(0);

  // Adds what the patterns lack of a vector, orthonormal.
  bool has_grown = false;
  const auto cover = [&](Vector rest) {
    const double size = rest.norm();
    if (size == 0.0) return;
    for (int pass = 0; pass < 2; ++pass) rest -= patterns * (patterns.transpose() * rest);
    if (!(rest.norm() > 1e-13 * size)) return;
    patterns.conservativeResize(Eigen::NoChange, patterns.cols() + 1);
    patterns.col(patterns.cols() - 1) = rest.normalized();
    has_grown = true;
  };
  const auto cover_all = [&] {
    if (excitation.constant.size() > 0) cover(excitation.constant);
    for (const LoadHarmonic& h : excitation.harmonics) {
      cover(h.amplitude.real());
      cover(h.amplitude.imag());
    }
  };
  cover_all();
  if (patterns.cols() > most_patterns && has_grown) {
    patterns.resize(system.size(), 0);
    cover_all();
  }
  if (has_grown || structure.load_count() != patterns.cols()) {
    structure.set_loads(patterns);
    harmonics.clear();
  }
  loads.clear();
  if (excitation.constant.size() > 0)
    loads.emplace_back(0, (patterns.transpose() * excitation.constant).cast<Complex>());
  else
    loads.emplace_back(0, ComplexVector::Zero(patterns.cols()));
  for (const LoadHarmonic& h : excitation.harmonics)
    loads.emplace_back(h.order, patterns.transpose().cast<Complex>() * h.amplitude);
  last_loads = excitation;
}

void HarmonicBalanceSolver::Implementation::load_on(int order, ComplexVector& load) const {
  load.setZero(patterns.cols());
  for (const auto& [k, shares] : loads)
    if (k == order) load = shares;
}

// --- the linear structure -------------------------------------------------------------------------------------------

bool HarmonicBalanceSolver::Implementation::condense_one(CondensedHarmonic& harmonic, double angular_frequency,
                                                         int order) {
  const bool is_condensed = harmonic.angular_frequency == angular_frequency;
  if (!is_condensed) {
    harmonic.held = 0.0;
    harmonic.angular_frequency = -1.0;
    Outcome outcome = structure.condense(angular_frequency, 0.0, harmonic.receptance);
    if (outcome == Outcome::near_resonance || outcome == Outcome::sliders_needed) {
      for (const double held : {held_part, 0.37 * held_part}) {
        const Outcome with_springs = structure.condense(angular_frequency, held, harmonic.receptance);
        harmonic.held = held;
        outcome = with_springs;
        if (with_springs == Outcome::regular) break;
      }
      if (outcome == Outcome::near_resonance) outcome = Outcome::regular;
    }
    if (outcome != Outcome::regular) return false;
    harmonic.angular_frequency = angular_frequency;
  }
  const bool has_load = harmonic.load.size() == patterns.cols();
  if (!has_load) load_on(order, harmonic.load);
  if (!is_condensed || !has_load)
    harmonic.linear = harmonic.receptance.rightCols(patterns.cols()).lazyProduct(harmonic.load);
  return true;
}

// Friction takes at most 4 |b^T phi| limit from a motion in a singular direction phi, each period and unit of
// amplitude; the load gives pi |phi^T L|. More than that, and the amplitude grows for ever. A static load pushes with
// |phi^T L| against |b^T phi| limit.
bool HarmonicBalanceSolver::Implementation::is_driven_beyond_friction(const Excitation& excitation,
                                                                      double angular_frequency,
                                                                      const ComplexVector& load) {
  for (const auto& direction : structure.resonances(angular_frequency)) {
    const bool is_static = angular_frequency == 0.0;
    const double given = (is_static ? 4.0 : pi) * std::abs((direction.loads.cast<Complex>().transpose() * load)(0));
    const double taken = 4.0 * direction.sliders.cwiseAbs().dot(excitation.limits);
    const double size = pi * direction.loads.norm() * load.norm();
    if (given > 1e-12 * size && given >= taken) return true;
  }
  return false;
}

bool HarmonicBalanceSolver::Implementation::condense(const Excitation& excitation, int stride, int places,
                                                     bool with_mean) {
  if (stride != harmonics_stride) harmonics.clear();
  harmonics_stride = stride;
  if (static_cast<int>(harmonics.size()) < places + 1) harmonics.resize(static_cast<std::size_t>(places) + 1);
  const auto need = [&](std::size_t place, int order) {
    const double w = order * excitation.angular_frequency;
    CondensedHarmonic& harmonic = harmonics[place];
    if (!condense_one(harmonic, w, order)) return false;
    return !(harmonic.held > 0.0 && is_driven_beyond_friction(excitation, w, harmonic.load));
  };
  if (with_mean && !need(0, 0)) return false;
  for (int i = 0; i < places; ++i)
    if (!need(static_cast<std::size_t>(i) + 1, 1 + stride * i)) return false;
  return true;
}

// How many orders beyond those kept the error estimate must see: about as many again (forces of sliders that slip most
// of the period fall slowly), the third harmonic of every load, and all orders that may resonate.
int HarmonicBalanceSolver::Implementation::orders_to_probe(const Excitation& excitation, const Orders& orders) const {
  int load = 1;
  for (const LoadHarmonic& h : excitation.harmonics) load = std::max(load, h.order);
  // The next odd order at least: a loop about a displaced middle has no even ones. A large structure pays each order
  // with a factorisation.
  const int least = orders.stride == 1 ? 2 : 1;
  int probes = system.size() > largest_cheap && highest_frequency == 0.0 ? least : orders.count + least;
  const auto highest = [&] { return orders.at(orders.count + probes - 1); };
  while (highest() < 3 * load) ++probes;
  while (probes < most_left_out && highest() * excitation.angular_frequency < highest_frequency) ++probes;
  return probes;
}

// --- the nonlinear equations ----------------------------------------------------------------------------------------

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

// --- the answer -----------------------------------------------------------------------------------------------------

// Forces on the driven columns and what they do to the observed coordinates.
void HarmonicBalanceSolver::Implementation::recover() {
  const auto& eq = equations.front();
  const Index m = stiffness.size(), e = patterns.cols(), o = structure.observed_count();
  const int count = series.orders.count;
  column_forces.setZero(m + e, count + 1);
  observed.resize(o, count);
  observed_mean = Vector::Zero(o);
  const auto take = [&](Index place) {
    const CondensedHarmonic& harmonic = harmonics[static_cast<std::size_t>(place)];
    for (const Index j : eq.active()) {
      const HysteresisLoop& loop = eq.loops()[static_cast<std::size_t>(j)];
      const Complex u = place == 0 ? Complex(series.mean[j]) : series.coefficients(place - 1, j);
      const Complex force =
          place == 0 ? Complex(loop.mean_force()) : loop.force(series.orders.at(static_cast<int>(place) - 1));
      column_forces(j, place) = -(force - harmonic.held * stiffness[j] * u);
    }
    column_forces.col(place).tail(e) = harmonic.load;
    moved.noalias() = harmonic.receptance * column_forces.col(place);
    return moved.bottomRows(o);
  };
  if (series.has_mean) observed_mean = take(0).real();
  largest_moved = 0.0;
  for (int i = 0; i < count; ++i) {
    observed.col(i) = take(i + 1);
    if (moved.size() > 0) largest_moved = std::max(largest_moved, moved.cwiseAbs().maxCoeff());
  }
}

// What the orders left out and the rest of the residual would change, and round-off, against the largest observed
// amplitude.
double HarmonicBalanceSolver::Implementation::truncation_error(int probes) {
  auto& eq = equations.front();
  const auto first = static_cast<std::size_t>(series.orders.count) + 1;
  eq.truncation(series, first, first + static_cast<std::size_t>(probes), left_out, forces_left_out, force_change);
  const Index m = stiffness.size(), o = structure.observed_count(), e = patterns.cols();
  const Index rows = o > 0 ? o : m, from = o > 0 ? m + e : 0;
  Vector change = Vector::Zero(rows), size = Vector::Zero(rows);
  for (Index i = 0; i < rows; ++i) {
    for (int p = 0; p < probes; ++p) {
      Complex x = 0.0;
      const ComplexMatrix& g = harmonics[first + static_cast<std::size_t>(p)].receptance;
      for (const Index j : eq.active()) x += product(g(from + i, j), forces_left_out(p, j));
      change[i] += std::abs(x);
    }
    for (int k = 0; k < series.orders.count; ++k) {
      Complex x = 0.0;
      const ComplexMatrix& g = harmonics[static_cast<std::size_t>(k) + 1].receptance;
      for (const Index j : eq.active()) x += product(g(from + i, j), force_change(k, j));
      change[i] += std::abs(x);
      size[i] += std::abs(o > 0 ? observed(i, k) : series.coefficients(k, i));
    }
  }
  const double largest = size.maxCoeff();
  return largest > 0.0 ? (safety * change.maxCoeff() + round_off * largest_moved) / largest : 0.0;
}

void HarmonicBalanceSolver::Implementation::fill_unbounded(SteadyResponse& response) const {
  const Index o = structure.observed_count(), m = stiffness.size();
  response.status = SteadyStatus::unbounded;
  response.amplitude = Vector::Constant(o, infinity);
  response.velocity_amplitude = response.acceleration_amplitude =
      request.rates ? Vector::Constant(o, infinity) : Vector();
  response.residual = response.error = infinity;
  response.mean = Vector::Constant(o, nan);
  response.rms = Vector::Constant(o, infinity);
  response.harmonics = ComplexMatrix::Constant(o, static_cast<Index>(request.harmonics.size()), {infinity, nan});
  response.dissipated = response.slip_share = response.offset = Vector::Constant(m, nan);
  response.viscous_work = response.input_work = nan;
  response.transitions = 0;
}

// A series cannot walk: where no series balances a structure that sliders alone hold, its motion over a period says
// whether it drifts.
bool HarmonicBalanceSolver::Implementation::walks(const Excitation& excitation, SteadyStart start,
                                                  SteadyResponse& response) {
  if (system.size() > largest_rigid || stiffness.size() == 0) return false;
  if (!may_walk) may_walk = (numerics::all_modes(system.stiffness(), system.mass()).eigenvalues.array() == 0.0).any();
  if (!*may_walk) return false;
  auto solver = std::make_unique<PeriodicSolver>(system, request);
  SteadyResponse motion;
  solver->solve(excitation, start, motion);
  if (motion.status != SteadyStatus::drifting) return false;
  motion.iterations += response.iterations;
  response = std::move(motion);
  walking = std::move(solver);
  return true;
}

void HarmonicBalanceSolver::Implementation::fill(const Excitation& excitation, SteadyResponse& response) {
  const auto& eq = equations.front();
  const Index o = structure.observed_count(), m = stiffness.size(), e = patterns.cols();
  const Orders orders = series.orders;
  const double w = excitation.angular_frequency;
  response.amplitude.resize(o);
  response.velocity_amplitude.resize(request.rates ? o : 0);
  response.acceleration_amplitude.resize(request.rates ? o : 0);
  response.mean = observed_mean;
  response.rms.resize(o);
  response.harmonics.setZero(o, static_cast<Index>(request.harmonics.size()));
  ComplexVector x(orders.count);
  for (Index i = 0; i < o; ++i) {
    x = observed.row(i).transpose();
    response.rms[i] = std::sqrt(observed_mean[i] * observed_mean[i] + 0.5 * x.squaredNorm());
    for (std::size_t h = 0; h < request.harmonics.size(); ++h) {
      const int k = request.harmonics[h];
      if (k <= orders.highest() && (k - 1) % orders.stride == 0)
        response.harmonics(i, static_cast<Index>(h)) = x[(k - 1) / orders.stride];
    }
    for (int derivative = 0; derivative < (request.rates ? 3 : 1); ++derivative) {
      turning.find(orders, x.data());
      (derivative == 0   ? response.amplitude
       : derivative == 1 ? response.velocity_amplitude
                         : response.acceleration_amplitude)[i] = turning.half_range();
      for (int k = 0; k < orders.count; ++k) x[k] = Complex(-x[k].imag(), x[k].real()) * (orders.at(k) * w);
    }
  }
  response.input_work = response.viscous_work = 0.0;
  for (int i = 0; i < orders.count; ++i) {
    const ComplexMatrix& g = harmonics[static_cast<std::size_t>(i) + 1].receptance;
    const double k = orders.at(i);
    double dissipation = 0.0, input = 0.0;
    for (Index b = 0; b < m + e; ++b)
      for (Index a = 0; a < m + e; ++a) {
        const Complex pair = product(std::conj(column_forces(a, i + 1)), column_forces(b, i + 1));
        dissipation -= g(a, b).imag() * pair.real();
        if (a >= m) input -= product(pair, g(a, b)).imag();
      }
    response.viscous_work += pi * k * dissipation;
    response.input_work += pi * k * input;
  }
  response.dissipated.setZero(m);
  response.slip_share.setZero(m);
  response.offset.setZero(m);
  response.transitions = 0;
  for (Index j = 0; j < m; ++j) {
    if (!(excitation.limits[j] > 0.0)) {
      response.slip_share[j] = 1.0;
      remembered_offsets[j] = 0.0;
      continue;
    }
    const HysteresisLoop& loop = eq.loops()[static_cast<std::size_t>(j)];
    response.dissipated[j] = loop.dissipated();
    response.slip_share[j] = loop.slip_share();
    response.offset[j] = loop.offset();
    response.transitions += loop.transitions();
    // A slider that slips forgets, but for the middle of its slip, where it would come to stick.
    remembered_offsets[j] = loop.slips() ? -stiffness[j] * (series.mean[j] + loop.middle()) : loop.offset();
  }
}

// --- the solver -----------------------------------------------------------------------------------------------------

HarmonicBalanceSolver::HarmonicBalanceSolver(const system::LocallyNonlinear& system, SteadyRequest request,
                                             HarmonicBalanceOptions options) {
  if (!(options.tolerance > 0.0) || !(options.residual_tolerance > 0.0) || !(options.most_harmonics >= 1))
    throw InvalidInput("harmonic balance needs positive tolerances and at least one harmonic");
  implementation_ = std::make_unique<Implementation>(system, std::move(request), options);
}

HarmonicBalanceSolver::~HarmonicBalanceSolver() = default;

void HarmonicBalanceSolver::forget() { implementation_->forget(); }
int HarmonicBalanceSolver::highest_order() const { return implementation_->series.orders.highest(); }

void HarmonicBalanceSolver::solve(const Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  Implementation& s = *implementation_;
  response.status = SteadyStatus::not_converged;
  response.iterations = 0;
  response.periods = 1;
  response.residual = response.error = 0.0;
  response.drift.resize(0);
  s.last = excitation;
  s.walking.reset();
  s.offsets = start == SteadyStart::previous ? s.remembered_offsets : Vector::Zero(s.stiffness.size());
  s.take_loads(excitation);

  const bool is_symmetric = excitation.is_half_wave_symmetric() && s.offsets.isZero(0.0);
  const int stride = is_symmetric ? 2 : 1;
  int order = 1;
  for (const LoadHarmonic& h : excitation.harmonics) order = std::max(order, h.order);
  for (const int k : s.request.harmonics)
    if (k <= s.options.most_harmonics) order = std::max(order, k);
  const int most = std::max(s.options.most_harmonics - 1, order - 1) / stride + 1;
  int count = std::max((order - 1 + stride - 1) / stride + 1, std::min(s.count_wanted, most));

  for (bool is_first = true;; is_first = false) {
    const Orders orders{stride, count};
    const int probes = s.orders_to_probe(excitation, orders);
    s.is_unbounded = !s.condense(excitation, stride, count + probes, !is_symmetric);
    if (s.is_unbounded) {
      if (!s.walks(excitation, start, response)) s.fill_unbounded(response);
      return;
    }
    if (is_first)
      s.predict(excitation.angular_frequency, orders, !is_symmetric);
    else
      s.series.resize(orders, !is_symmetric, s.stiffness.size());
    const bool has_converged = s.newton(excitation, !is_first, response);
    s.recover();
    response.error = s.truncation_error(probes);
    if (has_converged && response.error <= s.options.tolerance) {
      response.status = SteadyStatus::converged;
      // A point that needed few orders lets the next one try fewer.
      s.count_wanted = response.error < 0.02 * s.options.tolerance ? std::max(1, 2 * count / 3) : count;
      break;
    }
    if (count >= most || !has_converged) break;
    count = std::min(most, more(count));
  }
  if (response.status != SteadyStatus::converged && s.walks(excitation, start, response)) {
    s.past.clear();
    return;
  }
  s.fill(excitation, response);
  if (response.status == SteadyStatus::converged) {
    if (s.past.size() < 3) s.past.emplace_back();
    std::rotate(s.past.begin(), s.past.end() - 1, s.past.end());
    s.past.front().angular_frequency = excitation.angular_frequency;
    s.past.front().series = s.series;
  } else {
    s.past.clear();
  }
}

Waveform HarmonicBalanceSolver::waveform(int points) const {
  Implementation& s = *implementation_;
  if (s.walking) return s.walking->waveform(points);
  const Index n = s.system.size(), m = s.stiffness.size();
  const double w = s.last.angular_frequency;
  Waveform wave;
  wave.time = Vector::LinSpaced(points, 0.0, s.last.period() * (points - 1) / points);
  wave.position = wave.velocity = Matrix::Zero(n, points);
  wave.slider_force = wave.displacement = Matrix::Zero(m, points);
  if (s.is_unbounded) {
    wave.position.setConstant(infinity);
    wave.velocity.setConstant(infinity);
    return wave;
  }
  ComplexVector q;
  for (int place = s.series.has_mean ? 0 : 1; place <= s.series.orders.count; ++place) {
    const int k = place == 0 ? 0 : s.series.orders.at(place - 1);
    s.structure.expand(k * w, s.harmonics[static_cast<std::size_t>(place)].held, s.column_forces.col(place), q);
    for (int p = 0; p < points; ++p) {
      const Complex turn = unit(2.0 * pi * k * p / points);
      wave.position.col(p) += (turn * q).real();
      wave.velocity.col(p) += (Complex(0.0, k * w) * turn * q).real();
    }
  }
  for (Index j = 0; j < m; ++j)
    for (int p = 0; p < points; ++p) {
      wave.displacement(j, p) = s.system.relative_displacement(j, wave.position.col(p));
      if (s.last.limits[j] > 0.0)
        wave.slider_force(j, p) =
            s.equations.front().loops()[static_cast<std::size_t>(j)].force_at(2.0 * pi * p / points);
    }
  return wave;
}

}  // namespace rubato::integrate
