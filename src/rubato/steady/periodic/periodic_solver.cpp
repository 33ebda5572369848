#include <rubato/steady/free_motions.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include <rubato/core/error.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/undamped_resonance.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double round_off = 1e-13;     // of the amplitudes of an orbit whose residual is zero
constexpr double fine_balance = 2e-11;  // of the works in a period
constexpr double walking = 1e-9;        // drift over a period, relative to the state, that is none of round-off
constexpr int rest_periods = 20;

constexpr double lost = 1e-3;            // error at which round-off has taken the amplitudes
constexpr double still_an_orbit = 1e-8;  // residual of one that was put elsewhere along its free motions

double imbalance(const SteadyResponse& response) {
  return std::abs(response.input_work - response.viscous_work - response.dissipated.sum()) /
         std::abs(response.input_work);
}

const system::LocallyNonlinear& checked(const system::LocallyNonlinear& system) {
  if (system.size() > integrate::largest_exact)
    throw InvalidInput(
        fmt::format("solver = \"periodic\" is for up to {} coordinates, the model has {}; take solver = "
                    "\"harmonic_balance\", whose cost grows with the sliders alone",
                    integrate::largest_exact, system.size()));
  return system;
}

}  // namespace

PeriodicSolver::PeriodicSolver(const system::LocallyNonlinear& system, SteadyRequest request, PeriodicOptions options)
    : system_(checked(system)),
      request_(std::move(request)),
      options_(options),
      n_(system.size()),
      m_(system.slider_count()),
      flow_(system),
      derivative_(system),
      orbit_(system),
      start_(system.start()),
      end_(system.start()) {
  y_ = difference_ = correction_ = best_ = Vector::Zero(2 * n_ + m_);
  const numerics::SymmetricModes modes = numerics::all_modes(system.stiffness(), system.mass());
  const Index rigid = (modes.eigenvalues.array() == 0.0).count();
  unseen_.resize(n_, 0);
  if (m_ > 0) {
    rigid_ = modes.shapes.leftCols(rigid);
    free_ = free_motions(system, rigid_);
    unseen_ = unseen_motions(system, rigid_);
  }
  fastest_ = std::sqrt(std::max(0.0, modes.eigenvalues.maxCoeff()));
  wanted_offset_ = centre_ = Vector::Zero(m_);
}

// An orbit keeps its pieces, of some forty terms a coordinate.
double PeriodicSolver::most_pieces() const {
  constexpr double most_bytes = 1e9, terms = 40.0;
  return most_bytes / (terms * static_cast<double>(n_ + m_) * sizeof(double));
}

// About pi w_n/w pieces in a period, with the fastest motion's w_n.
void PeriodicSolver::require_memory(const system::Excitation& excitation) const {
  const double pieces = std::numbers::pi * fastest_ / excitation.angular_frequency;
  if (pieces <= most_pieces()) return;
  throw InvalidInput(
      fmt::format("a period of {:.4g} s holds {:.3g} of the fastest natural periods of the model, too many "
                  "for solver = \"periodic\", which follows each; take solver = \"harmonic_balance\"",
                  excitation.period(), fastest_ / excitation.angular_frequency));
}

void PeriodicSolver::forget() {
  known_.clear();
  centre_.setZero();
}

// What a place shares with the rigid motions that only dashpots resist. A stiffness that is round-off alone predicts
// them far away, where the rest is lost.
Vector PeriodicSolver::along_unseen(const Vector& position) const {
  return unseen_ * (unseen_.transpose() * (system_.mass() * position));
}

// A motion that neither springs nor contacts hold goes on for ever where static loads push along it.
bool PeriodicSolver::is_pushed_away(const system::Excitation& excitation) const {
  constexpr double round_off = 1e-12;
  if (excitation.constant.size() == 0) return false;
  for (Index k = 0; k < unseen_.cols(); ++k) {
    const auto shares = unseen_.col(k).cwiseProduct(excitation.constant);
    if (std::abs(shares.sum()) > round_off * shares.cwiseAbs().sum()) return true;
  }
  return false;
}

Waveform PeriodicSolver::waveform(int points) const { return orbit_.waveform(last_, half_, points); }

void PeriodicSolver::put(const Vector& y, const system::Excitation& excitation) {
  y_ = y;
  y_.tail(m_) = y_.tail(m_).cwiseMax(-excitation.limits).cwiseMin(excitation.limits);
}

double PeriodicSolver::size_of(const system::Excitation& excitation, const Vector& y) const {
  double energy = 0.0, rate_energy = 0.0;
  const SparseMatrix& mass = system_.mass();
  for (Index c = 0; c < mass.outerSize(); ++c)
    for (SparseMatrix::InnerIterator entry(mass, c); entry; ++entry) {
      energy += y[entry.row()] * entry.value() * y[c];
      rate_energy += y[n_ + entry.row()] * entry.value() * y[n_ + c];
    }
  return std::sqrt(energy + rate_energy / (excitation.angular_frequency * excitation.angular_frequency));
}

