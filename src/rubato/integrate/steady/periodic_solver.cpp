#include <rubato/integrate/steady/equivalent_linear.hpp>
#include <rubato/integrate/steady/periodic_solver.hpp>

#include <rubato/core/error.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <fmt/format.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace rubato::integrate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double round_off = 1e-13;      // of the amplitudes of an orbit whose residual is zero
constexpr double offset_margin = 1e-10;  // by which a slider that never slips stays inside its limit
constexpr double good_enough = 1e-10;    // residual that is accepted where round-off allows no smaller one
constexpr double suspicious = 1e3;       // a step that much longer than the state: a resonance without damping?
constexpr double fine_balance = 2e-11;   // of the works in a period
constexpr double walking = 1e-9;         // drift over a period, relative to the state, that is none of round-off
constexpr int most_halvings = 3, most_moves = 60, rest_periods = 20, longest_stretch = 64;

double imbalance(const SteadyResponse& response) {
  return std::abs(response.input_work - response.viscous_work - response.dissipated.sum()) /
         std::abs(response.input_work);
}

}  // namespace

/// Keeps the pieces of a pass.
class PeriodicSolver::Recorder final : public ExactVisitor {
 public:
  explicit Recorder(Orbit& orbit) : orbit_(orbit) { orbit_.clear(); }
  bool sample(const system::State&, const ExactWork&) override { return true; }
  bool transition(const system::State&, const Transition&, const ExactWork&) override { return true; }
  void piece(const TaylorPiece& piece, double start, double length, const std::vector<SliderState>& states) override {
    orbit_.add(piece, start, length, states);
  }

 private:
  Orbit& orbit_;
};

