#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/prepared_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>
#include <tuple>

// Laws with a memory in mechanisms: against structures with the same law, and against closed forms.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;

/// What a transient of a structure writes.
struct StructureStudy {
  explicit StructureStudy(const std::string& text) {
    const testing::PreparedStudy prepared(text);
    testing::QuietProgress progress;
    const std::atomic<bool> stop{false};
    analysis::RunContext context{sink, progress, stop};
    report = analysis::run_analysis(prepared.study.analyses.at(0), prepared.input(), context);
  }
  const testing::MemorySink::Table& rows() const { return sink.tables.at("run"); }

  testing::MemorySink sink;
  analysis::RunReport report;
};

const std::string bouc_wen = "stiffness = 20.0\npost_yield_ratio = 0.1\nA = 1.1\nbeta = 8.0\ngamma = 4.0\nn = 2\n";
const std::string load = "expression = \"1.5*sin(3*t)\"\n";
const std::string equal_steps = "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = 0.01\nduration = 5.0\n";
const std::string tight_steps =
    "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-6 }\nduration = 5.0\n"
    "output = { interval = 0.05 }\n";

std::string oscillator(double mass, const std::string& law, const std::string& analysis) {
  return "[[coordinate]]\nname = \"q\"\nmass = " + std::to_string(mass) + "\n" + law + "[[force]]\non = \"q\"\n" +
         load + analysis;
}

/// A body of 0.5 kg m2 that turns in a hinge, without gravity.
std::string turning(bool in_space, const std::string& law, const std::string& analysis) {
  const std::string z = in_space ? ", 0.0" : "";
  return std::string("[[body]]\nname = \"bar\"\nmass = 1.0\ninertia = ") + (in_space ? "[0.5, 0.5, 0.5]" : "0.5") +
         "\nposition = [0.0, 0.0" + z +
         "]\n[[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"ground\", \"bar\"]\nat = [0.0, 0.0" + z +
         "]\n" + (in_space ? "axis = [0.0, 0.0, 1.0]\n" : "") + law + "[[force]]\non = \"bar.rz\"\n" + load + analysis;
}

/// A block of 2 kg on a rail along y, under gravity.
std::string sliding(const std::string& law, const std::string& analysis, const std::string& keys = "") {
  return "[[body]]\nname = \"block\"\nmass = 2.0\ninertia = 0.1\nposition = [0.0, 0.0]\nvelocity = [0.0, 1.0]\n"
         "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\nat = [0.0, 0.0]\n"
         "axis = [0.0, 1.0]\n" +
         keys + "\n[gravity]\nacceleration = [0.0, -9.81]\n" + law + analysis;
}

/// The largest difference of a column of a mechanism from one of a structure, row by row.
double apart(const testing::MemorySink::Table& mechanism, std::size_t column,
             const testing::MemorySink::Table& structure, std::size_t other) {
  EXPECT_EQ(mechanism.rows.size(), structure.rows.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(mechanism.rows.size(), structure.rows.size()); ++i)
    largest = std::max(largest, std::abs(mechanism.rows[i][column] - structure.rows[i][other]));
  return largest;
}

// A structure starts with another auxiliary acceleration, of second order in the step: errors are those of the
// tolerance.
TEST(LawInAMechanism, OfAHingeIsTheOscillatorWithTheSameLaw) {
  const StructureStudy expected(
      oscillator(0.5, "[[bouc_wen]]\nname = \"foot\"\nbetween = [\"q\", \"ground\"]\n" + bouc_wen, tight_steps));
  for (const std::string where : {"joint = \"hinge\"\n", "between = [\"bar.rz\", \"ground\"]\n"})
    for (const bool in_space : {false, true}) {
      if (in_space && where.find("between") == 0) continue;
      const MechanismStudy ran(turning(in_space, "[[bouc_wen]]\nname = \"foot\"\n" + where + bouc_wen, tight_steps));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const auto& rows = ran.table("run");
      for (const auto& [of_mechanism, of_structure] :
           {std::pair{"moment", "force"}, {"angle", "displacement"}, {"dissipated", "dissipated"}})
        EXPECT_LT(apart(rows, rows.column(of_mechanism, "foot"), expected.rows(),
                        expected.rows().column(of_structure, "foot")),
                  1e-6)
            << of_mechanism;
      EXPECT_GT(std::abs(ran.last("run", "dissipated", "foot")), 0.05);
    }
}

