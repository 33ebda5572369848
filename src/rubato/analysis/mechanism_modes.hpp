#pragma once

#include <rubato/analysis/modes.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/system/mechanism.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Natural modes of a mechanism about its start, about its static equilibrium, or about where a transient leads.
struct MechanismModesPlan {
  /// The transient that leads there, which the analysis marches again.
  struct Reached {
    TransientPlan motion;
    std::string analysis;
    double time = 0.0;     ///< [s]
    bool settles = false;  ///< and on to the equilibrium next to it
  };

  ModesPlan modes;      ///< a count of 0: all, at most 20
  system::State state;  ///< at rest, with the multipliers of its loads; of one that is reached the start
  std::vector<std::string> warnings;
  std::string failure;  ///< why the equilibrium was not found: the analysis fails; empty: nothing did
  bool about_equilibrium = false;
  std::optional<Reached> reached;
};

/// Evaluates a description and finds the configuration. Throws InvalidInput, at its place, for a mechanism that cannot
/// be assembled, a transient that is none of the study's, a count that is no whole
/// number of at least 1, and a mechanism too large for its dense eigenproblem (3,000 coordinates).
MechanismModesPlan plan_mechanism_modes(const std::string& name, const Location& where,
                                        const model::ModesDescription& description, const system::Mechanism& mechanism,
                                        const StudyInput& input);

/// The table of run_modes, with the limit `free`; rotations in space are about the axes of the nodes. A configuration
/// that is not stable is a failure.
RunReport run_mechanism_modes(const std::string& name, const MechanismModesPlan& plan,
                              const system::Mechanism& mechanism, RunContext& context);

}  // namespace rubato::analysis
