#pragma once

#include <string>
#include <vector>

namespace rubato::io {

/// The JSON schema (draft 2020-12) of the study file, for completion and checks in editors; made of the fields that
/// model/fields declares.
std::string study_schema();

/// The keys of the study itself: its tables, its title and its parameters.
const std::vector<std::string>& study_keys();

}  // namespace rubato::io
