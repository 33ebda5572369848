#pragma once

#include <rubato/model/description.hpp>

#include <string>
#include <vector>

namespace rubato::model {

/// A value that can be computed with and is hardly meant.
struct DoubtfulValue {
  Location where;
  std::string message;
};

/// Values that no material has, as they come from other units: friction coefficients above 3 (in percent?), and elastic
/// moduli below those of gels (GPa or MPa instead of Pa): 1 kPa, or 1 MPa of what is denser than 1,500 kg/m3; and what
/// laws say of theirs.
std::vector<DoubtfulValue> doubtful_values(const ModelDescription& description, const numerics::Parameters& parameters);

}  // namespace rubato::model
