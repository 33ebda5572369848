#pragma once

namespace rubato::io {

/// The JSON schema (draft 2020-12) of the study file, for completion and checks in editors.
const char* study_schema();

}  // namespace rubato::io
