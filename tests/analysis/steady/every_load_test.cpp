#include <rubato/core/error.hpp>

#include "support/steady_study.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

// Every kind of load is carried by every analysis, and means the same in each of them.
namespace rubato::analysis {
namespace {

using ::testing::HasSubstr;

using testing::marched;
using testing::response;
using testing::run_study;
using testing::settled;
using testing::Swing;
using testing::value_of;

struct Structure {
  std::string name, text, slider;            ///< damped so that 30 periods forget the start
  std::vector<std::string> observed, loads;  ///< each a load by itself
};

std::string harmonic(const std::string& amplitude, const std::string& rest = "") {
  return "amplitude = " + amplitude + "\nangular_frequency = \"Omega\"\n" + rest;
}

const std::string parameters = "[parameters]\nOmega = 3.0\nN0 = 1.0\n";

Structure lumped() {
  return {"coordinates",
          R"(
[[coordinate]]
name = "a"
mass = 2.0
[[coordinate]]
name = "b"
mass = 1.0
[[spring]]
between = ["a", "ground"]
stiffness = 30.0
[[spring]]
between = ["a", "b"]
stiffness = 20.0
[[damper]]
between = ["a", "ground"]
damping = 2.0
[[damper]]
between = ["a", "b"]
damping = 1.0
)",
          R"(
[[slider]]
name = "rub"
between = ["a", "ground"]
stiffness = 20.0
friction_coefficient = 0.3
normal_load = "N0"
)",
          {"a", "b"},
          {"[[force]]\non = \"b\"\n" + harmonic("2.0", "phase = 0.4\n"),
           "[[force]]\non = \"b\"\n" + harmonic("2.0") + "[[force]]\non = \"a\"\nexpression = \"1.5*N0\"\n",
           "[[force]]\non = \"b\"\n" + harmonic("2.0") + "[[force]]\non = \"b\"\namplitude = 1.5\nfrequency = 0.0\n",
           "[base_motion]\n" + harmonic("2.0"),
           "[base_motion]\nof = \"velocity\"\ndirection = { b = 1.0, a = 0.5 }\n" + harmonic("1.0"),
           "[base_motion]\nof = \"displacement\"\n" + harmonic("0.3", "phase = 1.0\n"),
           "[[force]]\non = \"a\"\n" + harmonic("1.0") + "[base_motion]\nexpression = \"0.7\"\n"}};
}

/// A cantilever with a mass at its tip, which also hangs on a truss.
Structure frame(bool in_space) {
  const auto point = [&](const std::string& x, const std::string& y) {
    return "position = [" + x + ", " + y + (in_space ? ", 0.0]\n" : "]\n");
  };
  const std::string all = in_space ? R"(["x", "y", "z", "rx", "ry", "rz"])" : R"(["x", "y", "rz"])";
  std::string text = "[[node]]\nname = \"foot\"\n" + point("0.0", "0.0") + "[[node]]\nname = \"tip\"\n" +
                     point("2.0", "0.0") + "[[node]]\nname = \"hook\"\n" + point("2.0", "3.0") + R"(
[[material]]
name = "soft"
young = 1e8
poisson = 0.3
density = 500.0
[[section]]
name = "bar"
area = 1e-2
)";
  text += in_space ? "inertia = [1e-6, 2e-6]\ntorsion = 1e-6\n" : "inertia = 1e-6\n";
  text += R"(
