#include <rubato/results/columns/beam_section_forces.hpp>
#include <rubato/results/columns/bushing_forces.hpp>
#include <rubato/results/columns/joint_coordinates.hpp>
#include <rubato/results/columns/joint_frictions.hpp>
#include <rubato/results/columns/joint_laws.hpp>
#include <rubato/results/columns/joint_reactions.hpp>
#include <rubato/results/columns/mechanism_columns.hpp>
#include <rubato/results/columns/mechanism_contact_columns.hpp>
#include <rubato/results/columns/mechanism_law_columns.hpp>
#include <rubato/results/columns/mechanism_stop_columns.hpp>

namespace rubato::results {

ColumnGroups columns_of_motion(system::MechanismEquations& equations, const std::vector<Observed>& observed,
                               const model::SectionForcesDescription& section_forces) {
  const system::Mechanism& mechanism = equations.mechanism();
  ColumnGroups groups;
  groups.push_back(std::make_unique<JointAngles>(mechanism, observed, ObservedColumns::of_motion));
  groups.push_back(std::make_unique<JointDisplacements>(mechanism));
  groups.push_back(std::make_unique<JointReactions>(mechanism));
  groups.push_back(std::make_unique<JointFrictions>(equations));
  groups.push_back(std::make_unique<JointLaws>(mechanism));
  groups.push_back(std::make_unique<BushingForces>(mechanism));
  groups.push_back(std::make_unique<MechanismStopColumns>(mechanism));
  if (!mechanism.model().laws.empty()) groups.push_back(std::make_unique<MechanismLawColumns>(equations, true));
  if (!mechanism.model().contacts.empty()) groups.push_back(std::make_unique<MechanismContactColumns>(equations, true));
  groups.push_back(std::make_unique<BeamSectionForces>(mechanism, section_forces, ""));
  return groups;
}

ColumnGroups columns_of_equilibrium(system::MechanismEquations& equations, const std::vector<Observed>& observed,
                                    const model::SectionForcesDescription& section_forces, const std::string& title) {
  const system::Mechanism& mechanism = equations.mechanism();
  ColumnGroups groups;
  groups.push_back(
      std::make_unique<JointAngles>(mechanism, observed, std::vector{ObservedColumns::Quantity::position}));
  groups.push_back(std::make_unique<JointDisplacements>(mechanism));
  groups.push_back(std::make_unique<JointReactions>(mechanism));
  groups.push_back(std::make_unique<JointLaws>(mechanism));
  groups.push_back(std::make_unique<BushingForces>(mechanism));
  groups.push_back(std::make_unique<MechanismStopColumns>(mechanism));
  if (!mechanism.model().laws.empty()) groups.push_back(std::make_unique<MechanismLawColumns>(equations, false));
  if (!mechanism.model().contacts.empty())
    groups.push_back(std::make_unique<MechanismContactColumns>(equations, false));
  groups.push_back(std::make_unique<BeamSectionForces>(mechanism, section_forces, title));
  return groups;
}

}  // namespace rubato::results
