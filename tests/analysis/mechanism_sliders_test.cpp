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

// Sliders of mechanisms, under loads that stay the same, follow t, or are the force of another part: against structures
// with the same parts, and against closed forms.
namespace rubato {
namespace {

using testing::automatic;
using testing::damped_steps;
using testing::equal_steps;
using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::TwoMasses;

const std::string by_time =
    "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\nfriction_coefficient = 0.3\n"
    "normal_load = \"3 + 5*sin(1.7*t)\"\n";
const std::string by_law =
    "[[nonlinear_spring]]\nname = \"press\"\nbetween = [\"Z\", \"ground\"]\nforce = \"3.15*u + 0.2*u^3\"\n"
    "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\nfriction_coefficient = 0.6\n"
    "normal_load = { law = \"press\" }\n";
const std::string across =
    testing::replaced(by_law, "u^3", "u^3 + 0.1*rate") +
    "[[slider]]\nname = \"third\"\nbetween = [\"X\", \"Z\"]\nstiffness = 2.0\nfriction_coefficient = 0.3\n"
    "normal_load = { law = \"press\" }\n";

void expect_same(const testing::MemorySink::Table& mechanism, const testing::MemorySink::Table& structure,
                 const std::vector<std::string>& sliders, double force, double within) {
  ASSERT_EQ(mechanism.rows.size(), structure.rows.size());
  for (const std::string& slider : sliders)
    for (const char* quantity : {"force", "displacement", "dissipated", "slip", "normal_force"}) {
      double largest = 0.0, apart = 0.0;
      for (std::size_t i = 0; i < mechanism.rows.size(); ++i) {
        const double a = mechanism.rows[i][mechanism.column(quantity, slider)];
        const double b = structure.rows[i][structure.column(quantity, slider)];
        apart = std::max(apart, std::abs(a - b));
        largest = std::max(largest, std::abs(b));
      }
      EXPECT_LT(apart, within * std::max(1.0, largest)) << quantity << " of " << slider;
      if (quantity == std::string("force")) {
        EXPECT_GT(largest, force) << slider;
      }
    }
}

// Both do the same steps, with the same laws: what is left is Newton's tolerance.
TEST(SliderOfAMechanism, TakesTheStepsOfTheStructure) {
  for (const std::string& parts : {by_time, by_law, across}) {
    const TwoMasses study{equal_steps, parts};
    const auto structure = testing::run_study(study.structure());
    const MechanismStudy ran(study.mechanism());
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    std::vector<std::string> sliders{"rub"};
    if (parts == across) sliders.emplace_back("third");
    expect_same(ran.table("run"), structure.tables.at("run"), sliders, 0.5, 1e-9);
    for (const char* account : {"law_stored", "law_dissipated"})
      EXPECT_NEAR(
          ran.last("run.energy", account),
          testing::value_of(structure, "run.energy", account, "", structure.tables.at("run.energy").rows.size() - 1),
          1e-8)
          << account;
    const auto& rows = ran.table("run");
    bool opens = false;
    for (const auto& row : rows.rows) opens = opens || row[rows.column("normal_force", "rub")] == 0.0;
    EXPECT_TRUE(opens);
  }
}

TEST(SliderOfAMechanism, UnderAConstantLoadIsTheSliderOfTheStructure) {
  const std::string slider =
      "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"Z\"]\nstiffness = 7.2\nfriction_coefficient = 0.3\n"
      "normal_load = 4.0\n";
  const TwoMasses study{equal_steps, slider};
  const auto structure = testing::run_study(study.structure()).tables.at("run");
  const MechanismStudy ran(study.mechanism());
  const auto& rows = ran.table("run");
  ASSERT_EQ(rows.rows.size(), structure.rows.size());
  double apart = 0.0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    for (const char* quantity : {"force", "slip"})
      apart = std::max(apart, std::abs(rows.rows[i][rows.column(quantity, "rub")] -
                                       structure.rows[i][structure.column(quantity, "rub")]));
  EXPECT_LT(apart, 1e-9);
  EXPECT_EQ(ran.last("run", "normal_force", "rub"), 4.0);
}

// A prismatic joint leaves free what is between its two ends: -f acts on the second part of the joint.
TEST(SliderOfAMechanism, OnAJointIsTheSliderBetweenItsEnds) {
  const std::string rail =
      "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"x\"]\nat = [0.0, 0.0]\naxis = [1.0, "
      "0.0]\n";
  for (const std::string& parts : {by_time, by_law}) {
    const MechanismStudy between(TwoMasses{damped_steps, rail + parts}.mechanism());
    const MechanismStudy on(
        TwoMasses{damped_steps, rail + testing::replaced(parts, "between = [\"X\", \"ground\"]", "joint = \"rail\"")}
            .mechanism());
    ASSERT_EQ(on.report.status, analysis::RunStatus::done) << on.report.message;
    expect_same(on.table("run"), between.table("run"), {"rub"}, 0.5, 1e-11);
  }
}

TEST(SliderOfAMechanism, OnAHingeIsThatOfAnAngle) {
  const std::string rest = "stiffness = 7.2\nfriction_coefficient = 0.3\nnormal_load = 4.0\n" + damped_steps;
  const auto force = [](const std::string& on) {
    return "force = [{ on = \"" + on + "\", expression = \"4*sin(1.3*t) + 0.5\" }]\nspring = [{ between = [\"" + on +
           "\", \"ground\"], stiffness = 3.5 }]\n";
  };
  const auto structure = testing::run_study("coordinate = [{ name = \"x\", mass = 0.8 }]\n" + force("x") +
                                            "[[slider]]\nname = \"rub\"\nbetween = [\"x\", \"ground\"]\n" + rest)
                             .tables.at("run");
  const MechanismStudy ran(
      "body = [{ name = \"wheel\", mass = 1.0, inertia = 0.8, position = [0.0, 0.0] }]\n"
      "joint = [{ name = \"pin\", type = \"revolute\", between = [\"ground\", \"wheel\"], at = [0.0, 0.0] }]\n" +
      force("wheel.rz") + "[[slider]]\nname = \"rub\"\njoint = \"pin\"\n" + rest);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run");
  ASSERT_EQ(rows.rows.size(), structure.rows.size());
  double apart = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    apart = std::max(apart, std::abs(rows.rows[i][rows.column("moment", "rub")] -
                                     structure.rows[i][structure.column("force", "rub")]));
    apart = std::max(apart, std::abs(rows.rows[i][rows.column("slip_angle", "rub")] -
                                     structure.rows[i][structure.column("slip", "rub")]));
    largest = std::max(largest, rows.rows[i][rows.column("moment", "rub")]);
  }
  EXPECT_LT(apart, 1e-9);
  EXPECT_NEAR(largest, 1.2, 1e-12);
  EXPECT_EQ(ran.last("run", "normal_force", "rub"), 4.0);
}

TEST(SliderOfAMechanism, KeepsTheToleranceOfAutomaticSteps) {
  for (const std::string& parts : {by_time, by_law})
    for (const char* events : {"", ", events = \"locate\""}) {
      const TwoMasses exact{automatic(1e-8), parts}, study{automatic(1e-5, events), parts};
      const auto structure = testing::run_study(exact.structure()).tables.at("run");
      const MechanismStudy ran(study.mechanism());
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const auto& rows = ran.table("run");
      ASSERT_EQ(rows.rows.size(), structure.rows.size());
      double apart = 0.0;
      for (std::size_t i = 0; i < rows.rows.size(); ++i)
        apart = std::max(apart, std::abs(rows.rows[i][rows.column("displacement", "rub")] -
                                         structure.rows[i][structure.column("displacement", "rub")]));
      EXPECT_LT(apart, 20e-5) << parts << events;
    }
}

// Steps end where the slider slips, sticks, opens and closes: both routes find the same times.
TEST(SliderOfAMechanism, EndsStepsWhereItChanges) {
  for (const std::string& parts : {by_time, by_law}) {
    const TwoMasses study{automatic(1e-6, ", events = \"locate\""), parts};
    const auto structure = testing::run_study(study.structure()).tables.at("run.events");
    const MechanismStudy ran(study.mechanism());
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& rows = ran.table("run.events");
    ASSERT_EQ(rows.rows.size(), structure.rows.size()) << parts;
    EXPECT_GT(rows.rows.size(), 8U);
    for (std::size_t i = 0; i < rows.rows.size(); ++i) {
      EXPECT_NEAR(rows.rows[i][rows.column("time", "")], structure.rows[i][structure.column("time", "")], 1e-4) << i;
      EXPECT_EQ(rows.rows[i][rows.column("event", "")], structure.rows[i][structure.column("event", "")]) << i;
    }
  }
}

// A stop of a joint presses while it is closed, as a [[stop]] does.
TEST(SliderOfAMechanism, IsPressedByTheStopOfAJoint) {
  const std::string slider = "stiffness = 7.2\nfriction_coefficient = 0.6\nnormal_load = { law = \"wall\" }\n";
  const TwoMasses structure{automatic(1e-8),
                            "[[stop]]\nname = \"wall\"\nbetween = [\"Z\", \"ground\"]\ngap = 0.2\nstiffness = 5.0\n"
                            "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\n" +
                                slider};
  const TwoMasses mechanism{
      automatic(1e-5),
      "[[joint]]\nname = \"wall\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"z\"]\nat = [0.0, 1.0]\naxis = [1.0, "
      "0.0]\nlock = { at = 0.2, kind = \"stop\", stiffness = 5.0 }\n"
      "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\n" +
          slider};
  const auto expected = testing::run_study(structure.structure()).tables.at("run");
  const MechanismStudy ran(mechanism.mechanism());
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run");
  double apart = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    apart = std::max(apart, std::abs(rows.rows[i][rows.column("displacement", "rub")] -
                                     expected.rows[i][expected.column("displacement", "rub")]));
    largest = std::max(largest, rows.rows[i][rows.column("normal_force", "rub")]);
  }
  EXPECT_LT(apart, 20e-5);
  EXPECT_GT(largest, 1.0);
}

