#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/ran_study.hpp>
#include <support/two_masses.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

// Stops of mechanisms, between coordinates and on joints: against the same stops of structures, the locks of joints,
// and closed forms.
namespace rubato {
namespace {

using testing::automatic;
using testing::damped_steps;
using testing::equal_steps;
using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::TwoMasses;
using Table = testing::MemorySink::Table;

std::string stop(const std::string& where, const std::string& more) {
  return "[[stop]]\nname = \"wall\"\n" + where + "\n" + more + "\n";
}
const std::string between_both = "between = [\"X\", \"Z\"]", to_ground = "between = [\"Z\", \"ground\"]";
const std::string elastic = "gap = 0.2\nstiffness = 25.0", damped = elastic + "\ndamping = 0.4";
const std::string rail =
    "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"z\"]\nat = [0.0, 1.0]\naxis = [1.0, "
    "0.0]\n";

double apart(const Table& a, const Table& b, const std::string& variable, const std::string& label,
             const std::string& other = "") {
  EXPECT_EQ(a.rows.size(), b.rows.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i)
    most = std::max(most, std::abs(a.rows[i][a.column(variable, label)] -
                                   b.rows[i][b.column(variable, other.empty() ? label : other)]));
  return most;
}

double largest(const Table& of, const std::string& variable, const std::string& label) {
  double most = 0.0;
  for (const auto& row : of.rows) most = std::max(most, row[of.column(variable, label)]);
  return most;
}

TEST(StopOfAMechanism, IsTheStopOfTheStructure) {
  for (const std::string& where : {between_both, to_ground})
    for (const std::string& more : {elastic, damped}) {
      const TwoMasses exact{automatic(1e-8), stop(where, more)}, study{automatic(1e-6), stop(where, more)};
      const auto structure = testing::run_study(exact.structure());
      const MechanismStudy ran(study.mechanism());
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const Table &rows = ran.table("run"), &expected = structure.tables.at("run");
      EXPECT_LT(apart(rows, expected, "position", "x.x", "x"), 2e-5) << where << more;
      EXPECT_LT(apart(rows, expected, "penetration", "wall"), 2e-5) << where << more;
      EXPECT_LT(apart(rows, expected, "force", "wall"), 25.0 * 2e-5 + 0.4 * 2e-4) << where << more;
      EXPECT_GT(largest(rows, "force", "wall"), 1.0);
      const auto& energy = structure.tables.at("run.energy");
      for (const char* account : {"stop_stored", "stop_dissipated"})
        EXPECT_LT(apart(ran.table("run.energy"), energy, account, ""), 2e-4) << account << where << more;
      EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 1e-3);
      const Table &events = ran.table("run.events"), &expected_events = structure.tables.at("run.events");
      ASSERT_EQ(events.rows.size(), expected_events.rows.size()) << where << more;
      EXPECT_GT(events.rows.size(), 3U);
      for (std::size_t i = 0; i < events.rows.size(); ++i) {
        EXPECT_NEAR(events.rows[i][events.column("time", "")],
                    expected_events.rows[i][expected_events.column("time", "")], 1e-3)
            << i;
        EXPECT_EQ(events.rows[i][events.column("event", "")],
                  expected_events.rows[i][expected_events.column("event", "")]);
        EXPECT_NEAR(events.rows[i][events.column("energy_lost", "")],
                    expected_events.rows[i][expected_events.column("energy_lost", "")], 1e-4);
      }
    }
}

// The other end first, and the gap on the other side, is another stop; between the same ends it holds from there.
TEST(StopOfAMechanism, HoldsTheFirstOfItsEndsFromAbove) {
  const TwoMasses exact{automatic(1e-8), stop("between = [\"ground\", \"Z\"]", damped)};
  const TwoMasses study{automatic(1e-6), stop("between = [\"ground\", \"Z\"]", damped)};
  const auto structure = testing::run_study(exact.structure());
  const MechanismStudy ran(study.mechanism());
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_LT(apart(ran.table("run"), structure.tables.at("run"), "penetration", "wall"), 2e-5);
  EXPECT_GT(largest(ran.table("run"), "force", "wall"), 1.0);
}

// One law, said in three ways: they take the same steps.
TEST(StopOfAMechanism, IsTheLockOfItsJoint) {
  for (const std::string damping : {"", "damping = 0.4"})
    for (const std::string& analysis : {damped_steps, automatic(1e-5)}) {
      const std::string more = "gap = 0.2\nstiffness = 25.0\n" + damping;
      const std::string lock = fmt::format("lock = {{ at = 0.2, kind = \"stop\", stiffness = 25.0{}{} }}\n",
                                           damping.empty() ? "" : ", ", damping);
      const MechanismStudy locked(TwoMasses{analysis, rail + lock}.mechanism());
      ASSERT_EQ(locked.report.status, analysis::RunStatus::done) << locked.report.message;
      for (const char* where : {"joint = \"rail\"", "between = [\"Z\", \"ground\"]"}) {
        const MechanismStudy ran(TwoMasses{analysis, rail + stop(where, more)}.mechanism());
        ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
        EXPECT_LT(apart(ran.table("run"), locked.table("run"), "position", "z.x"), 1e-11) << where << damping;
        EXPECT_LT(apart(ran.table("run"), locked.table("run"), "position", "x.x"), 1e-11) << where << damping;
        const Table &energy = ran.table("run.energy"), &expected = locked.table("run.energy");
        const auto at_end = [](const Table& of, const char* account) { return of.rows.back()[of.column(account, "")]; };
        EXPECT_NEAR(at_end(energy, "stop_stored") + at_end(energy, "strain"), at_end(expected, "strain"), 1e-10);
        EXPECT_NEAR(at_end(energy, "stop_dissipated") + at_end(energy, "damper_dissipated"),
                    at_end(expected, "damper_dissipated") + at_end(expected, "lock_dissipated"), 1e-10);
      }
    }
}

TEST(StopOfAMechanism, StandsWhereTheStructureDoes) {
  for (const char* gap : {"0.2", "0.0", "-0.1", "3.0"})
    for (const char* push : {"4.0", "-4.0"}) {
      const std::string parts = stop("between = [\"Z\", \"X\"]", fmt::format("gap = {}\nstiffness = 25.0", gap));
      const TwoMasses study{
          "[[analysis]]\nname = \"run\"\ntype = \"static\"\n", parts,
          fmt::format("force = [{{ on = \"X\", expression = \"0.5\" }}, {{ on = \"Z\", expression = \"{}\" }}]\n",
                      push)};
      const auto structure = testing::run_study(study.structure());
      const MechanismStudy ran(study.mechanism());
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      for (const char* quantity : {"force", "penetration"})
        EXPECT_NEAR(ran.last("run", quantity, "wall"), testing::value_of(structure, "run", quantity, "wall"), 1e-8)
            << quantity << gap << push;
      EXPECT_NEAR(ran.last("run", "position", "z.x"), testing::value_of(structure, "run", "position", "z"), 1e-8);
    }
}

// A stop that is compressed as the run starts pushes from then on; one that its ends leave fast does not.
TEST(StopOfAMechanism, PushesFromTheStart) {
  for (const char* gap : {"-0.3", "0.0"}) {
    const std::string parts = stop(to_ground, fmt::format("gap = {}\nstiffness = 25.0\ndamping = 0.4", gap));
    const TwoMasses exact{automatic(1e-8), parts}, study{automatic(1e-6), parts};
    const auto structure = testing::run_study(exact.structure());
    const MechanismStudy ran(study.mechanism());
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_LT(apart(ran.table("run"), structure.tables.at("run"), "penetration", "wall"), 2e-5) << gap;
    EXPECT_LT(apart(ran.table("run"), structure.tables.at("run"), "position", "x.x", "x"), 2e-5) << gap;
    EXPECT_LT(apart(ran.table("run.energy"), structure.tables.at("run.energy"), "stop_dissipated", ""), 2e-4) << gap;
  }
}

TEST(StopOfAMechanism, GivesModesItsStiffnessWhereItIsClosed) {
  const auto squares = [](const std::string& more) {
    const MechanismStudy ran(
        TwoMasses{"[[analysis]]\nname = \"run\"\ntype = \"modes\"\n", stop(to_ground, more), ""}.mechanism());
    EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    std::vector<double> values;
    for (const auto& row : ran.table("run").rows)
      values.push_back(std::pow(row[ran.table("run").column("angular_frequency", "")], 2));
    return values;
  };
  const auto has = [](const std::vector<double>& values, double value) {
    return std::any_of(values.begin(), values.end(), [&](double one) { return std::abs(one - value) < 1e-6 * value; });
  };
  EXPECT_TRUE(has(squares("gap = -0.3\nstiffness = 25.0"), 27.0 / 1.5));
  EXPECT_TRUE(has(squares("gap = 0.3\nstiffness = 25.0"), 2.0 / 1.5));
}

TEST(StopOfAMechanism, PressesASlider) {
  const std::string slider =
      "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\nfriction_coefficient = 0.6\n"
      "normal_load = { law = \"wall\" }\n";
  for (const std::string& more : {elastic, damped}) {
    const std::string parts = stop(to_ground, more) + slider;
    const TwoMasses exact{automatic(1e-8), parts}, study{automatic(1e-5, ", events = \"locate\""), parts};
    const auto structure = testing::run_study(exact.structure());
    const MechanismStudy ran(study.mechanism());
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_LT(apart(ran.table("run"), structure.tables.at("run"), "displacement", "rub"), 20e-5) << more;
    EXPECT_LT(apart(ran.table("run"), structure.tables.at("run"), "force", "rub"), 200e-5) << more;
    EXPECT_GT(largest(ran.table("run"), "normal_force", "rub"), 1.0);
  }
}

// On an angle, and between rotations: a wheel against a stop turns back after half a period of both springs.
TEST(StopOfAMechanism, ActsOnAngles) {
  for (const std::string where : {"joint = \"pin\"", "between = [\"wheel.rz\", \"ground\"]"}) {
    const MechanismStudy ran(
        "body = [{ name = \"wheel\", mass = 1.0, inertia = 0.5, position = [0.0, 0.0], angular_velocity = 2.0 }]\n"
        "joint = [{ name = \"pin\", type = \"revolute\", between = [\"ground\", \"wheel\"], at = [0.0, 0.0] }]\n" +
        stop(where, "gap = 0.3\nstiffness = 18.0") + automatic(1e-7));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const Table& events = ran.table("run.events");
    ASSERT_EQ(events.rows.size(), 2U);
    const double closes = events.rows[0][events.column("time", "")], opens = events.rows[1][events.column("time", "")];
    EXPECT_NEAR(closes, 0.15, 1e-6);
    EXPECT_NEAR(opens - closes, std::acos(-1.0) / 6.0, 1e-5);
    EXPECT_NEAR(largest(ran.table("run"), "penetration_angle", "wall"), 2.0 / 6.0, 0.05);
    EXPECT_GT(largest(ran.table("run"), "moment", "wall"), 4.0);
  }
}

std::string refusal(const std::string& study) {
  try {
    const MechanismStudy ran(study);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "nothing";
}

TEST(StopOfAMechanism, IsRefusedByNameWhereItCannotAct) {
  const auto said = [](const std::string& parts) { return refusal(TwoMasses{equal_steps, parts}.mechanism()); };
  EXPECT_THAT(said(stop(to_ground, elastic) + stop(between_both, elastic)),
              HasSubstr("two stops or laws are called \"wall\""));
  EXPECT_THAT(said(stop("joint = \"rial\"", elastic) + rail),
              HasSubstr("stop \"wall\" acts on \"rial\", which is no joint; did you mean \"rail\"?"));
  EXPECT_THAT(said(stop("between = [\"X\", \"x.rz\"]", elastic)), HasSubstr("a displacement [m] and a rotation [rad]"));
  EXPECT_THAT(said(stop(to_ground, "gap = 0.1\nstiffness = 0.0")), HasSubstr("stiffness must be positive"));
  EXPECT_THROW(testing::run_study(TwoMasses{equal_steps, stop("joint = \"rail\"", elastic)}.structure()), InvalidInput);
}

}  // namespace
}  // namespace rubato
