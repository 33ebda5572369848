#pragma once

#include <rubato/analysis/study_input.hpp>

#include <optional>
#include <string>

namespace rubato::analysis {

/// A warning where `modal_ratio` damps a motion not at all because laws alone resist it: the modes that it belongs to
/// are those of K without laws, and their frequency is zero there.
std::optional<std::string> warning_of_modal_damping(const StudyInput& input);

}  // namespace rubato::analysis