TEST(SliderOfAMechanism, TellsItsEventsBesideThoseOfSeveralLocks) {
  const TwoMasses study{
      automatic(1e-5),
      by_time +
          "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"z\"]\nat = [0.0, "
          "1.0]\naxis = [1.0, 0.0]\nlock = [{ at = 0.2, kind = \"stop\", stiffness = 5.0 }, "
          "{ at = -0.4, kind = \"stop\", stiffness = 5.0 }]\n"};
  const MechanismStudy ran(study.mechanism());
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run.events");
  int of_slider = 0, of_locks = 0;
  double before = 0.0;
  for (const auto& row : rows.rows) {
    const bool is_slider = row[rows.column("joint", "")] == 2.0;
    (is_slider ? of_slider : of_locks) += 1;
    EXPECT_EQ(row[rows.column("lock", "")] == 0.0, is_slider);
    EXPECT_GE(row[rows.column("time", "")], before);
    before = row[rows.column("time", "")];
  }
  EXPECT_GT(of_slider, 5);
  EXPECT_GT(of_locks, 3);
}

TEST(SliderOfAMechanism, StandsWhereTheStructureDoes) {
  const std::string statics = "[[analysis]]\nname = \"run\"\ntype = \"static\"\n";
  for (const double mu : {0.2, 0.6, 3.0}) {
    const std::string parts = fmt::format(
        "[[nonlinear_spring]]\nname = \"press\"\nbetween = [\"Z\", \"ground\"]\nforce = \"3.15*u\"\n"
        "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\nfriction_coefficient = {}\n"
        "normal_load = {{ law = \"press\" }}\n",
        mu);
    const TwoMasses study{statics, parts,
                          "force = [{ on = \"X\", expression = \"7.0\" }, { on = \"Z\", expression = \"3.0\" }]\n"};
    const auto structure = testing::run_study(study.structure());
    const MechanismStudy ran(study.mechanism());
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double n = 3.15 * 3.0 / 5.15, x = std::max(7.0 / 10.7, (7.0 - mu * n) / 3.5);
    EXPECT_NEAR(ran.last("run", "displacement", "rub"), x, 1e-8);
    for (const char* quantity : {"force", "displacement", "slip", "normal_force"})
      EXPECT_NEAR(ran.last("run", quantity, "rub"), testing::value_of(structure, "run", quantity, "rub"), 1e-8)
          << quantity << mu;
  }
}

