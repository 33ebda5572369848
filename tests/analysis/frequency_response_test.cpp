#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/memory_sink.hpp"

#include <rubato/analysis/frequency_response.hpp>
#include <rubato/analysis/frequency_response_plan.hpp>
#include <rubato/integrate/steady/linear_response.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <cmath>
#include <complex>
#include <limits>

namespace rubato::testing {
namespace {

using namespace analysis;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A study and what an analysis of it needs; keeps everything alive.
struct Prepared {
  model::StudyDescription study;
  numerics::Parameters overrides, parameters;
  system::LocallyNonlinear system;

  explicit Prepared(const std::string& text, const numerics::Parameters& settings = {})
      : study(io::read_study_text(text, "study.toml")),
        overrides(settings),
        parameters(model::evaluate_parameters(study.parameters, settings)),
        system(system::assemble(model::build(study.model, parameters, model::NegativeLoad::zero))) {}
  StudyInput input() const { return {study, overrides, parameters, system}; }
  FrequencyResponsePlan plan() const {
    const auto& analysis = study.analyses.front();
    return plan_frequency_response(analysis.name, analysis.where,
                                   std::get<model::FrequencyResponseDescription>(analysis.task), input());
  }
};

/// Takes sliders as springs: the sweep is what is tested here, not the friction.
SteadySolvers stuck_sliders() {
  SteadySolvers solvers = steady_solvers({});
  solvers.response = solvers.stuck;
  return solvers;
}

struct Run {
  MemorySink sink;
  RunReport report;
  const MemorySink::Table& table(const std::string& name = "frf") const { return sink.tables.at(name); }
  double at(std::size_t row, const std::string& variable, const std::string& label = "",
            const std::string& name = "frf") const {
    return table(name).rows.at(row).at(table(name).column(variable, label));
  }
};

std::unique_ptr<Run> run(const Prepared& prepared, const SteadySolvers& solvers = stuck_sliders(), int threads = 1) {
  auto result = std::make_unique<Run>();
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{result->sink, progress, stop, threads};
  const FrequencyResponsePlan plan = prepared.plan();
  result->report = run_frequency_response("frf", plan, prepared.input(), solvers, context);
  return result;
}

/// One mass with a slider; what is added goes into the analysis.
std::string one_mass(const std::string& lines, const std::string& parameters = "", const std::string& force = "1.0",
                     const std::string& load = "\"N0\"", const std::string& frequency = "\"Omega\"") {
  return "[parameters]\nN0 = 1.0\nOmega = 2.0\nk = 1.0\n" + parameters +
         "[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
         "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = \"k\"\n"
         "[[damper]]\nbetween = [\"mass\", \"ground\"]\ndamping = 0.1\n"
         "[[slider]]\nname = \"contact\"\nbetween = [\"mass\", \"ground\"]\nstiffness = 0.5\n"
         "friction_coefficient = 0.5\nnormal_load = " +
         load + "\n[[force]]\non = \"mass\"\namplitude = " + force + "\nangular_frequency = " + frequency +
         "\n[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\n" + lines;
}

/// k - omega^2 + i 0.1 omega: the dynamic stiffness of the mass.
std::complex<double> dynamic_stiffness(double k, double omega) { return {k - omega * omega, 0.1 * omega}; }

TEST(FrequencyResponse, SolvesEveryCombinationWithTheFrequencyFastest) {
  const Prepared prepared(one_mass("angular_frequency = [0.5, 1.0, 3.0]\nsweep = { k = [1, 4], N0 = [0, 2] }\n"));
  const auto result = run(prepared);
  EXPECT_EQ(result->report.status, RunStatus::done);
  ASSERT_EQ(result->table().rows.size(), 12u);
  std::size_t row = 0;
  for (const double k : {1.0, 4.0})
    for (const double n0 : {0.0, 2.0})
      for (const double omega : {0.5, 1.0, 3.0}) {
        SCOPED_TRACE(row);
        EXPECT_EQ(result->at(row, "k"), k);
        EXPECT_EQ(result->at(row, "N0"), n0);
        EXPECT_EQ(result->at(row, "angular_frequency"), omega);
        // The force has amplitude 1 and the stuck slider adds 0.5 to k; a 2 x 2 solution costs a few units of
        // round-off.
        const std::complex<double> x = 1.0 / dynamic_stiffness(k + 0.5, omega);
        EXPECT_NEAR(result->at(row, "amplitude", "mass"), std::abs(x), 1e-14 * std::abs(x));
        EXPECT_NEAR(result->at(row, "velocity_amplitude", "mass"), omega * std::abs(x), 1e-13 * std::abs(x));
        EXPECT_NEAR(result->at(row, "phase", "mass"), std::arg(x), 1e-13);
        EXPECT_NEAR(result->at(row, "rms", "mass"), std::abs(x) / std::sqrt(2.0), 1e-13 * std::abs(x));
        EXPECT_EQ(result->at(row, "status"), 0.0);
        ++row;
      }
  EXPECT_EQ(result->table().layout.blocks.front().variable, "k");
}

TEST(FrequencyResponse, ShowsBothLimitsForEveryStructureOnce) {
  // N0 changes no linear limit, so the table has a line for each k only.
  const auto result = run(Prepared(one_mass("angular_frequency = [0.5, 3.0]\nsweep = { N0 = [0, 2], k = [1, 4] }\n")));
  const auto& linear = result->table("frf.linear");
  ASSERT_EQ(linear.rows.size(), 4u);
  std::size_t row = 0;
  for (const double k : {1.0, 4.0})
    for (const double omega : {0.5, 3.0}) {
      EXPECT_EQ(result->at(row, "k", "", "frf.linear"), k);
      const double free = 1.0 / std::abs(dynamic_stiffness(k, omega));
      const double stuck = 1.0 / std::abs(dynamic_stiffness(k + 0.5, omega));
      EXPECT_NEAR(result->at(row, "free_amplitude", "mass", "frf.linear"), free, 1e-14 * free);
      EXPECT_NEAR(result->at(row, "stuck_amplitude", "mass", "frf.linear"), stuck, 1e-14 * stuck);
      ++row;
    }
}

TEST(FrequencyResponse, LetsTheForceGrowWithTheFrequency) {
  // An unbalance m e Omega^2.
  const auto result = run(Prepared(one_mass("angular_frequency = [0.5, 2.0]\n", "", "\"0.3 * Omega^2\"")));
  for (const std::size_t row : {0u, 1u}) {
    const double omega = row == 0 ? 0.5 : 2.0;
    const double expected = 0.3 * omega * omega / std::abs(dynamic_stiffness(1.5, omega));
    EXPECT_NEAR(result->at(row, "amplitude", "mass"), expected, 1e-14 * expected);
  }
}

TEST(FrequencyResponse, TakesTheSpeedOfARotorWithItsEngineOrderAndPreload) {
  // The force has three times the speed; so the response repeats with it, and the column says so.
  const Prepared prepared(one_mass("angular_frequency = [0.2, 0.5]\nexcitation = \"speed\"\n",
                                   "speed = 0.3\npreload = \"2 * speed^2\"\n", "1.0", "\"preload\"", "\"3 * speed\""));
  const auto result = run(prepared);
  for (const std::size_t row : {0u, 1u}) {
    const double speed = row == 0 ? 0.2 : 0.5, omega = 3.0 * speed;
    const double expected = 1.0 / std::abs(dynamic_stiffness(1.5, omega));
    EXPECT_EQ(result->at(row, "angular_frequency"), speed);
    EXPECT_NEAR(result->at(row, "fundamental"), omega, 1e-15);
    EXPECT_NEAR(result->at(row, "amplitude", "mass"), expected, 1e-14 * expected);
  }
}

/// Keeps the limits that it is given.
class LimitKeeper final : public integrate::SteadySolver {
 public:
  explicit LimitKeeper(std::vector<double>& limits) : limits_(limits) {}
  void solve(const integrate::Excitation& excitation, integrate::SteadyStart,
             integrate::SteadyResponse& response) override {
    limits_.push_back(excitation.limits[0]);
    response.status = integrate::SteadyStatus::converged;
    response.amplitude = response.velocity_amplitude = response.acceleration_amplitude = response.mean = response.rms =
        Vector::Constant(1, excitation.limits[0]);
    response.harmonics = integrate::ComplexMatrix::Zero(1, 1);
    response.dissipated = response.slip_share = response.offset = Vector::Zero(1);
  }
  integrate::Waveform waveform(int) const override { return {}; }
  void forget() override {}