[[section]]
name = "wire"
area = 1e-7
[[beam]]
name = "arm"
nodes = ["foot", "tip"]
section = "bar"
material = "soft"
formulation = "euler_bernoulli"
[[truss]]
nodes = ["tip", "hook"]
section = "wire"
material = "soft"
[[mass]]
node = "tip"
mass = 1.0
[damping]
rayleigh = { mass = 0.6, stiffness = 0.0 }
)";
  text +=
      "[[support]]\nnode = \"hook\"\nfix = " + std::string(in_space ? R"(["x", "y", "z"])" : R"(["x", "y"])") + "\n";
  const std::string clamped = "[[support]]\nnode = \"foot\"\nfix = " + all + "\n";
  const std::string down = in_space ? "[0.0, -1.0, 0.3]" : "[0.0, -1.0]";
  const std::string ground =
      in_space ? "direction = { x = 0.3, y = 1.0, z = 0.5 }\n" : "direction = { x = 0.3, y = 1.0 }\n";
  const std::string wind = "[[distributed_force]]\non = \"arm\"\ndirection = " + down + "\n";
  Structure result{in_space ? "space" : "plane",
                   text,
                   R"(
[[slider]]
name = "rub"
between = ["tip.y", "ground"]
stiffness = 30.0
friction_coefficient = 1.0
normal_load = "N0"
)",
                   {"tip.x", "tip.y"},
                   {clamped + "[base_motion]\n" + ground + harmonic("1.0"),
                    clamped + "[base_motion]\nof = \"displacement\"\n" + ground + harmonic("0.1") +
                        "[gravity]\nacceleration = " + down + "\n",
                    clamped + wind + harmonic("3.0", "phase = 0.5\n"),
                    clamped + wind + harmonic("3.0") + wind + "expression = \"4.0\"\n",
                    clamped + "[[force]]\non = \"tip.y\"\n" + harmonic("5.0") + "[gravity]\nacceleration = " + down +
                        "\n" + wind + "amplitude = 2.0\nangular_frequency = 0.0\n"}};
  if (in_space) result.observed.emplace_back("tip.z");
  return result;
}

/// Matrices from files, which a test leaves in a folder of its own.
Structure matrices() {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "rubato_every_load";
  std::filesystem::create_directories(folder);
  const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n";
  const auto write = [&](const std::string& name, const std::string& entries) {
    std::ofstream(folder / name) << head << entries;
    return "\"" + (folder / name).string() + "\"\n";
  };
  return {"matrices",
          "[matrices]\nmass = " + write("m.mtx", "1 1 2\n2 1 0.3\n2 2 1\n") +
              "stiffness = " + write("k.mtx", "1 1 50\n2 1 -20\n2 2 20\n") +
              "damping = " + write("c.mtx", "1 1 3\n2 1 -1\n2 2 1\n") + "names = [\"a\", \"b\"]\n",
          R"(
[[slider]]
name = "rub"
between = ["a", "ground"]
stiffness = 20.0
friction_coefficient = 0.3
normal_load = "N0"
)",
          {"a", "b"},
          {"[[force]]\non = \"b\"\n" + harmonic("2.0") + "[[force]]\non = \"a\"\nexpression = \"1.5\"\n",
           "[base_motion]\n" + harmonic("2.0"),
           "[base_motion]\nof = \"velocity\"\ndirection = { b = 1.0 }\n" + harmonic("1.0")}};
}

// Steps of a 400th of the period err by (2 pi/400)^2/12 of the amplitude, 2e-5, and by the turning points that the
// return map misses within a step, of 1/400 of a period: less than 0.2 %. Harmonic balance and marching are asked for
// 0.1 %.
void expect_the_settled_transient(const Structure& structure, const std::string& load, bool with_slider) {
  SCOPED_TRACE(structure.name + (with_slider ? ", with a slider:\n" : ", linear:\n") + load);
  const auto sink = run_study(parameters + structure.text + (with_slider ? structure.slider : "") + load + marched +
                              response("periodic", "") + response("balance", "solver = \"harmonic_balance\"\n") +
                              response("marching", "solver = \"time_marching\"\n"));
  for (const std::string& observed : structure.observed) {
    const Swing swing = settled(sink, observed);
    const double scale = swing.amplitude + std::abs(swing.mean);
    if (observed == structure.observed[1]) {
      EXPECT_GT(swing.amplitude, 1e-3);
    }
    for (const char* solver : {"periodic", "balance", "marching"}) {
      SCOPED_TRACE(std::string(solver) + ", " + observed);
      EXPECT_NEAR(value_of(sink, solver, "amplitude", observed), swing.amplitude, 4e-3 * scale);
      EXPECT_NEAR(value_of(sink, solver, "mean", observed), swing.mean, 4e-3 * scale);
    }
  }
  if (with_slider) {
    EXPECT_GT(value_of(sink, "periodic", "slip_share", "rub"), 0.0);
  }
}

