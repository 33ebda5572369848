#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/io/read_study.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace rubato::analysis {
namespace {

using Role = model::Role;

/// A parameter in every kind of quantity that a steady response tells apart.
const std::string study_text = R"study(
[parameters]
k = 100.0
c = 0.1
mu = 0.3
N = "2*k"
F = 1.0
w = 3.0
phi = 0.1
share = 1.0
h = 4.0
ratio = 0.01
idle = 1.0

[[coordinate]]
name = "tip"
mass = 1.0

[[spring]]
between = ["tip", "ground"]
stiffness = "k"

[[damper]]
between = ["tip", "ground"]
damping = "c"

[damping]
modal_ratio = ["ratio"]

[[slider]]
between = ["tip", "ground"]
stiffness = 50.0
friction_coefficient = "mu"
normal_load = "N"

[[force]]
on = "tip"
amplitude = "F"
frequency = "w"
phase = "phi"

[[force]]
on = "tip"
held = "h"

[base_motion]
expression = "0*F*sin(t)"
direction = { tip = "share" }

[[analysis]]
name = "rest"
type = "static"
)study";

struct Dependence {
  model::StudyDescription study = io::read_study_text(study_text, "study.toml", ".");
  numerics::Parameters values = model::evaluate_parameters(study.parameters);
  ParameterDependence dependence{study, values, {}};

  std::vector<Role> roles_of(const std::string& name) const {
    const auto named = [&](const auto& parameter) { return parameter.name == name; };
    const auto place = std::find_if(study.parameters.begin(), study.parameters.end(), named) - study.parameters.begin();
    std::vector<Role> roles;
    for (const Role role : {Role::structure, Role::load, Role::frequency, Role::limit})
      if (dependence.reaches(static_cast<std::size_t>(place), role)) roles.push_back(role);
    return roles;
  }
};

TEST(ParameterDependence, TellsMatricesLoadsFrequenciesAndLimitsApart) {
  const Dependence of;
  using Roles = std::vector<Role>;
  EXPECT_EQ(of.roles_of("c"), Roles{Role::structure});
  EXPECT_EQ(of.roles_of("ratio"), Roles{Role::structure});
  EXPECT_EQ(of.roles_of("share"), Roles{Role::structure});
  EXPECT_EQ(of.roles_of("mu"), Roles{Role::limit});
  EXPECT_EQ(of.roles_of("N"), Roles{Role::limit});
  EXPECT_EQ(of.roles_of("F"), Roles{Role::load});
  EXPECT_EQ(of.roles_of("phi"), Roles{Role::load});
  EXPECT_EQ(of.roles_of("w"), Roles{Role::frequency});
}

TEST(ParameterDependence, FollowsAParameterThroughTheFormulaOfAnother) {
  const Dependence of;
  EXPECT_EQ(of.roles_of("k"), (std::vector<Role>{Role::structure, Role::limit}));
}

TEST(ParameterDependence, FindsNothingThatAHeldForceWouldChangeInASteadyResponse) {
  const Dependence of;
  EXPECT_EQ(of.roles_of("h"), std::vector<Role>{});
  EXPECT_EQ(of.roles_of("idle"), std::vector<Role>{});
}

}  // namespace
}  // namespace rubato::analysis
