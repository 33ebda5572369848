#pragma once

#include <rubato/analysis/mechanism_start_state.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/system/mechanism.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// A transient of a mechanism with all its values, from a start that satisfies the constraints.
struct MechanismPlan {
  TransientPlan transient;  ///< `start` is consistent; `automatic` holds the plan of fixed steps too
  bool allow_unstable = false;
  bool project_velocities = false;
  model::SectionForcesDescription section_forces;
  std::vector<std::string> warnings;  ///< what the start took: parts that moved, constraints that repeat others
  std::string failure;  ///< why the equilibrium to start from was not found: the analysis fails; empty: nothing did

  std::string summary() const;
};

/// What is asked for, or every coordinate: displacements, then rotations. Throws InvalidInput for an unknown name.
std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const system::Mechanism& mechanism);

/// Evaluates a description, assembles the mechanism and checks that it can run. Throws InvalidInput, naming the joints
/// and by how much they are apart, where they cannot be assembled, and for a method that constraints do not go with.
MechanismPlan plan_mechanism(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const system::Mechanism& mechanism,
                             const numerics::Parameters& parameters);

}  // namespace rubato::analysis