namespace {

const system::LocallyNonlinear& checked(const system::LocallyNonlinear& system) {
  if (system.size() > largest_exact)
    throw InvalidInput(
        fmt::format("solver = \"periodic\" is for up to {} coordinates, the model has {}; take solver = "
                    "\"harmonic_balance\", whose cost grows with the sliders alone",
                    largest_exact, system.size()));
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
  if (m_ > 0) rigid_ = modes.shapes.leftCols(rigid);
  fastest_ = std::sqrt(std::max(0.0, modes.eigenvalues.maxCoeff()));
  wanted_offset_ = offset_shift_ = centre_ = Vector::Zero(m_);
}

// An orbit keeps its pieces, about pi w_n/w a period of the fastest motion, of some forty terms a coordinate.
void PeriodicSolver::require_memory(const Excitation& excitation) const {
  constexpr double most_bytes = 1e9, terms = 40.0;
  const double pieces = std::numbers::pi * fastest_ / excitation.angular_frequency;
  if (pieces * terms * static_cast<double>(n_ + m_) * sizeof(double) <= most_bytes) return;
  throw InvalidInput(
      fmt::format("a period of {:.4g} s holds {:.3g} of the fastest natural periods of the model, too many "
                  "for solver = \"periodic\", which follows each; take solver = \"harmonic_balance\"",
                  excitation.period(), fastest_ / excitation.angular_frequency));
}

void PeriodicSolver::forget() {
  known_.clear();
  centre_.setZero();
}

Waveform PeriodicSolver::waveform(int points) const { return orbit_.waveform(last_, half_, points); }

void PeriodicSolver::put(const Vector& y, const Excitation& excitation) {
  y_ = y;
  y_.tail(m_) = y_.tail(m_).cwiseMax(-excitation.limits).cwiseMin(excitation.limits);
}

double PeriodicSolver::size_of(const Excitation& excitation, const Vector& y) const {
  double energy = 0.0, rate_energy = 0.0;
  const SparseMatrix& mass = system_.mass();
  for (Index c = 0; c < mass.outerSize(); ++c)
    for (SparseMatrix::InnerIterator entry(mass, c); entry; ++entry) {
      energy += y[entry.row()] * entry.value() * y[c];
      rate_energy += y[n_ + entry.row()] * entry.value() * y[n_ + c];
    }
  return std::sqrt(energy + rate_energy / (excitation.angular_frequency * excitation.angular_frequency));
}

// One pass of the flow from y_, over a period or half of it: orbit and P(y) - y.
bool PeriodicSolver::pass(const Excitation& excitation) {
  start_.t = 0.0;
  start_.q = y_.head(n_);
  start_.v = y_.segment(n_, n_);
  start_.slider_force = y_.tail(m_);
  end_ = start_;
  Recorder recorder(orbit_);
  factors_are_of_orbit_ = false;
  const ExactReport report = flow_.advance(end_, excitation.period() * (half_ ? 0.5 : 1.0), {}, recorder);
  if (report.end != ExactEnd::reached) return false;
  const double sign = half_ ? -1.0 : 1.0;
  difference_.head(n_) = sign * end_.q - y_.head(n_);
  difference_.segment(n_, n_) = sign * end_.v - y_.segment(n_, n_);
  difference_.tail(m_) = sign * end_.slider_force - y_.tail(m_);
  drift_.setZero(n_);
  if (!half_ && rigid_.cols() > 0) {
    const Matrix open = open_motions();
    drift_ = open * (open.transpose() * (system_.mass() * difference_.head(n_)));
    difference_.head(n_) -= drift_;
  }
  return difference_.allFinite();
}

double PeriodicSolver::residual(const Excitation& excitation) {
  const double size = size_of(excitation, y_), moved = size_of(excitation, difference_);
  double result = moved > 0.0 ? moved / size : 0.0;
  if (const double drifted = drift(excitation); drifted <= walking) result = std::max(result, drifted);
  for (Index i = 0; i < m_; ++i)
    if (excitation.limits[i] > 0.0) result = std::max(result, std::abs(difference_[2 * n_ + i]) / excitation.limits[i]);
  return result;
}

// Over the period of the pass, relative to the state.
double PeriodicSolver::drift(const Excitation& excitation) const {
  const double squared = drift_.dot(system_.mass() * drift_);
  return squared > 0.0 ? std::sqrt(squared) / size_of(excitation, y_) : 0.0;
}

// Newton's matrix at y_, from the pass just made.
void PeriodicSolver::factorise() {
  if (factors_are_of_orbit_) return;
  factors_are_of_orbit_ = true;
  derivative_.set_identity();
  orbit_.carry(derivative_);
  matrix_ = derivative_.matrix();
  if (half_) matrix_ = -matrix_;
  matrix_.diagonal().array() -= 1.0;
  if (!half_)
    for (Index i = 0; i < m_; ++i) {
      if (orbit_.slips(i)) continue;
      // Its force repeats if the displacements do; what is left open is its offset.
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const Index row = 2 * n_ + i;
      matrix_.row(row).setZero();
      matrix_(row, row) = 1.0;
      if (slider.first != ground) matrix_(row, slider.first) -= slider.stiffness;
      if (slider.second != ground) matrix_(row, slider.second) += slider.stiffness;
    }
  if (!half_ && rigid_.cols() > 0) hold_rigid_motions();
  factors_.compute(matrix_);
}

// Rigid motions that no slider which sticks in the pass holds, phi^T M phi = 1 [n x any].
Matrix PeriodicSolver::open_motions() const {
  Matrix held = Matrix::Zero(m_, rigid_.cols());
  for (Index i = 0; i < m_; ++i)
    if (!orbit_.slips(i))
      for (Index k = 0; k < rigid_.cols(); ++k) held(i, k) = system_.relative_displacement(i, rigid_.col(k));
  const Eigen::FullPivLU<Matrix> holds(held);
  const Index open = holds.dimensionOfKernel();
  if (open == 0) return Matrix(n_, 0);
  const Eigen::HouseholderQR<Matrix> basis(holds.kernel());
  return rigid_ * (basis.householderQ() * Matrix::Identity(rigid_.cols(), open));
}

// The orbit may lie anywhere along an open motion: Newton's steps leave it in place, in the metric of the mass.
void PeriodicSolver::hold_rigid_motions() {
  const Matrix open = open_motions();
  matrix_.topLeftCorner(n_, n_) += open * (open.transpose() * Matrix(system_.mass()));
}

void PeriodicSolver::measure(const Excitation& excitation, SteadyResponse& response) {
  orbit_.measure(excitation, request_, half_, response);
  response.drift.resize(0);
  if (response.status != SteadyStatus::drifting) return;
  // The works of loads on a motion that repeats, and what they do on the drift: f x at the end of the period less that
  // at its start.
  Vector load = excitation.constant.size() > 0 ? excitation.constant : Vector::Zero(n_);
  for (const LoadHarmonic& harmonic : excitation.harmonics) load += harmonic.amplitude.real();
  response.input_work += load.dot(drift_);
  response.drift.resize(response.mean.size());
  for (Index o = 0; o < response.drift.size(); ++o) {
    const auto& what = request_.observed[static_cast<std::size_t>(o)];
    response.drift[o] = drift_[what.first] - (what.second == ground ? 0.0 : drift_[what.second]);
    if (response.drift[o] != 0.0) response.mean[o] = response.rms[o] = std::numeric_limits<double>::quiet_NaN();
  }
}

// Newton's step from y_, with the matrix last factorised. False at a resonance without damping.
bool PeriodicSolver::correct() {
  right_side_ = -difference_;
  if (!half_)
    for (Index i = 0; i < m_; ++i)
      if (!orbit_.slips(i)) right_side_[2 * n_ + i] = offset_shift_[i];
  correction_.noalias() = factors_.solve(right_side_);
  return correction_.allFinite();
}

// Sliders that never slip move towards the offset that is wanted, as far as they do not slip then.
bool PeriodicSolver::must_move_offsets(const Excitation& excitation) {
  bool moves = false;
  offset_shift_.setZero();
  if (half_) {
    centre_.setZero();
    return false;
  }
  for (Index i = 0; i < m_; ++i) {
    const double limit = excitation.limits[i], stiffness = system_.sliders()[static_cast<std::size_t>(i)].stiffness;
    double low = 0.0, high = 0.0;
    orbit_.displacement_range(i, low, high);
    centre_[i] = -0.5 * stiffness * (low + high);
    if (limit == 0.0 || orbit_.slips(i)) continue;
    const double offset = y_[2 * n_ + i] - stiffness * system_.relative_displacement(i, y_.head(n_));
    const double inside = limit * (1.0 - offset_margin);
    const double lowest = -inside - stiffness * low, highest = inside - stiffness * high;
    centre_[i] = offset;
    if (!(lowest < highest)) continue;
    const double shift = std::clamp(wanted_offset_[i], lowest, highest) - offset;
    if (!(std::abs(shift) > 10.0 * offset_margin * limit)) continue;
    moves = true;
    // The structure gives way under a change of the offset, so that more of it is allowed than at rest.
    const bool at_edge = wanted_offset_[i] < lowest || wanted_offset_[i] > highest;
    offset_shift_[i] = at_edge ? shift / force_by_offset(i) : shift;
    if (std::abs(offset_shift_[i]) > std::abs(wanted_offset_[i] - offset))
      offset_shift_[i] = wanted_offset_[i] - offset;
  }
  return moves;
}

// How much the force of a slider that never slips changes with its offset, between 0 and 1.
double PeriodicSolver::force_by_offset(Index slider) {
  offset_probe_.setZero(m_);
  offset_probe_[slider] = 1.0;
  std::swap(offset_probe_, offset_shift_);
  difference_.swap(best_);
  difference_.setZero();
  factorise();
  const bool solved = correct();
  difference_.swap(best_);
  std::swap(offset_probe_, offset_shift_);
  return solved ? std::clamp(correction_[2 * n_ + slider], 0.05, 1.0) : 1.0;
}

bool PeriodicSolver::march(const Excitation& excitation, int periods) {
  for (int k = 0; k < periods * (half_ ? 2 : 1); ++k) {
    if (!pass(excitation)) return false;
    put(y_ + difference_, excitation);
  }
  return true;
}

void PeriodicSolver::march_from_rest(const Excitation& excitation) {
  y_ << system_.start().q, system_.start().v, system_.start().slider_force;
  put(Vector(y_), excitation);
  half_ = false;
  for (int periods = 0; periods < options_.most_periods; periods += rest_periods)
    if (!march(excitation, rest_periods) || residual(excitation) < 1e-7) break;
  for (Index i = 0; i < m_; ++i)
    wanted_offset_[i] = y_[2 * n_ + i] - system_.sliders()[static_cast<std::size_t>(i)].stiffness *
                                             system_.relative_displacement(i, y_.head(n_));
}

void PeriodicSolver::take_start(const Excitation& excitation, SteadyStart start) {
  wanted_offset_.setZero();
  if (start == SteadyStart::previous) wanted_offset_ = centre_;
  if (start == SteadyStart::rest)
    march_from_rest(excitation);
  else
    predict(excitation);
  half_ = excitation.is_half_wave_symmetric() && (wanted_offset_.array() == 0.0).all();
}

void PeriodicSolver::report_unbounded(SteadyResponse& response) const {
  const auto observed = static_cast<Index>(request_.observed.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  response.status = SteadyStatus::unbounded;
  response.residual = response.error = infinity;
  response.amplitude = response.rms = Vector::Constant(observed, infinity);
  response.velocity_amplitude = response.acceleration_amplitude =
      Vector::Constant(request_.rates ? observed : 0, infinity);
  response.mean = Vector::Constant(observed, nan);
  response.harmonics =
      ComplexMatrix::Constant(observed, static_cast<Index>(request_.harmonics.size()), {infinity, nan});
  response.dissipated = response.slip_share = response.offset = Vector::Constant(m_, nan);
  response.viscous_work = response.input_work = nan;
  response.transitions = 0;
  response.drift.resize(0);
}

double PeriodicSolver::observed_size(const Vector& y) const {
  double size = 0.0;
  for (const auto& what : request_.observed)
    size = std::max(size, std::abs(y[what.first] - (what.second == ground ? 0.0 : y[what.second])));
  return size;
}

void PeriodicSolver::solve(const Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  require_memory(excitation);
  forget_others(excitation);
  last_ = excitation;
  response.periods = 1;
  response.iterations = 0;
  offset_shift_.setZero(m_);
  flow_.set_excitation(excitation);
  take_start(excitation, start);

  response.status = SteadyStatus::not_converged;
  const bool converged = iterate(excitation, response) || iterate_from_elsewhere(excitation, response);
  if (response.status == SteadyStatus::unbounded) {
    report_unbounded(response);
    known_.clear();
    return;
  }
  if (converged) response.status = drift(excitation) > walking ? SteadyStatus::drifting : SteadyStatus::converged;
  measure(excitation, response);
  // What the small rest of the residual does to the balance of a slightly damped structure.
  for (int polish = 0; converged && polish < 2 && imbalance(response) > fine_balance; ++polish) {
    factorise();
    near_factors_ = true;
    if (!correct()) break;
    ++response.iterations;
    put(y_ + correction_, excitation);
    if (!pass(excitation)) break;
    response.residual = residual(excitation);
    measure(excitation, response);
  }
  const double largest = response.amplitude.size() > 0 ? response.amplitude.maxCoeff() : 0.0;
  response.error = round_off;
  // After a full step of Newton its matrix is as good as the one here would be.
  if (!near_factors_) factorise();
  if (correct() && largest > 0.0) {
    Vector rates = Vector::Zero(y_.size());
    rates.head(n_) = correction_.segment(n_, n_) / excitation.angular_frequency;
    response.error += std::hypot(observed_size(correction_), observed_size(rates)) / largest;
  }
  if (converged)
    remember(excitation);
  else
    known_.clear();
}

// Where the points before led nowhere: from a guess that knows nothing of them, then from where nothing moves. The best
// that all found is left in y_ and the orbit.
bool PeriodicSolver::iterate_from_elsewhere(const Excitation& excitation, SteadyResponse& response) {
  Vector best = y_;
  double least = response.residual;
  for (const bool from_guess : {true, false}) {
    if (response.status == SteadyStatus::unbounded) return false;
    if (from_guess && known_.empty()) continue;
    if (from_guess)
      guess(excitation);
    else
      y_.setZero();
    if (iterate(excitation, response)) return true;
    if (response.residual < least) {
      least = response.residual;
      best = y_;
    }
  }
  y_ = best;
  near_factors_ = false;
  response.residual = pass(excitation) ? residual(excitation) : infinity;
  return false;
}

// Newton's method from y_. A step that does not halve the residual within a few halvings leads over a kink of the flow:
// the flow itself is followed then.
bool PeriodicSolver::iterate(const Excitation& excitation, SteadyResponse& response) {
  double best = infinity;
  int halvings = 0, periods = 0, stretch = 4;
  const int first = response.iterations;
  bool may_move = true, moving = false;
  near_factors_ = false;
  Vector settled;  // an orbit whose offsets are being moved
  while (response.iterations < first + options_.most_iterations) {
    ++response.iterations;
    double& last = response.residual;
    last = pass(excitation) ? residual(excitation) : infinity;
    if (last <= options_.tolerance) {
      if (!may_move || response.iterations > first + most_moves || !must_move_offsets(excitation)) return true;
      settled = y_;
      moving = true;
      best = infinity;
    }
    // Steps with the matrix of the pass before converge as 2 last^2 / best where that one's step was quadratic.
    const bool factors_do = near_factors_ && 2.0 * last * last < 0.1 * options_.tolerance * best;
    near_factors_ = false;
    if (last < (halvings > 0 ? 0.5 : 0.9) * best) {
      best = last;
      best_ = y_;
      halvings = 0;
      if (!factors_do) factorise();
      const bool solved = correct();
      offset_shift_.setZero();
      if (solved) {
        put(best_ + correction_, excitation);
        near_factors_ = true;
        if (size_of(excitation, correction_) < suspicious * size_of(excitation, best_)) continue;
      }
      if (is_driven_beyond_friction(system_, excitation)) {
        response.status = SteadyStatus::unbounded;
        return false;
      }
    } else if (best <= good_enough && best < infinity && !moving) {  // round-off: nothing better can be had
      y_ = best_;
      response.residual = pass(excitation) ? residual(excitation) : infinity;
      return response.residual <= good_enough;
    } else if (moving) {  // another slider slips then: the offset stays
      moving = may_move = false;
      y_ = settled;
      best = infinity;
    } else if (halvings < most_halvings && best < infinity) {
      put(best_ + std::ldexp(1.0, -++halvings) * correction_, excitation);
    } else {
      if (best < infinity) y_ = best_;
      if (periods >= options_.most_periods || !march(excitation, stretch)) return false;
      periods += stretch;
      stretch = std::min(2 * stretch, longest_stretch);
      best = infinity;
      halvings = 0;
    }
  }
  return false;
}

}  // namespace rubato::integrate
