#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/mechanism_response.hpp"
#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"
#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <rubato/analysis/steady/damper_curve.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/optimum.hpp>

#include <cmath>
#include <string>

// Damper curves by harmonic balance, beside those on periodic orbits and beside dense frequency responses.
namespace rubato::testing {
namespace {

using namespace analysis;
using ::testing::HasSubstr;

const std::atomic<bool> never{false};

struct Curve {
  MemorySink sink;
  RunReport report;
  std::string name;
  const std::vector<std::vector<double>>& rows(const std::string& table = "") const {
    return sink.tables.at(table.empty() ? name : name + "." + table).rows;
  }
  double at(std::size_t row, const std::string& variable, const std::string& label = "",
            const std::string& table = "") const {
    return rows(table).at(row).at(sink.tables.at(table.empty() ? name : name + "." + table).column(variable, label));
  }
  double optimum(const std::string& variable, const std::string& label = "") const {
    return at(0, variable, label, "optimum");
  }
  Optimum::Kind kind() const { return static_cast<Optimum::Kind>(optimum("kind")); }
  PointStatus status(std::size_t row) const { return static_cast<PointStatus>(at(row, "status")); }
};

std::unique_ptr<Curve> run(const std::string& text) {
  const PreparedStudy prepared(text);
  auto result = std::make_unique<Curve>();
  QuietProgress progress;
  RunContext context{result->sink, progress, never, 1, nullptr};
  for (const auto& analysis : prepared.study.analyses) {
    result->name = analysis.name;
    if (const auto* curve = std::get_if<model::DamperCurveDescription>(&analysis.task)) {
      const auto plan = plan_damper_curve(analysis.name, analysis.where, *curve, prepared.input());
      result->report = run_damper_curve(analysis.name, plan, prepared.input(), damper_curve_solvers(plan), context);
    } else if (const auto* response = std::get_if<model::FrequencyResponseDescription>(&analysis.task)) {
      const auto plan = plan_frequency_response(analysis.name, analysis.where, *response, prepared.input());
      result->report =
          run_frequency_response(analysis.name, plan, prepared.input(), steady::steady_solvers(plan.route), context);
    }
  }
  return result;
}

std::string curve_of(const std::string& lines) {
  return "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"N0\"\n" + lines;
}

/// Two masses with a slider each, under loads of two orders.
std::string coupled_masses(const std::string& second_order = "0.3") {
  std::string text = "[parameters]\nN0 = 1.0\nOmega = 1.0\n";
  for (const auto& [name, mass] : {std::pair{"a", "1.0"}, {"b", "0.7"}})
    text += fmt::format(
        "[[coordinate]]\nname = \"{0}\"\nmass = {1}\n[[spring]]\nbetween = [\"{0}\", \"ground\"]\nstiffness = 1.0\n"
        "[[damper]]\nbetween = [\"{0}\", \"ground\"]\ndamping = 0.04\n",
        name, mass);
  text +=
      "[[spring]]\nbetween = [\"a\", \"b\"]\nstiffness = 0.4\n"
      "[[slider]]\nname = \"between\"\nbetween = [\"a\", \"b\"]\nstiffness = 0.8\nfriction_coefficient = 0.5\n"
      "normal_load = \"N0\"\n"
      "[[slider]]\nname = \"below\"\nbetween = [\"b\", \"ground\"]\nstiffness = 0.5\nfriction_coefficient = 0.2\n"
      "normal_load = \"N0\"\n"
      "[[force]]\non = \"a\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n";
  if (second_order != "0")
    text += "[[force]]\non = \"b\"\namplitude = " + second_order + "\nangular_frequency = \"3*Omega\"\n";
  return text;
}

constexpr const char* range = "range = [0.4, 0.8, 1.2, 1.8, 2.6]\nangular_frequency = { from = 0.6, to = 2 }\n";

// Both solvers, both objectives: every value, every peak and the optimum agree within the error told.
TEST(DamperCurveByBalance, AgreesWithPeriodicOrbitsWithinItsError) {
  for (const std::string objective : {"", "objective = \"dissipated\"\n"})
    for (const std::string load : {"0", "0.3"}) {
      const std::string text = coupled_masses(load) + curve_of(range + objective);
      const auto exact = run(text + "solver = \"periodic\"\n"), series = run(text + "solver = \"harmonic_balance\"\n");
      ASSERT_EQ(exact->rows().size(), series->rows().size());
      ASSERT_EQ(exact->rows("peaks").size(), series->rows("peaks").size()) << objective << load;
      for (std::size_t i = 0; i < exact->rows().size(); ++i) {
        EXPECT_EQ(series->status(i), PointStatus::converged);
        const double error = series->at(i, "error"), wanted = exact->at(i, "objective");
        EXPECT_LE(error, 1e-4);
        EXPECT_NEAR(series->at(i, "objective"), wanted, (objective.empty() ? 1.0 : 3.0) * error * wanted);
        EXPECT_NEAR(series->at(i, "angular_frequency"), exact->at(i, "angular_frequency"), 3e-4);
        for (const char* slider : {"between", "below"})
          EXPECT_NEAR(series->at(i, "dissipated", slider), exact->at(i, "dissipated", slider), 2e-3 * wanted);
      }
      for (std::size_t i = 0; i < exact->rows("peaks").size(); ++i) {
        const double height = exact->at(i, "objective", "", "peaks");
        const double checked = height > 0.15 * exact->optimum("objective") ? 3e-4 : 1e-2;
        EXPECT_NEAR(series->at(i, "objective", "", "peaks"), height, checked * height);
      }
      EXPECT_EQ(series->kind(), exact->kind());
      EXPECT_NEAR(series->optimum("objective"), exact->optimum("objective"), 2e-4 * exact->optimum("objective"));
      EXPECT_NEAR(series->optimum("N0"), exact->optimum("N0"), 5e-3 * exact->optimum("N0"));
      EXPECT_THAT(series->report.findings.at(0), HasSubstr("estimated error"));
    }
}

// Two peaks of one mass under two loads change places: their heights are equal there with either solver.
TEST(DamperCurveByBalance, FindsTheSameKink) {
  const std::string text =
      coupled_masses("0") + curve_of(
                                "range = { from = 0.2, to = 4, points = 9 }\n"
                                "angular_frequency = { from = 0.6, to = 2 }\nobserve = [\"a\", \"b\"]\n");
  const auto exact = run(text + "solver = \"periodic\"\n"), series = run(text + "solver = \"harmonic_balance\"\n");
  EXPECT_EQ(series->kind(), exact->kind());
  EXPECT_NEAR(series->optimum("N0"), exact->optimum("N0"), 2e-3 * exact->optimum("N0"));
  EXPECT_NEAR(series->optimum("derivative"), exact->optimum("derivative"), 2e-2);
}

/// The highest amplitude of a dense response, and where.
std::pair<double, double> highest(const Curve& response, const std::string& label) {
  std::pair<double, double> result{0.0, 0.0};
  for (std::size_t i = 0; i < response.rows().size(); ++i)
    if (const double amplitude = response.at(i, "amplitude", label); amplitude > result.first)
      result = {amplitude, response.at(i, "angular_frequency")};
  return result;
}

std::string response_of(const std::string& solver, const std::string& frequencies) {
  return "[[analysis]]\nname = \"response\"\ntype = \"frequency_response\"\nsolver = \"" + solver +
         "\"\nangular_frequency = " + frequencies + "\n";
}

std::string chain(int masses) {
  std::string text = "[parameters]\nN0 = 1.0\nOmega = 1.0\n";
  for (int i = 0; i < masses; ++i)
    text += fmt::format(
        "[[coordinate]]\nname = \"m{0}\"\nmass = 1.0\n[[spring]]\nbetween = [\"m{0}\", \"{1}\"]\nstiffness = 1e5\n"
        "[[damper]]\nbetween = [\"m{0}\", \"{1}\"]\ndamping = 300.0\n",
        i, i == 0 ? "ground" : fmt::format("m{}", i - 1));
  const int last = masses - 1;
  return text + fmt::format(
                    "[[slider]]\nname = \"tip\"\nbetween = [\"m{0}\", \"ground\"]\nstiffness = 200\n"
                    "friction_coefficient = 0.5\nnormal_load = \"N0\"\n"
                    "[[force]]\non = \"m{0}\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n",
                    last);
}

// Unless a solver is named it is chosen: small models by periodic orbits, large ones, which these refuse, by harmonic
// balance.
TEST(DamperCurveByBalance, TakesModelsOfAnySize) {
  const std::string frequencies = "angular_frequency = { from = 1, to = 2.6 }\n";
  const auto curve = run(chain(320) + curve_of("range = [1.0, 2.0, 3.0]\nobserve = \"m319\"\n" + frequencies));
  ASSERT_EQ(curve->rows().size(), 3u);
  EXPECT_THAT(curve->report.findings.back(), HasSubstr("320"));
  // A dense response at the same load is nowhere higher, and as high beside the peak.
  const double peak = curve->at(0, "objective"), at = curve->at(0, "angular_frequency");
  const auto dense = [&](double from, double to, int points) {
    const auto response =
        run(chain(320) +
            fmt::format("[[analysis]]\nname = \"dense\"\ntype = \"frequency_response\"\nsolver = "
                        "\"harmonic_balance\"\ntolerance = 1e-5\nobserve = \"m319\"\nangular_frequency = {{ from = {}, "
                        "to = {}, points = {} }}\n",
                        from, to, points));
    return highest(*response, "m319");
  };
  EXPECT_EQ(curve->status(0), PointStatus::converged);
  EXPECT_GE(peak, dense(1.0, 2.6, 200).first * (1.0 - 1e-4));
  const auto [height, place] = dense(at - 1e-3, at + 1e-3, 41);
  EXPECT_NEAR(peak, height, 1.1e-4 * height);
  EXPECT_NEAR(at, place, 1e-4);
}

/// The peak of each value against that of a dense response, and against a march there.
void expect_the_peaks_of_responses(const std::string& model, const std::string& label, double from, double to) {
  const auto curve = run(model + curve_of(fmt::format("range = [1.0, 1.6]\nangular_frequency = {{ from = {}, to = {} "
                                                      "}}\nobserve = [\"{}\"]\n",
                                                      from, to, label)));
  EXPECT_THAT(curve->report.findings.back(), HasSubstr("solved by harmonic_balance"));
  ASSERT_EQ(curve->status(0), PointStatus::converged);
  const double peak = curve->at(0, "objective"), at = curve->at(0, "angular_frequency"), error = curve->at(0, "error");
  EXPECT_LE(error, 1e-3);
  const auto dense =
      run(model + response_of("harmonic_balance", fmt::format("{{ from = {}, to = {}, points = 300 }}", from, to)));
  const auto near = run(model + response_of("harmonic_balance", fmt::format("{{ from = {}, to = {}, points = 41 }}",
                                                                            0.995 * at, 1.005 * at)));
  EXPECT_GE(peak, highest(*dense, label).first * (1.0 - 2e-3));
  const auto [height, place] = highest(*near, label);
  EXPECT_NEAR(peak, height, 2e-3 * height);
  EXPECT_NEAR(at, place, 1.3e-3 * place);
  const auto marched = run(model + response_of("time_marching", fmt::format("[{:.17g}]", at)));
  EXPECT_NEAR(marched->at(0, "amplitude", label), peak, 2.5e-3 * peak);
}

const std::string swinging_mass =
    "[parameters]\nN0 = 1.0\nOmega = 1.0\n[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
    "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 1.0\n"
    "[[damper]]\nbetween = [\"mass\", \"ground\"]\ndamping = 0.05\n"
    "[[force]]\non = \"mass\"\namplitude = 0.3\nangular_frequency = \"Omega\"\n";

TEST(DamperCurveByBalance, TakesLaws) {
  for (const std::string law :
       {"[[dahl]]\nname = \"pad\"\nbetween = [\"mass\", \"ground\"]\nslip_force = \"0.2*N0\"\nstiffness = 2.0\n",
        "[[nonlinear_spring]]\nname = \"pad\"\nbetween = [\"mass\", \"ground\"]\nforce = \"0.02*N0*u^3 + "
        "0.2*rate\"\n"}) {
    SCOPED_TRACE(law);
    expect_the_peaks_of_responses(swinging_mass + law, "mass", 0.6, 1.8);
  }
}

TEST(DamperCurveByBalance, TakesStops) {
  expect_the_peaks_of_responses(swinging_mass +
                                    "[[stop]]\nname = \"bumper\"\nbetween = [\"mass\", \"ground\"]\ngap = 0.0\n"
                                    "stiffness = \"2*N0\"\n",
                                "mass", 0.6, 2.0);
}

// A wedge that its load presses against contact planes of two blades.
TEST(DamperCurveByBalance, TakesContacts) {
  const std::string text = example("wedge-damper"),
                    model = replaced_everywhere(text.substr(0, text.find("[[analysis]]")), "amplitude = 3.0",
                                                "amplitude = 0.8");
  const std::string observe = "observe = [\"x1\"]\n";
  const auto curve = run(model +
                         "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"Fc\"\nrange = [4.0, "
                         "8.0]\noptimum = false\nangular_frequency = { from = 7.5, to = 9.5 }\n" +
                         observe);
  for (std::size_t row = 0; row < 2; ++row) {
    SCOPED_TRACE(row);
    ASSERT_EQ(curve->status(row), PointStatus::converged);
    const double peak = curve->at(row, "objective"), at = curve->at(row, "angular_frequency");
    const std::string loaded = replaced(model, "Fc = 6.0", fmt::format("Fc = {}", curve->at(row, "Fc")));
    const auto dense =
        run(loaded + response_of("harmonic_balance", "{ from = 7.5, to = 9.5, points = 101 }") + observe);
    const auto [height, place] = highest(*dense, "x1");
    EXPECT_NEAR(peak, height, 3e-3 * height);
    EXPECT_NEAR(at, place, 0.03);
    if (row > 0) continue;  // a march from rest settles at another of its responses
    const auto marched = run(loaded + response_of("time_marching", fmt::format("[{:.17g}]", at)) + observe);
    EXPECT_NEAR(marched->at(0, "amplitude", "x1"), peak, 2.5e-3 * peak);
    for (const char* contact : {"left", "right"})
      EXPECT_NEAR(marched->at(0, "dissipated", contact), curve->at(row, "dissipated", contact),
                  0.01 * curve->at(row, "dissipated", contact));
  }
}

// Carriages on rails are masses on springs, with a slider between them.
TEST(DamperCurveByBalance, TakesMechanismsAboutTheirEquilibrium) {
  const std::string start = "[parameters]\nN0 = 1.0\nOmega = 1.0\n",
                    rest =
                        "[[spring]]\nbetween = [\"a.x\", \"b.x\"]\nstiffness = 25.0\n"
                        "[[damper]]\nbetween = [\"a.x\", \"b.x\"]\ndamping = 0.2\n"
                        "[[slider]]\nname = \"pad\"\nbetween = [\"a.x\", \"b.x\"]\nstiffness = 30.0\n"
                        "friction_coefficient = 0.5\nnormal_load = \"N0\"\n"
                        "[[force]]\non = \"b.x\"\namplitude = 3.0\nangular_frequency = \"Omega\"\n" +
                        curve_of(
                            "range = [1.0, 3.0, 6.0, 10.0]\nangular_frequency = { from = 2.0, to = 12.0 }\n"
                            "observe = [\"b.x\"]\n"),
                    rails = R"(
[[body]]
name = "a"
mass = 2.0
inertia = 0.1
position = [0.0, 0.0]
[[body]]
name = "b"
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "rail_a"
type = "prismatic"
between = ["ground", "a"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
stiffness = 40.0
damping = 0.3
[[joint]]
name = "rail_b"
type = "prismatic"
between = ["ground", "b"]
at = [1.0, 0.0]
axis = [1.0, 0.0]
)",
                    masses = R"(
[[coordinate]]
name = "a.x"
mass = 2.0
[[coordinate]]
name = "b.x"
mass = 1.0
[[spring]]
between = ["a.x", "ground"]
stiffness = 40.0
[[damper]]
between = ["a.x", "ground"]
damping = 0.3
)";
  for (const std::string solver : {"", "solver = \"harmonic_balance\"\n"}) {
    const auto mechanism = run_mechanism_study(start + rails + rest + "about = \"static\"\n" + solver);
    const auto structure = run(start + masses + rest + solver);
    const auto expect_same = [&](const std::string& variable, const std::string& label, std::size_t row,
                                 double tolerance, const std::string& table = "") {
      const std::string of_mechanism = table.empty() ? "damper" : "damper." + table;
      EXPECT_NEAR(value_of(mechanism.sink, of_mechanism, variable, label, row),
                  structure->at(row, variable, label, table), tolerance)
          << variable << " " << row;
    };
    for (std::size_t row = 0; row < 4; ++row) {
      const double size = structure->at(row, "objective");
      expect_same("objective", "", row, 1.1e-3 * size);
      expect_same("angular_frequency", "", row, 5e-3);
      expect_same("dissipated", "pad", row, 1e-2 * size);
    }
    expect_same("N0", "", 0, 0.05, "optimum");
    expect_same("objective", "", 0, 1.1e-3, "optimum");
  }
}

// A pendulum without friction: J x'' + c x' + m g l x = F l cos(Omega t), and a warning where its turns are not small.
TEST(DamperCurveByBalance, TellsOfMechanismsThatTurnFar) {
  const auto curve = run_mechanism_study(
      swinging_bob +
      "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"F\"\nrange = [0.05, 1.0]\n"
      "angular_frequency = { from = 2.0, to = 5.0 }\nabout = \"static\"\nobserve = \"bob.rz\"\noptimum = false\n");
  const double l = 0.8, inertia = 1.5 * l * l + 0.02, stiffness = 1.5 * 9.81 * l, c = 0.35;
  const double highest = l / (c * std::sqrt(stiffness / inertia - 0.25 * c * c / (inertia * inertia)));
  EXPECT_NEAR(value_of(curve.sink, "damper", "objective", "", 0), 0.05 * highest, 1e-8 * highest);
  EXPECT_NEAR(value_of(curve.sink, "damper", "objective", "", 1), highest, 1e-7 * highest);
  ASSERT_EQ(curve.report.warnings.size(), 1u);
  EXPECT_THAT(curve.report.warnings[0], HasSubstr("at F = 1 "));
  EXPECT_THAT(curve.report.warnings[0], HasSubstr("\"bob.rz\" turns by"));
}

TEST(DamperCurveByBalance, RefusesPeriodicOrbitsOfLargeModelsAndToleranceOfThem) {
  const std::string lines = "range = [1.0, 2.0]\nangular_frequency = { from = 1, to = 2 }\nsolver = \"periodic\"\n";
  const auto fault = [](const std::string& text) -> std::string {
    try {
      (void)run(text);
    } catch (const InvalidInput& caught) {
      return caught.what();
    }
    return "none";
  };
  EXPECT_THAT(fault(chain(301) + curve_of(lines)), HasSubstr("take solver = \"harmonic_balance\""));
  EXPECT_THAT(fault(coupled_masses() + curve_of(lines + "tolerance = 1e-5\n")), HasSubstr("\"tolerance\" goes with"));
  EXPECT_THAT(fault(coupled_masses() + curve_of(lines + "about = \"static\"\n")), HasSubstr("is of mechanisms"));
}

// A hardening spring bends its resonance over, so that two responses are stable at many frequencies, and points fail
// with the orders that are held. What converges is one response: that of the peak, with its amplitude.
TEST(DamperCurveByBalance, TellsOneResponseWhereResonancesBendOver) {
  for (const std::string load : {"0.002", "0.3", "3"}) {
    const auto curve = run(fmt::format(R"toml(
coordinate = [{{ name = "x", mass = 1.0 }}, {{ name = "y", mass = 1.0 }}]
spring = [{{ between = ["x", "ground"], stiffness = 1.0 }}, {{ between = ["x", "y"], stiffness = 0.4 }},
          {{ between = ["y", "ground"], stiffness = 1.0 }}]
damper = [{{ between = ["x", "ground"], damping = 0.005 }}, {{ between = ["y", "ground"], damping = 0.005 }}]
nonlinear_spring = [{{ between = ["x", "ground"], force = "N0*u^3" }}]
force = [{{ on = "x", amplitude = {}, angular_frequency = "Om" }}]
[parameters]
Om = 1.0
N0 = 1.0
)toml",
                                       load) +
                           curve_of("range = { from = 0.01, to = 3, points = 9, spacing = \"log\" }\noptimum = false\n"
                                    "tolerance = 0.02\nangular_frequency = { from = 0.5, to = 4 }\n"));
    int converged = 0;
    for (std::size_t row = 0; row < curve->rows().size(); ++row) {
      if (curve->status(row) != PointStatus::converged) continue;
      ++converged;
      const double largest = std::max(curve->at(row, "amplitude", "x"), curve->at(row, "amplitude", "y"));
      EXPECT_NEAR(curve->at(row, "objective"), largest, 0.03 * largest) << load << ", row " << row;
    }
    if (load == "0.002") {
      EXPECT_GE(converged, 5);
    }
  }
}

}  // namespace
}  // namespace rubato::testing