void PeriodicSolver::measure(const system::Excitation& excitation, SteadyResponse& response) {
  orbit_.measure(excitation, request_, half_, response);
  response.drift.resize(0);
  if (response.status != SteadyStatus::drifting) return;
  // The works of loads on a motion that repeats, and what they do on the drift: f x at the end of the period less that
  // at its start.
  Vector load = excitation.constant.size() > 0 ? excitation.constant : Vector::Zero(n_);
  for (const system::LoadHarmonic& harmonic : excitation.harmonics) load += harmonic.amplitude.real();
  response.input_work += load.dot(drift_);
  response.drift.resize(response.mean.size());
  for (Index o = 0; o < response.drift.size(); ++o) {
    response.drift[o] = request_.observed[static_cast<std::size_t>(o)].of(drift_);
    if (response.drift[o] != 0.0) response.mean[o] = response.rms[o] = std::numeric_limits<double>::quiet_NaN();
  }
}

bool PeriodicSolver::march(const system::Excitation& excitation, int periods) {
  for (int k = 0; k < periods * (half_ ? 2 : 1); ++k) {
    if (!pass(excitation)) return false;
    put(y_ + difference_, excitation);
  }
  return true;
}

void PeriodicSolver::march_from_rest(const system::Excitation& excitation) {
  y_ << system_.start().q, system_.start().v, system_.start().slider_force;
  put(Vector(y_), excitation);
  half_ = false;
  for (int periods = 0; periods < options_.most_periods; periods += rest_periods)
    if (!march(excitation, rest_periods) || residual(excitation) < 1e-7) break;
  for (Index i = 0; i < m_; ++i)
    wanted_offset_[i] = y_[2 * n_ + i] - system_.sliders()[static_cast<std::size_t>(i)].stiffness *
                                             system_.relative_displacement(i, y_.head(n_));
}

void PeriodicSolver::take_start(const system::Excitation& excitation, SteadyStart start) {
  wanted_offset_.setZero();
  if (start == SteadyStart::previous) wanted_offset_ = centre_;
  if (start == SteadyStart::rest)
    march_from_rest(excitation);
  else
    predict(excitation);
  y_.head(n_) -= along_unseen(y_.head(n_));
  half_ = excitation.is_half_wave_symmetric() && (wanted_offset_.array() == 0.0).all();
}

double PeriodicSolver::observed_size(const Vector& y) const {
  double size = 0.0;
  for (const auto& what : request_.observed) size = std::max(size, std::abs(what.of(y)));
  return size;
}

void PeriodicSolver::solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  require_memory(excitation);
  forget_others(excitation);
  last_ = excitation;
  response.periods = 1;
  response.iterations = 0;
  if (is_pushed_away(excitation)) {
    make_unbounded(request_, m_, response);
    known_.clear();
    return;
  }
  flow_.set_excitation(excitation);
  take_start(excitation, start);

  response.status = SteadyStatus::not_converged;
  bool converged = iterate(excitation, response) || iterate_from_elsewhere(excitation, response);
  if (response.status == SteadyStatus::unbounded) {
    make_unbounded(request_, m_, response);
    known_.clear();
    return;
  }
  if (converged && free_.cols() > 0) {
    place_free_motions(excitation);
    response.residual = pass(excitation) ? residual(excitation) : std::numeric_limits<double>::infinity();
    converged = response.residual <= still_an_orbit;
  }
  if (converged) response.status = drift(excitation) > walking ? SteadyStatus::drifting : SteadyStatus::converged;
  measure(excitation, response);
  // What the small rest of the residual does to the balance of a slightly damped structure.
  for (int polish = 0; converged && polish < 2 && imbalance(response) > fine_balance; ++polish) {
    factorise();
    near_factors_ = true;
    if (!correct()) break;
    ++response.iterations;
    const Vector before = y_;
    const double worst = std::max(response.residual, options_.tolerance);
    put(y_ + correction_, excitation);
    const bool is_better = pass(excitation) && residual(excitation) <= worst;
    if (!is_better) {
      y_ = before;
      if (!pass(excitation)) break;
    }
    response.residual = residual(excitation);
    measure(excitation, response);
    if (!is_better) break;
  }
  const double largest = response.amplitude.size() > 0 ? response.amplitude.maxCoeff() : 0.0;
  response.error = round_off;
  // After a full step of Newton its matrix is as good as the one here would be.
  if (!near_factors_) factorise();
  if (correct() && largest > 0.0) {
    correction_.head(n_) -= along_unseen(correction_.head(n_));
    Vector rates = Vector::Zero(y_.size());
    rates.head(n_) = correction_.segment(n_, n_) / excitation.angular_frequency;
    response.error += std::hypot(observed_size(correction_), observed_size(rates)) / largest;
  }
  if (converged && !(response.error <= lost)) {
    converged = false;
    response.status = SteadyStatus::not_converged;
  }
  if (converged)
    remember(excitation);
  else
    known_.clear();
}

}  // namespace rubato::steady