// Without a shift of the auxiliary acceleration the two start alike: what is left is Newton's tolerance.
TEST(LawInAMechanism, TakesTheStepsOfTheOscillatorWithTheSameLaw) {
  const std::string steps = equal_steps + "method = \"average_acceleration\"\n";
  const std::string body =
      "[[body]]\nname = \"bar\"\nmass = 1.0\ninertia = 0.5\nposition = [0.0, 0.0]\n[[force]]\non = \"bar.rz\"\n" + load;
  for (const std::string& law :
       {"[[bouc_wen]]\nname = \"s\"\n" + bouc_wen,
        std::string("[[nonlinear_spring]]\nname = \"s\"\nforce = \"30*u + 500*u^3 + 0.1*rate + sin(7*t)\"\n")}) {
    const StructureStudy expected(oscillator(0.5, law + "between = [\"q\", \"ground\"]\n", steps));
    const MechanismStudy ran(body + law + "between = [\"bar.rz\", \"ground\"]\n" + steps);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& rows = ran.table("run");
    for (const auto& [of_mechanism, of_structure] :
         {std::pair{"moment", "force"}, {"angle", "displacement"}, {"dissipated", "dissipated"}})
      EXPECT_LT(apart(rows, rows.column(of_mechanism, "s"), expected.rows(), expected.rows().column(of_structure, "s")),
                1e-7)
          << of_mechanism << law;
  }
}

// u = x_first - x_second, and -force acts on the first: the law between both ends the other way round turns its signs.
TEST(LawInAMechanism, BetweenCoordinatesActsOnTheFirstAgainstItsDisplacement) {
  const std::string law = "[[nonlinear_spring]]\nname = \"s\"\nforce = \"30*u + 5*u^2\"\n";
  const StructureStudy expected(oscillator(0.5, law + "between = [\"ground\", \"q\"]\n", tight_steps));
  const MechanismStudy ran(turning(false, law + "between = [\"ground\", \"bar.rz\"]\n", tight_steps));
  const auto& rows = ran.table("run");
  EXPECT_LT(apart(rows, rows.column("angle", "bar.rz"), expected.rows(), expected.rows().column("position", "q")),
            1e-6);
  EXPECT_LT(apart(rows, rows.column("moment", "s"), expected.rows(), expected.rows().column("force", "s")), 1e-5);
  EXPECT_LT(ran.at(10, "run", "angle", "s") * ran.at(10, "run", "angle", "bar.rz"), 0.0);
}

TEST(LawInAMechanism, SaysTheSpringOfItsJointInOtherWords) {
  const std::string keys = "displacement = 0.1\n", run = replaced(equal_steps, "5.0", "2.0");
  const MechanismStudy expected(sliding("", run, keys + "stiffness = 30.0\nrest = 0.0\ndamping = 0.5"));
  const MechanismStudy ran(
      sliding("[[nonlinear_spring]]\nname = \"s\"\njoint = \"rail\"\nforce = \"30*u + 0.5*rate\"\n", run, keys));
  const auto& rows = ran.table("run");
  for (const char* variable : {"position", "velocity", "acceleration"})
    EXPECT_LT(apart(rows, rows.column(variable, "block.y"), expected.table("run"),
                    expected.table("run").column(variable, "block.y")),
              1e-9)
        << variable;
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    EXPECT_NEAR(ran.at(i, "run", "force", "s"), -expected.at(i, "run", "law_force", "rail"), 1e-9);
}

