#pragma once

#include <rubato/core/types.hpp>

#include <limits>
#include <string>
#include <vector>

namespace rubato::system {

/// A mechanical system as everything above a step sees it: the names of its coordinates, and the configurations that
/// they move in. Const, and shared by threads.
///
/// What runs in every step takes the system itself (LocallyNonlinear, Mechanism: both are final, so that these
/// functions cost them no call).
class System {
 public:
  virtual ~System() = default;

  /// n, of velocities, accelerations and motions
  virtual Index size() const = 0;
  /// Names for messages and results, [n].
  virtual const std::vector<std::string>& coordinates() const = 0;
  /// Whether coordinate i is in [rad] instead of [m].
  virtual bool is_rotation(Index i) const = 0;

  /// Whether configurations are vectors [n]: retract() adds and difference() subtracts, so that means of
  /// configurations may be taken number by number.
  virtual bool is_flat() const = 0;
  /// The largest turn between two configurations that difference() tells from one round the other side [rad].
  /// Infinite where rotations are numbers.
  virtual double largest_turn() const { return std::numeric_limits<double>::infinity(); }
  /// The configuration after a motion dq [n] from q. `out` must not be q.
  virtual void retract(const Vector& q, const Vector& dq, Vector& out) const = 0;
  /// The dq [n] that leads from q to `to` along one retraction.
  virtual void difference(const Vector& q, const Vector& to, Vector& dq) const = 0;

 protected:
  System() = default;
  System(const System&) = default;
  System(System&&) = default;
  System& operator=(const System&) = default;
  System& operator=(System&&) = default;
};

}  // namespace rubato::system
