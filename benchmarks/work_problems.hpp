#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace rubato::benchmarks {

/// What is marched with fixed and with automatic steps.
struct WorkProblem {
  enum class Kind { smooth, friction, rare_event };

  std::string name;
  Kind kind = Kind::smooth;
  bool is_linear = true;
  system::LocallyNonlinear system;
  system::State start;  ///< auxiliary acceleration that of equilibrium
  double duration = 0.0;
};

/// Those of the examples in a folder, and two made from them: the building without its dampers, and the building with
/// its dampers under a short blast instead of the ground motion. Throws InvalidInput.
std::vector<WorkProblem> work_problems(const std::filesystem::path& examples);

}  // namespace rubato::benchmarks
