#include <rubato/core/error.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance_parts.hpp>
#include <rubato/steady/marching/orbit_search.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

// Iterations of Newton after which a point that began with what others left begins again, a point that can be shot for
// is, and any other is left with its best balance.
constexpr int most_brief_iterations = 60, most_limited_iterations = 300, most_full_iterations = 3000;
// Pieces of the exact flow in a period times the cube of the state: a second or so a pass. Stiffer contacts are
// followed up to this multiple of the fundamental.
constexpr double most_work = 1e9, followed = 1000.0;

// Samples of laws: some for each of the orders, and so many that what they change takes this share of the tolerance.
constexpr int most_samples = 1 << 14;
constexpr double share_of_samples = 0.1;

}  // namespace

int samples_for(const Orders& orders, int wanted) {
  int samples = 128;
  while (samples < 8 * (orders.highest() + 4)) samples *= 2;
  return std::max(samples, wanted);
}

HarmonicBalanceSolver::Implementation::Implementation(const system::LocallyNonlinear& s, SteadyRequest r,
                                                      HarmonicBalanceOptions o)
    : system(s),
      request(std::move(r)),
      options(o),
      structure(s, request.observed, o.sweep),
      sliders(s.slider_count()),
      patterns(s.size(), 0) {
  for (const model::LawBetween& law : s.laws())
    if (law.law->takes_normal() && law.normal.formula)
      throw InvalidInput(fmt::format(
          "harmonic balance samples laws that repeat with the loads, and what presses on \"{}\" is a formula "
          "of t; take a transient",
          law.name));
  for (const model::Stop& stop : s.stops())
    if (stop.damping > 0.0)
      throw InvalidInput(fmt::format(
          "harmonic balance samples stops whose force is continuous, and that of \"{}\" jumps where it closes, "
          "by its damping; take solver = \"time_marching\", or damping = 0",
          stop.name));
  stiffness = structure.holding_stiffness();
  for (Index j = 0; j < sliders; ++j) stiffness[j] = s.sliders()[static_cast<std::size_t>(j)].stiffness;
  for (Index j = sliders; j < stiffness.size(); ++j)
    if (j < s.first_law() || j >= s.first_block()) stiffness[j] = contact_stiffness(s, j);
  limits = Vector::Constant(stiffness.size(), infinity);
  equations.emplace_back(stiffness, structure.holding_stiffness(), s);
  highest_frequency = structure.highest_frequency();
  forget();
}

void HarmonicBalanceSolver::Implementation::forget_points() {
  past.clear();
  equations.front().forget();
  count_wanted = 1;
  firmness = 0.0;
  samples_wanted = 0;
  laws_are_odd =
      equations.front().groups().empty() && std::all_of(system.laws().begin(), system.laws().end(),
                                                        [](const model::LawBetween& law) { return law.law->is_odd(); });
}

void HarmonicBalanceSolver::Implementation::forget() {
  forget_points();
  remembered_offsets = Vector::Zero(stiffness.size());
  // The basis of the loads has grown with those before; what is kept of it would show in the last digits.
  patterns.resize(system.size(), 0);
  loads.clear();
  harmonics.clear();
}

// Whether the motion over a period may be sought at a price: that of the exact flow with its derivative, contacts no
// stiffer than it can follow.
bool HarmonicBalanceSolver::Implementation::can_be_shot(const system::Excitation& excitation, SteadyStart start) {
  const Index n = system.size(), m = stiffness.size();
  if (n > largest_rigid || m == 0 || has_laws() || start == SteadyStart::previous || options.orders > 0) return false;
  if (!fastest) {
    const auto highest = [&](const SparseMatrix& k) {
      const Vector squares = numerics::all_modes(k, system.mass()).eigenvalues;
      return squares.size() > 0 ? std::sqrt(std::max(0.0, squares.maxCoeff())) : infinity;
    };
    fastest = {highest(system.stiffness()), highest(system.stuck_stiffness())};
  }
  const auto [alone, stuck] = *fastest;
  const double pieces =
      pi * std::max(alone, std::min(stuck, followed * excitation.angular_frequency)) / excitation.angular_frequency;
  const double size = static_cast<double>(2 * n + m);
  return pieces * size * size * size <= most_work;
}

