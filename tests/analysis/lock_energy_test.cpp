#include <support/laid_studies.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// What a stop does to the energy of what strikes it, and beside the friction of its own joint.
namespace rubato {
namespace {

using testing::MechanismStudy;

// One kilogram meets a stop with a spring and a damper at 1 m/s. While it touches,
//   x = v/omega_d exp(-zeta omega t) sin(omega_d t),
// and its force vanishes at omega_d t = pi - 2 a, zeta = sin a, where the velocity is -v exp(-tan(a) (pi - 2 a)) and
// the spring still holds k x^2/2, which goes into the damper as both relax.
TEST(DampedStop, TakesWhatItsSpringHoldsAsItLetsGo) {
  const MechanismStudy ran(R"(
[[body]]
name = "block"
mass = 1.0
inertia = 0.1
position = [0.0, 0.0]
velocity = [1.0, 0.0]
[[joint]]
name = "way"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
lock = { at = 0.1, kind = "stop", stiffness = 1e4, damping = 100.0 }
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-6 }
duration = 0.3
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double omega = 100.0, a = std::asin(0.5), touching = std::numbers::pi - 2.0 * a;
  const double decay = std::exp(-std::tan(a) * touching);
  const double depth = decay / (omega * std::cos(a)) * std::sin(touching);
  const double held = 0.5 * 1e4 * depth * depth;
  ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
  EXPECT_NEAR(ran.at(1, "run.events", "time"), 0.1 + touching / (omega * std::cos(a)), 1e-6);
  // The ledger's trapezoidal rule over a hundred steps of the touch: 1e-5 of what the damper takes.
  EXPECT_NEAR(ran.at(1, "run.events", "energy_lost"), held, 2e-5);
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), 0.5 * decay * decay, 2e-5);
  EXPECT_NEAR(ran.last("run.energy", "strain"), 0.0, 1e-12);
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), held, 2e-5);
  EXPECT_NEAR(ran.last("run.energy", "damper_dissipated"), 0.5 - 0.5 * decay * decay - held, 4e-5);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 4e-5);
}

/// A block of 1.28 kg whose friction holds 0.2 N, driven against a rigid stop 1 m away; the force that drives it
/// changes at 1 s. Steps are exact for accelerations that are constant between events.
std::string stopped_block(const std::string& force_after) {
  return R"(
[[body]]
name = "block"
mass = 1.28
inertia = 0.3
position = [0.0, 0.0]
[[joint]]
name = "way"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
lock = { at = 1.0, kind = "stop" }
friction = { coefficient = 0.2, preload = 1.0 }
force = "t < 1 ? 5 : )" +
         force_after + R"("
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-4 }
duration = 2.0
)";
}

// The stop and the friction would both hold the joint, and nothing tells which: the stop does while it presses, and
// then friction has its turn.
TEST(RigidStop, LeavesItsJointToFrictionAsItLetsGo) {
  const double rate = (5.0 - 0.2) / 1.28;
  for (const std::string force : {"-5", "-0.1", "0.1", "5"}) {
    const bool goes_back = force == "-5";
    const MechanismStudy ran(stopped_block(force));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_LT(ran.table("run").rows.size(), 500u) << force;
    EXPECT_NEAR(ran.at(0, "run.events", "time"), std::sqrt(2.0 / rate), 1e-9);
    EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), 4.8, 1e-8);
    EXPECT_NEAR(ran.last("run", "displacement", "way"), goes_back ? 1.0 - 0.5 * rate : 1.0, 1e-8) << force;
    EXPECT_NEAR(ran.last("run", "friction_force", "way"), goes_back ? 0.2 : force == "-0.1" ? 0.1 : 0.0, 1e-9) << force;
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), goes_back ? 0.2 * (1.0 + 0.5 * rate) : 0.2, 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
  }
}

// 5 N press the block of 2 kg onto its stop, but for 33 ms of each half second: while it rests steps are of 80 ms.
TEST(RigidStop, LetsGoWhereTheLoadPullsBetweenTwoSteps) {
  const MechanismStudy ran(
      testing::block_in_guide(testing::in_plane, 0.0, "displacement = -0.001\nlock = { at = 0.0, kind = \"stop\" }") +
      "[[force]]\non = \"block.x\"\nexpression = \"5 - 5.1*sin(12*t)\"\n" +
      testing::transient("{ tolerance = 1e-4 }", 4.0));
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 17u);  // it comes to the stop, and leaves it in each of eight periods
  for (std::size_t i = 1; i < events.rows.size(); i += 2)
    EXPECT_NEAR(events.rows[i][0], (std::asin(5.0 / 5.1) + static_cast<double>(i / 2) * 2.0 * std::numbers::pi) / 12.0,
                1e-8);
}

}  // namespace
}  // namespace rubato
