#pragma once

#include <rubato/integrate/steady/period_map.hpp>

#include <deque>
#include <vector>

namespace rubato::integrate {

struct OrbitSearchOptions {
  double tolerance = 1e-5;  ///< of the difference of the states one period apart, relative to the state [-]
  int confirmations = 3;    ///< consecutive periods in which it must hold
  int max_periods = 1000;
  int max_multiple = 8;  ///< subharmonics looked for
};

/// What became of the march of one lane.
struct OrbitReport {
  SteadyStatus status = SteadyStatus::not_converged;
  double residual = 0.0;  ///< of the last period, relative [-]
  double distance = 0.0;  ///< from where the march would end, estimated from the decay of the residuals, relative [-]
  int marched = 0;        ///< periods
  int multiple = 1;       ///< it repeats after so many periods
};

/// Extrapolates a sequence of marched periods to its end: Anderson's mixing (Anderson 1965; Walker and Ni
/// 2011, type II). With
/// the last differences dx, dr of the starts and of the residuals r = P(x) - x it takes
///
///   x_next = x + r - (dX + dR) g,   g = argmin |r - dR g|.
///
/// It lands on combinations of marched states, so that what they have in common (equilibrium, the slip of a slider that
/// sticks) it keeps.
class PeriodExtrapolation {
 public:
  explicit PeriodExtrapolation(std::size_t depth = 10) : depth_(depth) {}
  void clear();
  Vector next(const Vector& x, const Vector& residual);

 private:
  std::size_t depth_;
  std::deque<Vector> dx_, dr_;
  Vector last_x_, last_r_;
};

/// Marches until the states repeat. A march with equal periods of a dissipative structure ends there from anywhere, but
/// at 2 % of damping only after some 60 periods; `extrapolates` shortens that.
/// @param states  [size x lanes] where the lanes start; on return the starts of the last period marched
std::vector<OrbitReport> search_orbits(PeriodMap& map, const OrbitSearchOptions& options, bool extrapolates,
                                       LaneArray& states);

}  // namespace rubato::integrate
