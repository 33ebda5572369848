#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/time_law.hpp>

#include <string>

// Private to the model floor.
namespace rubato::model {

/// A law of time with values for everything. Throws InvalidInput at its place.
/// @param part  "the force on \"blade1\"", for messages
TimeLaw build_law(const TimeLawDescription& description, const numerics::Parameters& parameters,
                  const std::string& part);

}  // namespace rubato::model
