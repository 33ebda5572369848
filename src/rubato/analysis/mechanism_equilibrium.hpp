#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/model/description.hpp>
#include <rubato/system/mechanism.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// What the search for an equilibrium of a mechanism came to.
struct MechanismStatic {
  system::State state;  ///< at rest, with the multipliers that hold it; the best found where it is not one
  bool is_found = false, is_stable = false;
  int iterations = 0;
  double residual = 0.0;    ///< largest force left [N], [N m]
  Index worst = -1;         ///< its coordinate
  int load_steps = 0;       ///< 0: found with all loads at once
  double load = 1.0;        ///< the share of the loads in whose equilibrium the state is
  int unsettled_lock = -1;  ///< one that was met and let go without end

  /// Why it is no equilibrium to go on from; empty where it is one.
  std::string complaint(const system::Mechanism& mechanism) const;
};

/// The equilibrium of a mechanism under its loads at t = 0, downhill from a configuration that is assembled.
MechanismStatic equilibrium_near(const system::State& start, const system::Mechanism& mechanism);

/// Throws InvalidInput: a mechanism has no displacements to hold.
void refuse_displacements(const std::string& title, const model::StaticDescription& description);

/// Evaluates and checks a static analysis of a mechanism without running it. Throws InvalidInput.
/// @return what its start warns of
std::vector<std::string> check_mechanism_static(const std::string& name, const Location& where,
                                                const model::StaticDescription& description,
                                                const system::Mechanism& mechanism);

/// One row: the positions of what is observed, the coordinates that the joints leave free, and the reactions. An
/// equilibrium that is not found is a failure, and nothing is written. One that is not stable is told, and locks that
/// hold are.
RunReport run_mechanism_static(const std::string& name, const Location& where,
                               const model::StaticDescription& description, const system::Mechanism& mechanism,
                               RunContext& context);

}  // namespace rubato::analysis
