#pragma once

#include <rubato/system/state.hpp>
#include <rubato/system/system.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::system {

class ConstrainedEquations;

/// A system with constraints, in redundant coordinates:
///
///   M a + f(q, v, t) + G(q, t)^T multiplier = 0,   g(q, t) = 0,   G = dg/dq
///
/// with the constant mass M [n x n], forces f = internal - external, and velocities in the tangent space of the
/// configuration. Immutable; its equations are evaluated in workspaces, one a thread.
class ConstrainedSystem : public System {
 public:
  /// c
  virtual Index constraint_count() const = 0;
  /// Names of the constraints for messages and results, [c].
  virtual const std::vector<std::string>& rows() const = 0;
  /// The state at t = 0 as given: not yet consistent. Its sizes are those of all states.
  virtual const State& start() const = 0;
  /// Of all numbers that make a configuration; the size n of a motion may be smaller.
  Index configuration_size() const { return start().q.size(); }

  virtual const SparseMatrix& mass() const = 0;
  /// M x
  virtual void times_mass(const Vector& x, Vector& out) const = 0;
  /// By which errors are measured [m sqrt(kg)]; 0: that of one metre and one radian in every coordinate.
  virtual double reference() const { return 0.0; }

  /// Constraints that depend on time and drive the motion: what they do to it is work.
  virtual std::vector<Index> driven_rows() const { return {}; }

  /// Turns a small motion in the tangent space at the end of `travel` into the change of `travel` that makes it.
  virtual void to_travel(const Vector& /*travel*/, Vector& /*motion*/) const {}

  /// Whether the slopes of forces jump somewhere: a first correction of Newton's method is not trusted then.
  virtual bool has_kinks() const = 0;
  /// Whether there is friction whose limit follows multipliers.
  virtual bool has_followed_reactions() const { return false; }
  /// Whether there is friction whose direction is part of the motion.
  virtual bool has_slip_directions() const { return false; }
  /// Whether there are stops that are springs, which a motion meets for a short time.
  virtual bool has_stops() const { return false; }
  /// Whether one of them is closed.
  virtual bool touches(const State& /*state*/) const { return false; }
  /// Whether a motion moves memory that is not in q and v: State::memory.
  virtual bool has_memory() const { return false; }

  /// A workspace that evaluates the equations. The system must outlive it.
  virtual std::unique_ptr<ConstrainedEquations> equations() const = 0;
};

}  // namespace rubato::system
