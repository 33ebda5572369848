#pragma once

#include <rubato/model/model.hpp>

#include <string>
#include <unordered_set>
#include <vector>

// Private to the model floor: the part of build() that knows nodes.
namespace rubato::model {

/// A degree of freedom that is free to move.
struct NodeCoordinate {
  std::string name;  ///< "7.rz"
  bool is_rotation = false;
  double mass = 0.0;          ///< point masses [kg], or inertias [kg m2]
  double velocity = 0.0;      ///< at the start [m/s] or [rad/s]
  bool has_velocity = false;  ///< whether it is given, and not left out
};

/// A beam or truss that has a name, and its elements.
struct NamedLine {
  std::string name;
  std::size_t first = 0, count = 0;
  bool has_own_name = true;  ///< else it is FIRST-SECOND
};

struct BuiltStructure {
  Structure structure;
  std::vector<NodeCoordinate> coordinates;  ///< in the order of the nodes; the first is coordinate `offset`
  std::unordered_set<std::string> fixed;    ///< names of those held by supports
  std::vector<NamedLine> lines;             ///< beams and trusses
  std::vector<NamedLine> beams;             ///< all of them, FIRST-SECOND where they have no name
};

/// Evaluates and checks nodes, elements, masses and supports. A degree of freedom exists where something gives it an
/// inertia: beams all of a node's, trusses and masses the translations, inertias the rotations. Nodes within a beam
/// start with the velocities between those of its ends, as a beam that moves rigidly does. Throws InvalidInput.
/// @param offset  coordinates before those of the nodes
BuiltStructure build_structure(const StructureDescription& description, const numerics::Parameters& parameters,
                               Index offset);

/// Throws InvalidInput for a name that cannot head a column of results.
void refuse_unfit_name(const std::string& name, const Location& where);

/// A distributed force on the beam or truss that its description names. Throws InvalidInput.
DistributedForce build_distributed_force(const DistributedForceDescription& description,
                                         const std::vector<NamedLine>& lines, int dimension,
                                         const numerics::Parameters& parameters);

}  // namespace rubato::model
