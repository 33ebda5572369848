#pragma once

#include <rubato/integrate/exact/taylor_piece.hpp>

#include <span>
#include <vector>

namespace rubato::integrate {

/// Coordinates that the exact flow takes: every piece costs dense products, and beyond other ways are faster by far.
inline constexpr Index largest_exact = 300;

/// A slider that changes its state.
struct Transition {
  double t = 0.0;  ///< [s]
  Index slider = 0;
  SliderState state = SliderState::stick;  ///< the new one
};

/// Sums since the start of an advance, where they are asked for. A slip books limit * |change of slip|.
struct ExactWork {
  double damper = 0.0, slider = 0.0, load = 0.0;  ///< [J]
};

/// Sees samples and transitions in the order of time. Return false to stop.
class ExactVisitor {
 public:
  virtual ~ExactVisitor() = default;
  virtual bool sample(const system::State& state, const ExactWork& work) = 0;
  virtual bool transition(const system::State& state, const Transition& transition, const ExactWork& work) = 0;
  /// Sees every piece once, with the part of it that is used: from its start over a length [s].
  virtual bool piece(const TaylorPiece& piece, double start, double length, const std::vector<SliderState>& states) {
    (void)piece, (void)start, (void)length, (void)states;
    return true;
  }
};

enum class ExactEnd {
  reached,
  stopped,     ///< by the visitor
  not_finite,  ///< a NaN or an infinity appeared
  chattering,  ///< a slider changes its state without time passing
};

struct ExactReport {
  ExactEnd end = ExactEnd::reached;
  long transitions = 0;
  Index worst = -1;  ///< the slider that chatters
};

/// The exact flow of a structure with sliders: analytic pieces between located transitions.
///
/// A piece is a Taylor polynomial (TaylorPiece), and so are the slider's force and its rate, so that the first time at
/// which a sticking slider reaches its limit or a slipping one stops is a root of a polynomial, found to round-off.
/// What happens next follows from one-sided derivatives: at the limit the force, and with it the acceleration, is the
/// same whether the slider sticks or slips, so the first derivative of u that is not zero decides: outward slips,
/// inward sticks.
class ExactFlow {
 public:
  /// Throws InvalidInput for more than 300 coordinates and for loads by formulas of t.
  explicit ExactFlow(const system::LocallyNonlinear& system);

  /// Takes other loads and limits than the system's.
  void set_excitation(const system::Excitation& excitation);

  /// Carries a state to t_end.
  /// @param samples    rising times in [state.t, t_end] to visit [s]
  /// @param with_work  sum the work of dampers, sliders and loads
  ExactReport advance(system::State& state, double t_end, std::span<const double> samples, ExactVisitor& visitor,
                      bool with_work = false);

  /// A bound of the fastest change in the present state of the sliders: the length of a piece [s].
  double piece_length() const { return piece_.max_length(); }

 private:
  void decide_states(system::State& state, double table_end);
  /// Of a slider at its limit, from the piece just started; keeps the order of the term that decides.
  SliderState state_at_limit(Index slider, double force);
  bool is_idle(Index i) const { return piece_.limit(i) == 0.0; }
  double next_event(double length, Index& slider);

  const system::LocallyNonlinear& system_;
  TaylorPiece piece_;
  std::vector<SliderState> states_, decided_;
  std::vector<bool> critical_;
  /// The first term of u that is not round-off, of a slider that starts the piece at its limit; else 0. The search for
  /// transitions goes by it too: were it to see what the decision neglects, both would contradict each other forever.
  std::vector<int> first_order_;
  std::vector<double> path_;  ///< coefficients of a force, or of a rate of slip
  system::State now_;
  bool own_loads_ = true;
};

}  // namespace rubato::integrate
