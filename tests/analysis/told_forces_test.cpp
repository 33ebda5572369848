#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace rubato {
namespace {

using testing::MechanismStudy;

// Pins that begin to slip from rest: what the projection of given velocities left, 1e-18 rad/s, told the direction, and
// friction drove them in the first row.
TEST(ToldForces, OfPinsThatBeginToSlipAreAgainstTheMotion) {
  const MechanismStudy ran(R"(
[gravity]
acceleration = [0.06320175685553, 0.2088040454794, 0.1878118238121]

[[body]]
name = "b1"
position = [0.01028709214779, -0.01057106457868, 0.0250898594001]
mass = 2.5
inertia = [0.0002989805571629, 0.0004272937297207, 0.000371955715714]
rotation = [-1.487465163303, -0.7906743507209, 0.2840562385546]
velocity = [-0.00824311123587, -0.0484481887372, 0.07562273145014]
angular_velocity = [-1.441406278905, 0.2953795713216, 0.2678737501597]

[[body]]
name = "b2"
position = [0.02949971198598, -0.00910173625291, 0.04209753670474]
shape = { kind = "sphere", radius = 0.03028879543083, density = 8977.104150866 }
rotation = [1.733599849486, 0.2601000716431, 1.331596685589]

[[joint]]
name = "j1"
type = "rigid"
between = ["ground", "b1"]
at = [0.01257830246174, 0.008147051587627, 0.02731751940259]

[[joint]]
name = "joint 2"
type = "universal"
between = ["b1", "b2"]
at = [0.01462421844117, -0.01631807386143, 0.01981920626]
axis = [-0.5889049099586, -0.6637750650388, -0.4610788111152]
second_axis = [0.7675228971993, -0.2806063254963, -0.5763407779832]
friction = { coefficient = 0.070018886084, normal_load = "reaction", radius = 0.01641359331755 }

[[joint]]
name = "j3"
type = "strut"
between = ["b1", "ground"]
at = [-0.01255972098737, -0.006766876400686, 0.01256060311498]
to = [-0.004153658741767, -0.004220433497008, 0.01904013241803]
damping = 0.1770434940548

[[analysis]]
name = "start"
type = "transient"
duration = 0.1
method = { name = "generalized_alpha", rho_inf = 0.8 }
step = 0.001
output = { every = 10 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (const char* pin : {"joint 2.first", "joint 2.second"}) {
    const double first = ran.at(0, "start", "friction_moment", pin), next = ran.at(1, "start", "friction_moment", pin);
    EXPECT_NEAR(first, next, 0.01 * std::abs(next)) << pin;
  }
}

// The laws of a screw are of its angle; of its way along the axis a column told what the arms of its rows made of them.
TEST(ToldForces, OfTheLawOfAScrewAreMomentsAlone) {
  const MechanismStudy ran(R"(
[[body]]
name = "nut"
position = [0.3, 0.1, 0.0]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
[[joint]]
name = "thread"
type = "screw"
between = ["ground", "nut"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.3, 1.0]
lead = 0.2
stiffness = 5.0
rest = 0.4
[[analysis]]
name = "turning"
type = "transient"
duration = 0.1
step = 0.01
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& blocks = ran.table("turning").layout.blocks;
  const auto has = [&](const std::string& variable) {
    return std::any_of(blocks.begin(), blocks.end(), [&](const auto& block) { return block.variable == variable; });
  };
  EXPECT_TRUE(has("law_moment"));
  EXPECT_FALSE(has("law_force"));
  EXPECT_NEAR(ran.at(0, "turning", "law_moment", "thread"), 2.0, 1e-12);
}

}  // namespace
}  // namespace rubato