class EveryLoad : public ::testing::TestWithParam<std::string> {
 protected:
  static Structure structure() {
    const std::string name = GetParam();
    if (name == "coordinates") return lumped();
    return name == "matrices" ? matrices() : frame(name == "space");
  }
};
INSTANTIATE_TEST_SUITE_P(Structures, EveryLoad, ::testing::Values("coordinates", "matrices", "plane", "space"),
                         [](const auto& kind) { return kind.param; });

TEST_P(EveryLoad, GivesTheResponseToWhichATransientSettles) {
  for (const std::string& load : structure().loads) expect_the_settled_transient(structure(), load, true);
}

TEST_P(EveryLoad, GivesTheResponseOfALinearStructureToWhichATransientSettles) {
  for (const std::string& load : structure().loads) expect_the_settled_transient(structure(), load, false);
}

// The worst frequency of a curve is a point of the response, which the tests above hold to transients.
TEST_P(EveryLoad, GivesTheDamperCurveThePeakOfTheResponse) {
  for (const std::string& load : structure().loads) {
    SCOPED_TRACE(load);
    const std::string text = parameters + structure().text + structure().slider + load;
    const std::string observe = "observe = [\"" + structure().observed[1] + "\"]\n";
    const auto curve =
        run_study(text + "[[analysis]]\nname = \"curve\"\ntype = \"damper_curve\"\nparameter = \"N0\"\n" +
                  "range = [1.0, 1.5]\nangular_frequency = { from = 2.9, to = 3.1, points = 3 }\n" +
                  "optimum = false\nsolver = \"periodic\"\n" + observe);
    const double at = value_of(curve, "curve", "angular_frequency"), peak = value_of(curve, "curve", "objective");
    EXPECT_GT(peak, 0.0);
    const auto sink = run_study(text + "[[analysis]]\nname = \"peak\"\ntype = \"frequency_response\"\n" + observe +
                                "angular_frequency = [" + fmt::format("{:.17g}", at) + "]\n");
    EXPECT_NEAR(value_of(sink, "peak", "amplitude", structure().observed[1]), peak, 1e-9 * peak);
  }
}

// A linear structure swings about its static state: what is harmonic here is nothing at t = 0.
TEST(StaticLoad, IsTheMeanOfALinearResponse) {
  for (const bool in_space : {false, true}) {
    const Structure structure = frame(in_space);
    const std::string down = in_space ? "[0.2, -1.0, 0.3]\n" : "[0.2, -1.0]\n";
    const std::string loads =
        std::string("[[support]]\nnode = \"foot\"\nfix = ") +
        (in_space ? R"(["x", "y", "z", "rx", "ry", "rz"])" : R"(["x", "y", "rz"])") +
        "\n[gravity]\nacceleration = " + down +
        "[[distributed_force]]\non = \"arm\"\nexpression = \"4\"\ndirection = " + down +
        "[[force]]\non = \"tip.y\"\nexpression = \"-2\"\n[base_motion]\ndirection = { y = 1.0 }\n" +
        harmonic("3.0", "phase = \"-pi/2\"\n");
    const auto sink = run_study(parameters + structure.text + loads + response("response", "") +
                                "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
    for (const std::string& observed : structure.observed) {
      const double mean = value_of(sink, "response", "mean", observed);
      EXPECT_GT(std::abs(mean), 1e-6);
      EXPECT_NEAR(mean, value_of(sink, "rest", "position", observed), 1e-9 * std::abs(mean));
    }
  }
}

const std::string swinging_ground = R"(
[parameters]
Omega = 3.0
N0 = 1.0
a0 = 2.0
[[node]]
name = "n"
position = [0.0, 0.0]
[[mass]]
node = "n"
mass = 2.5
[[spring]]
between = ["n.x", "ground"]
stiffness = 30.0
[[spring]]
between = ["n.y", "ground"]
stiffness = 40.0
[[damper]]
between = ["n.x", "ground"]
damping = 0.8
[[damper]]
between = ["n.y", "ground"]
damping = 0.5
[[slider]]
name = "rub"
between = ["n.x", "ground"]
stiffness = 20.0
friction_coefficient = 1.0
normal_load = "N0"
)";
const std::string two_analyses = R"(
[[analysis]]
name = "response"
type = "frequency_response"
angular_frequency = [2.5, 3.0, 3.5]
sweep = { a0 = [1.0, 2.0] }
[[analysis]]
name = "curve"
type = "damper_curve"
parameter = "N0"
range = [0.5, 1.0, 2.0]
angular_frequency = { from = 2.0, to = 6.0 }
observe = ["n.x"]
solver = "periodic"
)";