 private:
  std::vector<double>& limits_;
};

TEST(FrequencyResponse, TiesThePreloadToTheSpeedAndCountsNegativeOnesAsZero) {
  const Prepared prepared(one_mass("angular_frequency = [1, 2, 3]\n", "", "1.0", "\"2 * Omega^2 - 4\""));
  std::vector<double> limits;
  SteadySolvers solvers = stuck_sliders();
  solvers.response = [&](const auto&, const auto&) { return std::make_unique<LimitKeeper>(limits); };
  const auto result = run(prepared, solvers);
  // mu = 0.5 times -2, 4 and 14 N.
  EXPECT_THAT(limits, ElementsAre(0.0, 2.0, 7.0));
  EXPECT_THAT(result->report.warnings,
              ElementsAre("at angular_frequency = 1 rad/s the normal load of slider \"contact\" is -2 N: it cannot be "
                          "pulled, and counts as 0 (1 point with negative loads)"));
}

TEST(FrequencyResponse, CallsAResonanceWithoutDampingInfinite) {
  const std::string text =
      "[parameters]\nOmega = 1.0\n[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
      "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 4.0\n"
      "[[force]]\non = \"mass\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [1.0, 2.0]\n";
  const auto result = run(Prepared(text), steady_solvers({}));
  EXPECT_EQ(result->at(0, "status"), 0.0);
  EXPECT_NEAR(result->at(0, "amplitude", "mass"), 1.0 / 3.0, 1e-15);
  EXPECT_EQ(result->at(1, "status"), 4.0);  // unbounded
  EXPECT_EQ(result->at(1, "amplitude", "mass"), std::numeric_limits<double>::infinity());
  EXPECT_THAT(result->report.warnings,
              ElementsAre("at angular_frequency = 2 rad/s the loads meet a resonance without damping: the response is "
                          "infinite (1 point)"));
}

TEST(FrequencyResponse, GoesOnPastCombinationsThatNoModelCanHave) {
  const auto result = run(Prepared(one_mass("angular_frequency = [1, 2]\nsweep = { k = [1, -1, 2] }\n")));
  EXPECT_EQ(result->report.status, RunStatus::done);
  ASSERT_EQ(result->table().rows.size(), 6u);
  EXPECT_EQ(result->at(2, "status"), 5.0);
  EXPECT_TRUE(std::isnan(result->at(2, "amplitude", "mass")));
  EXPECT_EQ(result->at(4, "status"), 0.0);
  ASSERT_EQ(result->report.warnings.size(), 1u);
  EXPECT_EQ(result->report.warnings[0],
            "at k = -1, angular_frequency = 1 rad/s there is no model (2 points): study.toml:10:13: error: the spring "
            "between \"mass\" and \"ground\": stiffness must not be negative, got -1");
}

}  // namespace
}  // namespace rubato::testing