TEST(LawInAMechanism, ClosesTheBalanceOfEnergy) {
  const std::string automatic =
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-6 }\n"
      "duration = 3.0\noutput = { interval = 0.05 }\n";
  for (const std::string law :
       {"[[bouc_wen]]\nname = \"s\"\njoint = \"rail\"\nstiffness = 200.0\npost_yield_ratio = 0.3\nbeta = 20.0\n"
        "gamma = 10.0\n",
        "[[nonlinear_spring]]\nname = \"s\"\nbetween = [\"block.y\", \"ground\"]\n"
        "force = \"50*u + 900*u^3 + 0.7*rate*abs(rate)\"\n"}) {
    const MechanismStudy ran(sliding(law, automatic));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    double most = 0.0;
    for (std::size_t i = 0; i < ran.table("run.energy").rows.size(); ++i)
      most = std::max(most, std::abs(ran.at(i, "run.energy", "residue")));
    EXPECT_LT(most, 2e-4) << law;
    EXPECT_GT(ran.last("run.energy", "law_dissipated"), 0.5);
    EXPECT_GT(ran.last("run.energy", "law_stored"), 0.1);
    EXPECT_NEAR(ran.last("run.energy", "law_dissipated"), ran.last("run", "dissipated", "s"), 1e-12);
  }
}

// z = 1 - exp(-u) in the direction of the way, of one that is loaded from its first state, with A = 1 and a limit of 1.
TEST(LawInAMechanism, SagsAsLoadingFromItsFirstStateSays) {
  const std::string law =
      "[[bouc_wen]]\nname = \"s\"\njoint = \"rail\"\nstiffness = 100.0\npost_yield_ratio = 0.2\n"
      "beta = 0.5\ngamma = 0.5\n";
  const std::string then =
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\ninitial = \"static\"\nstep = 0.01\n"
      "duration = 0.5\n";
  const MechanismStudy ran(sliding(law, "[[analysis]]\nname = \"sag\"\ntype = \"static\"\n" + then));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double u = ran.last("sag", "displacement", "s");
  EXPECT_NEAR(ran.last("sag", "force", "s"), -2.0 * 9.81, 1e-9);
  EXPECT_NEAR(20.0 * u - 80.0 * (1.0 - std::exp(u)), -2.0 * 9.81, 1e-9);
  EXPECT_NEAR(ran.last("sag", "position", "block.y"), u, 1e-14);
  // What it remembers of the way there goes on: at rest it stays.
  const std::string still = replaced(sliding(law, then), "velocity = [0.0, 1.0]\n", "");
  const MechanismStudy rests(still);
  ASSERT_EQ(rests.report.status, analysis::RunStatus::done) << rests.report.message;
  EXPECT_NEAR(rests.last("run", "position", "block.y"), u, 1e-10);
  EXPECT_NEAR(rests.last("run", "force", "s"), -2.0 * 9.81, 1e-8);
}

// omega^2 = (k + 3 k3 u^2)/m about the equilibrium, (alpha + (1 - alpha) A) k/m where nothing has moved.
TEST(LawInAMechanism, GivesModesItsTangent) {
  const std::string modes = "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n", about = "about = \"static\"\n";
  const std::string sag = "[[analysis]]\nname = \"sag\"\ntype = \"static\"\n";
  const std::string hard = "[[nonlinear_spring]]\nname = \"s\"\njoint = \"rail\"\nforce = \"30*u + 400*u^3\"\n";
  const double u = MechanismStudy(sliding(hard, sag)).last("sag", "displacement", "s");
  EXPECT_NEAR(MechanismStudy(sliding(hard, modes + about)).at(0, "modes", "angular_frequency"),
              std::sqrt((30.0 + 1200.0 * u * u) / 2.0), 1e-8);
  const std::string soft = "[[bouc_wen]]\nname = \"s\"\njoint = \"hinge\"\n" + bouc_wen;
  EXPECT_NEAR(MechanismStudy(turning(false, soft, modes)).at(0, "modes", "angular_frequency"),
              std::sqrt((0.1 + 0.9 * 1.1) * 20.0 / 0.5), 1e-9);
}

