#include <rubato/numerics/newton.hpp>
#include <rubato/steady/free_motions.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>
#include <rubato/steady/undamped_resonance.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// One pass of the flow, Newton's step from it, and their repetition.
namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double good_enough = 1e-10;  // residual that is accepted where round-off allows no smaller one
constexpr double suspicious = 1e3;     // a step that much longer than the state: a resonance without damping?
constexpr double walking = 1e-9;       // drift over a period, relative to the state, that is none of round-off
constexpr int most_halvings = 3, most_moves = 4, longest_stretch = 64;

}  // namespace

/// Keeps the pieces of a pass, and ends one that has too many: a contact that chatters.
class PeriodicSolver::Recorder final : public integrate::ExactVisitor {
 public:
  Recorder(Orbit& orbit, long most_pieces) : orbit_(orbit), left_(most_pieces) { orbit_.clear(); }
  bool sample(const system::State&, const integrate::ExactWork&) override { return true; }
  bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
    return true;
  }
  bool piece(const integrate::TaylorPiece& piece, double start, double length,
             const std::vector<integrate::SliderState>& states) override {
    orbit_.add(piece, start, length, states);
    return --left_ > 0;
  }

 private:
  Orbit& orbit_;
  long left_;
};

// One pass of the flow from y_, over a period or half of it: orbit and P(y) - y.
bool PeriodicSolver::pass(const system::Excitation& excitation) {
  // A step of Newton may lead so far away that sliders would slip and stick by round-off, without end.
  Vector displacements(m_);
  for (Index i = 0; i < m_; ++i) displacements[i] = system_.relative_displacement(i, y_.head(n_));
  if (!are_slider_forces_resolved(system_, excitation, displacements)) return false;
  start_.t = 0.0;
  start_.q = y_.head(n_);
  start_.v = y_.segment(n_, n_);
  start_.slider_force = y_.tail(m_);
  end_ = start_;
  Recorder recorder(orbit_, static_cast<long>(most_pieces()));
  factors_are_of_orbit_ = false;
  const integrate::ExactReport report = flow_.advance(end_, excitation.period() * (half_ ? 0.5 : 1.0), {}, recorder);
  if (report.end != integrate::ExactEnd::reached) return false;
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

double PeriodicSolver::residual(const system::Excitation& excitation) {
  const double size = size_of(excitation, y_), moved = size_of(excitation, difference_);
  double result = moved > 0.0 ? moved / size : 0.0;
  if (const double drifted = drift(excitation); drifted <= walking) result = std::max(result, drifted);
  for (Index i = 0; i < m_; ++i)
    if (excitation.limits[i] > 0.0) result = std::max(result, std::abs(difference_[2 * n_ + i]) / excitation.limits[i]);
  return result;
}

// Over the period of the pass, relative to the state.
double PeriodicSolver::drift(const system::Excitation& excitation) const {
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

// Rigid motions that some slider sees, and none that sticks in the pass: the structure may walk along them.
Matrix PeriodicSolver::open_motions() const {
  Matrix held = Matrix::Zero(m_ + free_.cols(), rigid_.cols());
  for (Index i = 0; i < m_; ++i)
    if (!orbit_.slips(i))
      for (Index k = 0; k < rigid_.cols(); ++k) held(i, k) = system_.relative_displacement(i, rigid_.col(k));
  held.bottomRows(free_.cols()) = free_.transpose() * (system_.mass() * rigid_);
  return kernel_of(held, rigid_);
}

// The orbit may lie anywhere along an open motion: Newton's steps leave it in place, in the metric of the mass. Along a
// free one as well, whose velocity repeats by itself: these rows hold its place, and its speed is such that it returns.
void PeriodicSolver::hold_rigid_motions() {
  const Matrix open = open_motions();
  matrix_.topLeftCorner(n_, n_) += open * (open.transpose() * Matrix(system_.mass()));
  matrix_.block(n_, 0, n_, n_) += free_ * (free_.transpose() * Matrix(system_.mass()));
}

// A structure that floats may lie anywhere: it is put where it lies on average where it was installed. Its own motion
// follows from the loads alone, (k w)^2 p_k = -phi^T a_k.
void PeriodicSolver::place_free_motions(const system::Excitation& excitation) {
  if (free_.cols() == 0) return;
  Vector place = -(free_.transpose() * (system_.mass() * y_.head(n_)));
  for (const system::LoadHarmonic& load : excitation.harmonics)
    place -= free_.transpose() * load.amplitude.real() / std::pow(load.order * excitation.angular_frequency, 2);
  y_.head(n_) += free_ * place;
}

// Newton's step from y_, with the matrix last factorised. False at a resonance without damping.
bool PeriodicSolver::correct() {
  right_side_ = -difference_;
  if (!half_)
    for (Index i = 0; i < m_; ++i)
      if (!orbit_.slips(i)) right_side_[2 * n_ + i] = 0.0;
  correction_.noalias() = factors_.solve(right_side_);
  return correction_.allFinite();
}

// Where the points before led nowhere: from a guess that knows nothing of them, then from where nothing moves. The best
// that all found is left in y_ and the orbit.
bool PeriodicSolver::iterate_from_elsewhere(const system::Excitation& excitation, SteadyResponse& response) {
  Vector best = y_;
  double least = response.residual;
  for (const bool from_guess : {true, false}) {
    if (response.status == SteadyStatus::unbounded) return false;
    if (from_guess && known_.empty()) continue;
    if (from_guess)
      guess(excitation);
    else
      y_.setZero();
    y_.head(n_) -= along_unseen(y_.head(n_));
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

/// The orbit as Newton's method sees it: the iterate is y_, each evaluation a pass of the flow.
struct PeriodicSolver::Shooting : numerics::NewtonProblem {
  Shooting(PeriodicSolver& of, const system::Excitation& excitation_, SteadyResponse& response_)
      : s(of), excitation(excitation_), response(response_) {
    s.near_factors_ = false;
  }

  double evaluate(bool /*with_tangent*/) {
    ++response.iterations;
    return response.residual = s.pass(excitation) ? s.residual(excitation) : infinity;
  }

  bool is_solved(double residual) { return residual <= s.options_.tolerance; }

  bool factorise() {
    const double residual = response.residual;
    // Steps with the matrix of the pass before converge as 2 r^2 / best where that one's step was quadratic.
    const bool factors_do = s.near_factors_ && 2.0 * residual * residual < 0.1 * s.options_.tolerance * best;
    s.near_factors_ = false;
    best = residual;
    s.best_ = s.y_;
    if (!factors_do) s.factorise();
    return true;
  }

  double correct() {
    const bool is_finite = s.correct();
    const double size = is_finite ? s.size_of(excitation, s.correction_) : infinity;
    if (size < suspicious * s.size_of(excitation, s.best_)) return size;
    if (UndampedResonance(s.system_).is_driven_beyond_friction(excitation)) response.status = SteadyStatus::unbounded;
    return size;
  }

  bool stops() { return response.status == SteadyStatus::unbounded; }

  void move(double part) {
    s.put(s.best_ + part * s.correction_, excitation);
    s.near_factors_ = part == 1.0;
  }

  // A step that does not halve the residual within a few halvings leads over a kink of the flow.
  bool is_lower(double residual, double before, double part) {
    return is_solved(residual) || residual < (part < 1.0 ? 0.5 : 0.9) * before;
  }

  bool may_be_halved(double before) { return !(before <= good_enough); }

  PeriodicSolver& s;
  const system::Excitation& excitation;
  SteadyResponse& response;
  double best = infinity;  // residual at best_
};

// Newton's method from y_. Where its steps come no nearer the flow itself is followed.
bool PeriodicSolver::iterate(const system::Excitation& excitation, SteadyResponse& response) {
  int periods = 0, stretch = 4, moves = 0;
  const int last = response.iterations + options_.most_iterations;
  Vector settled;  // the last orbit, whose offsets were moved
  numerics::NewtonRules rules;
  rules.most_iterations = options_.most_iterations;
  rules.most_halvings = most_halvings;
  while (response.iterations < last) {
    rules.most_evaluations = last - response.iterations;
    Shooting shooting(*this, excitation, response);
    const numerics::NewtonOutcome outcome = numerics::newton(shooting, rules).outcome;
    if (outcome == numerics::NewtonOutcome::stopped) return false;
    bool is_orbit = outcome == numerics::NewtonOutcome::converged;
    if (!is_orbit && shooting.best < infinity) {
      y_ = best_;
      response.residual = shooting.best;
    }
    if (outcome == numerics::NewtonOutcome::limit) break;
    if (!is_orbit && shooting.best <= good_enough) {
      // Round-off: nothing better can be had.
      near_factors_ = true;
      response.residual = pass(excitation) ? residual(excitation) : infinity;
      if (!(response.residual <= good_enough)) return false;
      is_orbit = true;
    }
    if (is_orbit) {
      settled = y_;
      if (moves == most_moves || !move_offsets(excitation)) return true;
      ++moves;
      continue;
    }
    if (periods >= options_.most_periods || !march(excitation, stretch)) return false;
    periods += stretch;
    stretch = std::min(2 * stretch, longest_stretch);
  }
  if (moves == 0) return false;
  y_ = settled;
  response.residual = pass(excitation) ? residual(excitation) : infinity;
  return response.residual <= good_enough;
}

}  // namespace rubato::steady
