#include <rubato/core/stopping.hpp>
#include <rubato/steady/linear/fourier_series.hpp>
#include <rubato/steady/linear/linear_limits.hpp>
#include <rubato/steady/linear/linear_response.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

constexpr Index least_points = 20;
constexpr Index direct_size = 3000;
constexpr double direct_fill =
    10.0;  // entries of the factor a row: below (chains, frames) it costs a few substitutions
// Beside a resonance a coordinate may stand still (a node) or not be coupled to it: what it does is finite.
constexpr double takes_no_part = 1e-9;

double largest_of(const ComplexVector& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0; }

}  // namespace

LinearResponse::LinearResponse(const system::LocallyNonlinear& system, StuckSliders stuck, SteadyRequest request,
                               const LinearSweep& sweep)
    : system_(system.has_laws() ? with_linear_laws(system, false) : system),
      stuck_(std::move(stuck)),
      request_(std::move(request)),
      stiffness_(system_, stuck_) {
  const bool is_worth_it = sweep.points >= least_points && system_.size() > direct_size &&
                           stiffness_.fill() > direct_fill && sweep.highest > 0.0;
  if (!is_worth_it) return;
  modal_.emplace(system_, stuck_, sweep.highest, sweep.tolerance);
  if (!modal_->is_usable()) modal_.reset();
}

LinearResponse limit(const system::LocallyNonlinear& system, bool stuck, SteadyRequest request,
                     const LinearSweep& sweep) {
  const StuckSliders sliders(static_cast<std::size_t>(system.slider_count()), stuck);
  if (!system.has_laws()) return {system, sliders, std::move(request), sweep};
  return {with_linear_laws(system, stuck), sliders, std::move(request), sweep};
}

LinearResponse free_limit(const system::LocallyNonlinear& system, SteadyRequest request, const LinearSweep& sweep) {
  return limit(system, false, std::move(request), sweep);
}

LinearResponse stuck_limit(const system::LocallyNonlinear& system, SteadyRequest request, const LinearSweep& sweep) {
  return limit(system, true, std::move(request), sweep);
}

void LinearResponse::forget() {
  if (modal_) modal_->forget();
}

void LinearResponse::solve(const system::Excitation& excitation, SteadyStart, SteadyResponse& response) {
  response = {};
  omega_ = excitation.angular_frequency;
  mean_ = Vector::Zero(system_.size());
  mean_doubt_ = {};
  if (excitation.constant.size() > 0 && excitation.constant.cwiseAbs().maxCoeff() > 0.0) {
    ComplexVector x;
    response.residual = solve_order(0, excitation.constant.cast<Complex>(), x, mean_doubt_);
    mean_ = x.real();
  }
  harmonics_.clear();
  doubts_.clear();
  for (const system::LoadHarmonic& load : excitation.harmonics) {
    harmonics_.push_back({load.order, ComplexVector()});
    const double residual =
        solve_order(load.order, load.amplitude, harmonics_.back().amplitude, doubts_.emplace_back());
    response.residual = std::max(response.residual, residual);
  }
  observe(excitation, response);
}

double LinearResponse::solve_order(int order, const ComplexVector& force, ComplexVector& x, Doubt& doubt) {
  stop_if_asked();
  std::optional<StiffnessSolution> by_modes;
  if (modal_) by_modes = modal_->solve(order * omega_, force, x);
  if (!by_modes) stiffness_.factorise(order * omega_);
  StiffnessSolution solution = by_modes ? std::move(*by_modes) : stiffness_.solve(force, x);
  doubt.uncertainty = std::move(solution.uncertainty);
  doubt.least = largest_of(doubt.uncertainty);
  // Written so that a solution that is not finite is a resonance too.
  const bool is_determined = doubt.least <= undetermined * largest_of(x);
  doubt.is_resonant = !is_determined && !solution.is_damped;
  doubt.is_lost = !is_determined && solution.is_damped;
  doubt.least *= takes_no_part;
  return solution.residual;
}

double LinearResponse::Doubt::of(const SteadyRequest::Observed& observed) const {
  return uncertainty.size() > 0 ? std::abs(observed.of(uncertainty)) : 0.0;
}

bool LinearResponse::Doubt::is_infinite(const SteadyRequest::Observed& observed, double value) const {
  return is_resonant && !(of(observed) <= std::max(undetermined * value, least));
}