// Another body that reaches its stop again and again makes the march reject, locate and begin anew.
TEST(LawInAMechanism, RemembersAcrossRejectedStepsAndRestarts) {
  const std::string automatic =
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-7 }\n"
      "duration = 3.0\n";
  const std::string law = "[[bouc_wen]]\nname = \"foot\"\njoint = \"hinge\"\n" + bouc_wen;
  const std::string ball =
      "[[body]]\nname = \"ball\"\nmass = 0.5\ninertia = 0.01\nposition = [3.0, 0.0]\nvelocity = [0.0, 2.0]\n"
      "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"ball\"]\nat = [3.0, 0.0]\n"
      "axis = [0.0, 1.0]\nstiffness = 50.0\nlock = { at = 0.1, kind = \"stop\", stiffness = 3e3, damping = 2.0 }\n";
  const MechanismStudy alone(turning(false, law, automatic)), beside(turning(false, ball + law, automatic));
  ASSERT_EQ(beside.report.status, analysis::RunStatus::done) << beside.report.message;
  ASSERT_GT(beside.table("run.events").rows.size(), 2u);
  EXPECT_NEAR(beside.last("run", "angle", "bar.rz"), alone.last("run", "angle", "bar.rz"), 2e-6);
  EXPECT_NEAR(beside.last("run", "dissipated", "foot"), alone.last("run", "dissipated", "foot"), 2e-5);
}

// A coarse march that is asked for rows between its steps shows the law on its own curve there.
TEST(LawInAMechanism, IsShownBetweenStepsByWhatItRemembers) {
  const std::string law = "[[bouc_wen]]\nname = \"foot\"\njoint = \"hinge\"\n" + bouc_wen;
  const std::string between = equal_steps + "output = { interval = 0.007 }\n";
  const MechanismStudy coarse(turning(false, law, between));
  const MechanismStudy fine(turning(false, law, replaced(between, "0.01", "0.001")));
  const auto& rows = coarse.table("run");
  for (const char* variable : {"moment", "angle", "dissipated"})
    EXPECT_LT(apart(rows, rows.column(variable, "foot"), fine.table("run"), fine.table("run").column(variable, "foot")),
              1e-2)
        << variable;
  double residue = 0.0;
  for (std::size_t i = 0; i < coarse.table("run.energy").rows.size(); ++i)
    residue = std::max(residue, std::abs(coarse.at(i, "run.energy", "residue")));
  EXPECT_LT(residue, 2e-3);
}

// A force that swings with time alone in the law of a body that hardly moves: m a = -f(t) at every row.
TEST(LawInAMechanism, OfTimeSwingsBetweenStepsAsItsFormulaSays) {
  const MechanismStudy ran(turning(false,
                                   "[[nonlinear_spring]]\nname = \"s\"\njoint = \"hinge\"\n"
                                   "force = \"0.1*u + 2*sin(40*t) + (t > 2 ? 3 : 0)\"\n",
                                   replaced(equal_steps, "0.01", "0.02") + "output = { interval = 0.013 }\n"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (std::size_t i = 1; i < ran.table("run").rows.size(); ++i) {
    const double t = ran.at(i, "run", "time");
    if (std::abs(t - 2.0) < 0.05) continue;
    EXPECT_NEAR(0.5 * ran.at(i, "run", "angular_acceleration", "bar.rz"),
                1.5 * std::sin(3.0 * t) - ran.at(i, "run", "moment", "s"), 2e-3)
        << t;
  }
}

// The same jump in a law and in a load: both end a step there.
TEST(LawInAMechanism, EndsStepsWhereItsFormulaSwitches) {
  const std::string law = "[[nonlinear_spring]]\nname = \"s\"\njoint = \"hinge\"\nforce = \"10*u\"\n";
  const std::string in_the_law = replaced(law, "10*u", "10*u + (t > 2.003 ? 3 : 0)");
  const MechanismStudy ran(turning(false, in_the_law, equal_steps));
  const MechanismStudy expected(
      replaced(turning(false, law, equal_steps), "1.5*sin(3*t)", "1.5*sin(3*t) - (t > 2.003 ? 3 : 0)"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "angle", "bar.rz"), expected.last("run", "angle", "bar.rz"), 1e-9);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "bar.rz"), expected.last("run", "angular_velocity", "bar.rz"), 1e-8);
}

