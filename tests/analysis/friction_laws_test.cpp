#include <rubato/analysis/run_study.hpp>

#include "support/mechanism_study.hpp"
#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

// Laws of friction and cables in studies: in structures and mechanisms, by equal and automatic steps.
namespace rubato::testing {
namespace {

struct Friction {
  std::string table, keys;
};
const Friction laws[] = {
    {"dahl", "stiffness = 20.0\nslip_force = 0.5\n"},
    {"smooth_friction", "friction_coefficient = 0.5\nnormal_load = 1.0\nvelocity = 0.05\n"},
    {"lugre",
     "bristle_stiffness = 20.0\nbristle_damping = 0.3\nviscous_damping = 0.1\ncoulomb_force = 0.4\n"
     "static_force = 0.6\nstribeck_velocity = 0.1\n"},
    {"iwan", "stiffness = 20.0\nslip_force = 0.5\nchi = -0.5\nbeta = 0.2\n"},
    {"bouc_wen", "stiffness = 20.0\nbeta = 20.0\ngamma = 15.0\ndegradation = { A = 0.02, nu = 0.2, eta = 0.1 }\n"},
    {"cable", "stiffness = 20.0\nlength = 0.01\n"}};

std::string law(const Friction& one, const std::string& where) {
  return "[[" + one.table + "]]\nname = \"rub\"\n" + where + one.keys;
}
const std::string load = "expression = \"1.5*sin(3*t)\"\n";
std::string oscillator(const std::string& part) {
  return "[[coordinate]]\nname = \"q\"\nmass = 0.5\n" + part + "[[force]]\non = \"q\"\n" + load;
}
const std::string spring = "[[spring]]\nbetween = [\"q\", \"ground\"]\nstiffness = 2.0\n";
std::string transient(const std::string& step, const std::string& keys = "") {
  return "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = " + step + "\nduration = 5.0\n" + keys;
}

double end_of(const MemorySink& sink, const std::string& variable, const std::string& label) {
  const auto& rows = sink.tables.at("run");
  return rows.rows.back().at(rows.column(variable, label));
}

TEST(FrictionLaws, AreOfSecondOrderAndKeepTheTolerance) {
  for (const Friction& one : laws) {
    SCOPED_TRACE(one.table);
    const std::string study = oscillator(spring + law(one, "between = [\"q\", \"ground\"]\n"));
    const auto end = [&](const std::string& step) {
      return end_of(run_study(study + transient(step)), "position", "q");
    };
    // Turns and kinks within steps scatter single ratios: the trend over a sixth to a tenth of the step.
    const double exact = end("0.00025");
    const double coarse = std::max(std::abs(end("0.02") - exact), std::abs(end("0.0125") - exact));
    EXPECT_GT(coarse, 8.0 * std::abs(end("0.002") - exact));
    for (const char* tolerance : {"1e-3", "1e-4", "1e-5"})
      EXPECT_NEAR(end(std::string("{ tolerance = ") + tolerance + " }"), exact, 3.0 * std::stod(tolerance))
          << tolerance;
  }
}

TEST(FrictionLaws, CloseTheLedgerOfEnergy) {
  for (const Friction& one : laws) {
    SCOPED_TRACE(one.table);
    const std::string study = oscillator(spring + law(one, "between = [\"q\", \"ground\"]\n"));
    const MemorySink sink = run_study(study + transient("{ tolerance = 1e-5 }"));
    const auto& ledger = sink.tables.at("run.energy");
    const auto& last = ledger.rows.back();
    const double residual = last.at(ledger.column("residue")), dissipated = last.at(ledger.column("law_dissipated"));
    EXPECT_LT(std::abs(residual), 3e-3);
    if (one.table == "cable") {
      EXPECT_EQ(dissipated, 0.0);
      continue;
    }
    EXPECT_GT(dissipated, 0.3);
    double before = 0.0;
    for (const auto& row : ledger.rows) {
      EXPECT_GE(row.at(ledger.column("law_dissipated")), before);
      before = row.at(ledger.column("law_dissipated"));
    }
  }
}

double apart(const MemorySink::Table& one, const MemorySink::Table& other, const char* of_mechanism,
             const char* of_structure) {
  EXPECT_EQ(one.rows.size(), other.rows.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(one.rows.size(), other.rows.size()); ++i)
    largest = std::max(largest, std::abs(one.rows[i][one.column(of_mechanism, "rub")] -
                                         other.rows[i][other.column(of_structure, "rub")]));
  return largest;
}

// A bar in a hinge, to the tolerance; and a body's own coordinate, where without a shift of the auxiliary acceleration
// both start alike, and what is left is Newton's tolerance.
TEST(FrictionLaws, OfAMechanismAreThoseOfAStructure) {
  const std::string bar =
      "[[body]]\nname = \"bar\"\nmass = 1.0\ninertia = 0.5\nposition = [0.0, 0.0]\n[[force]]\non = \"bar.rz\"\n" + load;
  const std::string hinge =
      "[[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"ground\", \"bar\"]\nat = [0.0, 0.0]\n";
  const std::string equal = transient("0.01", "method = \"average_acceleration\"\n");
  const std::string tight = transient("{ tolerance = 1e-6 }", "output = { interval = 0.05 }\n");
  for (const Friction& one : laws) {
    SCOPED_TRACE(one.table);
    const std::string of_structure = oscillator(law(one, "between = [\"q\", \"ground\"]\n"));
    const MemorySink equally = run_study(of_structure + equal), tightly = run_study(of_structure + tight);
    const MechanismStudy free(bar + law(one, "between = [\"bar.rz\", \"ground\"]\n") + equal);
    const MechanismStudy hinged(bar + hinge + law(one, "joint = \"hinge\"\n") + tight);
    ASSERT_EQ(free.report.status, analysis::RunStatus::done) << free.report.message;
    ASSERT_EQ(hinged.report.status, analysis::RunStatus::done) << hinged.report.message;
    for (const auto& [a, b] : {std::pair{"moment", "force"}, {"angle", "displacement"}, {"dissipated", "dissipated"}}) {
      EXPECT_LT(apart(free.table("run"), equally.tables.at("run"), a, b), 5e-7) << a;
      EXPECT_LT(apart(hinged.table("run"), tightly.tables.at("run"), a, b), 3e-5) << a;
    }
  }
}

// friction-family reference, section 10 (Canudas de Wit et al. 1995): a mass on a spring pulled at 0.1 m/s.
const std::string pulled = R"(
[[coordinate]]
name = "x"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 2.0
[[force]]
on = "x"
expression = "0.2*t"
[[lugre]]
name = "rub"
between = ["x", "ground"]
bristle_stiffness = 1e5
bristle_damping = 316.22776601683796
viscous_damping = 0.4
coulomb_force = 1.0
static_force = 1.5
stribeck_velocity = 0.001
)";

/// Times at which the mass starts to slip, with the extension of the spring, in the order of time.
std::vector<std::pair<double, double>> starts_of(const std::string& step) {
  const MemorySink sink =
      run_study(pulled + "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 22.0\nstep = " + step + "\n");
  const auto& table = sink.tables.at("run");
  const std::size_t x = table.column("position", "x"), v = table.column("velocity", "x");
  std::vector<std::pair<double, double>> starts;
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    const auto &before = table.rows[i - 1], &after = table.rows[i];
    if (!(before[v] < 0.05 && after[v] >= 0.05)) continue;
    const double share = (0.05 - before[v]) / (after[v] - before[v]);
    const double t = before[0] + share * (after[0] - before[0]);
    starts.emplace_back(t, 0.1 * t - before[x] - share * (after[x] - before[x]));
  }
  return starts;
}

