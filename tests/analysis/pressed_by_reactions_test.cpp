#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// Sliders on joints, whose limit follows the force that a joint holds: against loads in numbers, the dry friction of
// the joints themselves, and closed forms.
namespace rubato {
namespace {

using testing::bar_on_pin;
using testing::block_in_guide;
using ::testing::HasSubstr;
using testing::in_plane;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

constexpr double gravity = 9.81, mass = 2.0, rise = 0.3;

class PressedByReactions : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, PressedByReactions, ::testing::Values(in_plane, testing::in_space),
                         [](const auto& info) { return testing::name_of_laid(info); });

std::string rub(const std::string& joint, double stiffness, double mu, const std::string& load) {
  return fmt::format(
      "[[slider]]\nname = \"rub\"\njoint = \"{}\"\nstiffness = {}\nfriction_coefficient = {}\nnormal_load = {}\n",
      joint, stiffness, mu, load);
}

double apart(const MechanismStudy& a, const MechanismStudy& b, const std::string& variable, const std::string& label) {
  const auto &one = a.table("run"), &other = b.table("run");
  EXPECT_EQ(one.rows.size(), other.rows.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(one.rows.size(), other.rows.size()); ++i)
    most = std::max(most,
                    std::abs(one.rows[i][one.column(variable, label)] - other.rows[i][other.column(variable, label)]));
  return most;
}

// What the guide holds does not change: both say the same in every step.
TEST_P(PressedByReactions, OnAnInclineAreThoseOfItsNormalForce) {
  const double normal = mass * gravity * std::cos(rise);
  for (const char* step : {"0.002", "{ tolerance = 1e-5 }"}) {
    const auto study = [&](const std::string& load) {
      return block_in_guide(GetParam(), rise, "stiffness = 300.0", 2.0) + rub("guide", 4000.0, 0.4, load) +
             GetParam().gravity() + transient(step, 1.5) + "output = { interval = 0.05 }\n";
    };
    const MechanismStudy ran(study("\"reaction\"")), given(study(fmt::format("{:.17g}", normal)));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_LT(apart(ran, given, "displacement", "rub"), 2e-5) << step;
    EXPECT_LT(apart(ran, given, "force", "rub"), 2e-2) << step;
    EXPECT_NEAR(ran.last("run", "normal_force", "rub"), normal, 1e-8) << step;
    EXPECT_NEAR(ran.last("run.energy", "law_dissipated"), given.last("run.energy", "law_dissipated"), 1e-4) << step;
    EXPECT_NEAR(ran.last("run.energy", "residue"), given.last("run.energy", "residue"), 1e-4) << step;
  }
}

// Each half swing of a block on a spring loses 2 mu N/k of its amplitude; what is left of kT takes its share of the
// stick at each turn.
TEST_P(PressedByReactions, RingDownByTheSameLengthEachHalfSwing) {
  const double stiffness = 300.0, mu = 0.1, normal = mass * gravity;
  const MechanismStudy ran(block_in_guide(GetParam(), 0.0, fmt::format("stiffness = {}", stiffness), 2.0) +
                           rub("guide", 1e6, mu, "\"reaction\"") + GetParam().gravity() +
                           transient("{ tolerance = 1e-6 }", 1.2));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run");
  std::vector<double> turns;
  const std::size_t u = rows.column("displacement", "rub");
  for (std::size_t i = 1; i + 1 < rows.rows.size(); ++i) {
    const double before = rows.rows[i - 1][u], now = rows.rows[i][u], after = rows.rows[i + 1][u];
    if ((now - before) * (after - now) < 0.0 && std::abs(now) > 0.01) turns.push_back(std::abs(now));
  }
  ASSERT_GE(turns.size(), 3U);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_NEAR(turns[i - 1] - turns[i], 2.0 * mu * normal / stiffness, 2e-4);
}

// The pin of a bar is pressed by its weight and by its swing; a stiff slider with mu times the radius as its
// coefficient is the dry friction of the pin, but for the little that its spring gives way.
TEST_P(PressedByReactions, OnAPinAreItsDryFrictionWhereTheSpringIsStiff) {
  const auto analysis =
      GetParam().gravity() + transient("{ tolerance = 1e-7 }", 2.0) + "output = { interval = 0.02 }\n";
  const MechanismStudy dry(
      bar_on_pin(GetParam(), "friction = { coefficient = 0.3, normal_load = \"reaction\", radius = 0.1 }") + analysis);
  ASSERT_EQ(dry.report.status, analysis::RunStatus::done) << dry.report.message;
  double last = 0.0;
  for (const double stiffness : {2e3, 2e4, 2e5}) {
    const MechanismStudy ran(bar_on_pin(GetParam(), "") + rub("pin", stiffness, 0.03, "\"reaction\"") + analysis);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto &one = ran.table("run"), &other = dry.table("run");
    ASSERT_EQ(one.rows.size(), other.rows.size());
    double most = 0.0;
    for (std::size_t i = 0; i < one.rows.size(); ++i)
      most = std::max(most,
                      std::abs(one.rows[i][one.column("angle", "rub")] - other.rows[i][other.column("angle", "pin")]));
    // Friction turns round over the stretch mu N radius/kT, for which a bar that turns takes a time of the root of
    // that.
    if (last > 0.0) {
      EXPECT_LT(most, 0.35 * last);
    }
    last = most;
    EXPECT_LT(most, 5e-3);
    EXPECT_LT(std::abs(ran.last("run.energy", "residue")), 1e-3 * 9.81);
    EXPECT_GT(ran.last("run.energy", "law_dissipated"), 1.0);
    EXPECT_NEAR(ran.last("run.energy", "law_dissipated"), dry.last("run.energy", "friction_dissipated"),
                0.05 * dry.last("run.energy", "friction_dissipated"));
  }
}

// Statics: a spring helps the block to stand where friction alone does not, tan(rise) > mu.
TEST_P(PressedByReactions, StandWhereTheLimitLets) {
  for (const double mu : {0.1, 0.5}) {
    const double stiffness = 50.0, pull = mass * gravity * std::sin(rise), normal = mass * gravity * std::cos(rise);
    const MechanismStudy ran(block_in_guide(GetParam(), rise, fmt::format("stiffness = {}", stiffness)) +
                             rub("guide", 4000.0, mu, "\"reaction\"") + GetParam().gravity() +
                             "[[analysis]]\nname = \"run\"\ntype = \"static\"\n");
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double friction = std::min(mu * normal, pull * 4000.0 / 4050.0);
    EXPECT_NEAR(ran.last("run", "force", "rub"), -friction, 1e-7) << mu;
    EXPECT_NEAR(ran.last("run", "displacement", "rub"), -(pull - friction) / stiffness, 1e-8) << mu;
    EXPECT_NEAR(ran.last("run", "normal_force", "rub"), normal, 1e-7);
  }
}

TEST_P(PressedByReactions, GiveModesTheirStiffnessWhileTheyStickOnly) {
  const auto study = [&](double mu) {
    return block_in_guide(GetParam(), rise, "stiffness = 50.0") + rub("guide", 4000.0, mu, "\"reaction\"") +
           GetParam().gravity() + "[[analysis]]\nname = \"run\"\ntype = \"modes\"\nabout = \"static\"\n";
  };
  const MechanismStudy ran(study(0.5));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "run", "angular_frequency"), std::sqrt(4050.0 / mass), 1e-6);
  EXPECT_THAT(verdict(study(0.1)), HasSubstr("slider \"rub\" is at the limit that a reaction sets"));
}