// The structure with contacts no stiffer than this [N/m].
system::LocallyNonlinear HarmonicBalanceSolver::Implementation::with_contacts_up_to(double most) const {
  system::LocallyNonlinear::Parts parts;
  parts.mass = system.mass();
  parts.damping = system.damping();
  parts.stiffness = system.stiffness();
  parts.sliders = system.sliders();
  for (model::Slider& slider : parts.sliders) slider.stiffness = std::min(slider.stiffness, most);
  parts.loads = system.loads();
  parts.coordinates = system.coordinates();
  return system::LocallyNonlinear(std::move(parts));
}

// Where no series balances the structure, the motion over a period itself is sought: it may walk over its sliders,
// which a series cannot, or its contacts stick and slip so sharply that more orders than there are would be needed.
bool HarmonicBalanceSolver::Implementation::shoot(const system::Excitation& excitation, SteadyStart start,
                                                  SteadyResponse& response) {
  if (system.size() > largest_rigid || stiffness.size() == 0 || has_laws() || options.orders > 0) return false;
  if (!may_walk) may_walk = (numerics::all_modes(system.stiffness(), system.mass()).eigenvalues.array() == 0.0).any();
  const bool may_repeat = can_condense && can_be_shot(excitation, start);
  if (!*may_walk && !may_repeat) return false;
  const SteadyStart offsets_from = start == SteadyStart::rest ? SteadyStart::unloaded : start;
  auto solver = std::make_unique<PeriodicSolver>(system, request);
  std::unique_ptr<system::LocallyNonlinear> softened;
  SteadyResponse motion;
  const double reach = followed * excitation.angular_frequency;
  if (may_repeat && fastest->second > reach) {
    // Of contacts so stiff that their give hardly matters: what four times as much give changes is three times the
    // error.
    const double most = stiffness.maxCoeff() * std::pow(reach / fastest->second, 2);
    const system::LocallyNonlinear softer_yet = with_contacts_up_to(0.25 * most);
    softened = std::make_unique<system::LocallyNonlinear>(with_contacts_up_to(most));
    SteadyResponse other;
    PeriodicSolver(softer_yet, request).solve(excitation, offsets_from, other);
    solver = std::make_unique<PeriodicSolver>(*softened, request);
    solver->solve(excitation, offsets_from, motion);
    const double size = motion.amplitude.size() > 0 ? motion.amplitude.maxCoeff() : 0.0;
    const double change = size > 0.0 ? (motion.amplitude - other.amplitude).cwiseAbs().maxCoeff() / size : infinity;
    motion.error += change;
    if (other.status != motion.status || !(motion.error <= options.tolerance))
      motion.status = SteadyStatus::not_converged;
  } else {
    solver->solve(excitation, offsets_from, motion);
  }
  const bool repeats = motion.status == SteadyStatus::converged && (may_repeat || !can_condense);
  if (motion.status != SteadyStatus::drifting && motion.status != SteadyStatus::unbounded && !repeats) return false;
  motion.iterations += response.iterations;
  response = std::move(motion);
  shot = std::move(solver);
  shot_system = std::move(softened);
  return true;
}

HarmonicBalanceSolver::HarmonicBalanceSolver(const system::LocallyNonlinear& system, SteadyRequest request,
                                             HarmonicBalanceOptions options) {
  if (!(options.tolerance > 0.0) || !(options.residual_tolerance > 0.0) || !(options.most_harmonics >= 1) ||
      options.orders < 0 || options.orders > options.most_harmonics)
    throw InvalidInput("harmonic balance needs positive tolerances and orders from 1 to most_harmonics");
  implementation_ = std::make_unique<Implementation>(system, std::move(request), options);
}

HarmonicBalanceSolver::~HarmonicBalanceSolver() = default;

void HarmonicBalanceSolver::forget() { implementation_->forget(); }

int HarmonicBalanceSolver::highest_order() const { return implementation_->series.orders.highest(); }

