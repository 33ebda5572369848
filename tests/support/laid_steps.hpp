#pragma once

#include <support/laid_studies.hpp>

#include <gtest/gtest.h>

#include <string>
#include <tuple>

namespace rubato::testing {

/// The three kinds of steps of a mechanism: equal ones, and those of both controllers.
inline std::string step_of_kind(int kind, const std::string& equal, const std::string& tolerance) {
  if (kind == 0) return equal;
  return "{ tolerance = " + tolerance + (kind == 1 ? " }" : ", controller = \"cardona_cassano\" }");
}

/// A study in the plane and in space, with each of them.
class LaidWithSteps : public ::testing::TestWithParam<std::tuple<bool, int>> {
 public:
  static const Laid& laid() { return std::get<0>(GetParam()) ? in_space : in_plane; }
  static std::string run(double duration, const std::string& equal, const std::string& tolerance) {
    return transient(step_of_kind(std::get<1>(GetParam()), equal, tolerance), duration);
  }
  static auto all_of_them() { return ::testing::Combine(::testing::Bool(), ::testing::Values(0, 1, 2)); }
  static std::string name(const ::testing::TestParamInfo<std::tuple<bool, int>>& info) {
    const char* const names[] = {"equal_steps", "steps_of_its_own", "steps_of_the_paper"};
    return std::string(std::get<0>(info.param) ? "in_space_" : "in_the_plane_") + names[std::get<1>(info.param)];
  }
};

}  // namespace rubato::testing
