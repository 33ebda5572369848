#pragma once

#include <rubato/steady/marching/period_record.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <span>
#include <vector>

namespace rubato::steady {

/// Numbers of several points side by side [rows x lanes]; a row, which holds one number of every point, is contiguous.
using LaneArray = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A method marched over one period of the excitation: the map from the state at its start to the state at its end, for
/// one point or for several of one frequency in lanes. The states are vectors in which all entries are lengths, so that
/// their differences can be compared:
///
///   x = (q, v / omega, slip, A / omega^2),   slip = u - fc / kT,
///
/// in physical or other coordinates of the structure, A where the method carries it. What other laws remember stands
/// behind the slips, and counts among them.
class PeriodMap {
 public:
  virtual ~PeriodMap() = default;

  virtual Index size() const = 0;        ///< of a state
  virtual Index slip_start() const = 0;  ///< row of the first slip: before it stand q and v / omega
  virtual Index slips() const = 0;
  virtual Index lanes() const = 0;  ///< most points side by side

  /// Binds the map to excitations of one frequency, one a lane. Returns false where this map cannot take them: a step
  /// too long for its iteration, a resonance without damping.
  virtual bool prepare(std::span<const system::Excitation> excitations, int steps) = 0;

  /// Writes the states one period later. With `records` (one a lane, reset by the caller for a multiple of `steps`)
  /// the samples from column `first` on are written too, and the works added up; lanes whose record ends before are
  /// left out.
  /// @return false if a step failed or a number is not finite
  virtual bool advance(const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records, Index first) = 0;

  /// A state of the system, at the phase zero of the loads, in the letters of the map (after prepare).
  virtual void encode(const system::State& state, LaneArray& states, Index lane) = 0;

  /// Moves the structure of a state by a displacement, and nothing else of it.
  virtual void displace(const Vector& by, LaneArray& states, Index lane) = 0;

  /// How far a difference of states moves what is observed: the largest |(dq, dv / omega)| over the observed of the
  /// request [m].
  virtual double observed_size(const LaneArray& differences, Index lane) const = 0;

  /// (I - dP/dx)^-1 of the structure without sliders [size x size], which makes of a residual the way to the end of the
  /// march; empty where it is not known.
  virtual Matrix linear_update() { return {}; }
};

/// (I - E^steps)^-1; empty where that is nearly singular: a motion that nothing damps.
Matrix resolvent_of_power(const Matrix& propagator, int steps);

}  // namespace rubato::steady