void HarmonicBalanceSolver::solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  Implementation& s = *implementation_;
  response.status = SteadyStatus::not_converged;
  response.iterations = 0;
  response.periods = 1;
  response.residual = response.error = 0.0;
  response.drift.resize(0);
  s.last = excitation;
  s.limits.head(s.sliders) = excitation.limits;
  s.shot.reset();
  s.offsets = start == SteadyStart::previous ? s.remembered_offsets : Vector::Zero(s.stiffness.size());
  s.take_loads(excitation);

  // What a hard point left is not believed for long: what fails with it, or becomes dear, is begun again from nothing.
  using Effort = Implementation::Effort;
  const bool inherits = s.has_solved_points();
  const Effort full = s.can_be_shot(excitation, start) ? Effort::limited : Effort::full;
  bool has_converged = s.attempt(excitation, inherits ? Effort::brief : full, response);
  if (!has_converged && s.can_condense && inherits) {
    s.forget_points();
    has_converged = s.attempt(excitation, full, response);
  }
  if (!has_converged) s.forget_points();
  if (!has_converged && s.shoot(excitation, start, response)) return;
  if (!s.has_answer) {
    s.fill_without_answer(excitation, response);
    return;
  }
  s.fill(excitation, response);
  if (!has_converged) return;
  response.status = SteadyStatus::converged;
  if (s.past.size() < 3) s.past.emplace_back();
  std::rotate(s.past.begin(), s.past.end() - 1, s.past.end());
  s.past.front().angular_frequency = excitation.angular_frequency;
  s.equations.front().displacement_and_force(s.series, s.past.front().motion.displacement, s.past.front().motion.force);
}

// Balances more and more orders. What it leaves is the balance of the most orders that Newton's method solved, with its
// error; has_answer is false where there is none.
bool HarmonicBalanceSolver::Implementation::attempt(const system::Excitation& excitation, Effort effort,
                                                    SteadyResponse& response) {
  if (held_to) return attempt_held(excitation, effort, response);
  auto& eq = equations.front();
  const Index m = stiffness.size();
  const bool is_symmetric = excitation.is_half_wave_symmetric() && offsets.isZero(0.0) && laws_are_odd;
  const int stride = is_symmetric ? 2 : 1;
  int order = 1;
  for (const system::LoadHarmonic& h : excitation.harmonics) order = std::max(order, h.order);
  for (const int k : request.harmonics)
    if (k <= options.most_harmonics) order = std::max(order, k);
  const bool are_given = options.orders > 0;
  const int most = std::max((are_given ? options.orders : options.most_harmonics) - 1, order - 1) / stride + 1;
  // The balance of few orders may be none of the motion where contacts open, slip and close.
  const int least = eq.groups().empty() ? 1 : fewest_for_groups;
  int count = std::max((order - 1 + stride - 1) / stride + 1, std::min(std::max(count_wanted, least), most));
  if (are_given) {
    // Of groups two balances tell the error.
    const int least_given = (order - 1 + stride - 1) / stride + 1;
    count = std::max(least_given, std::min(count, eq.groups().empty() ? most : fewer(most)));
  }
  const int first_iteration = response.iterations;
  const int most_iterations = effort == Effort::brief     ? most_brief_iterations
                              : effort == Effort::limited ? most_limited_iterations
                                                          : most_full_iterations;

  bool has_solution = false;
  Motion solution;
  ComplexMatrix observed_before;
  double difference = infinity;
  Vector compliance;
  has_answer = false;
  bool is_sampled_anew = false;  // a balance of the same orders, with more samples
  bool has_samples_to_spare = false;
  for (;;) {
    const Orders orders{stride, count};
    const int probes = orders_to_probe(excitation, orders);
    samples_used = samples_for(orders, samples_wanted);
    eq.set_samples(samples_used);
    can_condense = condense(excitation, stride, count + probes, !is_symmetric);
    if (!can_condense) return false;
    bool has_start = has_solution;
    if (has_solution) {
      guess = solution;
      guess.resize(orders, !is_symmetric, m);
    } else {
      has_start = predict(excitation.angular_frequency, orders, !is_symmetric);
    }
    series.resize(orders, !is_symmetric, m);
    // A structure that sliders alone hold seems to be in balance very far away.
    if (!newton(excitation, has_start, has_solution, effort, response) ||
        !are_slider_forces_resolved(system, excitation, series.mean)) {
      if (has_solution) response.residual = return_to(solution, compliance);
      return false;
    }
    recover();
    if (has_laws()) {
      const double of_samples = sampling_error(probes);
      // A law that is odd as far as it could be seen, and is not.
      if (stride == 2 && !laws_act_oddly()) {
        laws_are_odd = false;
        return attempt(excitation, effort, response);
      }
      const int samples = samples_for(orders, samples_wanted);
      is_sampled_anew = of_samples > share_of_samples * options.tolerance && samples < most_samples;
      if (is_sampled_anew) samples_wanted = 4 * samples;
      // Of second order: with a quarter of the samples sixteen times as much.
      has_samples_to_spare = !eq.groups().empty() && of_samples < share_of_samples * options.tolerance / 64.0;
    }
    response.error = truncation_error(probes);
    // The linear estimate knows nothing of what stiff contacts do as orders are added, nor of light parts that open and
    // close: two balances tell.
    if (!std::isinf(firmness_used) || !eq.groups().empty()) {
      difference = observed_before.size() > 0 ? change_since(observed_before) : infinity;
      if (!are_given || difference < infinity) response.error = std::max(response.error, caution * difference);
      if (!is_sampled_anew) observed_before = observed;
    }
    has_solution = has_answer = true;
    if (!laws_close()) {
      response.error = infinity;
      return false;
    }
    const bool is_enough = are_given ? count == most : response.error <= options.tolerance;
    if (!is_sampled_anew && is_enough) {
      // A point that needed few orders lets the next one try fewer.
      firmness = firmness_used;
      const bool is_plenty = response.error < 0.02 * options.tolerance;
      count_wanted = is_plenty && !are_given ? std::max(1, 2 * count / 3) : count;
      if (has_samples_to_spare) samples_wanted /= 4;
      // Groups are balanced twice: the next point as often as this one, or with fewer orders both times.
      if (!eq.groups().empty())
        count_wanted = fewer(!are_given && response.error < 0.25 * options.tolerance ? fewer(count) : count);
      return true;
    }
    if ((count >= most && !is_sampled_anew) || response.iterations - first_iteration > most_iterations) return false;
    eq.displacement_and_force(series, solution.displacement, solution.force);
    compliance = eq.added_compliance();
    if (!is_sampled_anew) count = std::min(most, more(count));
  }
}