// A slider that sticks is its spring to small motions, one that is open is none; under the force of gravity the
// equilibrium slips, and from rest it goes on and comes back.
TEST(SliderOfAMechanism, GivesModesTheTangentOfItsBranch) {
  const auto frequency = [](const std::string& load, const std::string& about) {
    const TwoMasses study{"[[analysis]]\nname = \"run\"\ntype = \"modes\"\n" + about,
                          "[[nonlinear_spring]]\nname = \"press\"\nbetween = [\"Z\", \"ground\"]\nforce = \"3.15*u\"\n"
                          "[[slider]]\nname = \"rub\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\n"
                          "friction_coefficient = 0.6\nnormal_load = " +
                              load + "\n",
                          "force = [{ on = \"X\", expression = \"1.0\" }, { on = \"Z\", expression = \"3.0\" }]\n"};
    const MechanismStudy ran(study.mechanism());
    EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& rows = ran.table("run");
    std::vector<double> squares;
    for (const auto& row : rows.rows) squares.push_back(std::pow(row[rows.column("angular_frequency", "")], 2));
    return squares;
  };
  const auto has = [](const std::vector<double>& squares, double value) {
    return std::any_of(squares.begin(), squares.end(),
                       [&](double one) { return std::abs(one - value) < 1e-6 * value; });
  };
  const std::string statically = "about = \"static\"\n";
  EXPECT_TRUE(has(frequency("\"5 + t\"", ""), 3.5 + 7.2));
  EXPECT_TRUE(has(frequency("\"t - 1\"", ""), 3.5));
  EXPECT_TRUE(has(frequency("{ law = \"press\" }", statically), 10.7));
  EXPECT_TRUE(has(frequency("{ law = \"press\" }", statically), 5.15 / 1.5));
}

