#include <rubato/core/error.hpp>
#include <rubato/integrate/steady/harmonic_balance_parts.hpp>
#include <rubato/integrate/steady/orbit_search.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <algorithm>
#include <limits>
#include <numbers>

namespace rubato::integrate {
namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

// The orders a step adds: enough to pay for solving again.
int more(int count) { return count + std::max(1, count / 2); }

}  // namespace

HarmonicBalanceSolver::Implementation::Implementation(const system::LocallyNonlinear& s, SteadyRequest r,
                                                      HarmonicBalanceOptions o)
    : system(s), request(std::move(r)), options(o), structure(s, request.observed), patterns(s.size(), 0) {
  stiffness.resize(s.slider_count());
  for (Index j = 0; j < stiffness.size(); ++j) stiffness[j] = s.sliders()[static_cast<std::size_t>(j)].stiffness;
  equations.emplace_back(stiffness, structure.holding_stiffness());
  highest_frequency = structure.highest_frequency();
  forget();
}

void HarmonicBalanceSolver::Implementation::forget() {
  past.clear();
  equations.front().forget();
  remembered_offsets = Vector::Zero(stiffness.size());
  count_wanted = 1;
  // The basis of the loads has grown with those before; what is kept of it would show in the last digits.
  patterns.resize(system.size(), 0);
  loads.clear();
  harmonics.clear();
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
    s.has_answer = s.condense(excitation, stride, count + probes, !is_symmetric);
    if (!s.has_answer) {
      if (!s.walks(excitation, start, response)) s.fill_without_answer(excitation, response);
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

}  // namespace rubato::integrate
