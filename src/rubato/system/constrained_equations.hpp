#pragma once

#include <rubato/model/time_law.hpp>
#include <rubato/system/constrained_system.hpp>
#include <rubato/system/saddle_matrix.hpp>

#include <vector>

namespace rubato::system {

/// Evaluates the equations of a constrained system and solves with their matrix
///
///   [ mass M + damping C + stiffness (K + d(G^T multiplier)/dq)   G^T ]
///   [ G                                                           -E  ]    C = df/dv, K = df/dq
///
/// (SaddleMatrix). A workspace: one a thread; nothing is allocated after the construction.
class ConstrainedEquations {
 public:
  virtual ~ConstrainedEquations() = default;
  ConstrainedEquations(const ConstrainedEquations&) = delete;
  ConstrainedEquations& operator=(const ConstrainedEquations&) = delete;

  virtual const ConstrainedSystem& system() const = 0;

  /// Goes to a state; what follows is evaluated there. Reads t, q, v, and the branches and memory that the state holds.
  /// @param side  which limit to take of a load that jumps at t
  virtual void go_to(const State& state, model::Side side) = 0;
  /// The state from which go_to_end() and move_laws() lead.
  virtual void begin_step(const State& /*from*/) {}
  /// Goes to a state that a step leads to from where it began: of laws with a memory the one at its start counts, from
  /// which they follow the motion without a turn. Otherwise as go_to().
  virtual void go_to_end(const State& to, model::Side side) { go_to(to, side); }
  /// Writes the memory of the laws at a state to which the motion leads from where the step began.
  virtual void move_laws(State& /*to*/) {}
  /// The same, from a state in which it begins.
  void move_laws(const State& from, State& to) {
    begin_step(from);
    move_laws(to);
  }

  /// Writes f [n] and g [c].
  virtual void residual(Vector& force, Vector& constraint) = 0;
  /// residual(), G, which the next product with it uses, and the matrix above, ready to be factorised.
  struct Weights {
    double mass = 1.0, damping = 0.0, stiffness = 0.0;
    double constraint = 0.0;  ///< what E is a share of, over M; 0: the weight of mass
    bool friction = false;    ///< with the slopes of the friction that reactions make, beside G^T
    bool secants = false;     ///< with secants of the directions of slip instead of their slopes: they never overshoot
                              ///< (Weiszfeld 1937)
  };
  virtual void linearise(const Weights& weights, const Vector& multiplier, Vector& force, Vector& constraint) = 0;
  /// Evaluates G alone, with g.
  virtual void constraints(Vector& constraint) = 0;
  /// out += factor (G^T multiplier + the friction that these multipliers make), with the G evaluated last.
  virtual void add_constraint_force(const Vector& multiplier, double factor, Vector& out) const = 0;
  /// The derivative of g(q(t), t) in time: G v + dg/dt [c], with the G evaluated last.
  virtual void constraint_rate(const Vector& v, Vector& out) = 0;
  /// What must be added to G a to make the second derivative of g in time [c].
  virtual void second_rate(Vector& out) = 0;
  /// The share of all loads in f: of all that follows time itself [n].
  virtual void force_of_loads(Vector& out) = 0;

  /// Whether friction that follows a reaction slides: the multipliers then make forces that are not linear in them.
  virtual bool has_sliding_reactions() const { return false; }
  /// Whether friction that holds would have to hold more than it can, in a state and with its multipliers; goes there.
  virtual bool lets_go(const State& /*state*/) { return false; }
  /// From now on friction follows the multipliers plus `share` times `lag`. The multipliers of a step that projects its
  /// velocities lag behind the reactions.
  /// @param lag  [c], or empty: nothing
  virtual void set_reaction_lag(const Vector& /*lag*/, double /*share*/) {}
  /// Sets the floors of slip velocities for a step of length h from a state; goes there.
  virtual void set_slip_floors(const State& /*from*/, double /*h*/, State& /*to*/) {}

  /// Turns the matrix of linearise() into factors. Returns false where it has none.
  bool factorise() { return saddle_.factorise(); }
  /// Solves with the factors; (x, y) is overwritten by the solution.
  void solve(Vector& x, Vector& y) { saddle_.solve(x, y); }
  /// Rows of constraints that repeat those before them, as the last factors found: SaddleMatrix::redundant_rows().
  std::vector<Index> redundant_rows(double left = 1e-8) const { return saddle_.redundant_rows(left); }
  const SaddleMatrix& matrix() const { return saddle_; }

 protected:
  ConstrainedEquations() = default;

  SaddleMatrix saddle_;
};

}  // namespace rubato::system
