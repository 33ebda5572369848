#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/mechanism.hpp>

namespace rubato::model {

/// Whether a study describes a mechanism: it has a body, a joint or a geometrically exact beam.
bool is_mechanism(const ModelDescription& description);

/// The mechanism for given values of the parameters. Throws InvalidInput, at the place in the user's file, for unknown
/// or duplicate names, values out of their range, an axis or a distance without length, angles that look like degrees,
/// a lock that its joint starts beyond, formulas that are faulty or not finite at the start, and parts that mechanisms
/// do not have.
Mechanism build_mechanism(const ModelDescription& description, const numerics::Parameters& parameters);

}  // namespace rubato::model