// What is observed, against the balance of fewer orders: the sum of the moduli of all changes over that of all orders.
double HarmonicBalanceSolver::Implementation::change_since(const ComplexMatrix& before) const {
  double largest = 0.0, change = 0.0;
  for (Index i = 0; i < observed.rows(); ++i) {
    largest = std::max(largest, observed.row(i).cwiseAbs().sum());
    change = std::max(change, (observed.row(i).head(before.cols()) - before.row(i)).cwiseAbs().sum() +
                                  observed.row(i).tail(observed.cols() - before.cols()).cwiseAbs().sum());
  }
  return largest > 0.0 ? change / largest : 0.0;
}

// Whether forces half a period apart are opposite, where only odd orders are balanced.
bool HarmonicBalanceSolver::Implementation::laws_act_oddly() const {
  const auto acts_oddly = [](const auto& law) {
    constexpr double round_off = 1e-8;
    return law.asymmetry() <= round_off * law.largest_force();
  };
  const auto& laws = equations.front().laws();
  const auto& groups = equations.front().groups();
  return std::all_of(laws.begin(), laws.end(), acts_oddly) && std::all_of(groups.begin(), groups.end(), acts_oddly);
}

bool HarmonicBalanceSolver::Implementation::laws_close() const {
  const auto has_closed = [](const auto& law) { return law.has_closed(); };
  const auto& laws = equations.front().laws();
  const auto& groups = equations.front().groups();
  return std::all_of(laws.begin(), laws.end(), has_closed) && std::all_of(groups.begin(), groups.end(), has_closed);
}

// Leaves the balance of fewer orders, solved before.
double HarmonicBalanceSolver::Implementation::return_to(const Motion& motion, const Vector& compliance) {
  auto& eq = equations.front();
  eq.join(harmonics, compliance);
  eq.set(limits, offsets);
  series = eq.balanced(motion.displacement, motion.force);
  const double left = eq.solve(series, options.residual_tolerance, 2).residual;
  recover();
  return left;
}

Waveform HarmonicBalanceSolver::waveform(int points) const {
  Implementation& s = *implementation_;
  if (s.shot) return s.shot->waveform(points);
  const Index n = s.system.size(), m = s.sliders;
  const double w = s.last.angular_frequency;
  Waveform wave;
  wave.time = Vector::LinSpaced(points, 0.0, s.last.period() * (points - 1) / points);
  wave.position = wave.velocity = Matrix::Zero(n, points);
  wave.slider_force = wave.displacement = Matrix::Zero(m, points);
  if (!s.has_answer) {
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

}  // namespace rubato::steady