void LinearResponse::observe(const system::Excitation& excitation, SteadyResponse& response) const {
  const auto count = static_cast<Index>(request_.observed.size());
  const Index m = system_.slider_count();
  response.status = SteadyStatus::converged;
  response.amplitude = response.mean = response.rms = Vector::Zero(count);
  response.velocity_amplitude = response.acceleration_amplitude = Vector::Zero(request_.rates ? count : 0);
  response.harmonics = ComplexMatrix::Zero(count, static_cast<Index>(request_.harmonics.size()));
  response.dissipated = response.offset = Vector::Zero(m);
  response.slip_share.resize(m);
  for (Index i = 0; i < m; ++i) response.slip_share[i] = stuck_[static_cast<std::size_t>(i)] ? 0.0 : 1.0;

  std::vector<int> orders;
  for (const system::LoadHarmonic& harmonic : harmonics_) orders.push_back(harmonic.order);
  double largest = 0.0, largest_error = 0.0;
  for (Index o = 0; o < count; ++o) {
    const auto& observed = request_.observed[static_cast<std::size_t>(o)];
    std::vector<Complex> x, v, a;
    double squares = 0.0, error = 0.0;
    bool is_bounded = true;
    response.mean[o] = observed.of(mean_);
    if (mean_doubt_.is_infinite(observed, std::abs(response.mean[o]))) {
      response.mean[o] = infinity;
      is_bounded = false;
    }
    for (std::size_t j = 0; j < harmonics_.size(); ++j) {
      const Complex c = observed.of(harmonics_[j].amplitude);
      const Complex rate(0.0, orders[j] * omega_);
      const bool is_resonant = doubts_[j].is_infinite(observed, std::abs(c));
      is_bounded = is_bounded && !is_resonant;
      x.push_back(is_resonant ? Complex(infinity, no_number) : c);
      v.push_back(rate * c);
      a.push_back(rate * rate * c);
      squares += 0.5 * std::norm(c);
      error += doubts_[j].of(observed);
    }
    for (std::size_t h = 0; h < request_.harmonics.size(); ++h)
      for (std::size_t j = 0; j < orders.size(); ++j)
        if (orders[j] == request_.harmonics[h]) response.harmonics(o, static_cast<Index>(h)) = x[j];
    if (!is_bounded) response.status = SteadyStatus::unbounded;
    response.amplitude[o] = is_bounded ? half_peak_to_peak(orders, x) : infinity;
    response.rms[o] = is_bounded ? std::sqrt(response.mean[o] * response.mean[o] + squares) : infinity;
    if (request_.rates) {
      response.velocity_amplitude[o] = is_bounded ? half_peak_to_peak(orders, v) : infinity;
      response.acceleration_amplitude[o] = is_bounded ? half_peak_to_peak(orders, a) : infinity;
    }
    largest = std::max(largest, response.amplitude[o]);
    largest_error = std::max(largest_error, error);
  }
  const bool is_unbounded = response.status == SteadyStatus::unbounded;
  response.error = is_unbounded ? infinity : largest > 0.0 ? largest_error / largest : 0.0;
  const auto is_lost = [](const Doubt& doubt) { return doubt.is_lost; };
  if (!is_unbounded && (is_lost(mean_doubt_) || std::any_of(doubts_.begin(), doubts_.end(), is_lost)))
    response.status = SteadyStatus::not_converged;
  response.iterations = 1;
  // Works over a period T: f . v has the mean Re(conj(f) i k omega x) / 2, and T omega = 2 pi.
  for (std::size_t j = 0; j < harmonics_.size(); ++j) {
    const ComplexVector& x = harmonics_[j].amplitude;
    const double k = orders[j];
    response.input_work -= std::numbers::pi * k * excitation.harmonics[j].amplitude.dot(x).imag();
    response.viscous_work += std::numbers::pi * k * k * omega_ * x.dot(system_.damping() * x).real();
  }
  if (is_unbounded) response.input_work = response.viscous_work = no_number;
}

Waveform LinearResponse::waveform(int points) const {
  const Index n = system_.size(), m = system_.slider_count();
  Waveform wave{Vector(points), Matrix(n, points), Matrix(n, points), Matrix::Zero(m, points), Matrix(m, points)};
  for (int p = 0; p < points; ++p) {
    const double theta = 2.0 * std::numbers::pi * p / points;
    wave.time[p] = theta / omega_;
    wave.position.col(p) = mean_;
    wave.velocity.col(p).setZero();
    for (const system::LoadHarmonic& harmonic : harmonics_) {
      const ComplexVector x = harmonic.amplitude * std::polar(1.0, harmonic.order * theta);
      wave.position.col(p) += x.real();
      wave.velocity.col(p) -= harmonic.order * omega_ * x.imag();
    }
    for (Index i = 0; i < m; ++i) {
      const auto slider = static_cast<std::size_t>(i);
      wave.displacement(i, p) = system_.relative_displacement(i, wave.position.col(p));
      if (stuck_[slider]) wave.slider_force(i, p) = system_.sliders()[slider].stiffness * wave.displacement(i, p);
    }
  }
  return wave;
}

}  // namespace rubato::steady