// Of another joint: the bar's pin presses on a slider of a guide beside it.
TEST(PressedByReaction, OfAnotherJointFollowsIt) {
  const auto study = [](const std::string& load) {
    return bar_on_pin(in_plane, "") +
           "[[body]]\nname = \"block\"\nmass = 1.5\ninertia = 0.2\nposition = [0.0, -3.0]\nvelocity = [1.0, 0.0]\n"
           "[[joint]]\nname = \"guide\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\nat = [0.0, "
           "-3.0]\naxis = [1.0, 0.0]\nstiffness = 40.0\n" +
           rub("guide", 500.0, 0.1, load) + in_plane.gravity() + transient("{ tolerance = 1e-6 }", 2.0) +
           "output = { interval = 0.1 }\n";
  };
  const MechanismStudy ran(study("{ law = \"pin.reaction\" }"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("run");
  double most = 0.0;
  for (const auto& row : rows.rows) {
    const double held = std::hypot(row[rows.column("reaction_x", "pin")], row[rows.column("reaction_y", "pin")]);
    EXPECT_NEAR(row[rows.column("normal_force", "rub")], held, 1e-6 * (1.0 + held));
    most = std::max(most, std::abs(row[rows.column("force", "rub")]) - 0.1 * held);
  }
  EXPECT_LT(most, 1e-3);
}

TEST(PressedByReaction, IsRefusedByNameWhereThereIsNone) {
  const auto said = [](const std::string& parts) {
    return verdict(block_in_guide(in_plane, rise, "stiffness = 50.0") + parts + transient("0.01", 0.1));
  };
  EXPECT_THAT(said("[[slider]]\nname = \"rub\"\nbetween = [\"block.x\", \"ground\"]\nstiffness = 1.0\n"
                   "friction_coefficient = 0.1\nnormal_load = \"reaction\"\n"),
              HasSubstr("say whose, with { law = \"JOINT.reaction\" }"));
  EXPECT_THAT(said(rub("guide", 1.0, 0.1, "{ law = \"guides.reaction\" }")),
              HasSubstr("the reaction of \"guides\", which is no joint; did you mean \"guide\"?"));
  EXPECT_THAT(said("[[joint]]\nname = \"rod\"\ntype = \"strut\"\nbetween = [\"ground\", \"block\"]\nat = [1.0, "
                   "1.0]\nforce = 0\n" +
                   rub("rod", 1.0, 0.1, "\"reaction\"")),
              HasSubstr("the reaction of the joint \"rod\", a strut; it holds no force by itself"));
  EXPECT_THAT(
      said("[[joint]]\nname = \"twin\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\nat = [0.0, "
           "0.0]\naxis = [" +
           fmt::format("{}, {}", std::cos(rise), std::sin(rise)) + "]\n" + rub("guide", 1.0, 0.1, "\"reaction\"")),
      HasSubstr("the slider \"rub\" follows a reaction that is not determined"));
}

// Over steps of nanoseconds, as locating takes them, multipliers are round-off: sliders opened in between, and forgot
// their force.
TEST(PressedByReaction, DoNotEndStepsAtTheirTransitions) {
  EXPECT_THAT(verdict(block_in_guide(in_plane, rise, "stiffness = 50.0") + rub("guide", 1000.0, 0.4, "\"reaction\"") +
                      transient("{ tolerance = 1e-7, events = \"locate\" }", 0.1)),
              HasSubstr("does not go with the slider \"rub\", which a reaction presses"));
}

}  // namespace
}  // namespace rubato
