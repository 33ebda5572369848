#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/steel_strip.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// What the sections of beams carry.
namespace rubato {
namespace {

using testing::MechanismStudy;

/// The strip in equilibrium under a load that bends it by a millimetre, y of its section along y.
std::string bent_strip(bool in_space, const std::string& loads, const std::string& keys) {
  const std::string beam = "formulation = \"geometrically_exact\"\nelements = 4\n";
  return testing::strip(in_space ? beam + "orientation = [0.0, 1.0, 0.0]" : beam, "", in_space) + loads +
         "[[analysis]]\nname = \"bent\"\ntype = \"static\"\n" + keys + "\n";
}
std::string force(const std::string& on, double value) {
  return fmt::format("[[force]]\non = \"{}\"\nexpression = \"{}\"\n", on, value);
}

// The deflection shortens the lever by its square: 1e-6 of it.
constexpr double bent = 1e-5;

TEST(SectionForces, OfACantileverInThePlaneGrowTowardsItsClamp) {
  const MechanismStudy ran(bent_strip(false, force("b.y", 0.5) + force("b.x", 20.0), "section_forces = true"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (int i = 1; i <= 4; ++i) {
    const std::string part = fmt::format("arm({})", i);
    const double left = 1.0 - (i - 0.5) / 4.0;  // from the middle of the part to the load
    // The pull of 20 N straightens: it takes its lever about the load from the moment.
    const double lifted = ran.at(0, "bent", "position", "b.y") -
                          0.5 * (ran.at(0, "bent", "position", i == 4 ? "b.y" : fmt::format("arm:{}.y", i)) +
                                 (i == 1 ? 0.0 : ran.at(0, "bent", "position", fmt::format("arm:{}.y", i - 1))));
    EXPECT_NEAR(ran.at(0, "bent", "bending_moment", part), 0.5 * left - 20.0 * lifted, bent) << part;
    EXPECT_NEAR(ran.at(0, "bent", "normal_force", part), 20.0, 2e-3);  // 0.5 N over a slope of 2e-3
    EXPECT_NEAR(ran.at(0, "bent", "shear_force", part),
                0.5 - 20.0 * 0.5 *
                          (ran.at(0, "bent", "angle", i == 4 ? "b.rz" : fmt::format("arm:{}.rz", i)) +
                           (i == 1 ? 0.0 : ran.at(0, "bent", "angle", fmt::format("arm:{}.rz", i - 1)))),
                bent);
  }
}

TEST(SectionForces, OfACantileverInSpaceAreInTheAxesOfItsSection) {
  const MechanismStudy ran(bent_strip(true, force("b.y", 0.3) + force("b.z", 0.5) + force("b.rx", 0.02),
                                      "section_forces = [\"arm\"]\nobserve = \"b.z\""));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double turned = 0.02 * 1.0 / (2.1e11 / 2.6 * 1.4e-9);  // at most: the section's axes turn by the torsion
  for (int i = 1; i <= 4; ++i) {
    const std::string part = fmt::format("arm({})", i);
    const double left = 1.0 - (i - 0.5) / 4.0;
    EXPECT_NEAR(ran.at(0, "bent", "torsion", part), 0.02, 1e-3 * left);  // and what the deflections lend to it
    EXPECT_NEAR(ran.at(0, "bent", "bending_moment_z", part), 0.3 * left, turned * 0.5 * left);
    EXPECT_NEAR(ran.at(0, "bent", "bending_moment_y", part), -0.5 * left, turned * 0.3 * left);
    EXPECT_NEAR(ran.at(0, "bent", "shear_force_y", part), 0.3, turned);
    EXPECT_NEAR(ran.at(0, "bent", "shear_force_z", part), 0.5, turned);
    EXPECT_NEAR(ran.at(0, "bent", "normal_force", part), 0.0, 2e-3);
  }
}

// A mass of 2 kg on a rod without mass to speak of: what the rod carries, its damping included, is what slows the mass.
TEST(SectionForces, HoldWhatIsViscousToo) {
  const MechanismStudy ran(R"(
[[node]]
name = "a"
position = [0.0, 0.0]
[[node]]
name = "b"
position = [1.0, 0.0]
velocity = [1.0, 0.0]
[[support]]
node = "a"
fix = ["x", "y", "rz"]
[[mass]]
node = "b"
mass = 2.0
[[material]]
name = "rubber"
young = 1e6
poisson = 0.45
density = 1e-3
retardation_time = 0.02
[[section]]
name = "rod"
area = 1e-4
inertia = 1e-8
shear_factor = 0.83
[[beam]]
name = "rod"
nodes = ["a", "b"]
section = "rod"
material = "rubber"
formulation = "geometrically_exact"
elements = 1
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-4 }
duration = 0.5
section_forces = true
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run").rows;
  double viscous = 0.0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double carried = ran.at(row, "run", "normal_force", "rod(1)");
    EXPECT_NEAR(carried, -2.0 * ran.at(row, "run", "acceleration", "b.x"), 1e-5);
    viscous = std::max(viscous, std::abs(carried - 100.0 * (ran.at(row, "run", "position", "b.x") - 1.0)));
  }
  EXPECT_NEAR(viscous, 2.0, 1e-5);  // E A tau/L times 1 m/s at the start
}

TEST(SectionForces, AreRefusedWhereThereIsNoSuchBeam) {
  try {
    const MechanismStudy ran(bent_strip(false, "", "section_forces = [\"arn\"]"));
    ADD_FAILURE() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.where().line, 33) << error.what();
    EXPECT_NE(std::string(error.what()).find("did you mean \"arm\"?"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rubato