void expect_the_same(const testing::MemorySink& one, const testing::MemorySink& other) {
  ASSERT_EQ(one.tables.size(), other.tables.size());
  for (const auto& [name, table] : one.tables) {
    const auto& rows = other.tables.at(name).rows;
    ASSERT_EQ(table.rows.size(), rows.size()) << name;
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (const auto& block : table.layout.blocks) {
        const bool is_number = block.categories.empty() && block.unit != "" && block.variable != "residual" &&
                               block.variable != "error" && block.variable != "iterations";
        for (std::size_t k = table.column(block.variable), last = k + block.width(); is_number && k < last; ++k)
          if (std::isnan(rows[i][k])) {
            EXPECT_TRUE(std::isnan(table.rows[i][k])) << name << " " << block.variable;
          } else {  // optima are placed to 1e-9
            EXPECT_NEAR(table.rows[i][k], rows[i][k], 1e-8 * std::abs(rows[i][k]) + 1e-10)
                << name << " " << block.variable;
          }
      }
  }
}

TEST(MotionOfTheGround, IsItsEquivalentForceOnTheNodesInEverySteadyResponse) {
  const auto force = [](const std::string& on, const std::string& amplitude) {
    return "[[force]]\non = \"" + on + "\"\namplitude = \"" + amplitude + "\"\nangular_frequency = \"Omega\"\n";
  };
  const auto ground = run_study(swinging_ground + "[base_motion]\namplitude = \"a0\"\nangular_frequency = \"Omega\"\n" +
                                "direction = { x = 1.0, y = 0.5 }\n" + two_analyses);
  const auto forces = run_study(swinging_ground + force("n.x", "-2.5*a0") + force("n.y", "-1.25*a0") + two_analyses);
  expect_the_same(ground, forces);
  const auto displaced =
      run_study(swinging_ground + "[base_motion]\nof = \"displacement\"\namplitude = \"-a0/Omega^2\"\n" +
                "angular_frequency = \"Omega\"\ndirection = { x = 1.0, y = 0.5 }\n" + two_analyses);
  expect_the_same(displaced, forces);
}

// Whatever a load is made of may follow a swept parameter, or the frequency itself.
TEST(SweptParameter, ReachesGravityDirectionsAndLawsOfEveryLoad) {
  const Structure plane = frame(false);
  const std::string loads = R"(
[gravity]
acceleration = ["0.2*g", "-g"]
[[distributed_force]]
on = "arm"
direction = ["0.1*d", "-d"]
amplitude = "p*Omega^2"
angular_frequency = "Omega"
phase = "0.3*p"
[base_motion]
of = "displacement"
amplitude = "b"
angular_frequency = "Omega"
direction = { x = "d", y = "1 + g" }
[[support]]
node = "foot"
fix = ["x", "y", "rz"]
)";
  const std::vector<std::pair<std::string, double>> start{{"g", 1.0}, {"d", 1.0}, {"p", 0.3}, {"b", 0.05}};
  const auto study = [&](const std::string& name, double value) {
    std::string text = "[parameters]\nOmega = 3.0\nN0 = 1.0\n";
    for (const auto& [parameter, given] : start)
      text += parameter + " = " + std::to_string(parameter == name ? value : given) + "\n";
    return text + plane.text + plane.slider + loads +
           "[[analysis]]\nname = \"response\"\ntype = \"frequency_response\"\n" +
           "angular_frequency = [2.0, 3.0]\nobserve = [\"tip.y\"]\n";
  };
  for (const auto& [name, given] : start) {
    SCOPED_TRACE(name);
    const std::string wide = study("", 0.0) + "sweep = { " + name + " = [" + std::to_string(given) + ", " +
                             std::to_string(1.7 * given) + "] }\n";
    const auto swept = run_study(wide), apart = run_study(study(name, 1.7 * given)), first = run_study(study("", 0.0));
    for (const char* variable : {"amplitude", "mean"})
      for (std::size_t row = 0; row < 2; ++row) {
        const double wanted = value_of(apart, "response", variable, "tip.y", row);
        EXPECT_NEAR(value_of(swept, "response", variable, "tip.y", row + 2), wanted, 1e-6 * std::abs(wanted));
        EXPECT_NEAR(value_of(swept, "response", variable, "tip.y", row),
                    value_of(first, "response", variable, "tip.y", row), 1e-6 * std::abs(wanted));
      }
    EXPECT_GT(
        std::abs(value_of(swept, "response", "amplitude", "tip.y", 2) -
                 value_of(swept, "response", "amplitude", "tip.y", 0)) +
            std::abs(value_of(swept, "response", "mean", "tip.y", 2) - value_of(swept, "response", "mean", "tip.y", 0)),
        1e-3);
  }
}

