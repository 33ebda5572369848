#pragma once

#include <rubato/model/time_law.hpp>
#include <rubato/system/constrained_system.hpp>
#include <rubato/system/guard.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::system {

/// Equations of motion of one's own, in coordinates that are numbers:
///
///   M a + f(q, v, t) + G(q, t)^T multiplier = 0,   g(q, t) = 0,   G = dg/dq
///
/// with the constant mass M. What must be written is force(), and with constraints constraint() and jacobian(); slopes
/// that are not written are found by central differences of these, to some nine digits, in the sizes that q and v have
/// at the time: write second_rate() where the origin is far from what moves. Matrices are dense: for some hundred
/// coordinates.
///
/// Branches of one's own (engaged, open, broken) are numbers in State::phase: guards tell when one ends, pass() sets
/// the next. All functions are called by several threads at once, and so must not write to the system.
class OwnSystem : public ConstrainedSystem {
 public:
  /// @param coordinates  names [n]
  /// @param mass         M [n x n], symmetric positive definite
  /// @param q, v         at t = 0 [n]; make_consistent() moves them onto the constraints
  /// @param rows         names of the constraints [c]
  /// @param phase        branches at the start
  /// Throws InvalidInput for sizes that do not fit, and for a coordinate without mass.
  OwnSystem(std::vector<std::string> coordinates, const SparseMatrix& mass, Vector q, Vector v,
            std::vector<std::string> rows = {}, std::vector<int> phase = {});

  /// f [n] [N]: internal forces less external ones.
  /// @param side  which limit to take of a load that jumps at state.t
  virtual void force(const State& state, model::Side side, Vector& f) const = 0;
  /// K = df/dq and C = df/dv [n x n].
  virtual void force_slopes(const State& state, model::Side side, Matrix& stiffness, Matrix& damping) const;
  /// The part of f that follows time itself [n]: what may swing within a step while nothing moves.
  virtual void force_of_time(const State& state, model::Side side, Vector& f) const;

  /// g [c] [m], [rad].
  virtual void constraint(const State& state, Vector& g) const;
  /// G [c x n].
  virtual void jacobian(const State& state, Matrix& G) const;
  /// d(G^T multiplier)/dq [n x n].
  virtual void curvature(const State& state, const Vector& multiplier, Matrix& stiffness) const;
  /// The derivative of g in time at constant q [c]; to be written where there are driven_rows().
  virtual void constraint_time_rate(const State& state, Vector& rate) const;
  /// The second derivative of g along the motion for a = 0 [c]; to be written where there are driven_rows().
  virtual void second_rate(const State& state, Vector& rate) const;
  /// Whether a constraint holds on the branch of the state; the multiplier of one that does not is zero.
  virtual bool is_active(Index /*row*/, const State& /*state*/) const { return true; }

  /// What the forces have stored [J]: a potential of a part of f.
  virtual double potential_energy(const State& /*state*/) const { return 0.0; }

  /// Times in (from, to) at which forces are not smooth, rising. No step passes one.
  virtual std::vector<double> breakpoints(double /*from*/, double /*to*/) const { return {}; }
  /// How many guards there are.
  virtual Index guard_count() const { return 0; }
  virtual GuardValue guard(Index guard, const State& state) const;
  /// Lets a state go on from the transition of a guard: sets State::phase, and v where there is an impact. What its
  /// constraints then forbid of the velocities is removed.
  virtual Passage pass(Index guard, State& state) const;

  Index size() const final { return static_cast<Index>(coordinates_.size()); }
  const std::vector<std::string>& coordinates() const override { return coordinates_; }
  bool is_rotation(Index /*i*/) const override { return false; }
  bool is_flat() const override { return true; }
  void retract(const Vector& q, const Vector& dq, Vector& out) const override { out = q + dq; }
  void difference(const Vector& q, const Vector& to, Vector& dq) const override { dq = to - q; }
  Index constraint_count() const final { return static_cast<Index>(rows_.size()); }
  const std::vector<std::string>& rows() const override { return rows_; }
  const State& start() const override { return start_; }
  const SparseMatrix& mass() const override { return mass_; }
  void times_mass(const Vector& x, Vector& out) const override { out.noalias() = mass_ * x; }
  bool has_kinks() const override { return false; }
  /// That of the largest coordinate at the start in all of them; 0 where all are zero: one metre. To be written where
  /// motions are of another size: errors of automatic steps are shares of it.
  double reference() const override { return reference_; }
  std::unique_ptr<ConstrainedEquations> equations() const override;

 private:
  std::vector<std::string> coordinates_, rows_;
  SparseMatrix mass_;
  State start_;
  double reference_ = 0.0;
};

}  // namespace rubato::system
