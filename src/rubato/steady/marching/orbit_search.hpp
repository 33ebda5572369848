#pragma once

#include <rubato/steady/marching/orbit_extrapolation.hpp>

#include <vector>

namespace rubato::steady {

struct OrbitSearchOptions {
  double tolerance = 1e-5;  ///< of the difference of the states one period apart, relative to the state [-]
  int confirmations = 2;    ///< consecutive marched periods in which it must hold
  int max_periods = 1000;
  int max_multiple = 8;  ///< subharmonics looked for
  /// Motions that no spring resists: along them a state may be moved, sliders included, without changing what follows
  /// [size x any], orthonormal.
  Matrix rigid;
};

/// What became of the march of one lane.
struct OrbitReport {
  SteadyStatus status = SteadyStatus::not_converged;
  double residual = 0.0;           ///< of the last period, relative [-]
  double distance = 0.0;           ///< from where the march would end, relative, estimated [-]
  double observed_distance = 0.0;  ///< the same of what is observed [m]
  int marched = 0;                 ///< periods
  int multiple = 1;                ///< it repeats after so many periods
};

/// `options.rigid` for a map that is prepared [size x any]; none for more than largest_rigid coordinates.
Matrix rigid_motions(PeriodMap& map, const system::LocallyNonlinear& system);
inline constexpr Index largest_rigid = 300;

/// Marches until the states repeat: the state one period apart differs by less than the tolerance, in consecutive
/// periods, and the end of the march is estimated (from the extrapolation, or from the decay of the residuals) to be
/// nearer than ten times that. The march of a dissipative structure ends there from anywhere, but at 2 % of damping
/// only after some 60 periods, which an extrapolation shortens. Displacements along rigid motions that no slider which
/// stayed where it was holds are taken back after each period: where they go on while all else repeats, it drifts.
/// @param extrapolation  null: marched only. Then what repeats after several periods, or never, is told apart.
/// @param states         [size x lanes] where the lanes start; on return the starts of the last period
std::vector<OrbitReport> search_orbits(PeriodMap& map, const OrbitSearchOptions& options,
                                       OrbitExtrapolation* extrapolation, LaneArray& states);

}  // namespace rubato::steady