std::string refusal(const TwoMasses& study) {
  try {
    const MechanismStudy ran(study.mechanism());
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "nothing";
}

TEST(SliderOfAMechanism, IsRefusedByNameWhereNothingCanPress) {
  const auto slider = [](const std::string& name, const std::string& load) {
    return "[[slider]]\nname = \"" + name +
           "\"\nbetween = [\"X\", \"ground\"]\nstiffness = 7.2\nfriction_coefficient = 0.6\nnormal_load = " + load +
           "\n";
  };
  const auto rail = [](const std::string& lock) {
    return "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"z\"]\nat = [0.0, 1.0]\naxis = "
           "[1.0, 0.0]\n" +
           lock;
  };
  const auto said = [&](const std::string& parts) { return refusal({equal_steps, parts}); };
  EXPECT_THAT(said(slider("a", "{ law = \"b\" }") + slider("b", "{ law = \"a\" }")),
              HasSubstr("slider \"a\": the force of the slider \"b\" rubs, it does not press"));
  EXPECT_THAT(said(slider("a", "-1.0")), HasSubstr("normal_load must not be negative"));
  EXPECT_THAT(said(slider("a", "{ law = \"wall\" }")), HasSubstr("no law and no joint with a stop"));
  EXPECT_THAT(said(rail("") + slider("a", "{ law = \"rail\" }")), HasSubstr("which has no lock; give it lock"));
  EXPECT_THAT(said(rail("lock = { at = 0.2, kind = \"stop\" }\n") + slider("a", "{ law = \"rail\" }")),
              HasSubstr("whose stop has no stiffness"));
  EXPECT_THAT(
      said(rail("lock = { at = 0.2, kind = \"latch\", stiffness = 3.0 }\n") + slider("a", "{ law = \"rail\" }")),
      HasSubstr("whose lock is a latch"));
  EXPECT_THAT(said(slider("x", "1.0") + slider("x", "1.0")), HasSubstr("two sliders or laws are called \"x\""));
}

}  // namespace
}  // namespace rubato