TEST(LuGreInATransient, SticksAndSlipsWithThePeriodOfAStiffSolver) {
  // Of second order: 7.8e-5 at a step of 1 ms.
  const auto starts = starts_of("0.001");
  ASSERT_EQ(starts.size(), 3u);
  EXPECT_NEAR(starts[2].first - starts[1].first, 6.36271982107, 2e-4);
  EXPECT_NEAR(starts[2].second, 0.751382556688, 2e-5);
}

// One long step from rest may end in slip, long before the friction gives way: automatic steps did, and the mass
// slipped after 4 s instead of 6.4.
TEST(LuGreInATransient, DoesNotLetGoWithinALongStep) {
  for (const auto& [tolerance, allowed] : {std::pair{"1e-2", 0.1}, {"1e-3", 2e-2}, {"1e-4", 5e-3}}) {
    const auto starts = starts_of(std::string("{ tolerance = ") + tolerance + " }");
    ASSERT_EQ(starts.size(), 3u) << tolerance;
    EXPECT_NEAR(starts[2].first - starts[1].first, 6.36271982107, allowed) << tolerance;
    EXPECT_NEAR(starts[2].second, 0.751382556688, 0.1 * allowed) << tolerance;
  }
}

// A ball of 2 kg on a cable of 1.5 m that is hung up slack at 1.2 m: it falls freely until the cable is taut, and rests
// mg/k below.
TEST(CableInAMechanism, HoldsABallOnAStrut) {
  const auto study = [](double height) {
    return "[[body]]\nname = \"ball\"\nmass = 2.0\ninertia = 0.1\nposition = [0.0, " + std::to_string(-height) +
           "]\n[[joint]]\nname = \"line\"\ntype = \"strut\"\nbetween = [\"ground\", \"ball\"]\nat = [0.0, 0.0]\n"
           "to = [0.0, " +
           std::to_string(-height) +
           "]\nforce = 0\n[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"ball\"]\nat = "
           "[0.0, 0.0]\naxis = [0.0, 1.0]\n"
           "[gravity]\nacceleration = [0.0, -9.81]\n"
           "[[cable]]\nname = \"rope\"\njoint = \"line\"\nstiffness = 400.0\nlength = 1.5\n";
  };
  const MechanismStudy rest(study(1.6) + "[[analysis]]\nname = \"run\"\ntype = \"static\"\n");
  ASSERT_EQ(rest.report.status, analysis::RunStatus::done) << rest.report.message;
  EXPECT_NEAR(rest.last("run", "force", "rope"), 19.62, 1e-8);
  EXPECT_NEAR(rest.last("run", "position", "ball.y"), -1.5 - 19.62 / 400.0, 1e-10);

  const MechanismStudy fall(study(1.2) +
                            "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 1.0\n"
                            "step = { tolerance = 1e-6, events = \"locate\" }\noutput = { interval = 0.01 }\n");
  ASSERT_EQ(fall.report.status, analysis::RunStatus::done) << fall.report.message;
  // Taut at t1 with the speed g t1; then a vibration about 1.5 + mg/k, thrown up to where it is slack again.
  const double g = 9.81, t1 = std::sqrt(0.6 / g), w = std::sqrt(200.0), rest_at = 19.62 / 400.0;
  for (const double t : {0.1, 0.2, 0.28, 0.35}) {
    const double s = t - t1;
    const double y =
        t < t1 ? -1.2 - 0.5 * g * t * t : -1.5 - rest_at + rest_at * std::cos(w * s) - g * t1 / w * std::sin(w * s);
    EXPECT_NEAR(fall.at(static_cast<std::size_t>(std::lround(100 * t)), "run", "position", "ball.y"), y, 3e-6) << t;
  }
}

// Modes have the slopes where nothing has moved; static states load from rest: kT u - R u^1.5/0.75 = 0.61960853669
// at 1.
TEST(FrictionLaws, HaveStaticStatesAndModes) {
  const MemorySink sink = run_study(R"(
coordinate = [{ name = "m", mass = 1.0 }]
iwan = [{ name = "joint", between = ["m", "ground"], stiffness = 1.0, slip_force = 1.0, chi = -0.5, beta = 0.1 }]
force = [{ on = "m", amplitude = 0.61960853669, angular_frequency = 0 }]
[[analysis]]
name = "rest"
type = "static"
[[analysis]]
name = "modes"
type = "modes"
)");
  EXPECT_NEAR(value_of(sink, "rest", "position", "m"), 1.0, 1e-9);
  EXPECT_NEAR(value_of(sink, "modes", "angular_frequency"), 1.0, 1e-12);
}

}  // namespace
}  // namespace rubato::testing