std::string refusal(const std::string& text) {
  try {
    const auto study = io::read_study_text(text, "study.toml");
    (void)model::build_mechanism(study.model, {});
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "nothing";
}

TEST(LawInAMechanism, IsRefusedByNameWhereItFindsNoCoordinate) {
  const auto law = [](const std::string& where) {
    return "[[bouc_wen]]\nname = \"foot\"\nstiffness = 1.0\n" + where + "\n";
  };
  EXPECT_THAT(refusal(turning(false, law("joint = \"hing\""), "\n")), HasSubstr("did you mean \"hinge\""));
  EXPECT_THAT(refusal(turning(true, law("between = [\"bar.rx\", \"ground\"]"), "\n")),
              HasSubstr("let the law act on a revolute joint"));
  EXPECT_THAT(refusal(turning(false, law("between = [\"bar.rz\", \"bar.x\"]"), "\n")),
              HasSubstr("joins a displacement [m] and a rotation [rad]"));
  EXPECT_THAT(refusal(replaced(turning(true, law("joint = \"hinge\""), "\n"), "revolute", "cylindrical")),
              HasSubstr("more than one coordinate free"));
  EXPECT_THAT(refusal(replaced(turning(false, law("joint = \"hinge\""), "\n"), "revolute", "rigid")),
              HasSubstr("no coordinate free; take a revolute"));
  EXPECT_THAT(refusal(replaced(turning(false, law("joint = \"hinge\""), "\n"), "foot", "hinge")),
              HasSubstr("has the name of a joint"));
}

TEST(LawInAMechanism, BetweenPlacesSeesTheirDisplacementFromTheConfigurationGiven) {
  for (const bool in_space : {false, true}) {
    const std::string z = in_space ? ", 1.0" : "", inertia = in_space ? "[0.1, 0.1, 0.1]" : "0.1";
    std::string text;
    for (const auto& [name, x, speed] : {std::tuple{"a", "2.0", "0.0"}, {"b", "5.0", "0.7"}})
      text += std::string("[[body]]\nname = \"") + name + "\"\nmass = 2.0\ninertia = " + inertia + "\nposition = [" +
              x + ", 3.0" + z + "]\nvelocity = [" + speed + ", 0.0" + (in_space ? ", 0.0" : "") + "]\n";
    const MechanismStudy ran(text +
                             "[[nonlinear_spring]]\nname = \"s\"\nbetween = [\"a.x\", \"b.x\"]\n"
                             "force = \"25*u\"\n" +
                             tight_steps);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    // Against each other they swing with omega^2 = 2 * 25/2.
    EXPECT_EQ(ran.at(0, "run", "displacement", "s"), 0.0);
    EXPECT_NEAR(ran.last("run", "displacement", "s"), -0.7 / 5.0 * std::sin(25.0), 1e-5);
    EXPECT_NEAR(ran.last("run", "position", "a.x"), 2.0 + 0.5 * (0.7 * 5.0 - 0.14 * std::sin(25.0)), 1e-5);
  }
}

// A strut without keys of its own is there for its law, which sees its length.
TEST(LawInAMechanism, OnAStrutSeesItsLength) {
  const std::string text =
      "[[node]]\nname = \"m\"\nposition = [3.0, 4.0]\nvelocity = [1.8, 2.4]\n[[mass]]\nnode = \"m\"\nmass = 2.0\n"
      "[[joint]]\nname = \"strut\"\ntype = \"strut\"\nbetween = [\"ground\", \"m\"]\nat = [0.0, 0.0]\n"
      "[[nonlinear_spring]]\nname = \"s\"\njoint = \"strut\"\nforce = \"72*(u - 5)\"\n"
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-6 }\nduration = 1.0\n";
  const MechanismStudy ran(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double length = 5.0 + 0.5 * std::sin(6.0);
  EXPECT_NEAR(ran.last("run", "displacement", "strut"), length, 1e-5);
  EXPECT_NEAR(ran.last("run", "displacement", "s"), ran.last("run", "displacement", "strut"), 1e-14);
}

}  // namespace
}  // namespace rubato
