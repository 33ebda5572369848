#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/steady/damper_curve.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/optimum.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace rubato::testing {
namespace {

using namespace analysis;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Curve {
  MemorySink sink;
  RunReport report;
  const std::vector<std::vector<double>>& rows(const std::string& table = "") const {
    return sink.tables.at(table.empty() ? "damper" : "damper." + table).rows;
  }
  double at(std::size_t row, const std::string& variable, const std::string& label = "",
            const std::string& table = "") const {
    return rows(table).at(row).at(sink.tables.at(table.empty() ? "damper" : "damper." + table).column(variable, label));
  }
  double optimum(const std::string& variable, const std::string& label = "") const {
    return at(0, variable, label, "optimum");
  }
  Optimum::Kind kind() const { return static_cast<Optimum::Kind>(optimum("kind")); }
};

const std::atomic<bool> never{false};

std::unique_ptr<Curve> run(const PreparedStudy& prepared, int threads = 1, results::Journal* journal = nullptr,
                           const std::atomic<bool>& stop = never) {
  auto result = std::make_unique<Curve>();
  QuietProgress progress;
  RunContext context{result->sink, progress, stop, threads, journal};
  for (const auto& analysis : prepared.study.analyses)
    if (const auto* curve = std::get_if<model::DamperCurveDescription>(&analysis.task)) {
      const DamperCurvePlan plan = plan_damper_curve(analysis.name, analysis.where, *curve, prepared.input());
      result->report = run_damper_curve("damper", plan, prepared.input(), damper_curve_solvers(plan), context);
    }
  return result;
}

/// m = k = kT = f0 = 1, mu = 0.5; what is added goes into the analysis.
std::string one_mass(const std::string& lines, const std::string& damping = "0.1", const std::string& load = "\"N0\"") {
  return "[parameters]\nN0 = 1.0\nOmega = 1.0\nc = " + damping +
         "\nm = 1.0\n[[coordinate]]\nname = \"mass\"\nmass = \"m\"\n"
         "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 1.0\n"
         "[[damper]]\nbetween = [\"mass\", \"ground\"]\ndamping = \"c\"\n"
         "[[slider]]\nname = \"contact\"\nbetween = [\"mass\", \"ground\"]\nstiffness = 1.0\n"
         "friction_coefficient = 0.5\nnormal_load = " +
         load +
         "\n[[force]]\non = \"mass\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
         "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"N0\"\n" +
         lines;
}

const std::string usual = "range = [0, 0.5, 1, 2, 40]\nangular_frequency = { from = 0.5, to = 2 }\n";

/// Largest amplitude of m = f0 = 1 on a spring and a dashpot, and where it is.
struct LinearPeak {
  double k, c, m = 1.0;
  double place() const { return std::sqrt(k / m - 0.5 * c * c / (m * m)); }
  double height() const { return 1.0 / (c * std::sqrt(k / m - 0.25 * c * c / (m * m))); }
};

PreparedStudy example(const std::string& name, const numerics::Parameters& settings = {}) {
  std::ifstream file(std::string(RUBATO_EXAMPLES) + "/" + name + "/study.toml");
  std::stringstream text;
  text << file.rdbuf();
  return PreparedStudy(text.str(), settings);
}

TEST(DamperCurve, EndsInBothLinearLimits) {
  const auto curve = run(PreparedStudy(one_mass(usual)));
  EXPECT_EQ(curve->report.status, RunStatus::done);
  EXPECT_THAT(curve->report.warnings, IsEmpty());
  ASSERT_EQ(curve->rows().size(), 5u);
  const LinearPeak free{1.0, 0.1}, stuck{2.0, 0.1};
  // Without load nothing rubs; under 40 N the spring of the slider never reaches its limit.
  for (const auto& [row, limit] : {std::pair{0u, free}, std::pair{4u, stuck}}) {
    EXPECT_NEAR(curve->at(row, "angular_frequency"), limit.place(), 2e-9);
    EXPECT_NEAR(curve->at(row, "amplitude", "mass"), limit.height(), 1e-11);
    EXPECT_NEAR(curve->at(row, "dissipated", "contact"), 0.0, 1e-12);
  }
  ASSERT_EQ(curve->rows("linear").size(), 5u);
  for (std::size_t row = 0; row < 5; ++row) {
    EXPECT_NEAR(curve->at(row, "free_angular_frequency", "", "linear"), free.place(), 2e-9);
    EXPECT_NEAR(curve->at(row, "free_objective", "", "linear"), free.height(), 1e-11);
    EXPECT_NEAR(curve->at(row, "stuck_angular_frequency", "", "linear"), stuck.place(), 2e-9);
    EXPECT_NEAR(curve->at(row, "stuck_objective", "", "linear"), stuck.height(), 1e-11);
  }
}

TEST(DamperCurve, DissipatesAtThePeakWhatTheForceDoesBesidesTheDashpot) {
  const auto curve =
      run(PreparedStudy(one_mass("range = [0.6, 0.9, 1.2]\nangular_frequency = { from = 0.5, to = 2 }\n")));
  for (std::size_t row = 0; row < 3; ++row) {
    // While it slips both ways the loop is a parallelogram: 4 R (X - R/kT), R = mu N.
    const double limit = 0.5 * curve->at(row, "N0"), amplitude = curve->at(row, "amplitude", "mass");
    const double loop = 4.0 * limit * (amplitude - limit);
    EXPECT_NEAR(curve->at(row, "dissipated", "contact"), loop, 1e-10 * loop);
  }
}

// Reference page, section 4.
TEST(DamperCurve, HasTheOptimumOfTheThesisWithItsCertificate) {
  const auto curve = run(example("underplatform-damper"));
  EXPECT_EQ(curve->report.status, RunStatus::done);
  EXPECT_EQ(curve->kind(), Optimum::Kind::smooth);
  EXPECT_NEAR(curve->optimum("N0"), 34.7788, 5e-5);
  EXPECT_NEAR(curve->optimum("amplitude", "blade2"), 3.45279383277, 3.5e-8);
  EXPECT_NEAR(curve->optimum("angular_frequency"), 7.777456595, 7.8e-8);
  EXPECT_NEAR(curve->optimum("derivative"), 0.0, 1e-8);
  EXPECT_NEAR(curve->optimum("slope"), 0.0, 1e-6);
  EXPECT_GT(curve->optimum("curvature"), 0.0);
  EXPECT_THAT(curve->report.findings.at(0), HasSubstr("lowest amplitude 3.45279383 m at N0 = 34.77876"));
}

// At 20 N and above the slider sticks, and what presses it changes nothing; at 0.05 N it hardly brakes. All of these
// are far higher than the response with a slider that slips, and the stuck ones were taken for a flat optimum.
TEST(DamperCurve, HasItsOptimumWhereTheSliderSlipsThoughTheBestSamplesStick) {
  const std::string frequencies = "angular_frequency = { from = 0.5, to = 2 }\n";
  const auto fine = run(PreparedStudy(one_mass("range = { from = 0.1, to = 3, points = 30 }\n" + frequencies)));
  for (const std::string samples :
       {"[0.05, 20]", "[0.05, 25, 50, 75]", "[0.05, 15, 16, 17]", "[0.05, 17, 18, 19, 20]"}) {
    const auto curve = run(PreparedStudy(one_mass("range = " + samples + "\n" + frequencies)));
    EXPECT_EQ(curve->kind(), Optimum::Kind::smooth) << samples;
    EXPECT_NEAR(curve->optimum("N0"), fine->optimum("N0"), 1e-6) << samples;
    EXPECT_NEAR(curve->optimum("objective"), fine->optimum("objective"), 1e-10) << samples;
  }
}

TEST(DamperCurve, IsAsHighForTheSameDamperOnASpinningRotor) {
  // The load of the damper is m r speed^2 and the forces are the third engine order. Where the amplitude A(w, N) has
  // both derivatives zero, so has A(w, N(w, m)): at the mass whose load at that frequency is the best constant one.
  const auto rotor = run(example("rotor-speed"));
  EXPECT_NEAR(rotor->optimum("amplitude", "blade2"), 3.45279383277, 1e-7);
}

// Two oscillators of one height under forces p and 8/p^2: their peaks are equal at p = 2, where the derivatives are in
// the ratio 1 to -2.
TEST(DamperCurve, HasAKinkWhereTwoPeaksAreEqual) {
  const std::string text =
      "[parameters]\np = 1.0\nOmega = 1.0\n"
      "[[coordinate]]\nname = \"slow\"\nmass = 1.0\n[[coordinate]]\nname = \"fast\"\nmass = 0.25\n"
      "[[spring]]\nbetween = [\"slow\", \"ground\"]\nstiffness = 1.0\n"
      "[[spring]]\nbetween = [\"fast\", \"ground\"]\nstiffness = 1.0\n"
      "[[damper]]\nbetween = [\"slow\", \"ground\"]\ndamping = 0.1\n"
      "[[damper]]\nbetween = [\"fast\", \"ground\"]\ndamping = 0.05\n"
      "[[force]]\non = \"slow\"\namplitude = \"p\"\nangular_frequency = \"Omega\"\n"
      "[[force]]\non = \"fast\"\namplitude = \"8 / p^2\"\nangular_frequency = \"Omega\"\n"
      "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"p\"\n"
      "range = { from = 1, to = 4, points = 6 }\nangular_frequency = { from = 0.5, to = 3 }\n";
  const auto curve = run(PreparedStudy(text));
  EXPECT_EQ(curve->kind(), Optimum::Kind::kink);
  EXPECT_NEAR(curve->optimum("p"), 2.0, 1e-8);
  const LinearPeak slow{1.0, 0.1};
  EXPECT_NEAR(curve->optimum("objective"), 2.0 * slow.height(), 1e-8);
  EXPECT_NEAR(curve->optimum("other_objective"), 2.0 * slow.height(), 1e-8);
  EXPECT_NEAR(curve->optimum("derivative") / curve->optimum("other_derivative"),
              curve->optimum("largest") == 0.0 ? -0.5 : -2.0, 1e-6);
  EXPECT_NEAR(curve->optimum("multiplier") * curve->optimum("derivative") +
                  curve->optimum("other_multiplier") * curve->optimum("other_derivative"),
              0.0, 1e-10);
  // Both are followed all along: two numbers, the same at every value.
  ASSERT_EQ(curve->rows("peaks").size(), 12u);
  for (std::size_t row = 0; row < 12; ++row)
    EXPECT_EQ(curve->at(row, "peak", "", "peaks"), curve->at(row, "largest", "", "peaks") == 0.0 ? 2.0 : 1.0);
}

// Three sectors of unlike masses and springs, weakly coupled, with friction between neighbours.
std::string sectors(const std::string& points) {
  std::string text = "[parameters]\nN0 = 1.0\nOmega = 1.0\n";
  const auto joint = [&](const char* kind, const char* ends, const char* key, double value) {
    text += fmt::format("[[{}]]\nbetween = [{}]\n{} = {}\n", kind, ends, key, value);
  };
  const auto mass = [&](const char* name, double value, double stiffness) {
    text += fmt::format("[[coordinate]]\nname = \"{}\"\nmass = {}\n", name, value);
    joint("spring", fmt::format("\"{}\", \"ground\"", name).c_str(), "stiffness", stiffness);
    joint("damper", fmt::format("\"{}\", \"ground\"", name).c_str(), "damping", 0.02);
  };
  mass("a", 0.69182, 0.60512);
  mass("b", 0.95577, 1.3659);
  mass("c", 1.4108, 0.96104);
  for (const char* ends : {"\"a\", \"b\"", "\"b\", \"c\""}) {
    joint("spring", ends, "stiffness", 0.061641);
    joint("slider", ends, "stiffness", ends[1] == 'a' ? 0.57662 : 0.97064);
    text += "friction_coefficient = 1.0\nnormal_load = \"N0\"\n";
  }
  return text +
         "[[force]]\non = \"a\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
         "[[force]]\non = \"c\"\namplitude = 0.7\nangular_frequency = \"Omega\"\nphase = 2.0\n"
         "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"N0\"\noptimum = false\n"
         "range = [0.7663094323935531]\nobserve = [\"a\", \"c\"]\n"
         "angular_frequency = { from = 0.3, to = 4.0" +
         points + " }\n";
}

// The largest of 513 samples, refined; a curve of 17 without a coarse scan took the peak at 0.979 rad/s, 9.6 % lower.
TEST(DamperCurve, TakesTheHigherOfTwoPeaksThatAreClose) {
  const auto fine = run(PreparedStudy(sectors(", points = 513")));
  EXPECT_NEAR(fine->at(0, "objective"), 8.545361290, 1e-8);
  for (const std::string& points : {std::string(), std::string(", points = 33"), std::string(", points = 5")}) {
    const auto curve = run(PreparedStudy(sectors(points)));
    EXPECT_NEAR(curve->at(0, "objective"), fine->at(0, "objective"), 1e-8);
    EXPECT_NEAR(curve->at(0, "angular_frequency"), fine->at(0, "angular_frequency"), 1e-6);
  }
}

// A blade that lets its damper slip has its higher peak at 3.89 rad/s, between samples at 3.48 and 4.67. The sample
// that halves them, at 4.07, lies by chance on the cubic through the four around it, and tells nothing; its phase does.
// Without that the lower peak was taken, at 4.72 rad/s and 4 % below.
TEST(DamperCurve, TakesTheHigherOfTwoPeaksThoughTheAmplitudesOfItsSamplesLieOnACubic) {
  const auto blades = [](const std::string& objective, int points) {
    return fmt::format(
        "[parameters]\nN = 1.0\nOmega = 10.0\n"
        "[[coordinate]]\nname = \"root\"\nmass = 0.2510315\n[[coordinate]]\nname = \"tip\"\nmass = 0.1482578\n"
        "[[spring]]\nbetween = [\"ground\", \"root\"]\nstiffness = 5.1484073\n"
        "[[spring]]\nbetween = [\"tip\", \"root\"]\nstiffness = 12.111454\n"
        "[damping]\nrayleigh = {{ mass = 0.2398897116, stiffness = 0.0020564925694795825 }}\n"
        "[[slider]]\nname = \"damper\"\nbetween = [\"tip\", \"ground\"]\nstiffness = 12.448816715411999\n"
        "friction_coefficient = 0.3\nnormal_load = \"10.594155*N\"\n"
        "[[force]]\non = \"root\"\namplitude = 10.594154654699773\nangular_frequency = \"Omega\"\n"
        "[[analysis]]\nname = \"damper\"\ntype = \"damper_curve\"\nparameter = \"N\"\noptimum = false\n"
        "range = [2.6, 2.677214631623739]\n{}\n"
        "angular_frequency = {{ from = 3.20166, to = 26.6805, points = {} }}\n",
        objective, points);
  };
  for (const std::string objective : {"observe = [\"root\"]", "objective = \"dissipated\""}) {
    const auto fine = run(PreparedStudy(blades(objective, 129))), coarse = run(PreparedStudy(blades(objective, 17)));
    for (const std::size_t row : {0u, 1u}) {
      EXPECT_NEAR(coarse->at(row, "objective"), fine->at(row, "objective"), 1e-8) << objective;
      EXPECT_NEAR(coarse->at(row, "angular_frequency"), fine->at(row, "angular_frequency"), 1e-6) << objective;
    }
  }
}

TEST(DamperCurve, OfFrictionWorkHasItsOptimumWhereMostIsDissipated) {
  const auto curve =
      run(PreparedStudy(one_mass("range = { from = 0.1, to = 3, points = 12 }\nobjective = \"dissipated\"\n"
                                 "angular_frequency = { from = 0.5, to = 2 }\n")));
  EXPECT_EQ(curve->kind(), Optimum::Kind::smooth);
  EXPECT_LT(curve->optimum("curvature"), 0.0);
  for (std::size_t row = 0; row < 12; ++row) {
    EXPECT_NEAR(curve->at(row, "objective"), curve->at(row, "dissipated", "contact"), 1e-9);
    EXPECT_LT(curve->at(row, "objective"), curve->optimum("objective"));
  }
  EXPECT_THAT(curve->report.findings.at(0), HasSubstr("largest friction work"));
}

TEST(DamperCurve, OfAParameterThatChangesTheMassBuildsTheModelAnew) {
  const std::string text = one_mass("range = [0.5, 1, 2]\nangular_frequency = { from = 0.2, to = 3 }\n", "0.1", "0");
  std::string over_mass = text;
  over_mass.replace(over_mass.find("parameter = \"N0\""), 16, "parameter = \"m\"");
  const auto curve = run(PreparedStudy(over_mass));
  for (std::size_t row = 0; row < 3; ++row) {
    const LinearPeak free{1.0, 0.1, curve->at(row, "m")};
    EXPECT_NEAR(curve->at(row, "angular_frequency"), free.place(), 5e-9);
    EXPECT_NEAR(curve->at(row, "objective"), free.height(), 1e-10);
    EXPECT_NEAR(curve->at(row, "free_objective", "", "linear"), free.height(), 1e-10);
  }
}

// Without a dashpot friction bounds the response only where its work over a period, 4 R (X - R/kT), outgrows that of
// the force, pi f0 X: for R = mu N0 > pi/4, so N0 > 1.57.
TEST(DamperCurve, SaysWhereItIsInfinite) {
  const auto curve = run(PreparedStudy(one_mass(usual, "0")));
  EXPECT_EQ(curve->report.status, RunStatus::done);
  for (const std::size_t row : {0u, 1u, 2u}) {
    EXPECT_EQ(curve->at(row, "status"), static_cast<double>(PointStatus::unbounded));
    EXPECT_EQ(curve->at(row, "objective"), HUGE_VAL);
    EXPECT_NEAR(curve->at(row, "angular_frequency"), 1.0, 1e-12);
  }
  EXPECT_EQ(curve->at(3, "status"), 0.0);
  // Nor is the stuck resonance, which has no dashpot either, infinite: at w^2 = 2 the mass slips beyond X = R/kT just
  // as far as to take pi f0 X.
  EXPECT_EQ(curve->at(4, "status"), 0.0);
  EXPECT_THAT(curve->report.warnings.at(0), HasSubstr("at N0 = 0 the loads meet a resonance without damping, or push "
                                                      "what nothing holds: the response is infinite"));
}

TEST(DamperCurve, WarnsOfPeaksAtTheEndOfTheFrequenciesAndOfLoadsThatPull) {
  const auto narrow = run(PreparedStudy(one_mass("range = [0.5, 1, 2]\nangular_frequency = { from = 1.5, to = 2 }\n")));
  EXPECT_THAT(narrow->report.warnings,
              ElementsAre("at N0 = 0.5 the largest lies at an end of the frequencies (3 values); widen them"));
  const auto pulled = run(PreparedStudy(
      one_mass("range = [0.5, 1, 2]\nangular_frequency = { from = 0.5, to = 2 }\n", "0.1", "\"N0 - 0.6\"")));
  EXPECT_THAT(
      pulled->report.warnings,
      ElementsAre("at N0 = 0.5 the normal load of slider \"contact\" is -0.1 N: it cannot be pulled, and counts "
                  "as 0 (1 value with negative loads)"));
}

TEST(DamperCurve, HasTheSameBitsForAnyNumberOfThreads) {
  const std::string lines =
      usual + "sweep = { samples = 12, parameters = { c = { distribution = \"uniform\", from = 0.05, to = 0.2 } } }\n";
  for (const std::string& text : {one_mass(usual), one_mass(lines)}) {
    const PreparedStudy prepared(text);
    const auto one = run(prepared, 1), two = run(prepared, 2), four = run(prepared, 4);
    for (const auto& [name, table] : one->sink.tables) {
      ASSERT_EQ(table.rows.size(), two->sink.tables.at(name).rows.size());
      for (std::size_t row = 0; row < table.rows.size(); ++row)
        for (std::size_t i = 0; i < table.rows[row].size(); ++i) {
          const double value = table.rows[row][i];
          for (const Curve* other : {two.get(), four.get()}) {
            const double same = other->sink.tables.at(name).rows[row][i];
            EXPECT_TRUE(value == same || (std::isnan(value) && std::isnan(same))) << name << " row " << row;
          }
        }
    }
  }
}

TEST(DamperCurve, OfRandomSamplesHasBandsAndAnOptimumOfEach) {
  const auto curve = run(PreparedStudy(one_mass(
      usual +
      "sweep = { samples = 21, parameters = { c = { distribution = \"uniform\", from = 0.05, to = 0.2 } } }\n")));
  EXPECT_EQ(curve->rows().size(), 21u * 5u);
  EXPECT_EQ(curve->rows("optimum").size(), 21u);
  ASSERT_EQ(curve->rows("bands").size(), 5u);
  // Without load the median over c is the peak of the median of c, since the peak falls with c. Latin hypercube: one
  // sample in each of 21 strata, the middle one within (0.15 / 21) of the median.
  const double median = curve->at(0, "objective_p50", "", "bands");
  const LinearPeak lower{1.0, 0.125 + 0.15 / 42}, upper{1.0, 0.125 - 0.15 / 42};
  EXPECT_GT(median, lower.height());
  EXPECT_LT(median, upper.height());
}

TEST(DamperCurve, IsDrawnAloneWhereNoOptimumIsWanted) {
  const auto with = run(PreparedStudy(one_mass(usual))),
             alone = run(PreparedStudy(one_mass(usual + "optimum = false\n")));
  EXPECT_EQ(alone->rows(), with->rows());
  EXPECT_EQ(alone->sink.tables.count("damper.optimum"), 0u);
  EXPECT_THAT(alone->report.findings, IsEmpty());
}

TEST(DamperCurve, ResumesAfterTheLinesThatAreDone) {
  const PreparedStudy prepared(one_mass(usual + "sweep = { c = [0.05, 0.1, 0.2] }\n"));
  MemoryJournal whole;
  const auto all = run(prepared, 1, &whole);
  MemoryJournal part;
  part.pieces.assign(whole.pieces.begin(), whole.pieces.begin() + 2);
  const auto resumed = run(prepared, 1, &part);
  EXPECT_EQ(all->rows(), resumed->rows());
  EXPECT_EQ(all->rows("linear"), resumed->rows("linear"));
  EXPECT_EQ(part.pieces.size(), 3u);
  EXPECT_EQ(all->report.statistics, resumed->report.statistics);
}

TEST(DamperCurve, IsInterruptedBetweenPoints) {
  const std::atomic<bool> stop{true};
  const auto curve = run(PreparedStudy(one_mass(usual)), 1, nullptr, stop);
  EXPECT_EQ(curve->report.status, RunStatus::interrupted);
  EXPECT_EQ(curve->report.message, "interrupted after 0 of 5 values");
}

// All values are there, and what is missing is the optimum.
TEST(DamperCurve, IsInterruptedInSearchOfItsOptimum) {
  std::atomic<bool> stop{false};
  struct Stopping final : analysis::Progress {
    explicit Stopping(std::atomic<bool>& flag) : stop(flag) {}
    void begin(const std::string&, double, const std::string&) override {}
    void advance(double done) override { stop = done >= 5.0; }
    void end() override {}
    std::atomic<bool>& stop;
  } progress(stop);
  const PreparedStudy prepared(one_mass(usual));
  MemorySink sink;
  analysis::RunContext context{sink, progress, stop};
  const auto report = analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context);
  EXPECT_EQ(report.status, RunStatus::interrupted);
  EXPECT_EQ(report.message, "interrupted after all 5 values, in the search for the optimum");
  EXPECT_EQ(sink.tables.at("damper").rows.size(), 5u);
}

// The highest peak of the table of peaks is that of the curve, with its status and error, and each other has its own.
TEST(DamperCurve, TellsWhatBecameOfEachPeak) {
  for (const std::string solver : {"periodic", "harmonic_balance"}) {
    const auto curve = run(PreparedStudy(one_mass(usual + "solver = \"" + solver + "\"\n")));
    ASSERT_FALSE(curve->rows("peaks").empty());
    for (std::size_t row = 0; row < curve->rows("peaks").size(); ++row) {
      EXPECT_EQ(curve->at(row, "status", "", "peaks"), 0.0);
      EXPECT_GE(curve->at(row, "error", "", "peaks"), 0.0);
      for (std::size_t i = 0; i < curve->rows().size(); ++i) {
        if (curve->at(row, "angular_frequency", "", "peaks") == curve->at(i, "angular_frequency")) {
          EXPECT_EQ(curve->at(row, "error", "", "peaks"), curve->at(i, "error"));
        }
      }
    }
  }
}

}  // namespace
}  // namespace rubato::testing