std::string refusal(const std::string& text) {
  try {
    (void)run_study(text);
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return "accepted";
}

TEST(LoadThatDoesNotRepeat, IsRefusedByEverySteadyResponseWithItsName) {
  const Structure plane = frame(false);
  const std::string foot = "[[support]]\nnode = \"foot\"\nfix = [\"x\", \"rz\"]\n",
                    drive = "[[force]]\non = \"tip.y\"\n" + harmonic("1.0");
  const std::vector<std::pair<std::string, std::string>> loads{
      {"[[force]]\non = \"tip.x\"\nexpression = \"sin(t)\"\n", "the force on \"tip.x\" is a formula of t"},
      {"[[distributed_force]]\non = \"arm\"\ndirection = [0.0, 1.0]\nexpression = \"t\"\n",
       "the distributed force on \"arm\" is a formula of t"},
      {"[base_motion]\ndirection = { x = 1.0 }\nexpression = \"t\"\n", "[base_motion] is a formula of t"},
      {"[[displacement]]\non = \"foot.y\"\nexpression = \"sin(t)\"\n",
       "the displacement of \"foot.y\" is a formula of t"}};
  const std::vector<std::string> analyses{
      response("periodic", ""), response("balance", "solver = \"harmonic_balance\"\n"),
      response("marching", "solver = \"time_marching\"\n"),
      "[[analysis]]\nname = \"curve\"\ntype = \"damper_curve\"\nparameter = \"N0\"\nrange = [1.0, 2.0]\n"
      "angular_frequency = { from = 2.0, to = 4.0 }\nobserve = [\"tip.y\"]\n"};
  for (const auto& [load, message] : loads)
    for (const std::string& analysis : analyses) {
      const std::string text = parameters + plane.text + plane.slider + foot + drive + load + analysis;
      EXPECT_THAT(refusal(text), HasSubstr(message + ": a steady response needs harmonic loads")) << load << analysis;
      EXPECT_THAT(refusal(text), HasSubstr("run a transient"));
    }
}

// m q'' + k q = 3 from rest: q = 3/k (1 - cos(w t)).
TEST(FormulaWithoutTime, IsAStaticLoadOfTheExactFlowAndOfMethodStudies) {
  const std::string mass = R"(
[[coordinate]]
name = "a"
mass = 2.0
[[spring]]
between = ["a", "ground"]
stiffness = 18.0
[[force]]
on = "a"
expression = "1.5*2"
[[analysis]]
name = "exact"
type = "transient"
method = "exact"
duration = 2.0
output = { interval = 0.5 }
[[analysis]]
name = "study"
type = "method_study"
methods = ["generalized_alpha"]
step = 0.01
duration = 1.0
)";
  const auto sink = run_study(mass);
  for (std::size_t i = 0; i <= 4; ++i) {
    const double t = 0.5 * static_cast<double>(i);
    EXPECT_NEAR(value_of(sink, "exact", "position", "a", i), 3.0 / 18.0 * (1.0 - std::cos(3.0 * t)), 1e-12);
  }
  EXPECT_NEAR(value_of(sink, "study", "observed_order"), 2.0, 0.1);
}

}  // namespace
}  // namespace rubato::analysis
