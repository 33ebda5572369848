#pragma once

#include <rubato/system/state.hpp>

#include <string>
#include <utility>
#include <vector>

namespace rubato::integrate {

enum class EquilibriumOutcome {
  found,
  not_finite,            ///< found, of loads that are no numbers
  floats,                ///< some motion meets no resistance, even with all sliders stuck
  gives_way,             ///< the sliders that slip leave a motion without resistance
  gives_way_on_the_way,  ///< loads that grow from zero lead no further than a share of them
  contacts_unsettled,    ///< which sliders slip and which stops are closed did not settle
  lock_unsettled,        ///< whether a lock holds did not settle
  not_converged          ///< forces are left
};

/// What the search for an equilibrium came to, of whatever system, with the names of the user's parts.
struct Equilibrium {
  EquilibriumOutcome outcome = EquilibriumOutcome::not_converged;
  system::State state;               ///< at rest; the best found where it is no equilibrium
  bool is_stable = true;             ///< no motion that is left goes downhill from it
  double reached = 1.0;              ///< the share of the loads in whose equilibrium the state is
  int load_steps = 0;                ///< by which they were raised; 0: found with all of them at once
  int iterations = 0;                ///< that were taken
  double residual = 0.0;             ///< largest force left [N], [N m]
  double rounding = 0.0;             ///< by what share displacements may err, the stiffness being rounded
  std::string worst;                 ///< its coordinate
  bool turns_worst = false;          ///< which is a rotation
  bool leaves_out_friction = false;  ///< that of joints, which might hold the system

  std::vector<std::string> moving;    ///< coordinates that nothing resists
  std::vector<std::string> changing;  ///< the sliders that slip, or the lock that did not settle
  std::vector<std::string> holding;   ///< locks that hold
  /// What holds a displacement that is prescribed.
  struct Reaction {
    std::string coordinate;
    bool is_moment = false;
    double value = 0.0;  ///< [N] or [N m]
  };
  std::vector<Reaction> reactions;
  std::vector<std::pair<std::string, std::string>> statistics;
};

}  // namespace rubato::integrate
