#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/steady/frequency_response.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/steady/frequency_text.hpp>
#include <rubato/analysis/steady/status_counts.hpp>
#include <rubato/steady/linear/linear_response.hpp>

#include <atomic>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>

namespace rubato::testing {
namespace {

using namespace analysis;
using steady::steady_solvers;
using steady::SteadySolvers;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

FrequencyResponsePlan plan_of(const PreparedStudy& prepared) {
  const auto& analysis = prepared.study.analyses.front();
  return plan_frequency_response(analysis.name, analysis.where,
                                 std::get<model::FrequencyResponseDescription>(analysis.task), prepared.input());
}

/// Takes sliders as springs: the sweep is what is tested here, not the friction.
SteadySolvers stuck_sliders() {
  SteadySolvers solvers = steady_solvers({});
  solvers.response = solvers.stuck;
  return solvers;
}

/// Calls back before every point, and remembers sliders as springs.
class WatchedSolver final : public steady::SteadySolver {
 public:
  WatchedSolver(std::unique_ptr<steady::SteadySolver> inner, std::function<void()> before_point, int lanes = 1)
      : inner_(std::move(inner)), before_point_(std::move(before_point)), lanes_(lanes) {}
  void solve(const system::Excitation& excitation, steady::SteadyStart start,
             steady::SteadyResponse& response) override {
    before_point_();
    inner_->solve(excitation, start, response);
  }
  int lanes() const override { return lanes_; }
  void solve_lanes(std::span<const system::Excitation> excitations, steady::SteadyStart start,
                   std::span<steady::SteadyResponse> responses) override {
    for (std::size_t i = 0; i < excitations.size(); ++i) solve(excitations[i], start, responses[i]);
    widest = std::max(widest, static_cast<int>(excitations.size()));
  }
  steady::Waveform waveform(int points) const override { return inner_->waveform(points); }
  void forget() override { inner_->forget(); }

  static inline int widest = 0;  ///< of all solvers: the most points side by side

 private:
  std::unique_ptr<steady::SteadySolver> inner_;
  std::function<void()> before_point_;
  int lanes_;
};

SteadySolvers watched(const std::function<void()>& before_point, int lanes = 1) {
  SteadySolvers solvers = stuck_sliders();
  solvers.response = [=, make = solvers.stuck](const auto& system, const auto& request) {
    return std::make_unique<WatchedSolver>(make(system, request), before_point, lanes);
  };
  return solvers;
}

/// Keeps the limits that it is given.
class LimitKeeper final : public steady::SteadySolver {
 public:
  explicit LimitKeeper(std::vector<double>& limits) : limits_(limits) {}
  void solve(const system::Excitation& excitation, steady::SteadyStart, steady::SteadyResponse& response) override {
    limits_.push_back(excitation.limits[0]);
    response.status = steady::SteadyStatus::converged;
    response.amplitude = response.velocity_amplitude = response.acceleration_amplitude = response.mean = response.rms =
        Vector::Constant(1, excitation.limits[0]);
    response.harmonics = ComplexMatrix::Zero(1, 1);
    response.dissipated = response.slip_share = response.offset = Vector::Zero(1);
  }
  steady::Waveform waveform(int) const override { return {}; }
  void forget() override {}

 private:
  std::vector<double>& limits_;
};

struct Run {
  MemorySink sink;
  RunReport report;
  const MemorySink::Table& table(const std::string& name = "frf") const { return sink.tables.at(name); }
  double at(std::size_t row, const std::string& variable, const std::string& label = "",
            const std::string& name = "frf") const {
    return table(name).rows.at(row).at(table(name).column(variable, label));
  }
};

const std::atomic<bool> never{false};

std::unique_ptr<Run> run(const PreparedStudy& prepared, const SteadySolvers& solvers = stuck_sliders(), int threads = 1,
                         results::Journal* journal = nullptr, const std::atomic<bool>& stop = never) {
  auto result = std::make_unique<Run>();
  QuietProgress progress;
  RunContext context{result->sink, progress, stop, threads, journal};
  const FrequencyResponsePlan plan = plan_of(prepared);
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
  const PreparedStudy prepared(one_mass("angular_frequency = [0.5, 1.0, 3.0]\nsweep = { k = [1, 4], N0 = [0, 2] }\n"));
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
  const auto result =
      run(PreparedStudy(one_mass("angular_frequency = [0.5, 3.0]\nsweep = { N0 = [0, 2], k = [1, 4] }\n")));
  const auto& linear = result->table("frf.linear");
  ASSERT_EQ(linear.rows.size(), 4u);
  std::size_t row = 0;
  for (const double k : {1.0, 4.0})
    for (const double omega : {0.5, 3.0}) {
      EXPECT_EQ(result->at(row, "k", "", "frf.linear"), k);
      for (const auto& [limit, slider] : {std::pair<std::string, double>{"free", 0.0}, {"stuck", 0.5}}) {
        const std::complex<double> x = 1.0 / dynamic_stiffness(k + slider, omega);
        EXPECT_NEAR(result->at(row, limit + "_amplitude", "mass", "frf.linear"), std::abs(x), 1e-14 * std::abs(x));
        EXPECT_NEAR(result->at(row, limit + "_phase", "mass", "frf.linear"), std::arg(x), 1e-13);
      }
      ++row;
    }
}

/// A grid of 60 lines of 600 points, which are cut into pieces.
const std::string long_sweep =
    "angular_frequency = { from = 0.5, to = 3, points = 600 }\n"
    "sweep = { k = { from = 1, to = 4, points = 6 }, N0 = { from = 0, to = 3, points = 10 } }\n";

TEST(FrequencyResponse, HasTheSameBitsForAnyNumberOfThreads) {
  // With friction: the periodic solver continues from point to point.
  const PreparedStudy prepared(
      one_mass("angular_frequency = { from = 0.5, to = 3, points = 300 }\nsweep = { k = [1, 2], N0 = [0, 0.5, 1] }\n"));
  const SteadySolvers solvers = steady_solvers({});
  const auto one = run(prepared, solvers, 1);
  for (const int threads : {2, 5}) {
    const auto several = run(prepared, solvers, threads);
    EXPECT_EQ(several->table().rows, one->table().rows);
    EXPECT_EQ(several->table("frf.linear").rows, one->table("frf.linear").rows);
  }
  EXPECT_EQ(one->table().rows.size(), 1800u);
}

TEST(FrequencyResponse, SolvesLinesOfOneStructureSideBySide) {
  const PreparedStudy prepared(one_mass(long_sweep));
  WatchedSolver::widest = 0;
  const auto lanes = run(prepared, watched([] {}, 4), 2);
  EXPECT_EQ(WatchedSolver::widest, 4);
  const auto alone = run(prepared, watched([] {}, 1), 2);
  EXPECT_EQ(lanes->table().rows, alone->table().rows);
  EXPECT_EQ(lanes->table("frf.linear").rows, alone->table("frf.linear").rows);
}

TEST(FrequencyResponse, ResumesWithTheSameBitsWhereItStopped) {
  const PreparedStudy prepared(one_mass(long_sweep));
  const auto whole = run(prepared);
  MemoryJournal journal;
  std::atomic<bool> stop{false};
  std::atomic<long> points{0};
  const auto broken = run(prepared, watched([&] { stop = ++points > 20000; }), 2, &journal, stop);
  EXPECT_EQ(broken->report.status, RunStatus::interrupted);
  EXPECT_THAT(broken->report.message, HasSubstr("of 36000 points"));
  // What was reached is there, in the same order.
  ASSERT_GT(broken->table().rows.size(), 19000u);
  ASSERT_LT(broken->table().rows.size(), 36000u);
  points = 0;
  const auto resumed = run(prepared, watched([&] { ++points; }), 2, &journal);
  EXPECT_LT(points, 18000);
  EXPECT_EQ(resumed->report.status, RunStatus::done);
  EXPECT_EQ(resumed->table().rows, whole->table().rows);
  EXPECT_EQ(resumed->table("frf.linear").rows, whole->table("frf.linear").rows);
  EXPECT_EQ(resumed->report.statistics, whole->report.statistics);
}

TEST(FrequencyResponse, KeepsLoopsAtTheNearestPoints) {
  const PreparedStudy prepared(
      one_mass("angular_frequency = [0.5, 1.0, 1.5]\nwaveforms = { at = [0.9], points = 16 }\n"));
  const auto result = run(prepared);
  const auto& table = result->table("frf.waveforms");
  ASSERT_EQ(table.rows.size(), 16u);
  const std::complex<double> x = 1.0 / dynamic_stiffness(1.5, 1.0);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(result->at(i, "angular_frequency", "", "frf.waveforms"), 1.0);
    const double t = 2.0 * std::numbers::pi * static_cast<double>(i) / 16.0;
    const double expected = std::abs(x) * std::cos(t + std::arg(x));
    EXPECT_NEAR(result->at(i, "time", "", "frf.waveforms"), t, 1e-15);
    EXPECT_NEAR(result->at(i, "position", "mass", "frf.waveforms"), expected, 1e-14 * std::abs(x));
    EXPECT_NEAR(result->at(i, "displacement", "contact", "frf.waveforms"), expected, 1e-14 * std::abs(x));
    EXPECT_NEAR(result->at(i, "force", "contact", "frf.waveforms"), 0.5 * expected, 1e-14 * std::abs(x));
  }
}

TEST(FrequencyResponse, ShowsTheBandsOfRandomSamples) {
  // Below resonance the amplitude falls with k, so that its percentiles are the amplitudes at the percentiles of k; of
  // 4001 samples in a Latin hypercube each lies within 1/4001 of the range [1, 2] from its place.
  const PreparedStudy prepared(one_mass(
      "angular_frequency = [0.1]\nobserve = [\"mass\"]\nsweep = { samples = 4001, parameters = { k = { distribution = "
      "\"uniform\", from = 1, to = 2 } } }\n"));
  const auto result = run(prepared);
  ASSERT_EQ(result->table().rows.size(), 4001u);
  ASSERT_EQ(result->table("frf.bands").rows.size(), 1u);
  for (const int percent : {5, 25, 50, 75, 95}) {
    const double k = 2.0 - percent / 100.0;
    const double expected = 1.0 / std::abs(dynamic_stiffness(k + 0.5, 0.1));
    const std::string variable = std::string("amplitude_p") + (percent == 5 ? "05" : std::to_string(percent));
    EXPECT_NEAR(result->at(0, variable, "mass", "frf.bands"), expected, expected / 4001.0) << percent;
  }
  EXPECT_EQ(result->at(0, "missing", "", "frf.bands"), 0.0);
}

TEST(FrequencyResponse, SweepsUpAndThenDownWithItsMemory) {
  const PreparedStudy prepared(
      one_mass("angular_frequency = [0.5, 1.0, 1.5]\nstart = \"previous\"\ndirection = \"both\"\n"));
  const auto result = run(prepared);
  std::vector<double> frequencies, directions;
  for (std::size_t i = 0; i < 6; ++i) {
    frequencies.push_back(result->at(i, "angular_frequency"));
    directions.push_back(result->at(i, "direction"));
  }
  EXPECT_THAT(frequencies, ElementsAre(0.5, 1.0, 1.5, 1.5, 1.0, 0.5));
  EXPECT_THAT(directions, ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_EQ(result->table("frf.linear").rows.size(), 3u);
}

TEST(FrequencyResponse, TakesFrequenciesInHertz) {
  // A frequency [Hz] that the study gives to a parameter in rad/s, and to one in Hz.
  const auto angular = run(PreparedStudy(one_mass("frequency = [0.25]\n")));
  const double omega = 2.0 * std::numbers::pi * 0.25, expected = 1.0 / std::abs(dynamic_stiffness(1.5, omega));
  EXPECT_NEAR(angular->at(0, "amplitude", "mass"), expected, 1e-13 * expected);
  std::string text = one_mass("frequency = [0.25]\n");
  text.replace(text.find("angular_frequency = \"Omega\""), 27, "frequency = \"Omega\"");
  const auto hertz = run(PreparedStudy(text));
  EXPECT_NEAR(hertz->at(0, "amplitude", "mass"), expected, 1e-13 * expected);
  EXPECT_EQ(hertz->at(0, "angular_frequency"), omega);
}

TEST(FrequencyResponse, AddsHarmonicsAndStaticLoadsOfSeveralForces) {
  std::string text = one_mass("angular_frequency = [0.4]\nharmonics = [1, 3]\n");
  text.insert(text.find("[[analysis]]"),
              "[[force]]\non = \"mass\"\namplitude = 0.5\nangular_frequency = \"3 * Omega\"\nphase = 0.7\n"
              "[[force]]\non = \"mass\"\namplitude = 0.3\nangular_frequency = 0\n");
  const auto result = run(PreparedStudy(text));
  const std::complex<double> third = std::polar(0.5, 0.7) / dynamic_stiffness(1.5, 1.2);
  EXPECT_NEAR(result->at(0, "harmonic3_amplitude", "mass"), std::abs(third), 1e-14);
  EXPECT_NEAR(result->at(0, "harmonic3_phase", "mass"), std::arg(third), 1e-13);
  EXPECT_NEAR(result->at(0, "mean", "mass"), 0.3 / 1.5, 1e-15);
}

TEST(FrequencyResponse, BuildsTheModelAgainWhereItsStructureFollowsTheSpeed) {
  // A spring stiffened by rotation.
  std::string text = one_mass("angular_frequency = [0.5, 2.0]\n");
  text.replace(text.find("stiffness = \"k\""), 15, "stiffness = \"k + 3 * Omega^2\"");
  const auto result = run(PreparedStudy(text));
  for (const std::size_t row : {0u, 1u}) {
    const double omega = row == 0 ? 0.5 : 2.0;
    const double expected = 1.0 / std::abs(dynamic_stiffness(1.5 + 3.0 * omega * omega, omega));
    EXPECT_NEAR(result->at(row, "amplitude", "mass"), expected, 1e-14 * expected);
  }
}

TEST(FrequencyResponse, LetsParametersFollowThoseThatAreSwept) {
  // preload = 2 N0 is a formula; --set would replace it.
  const std::string text =
      one_mass("angular_frequency = [1]\nsweep = { N0 = [1, 3] }\n", "preload = \"2 * N0\"\n", "1.0", "\"preload\"");
  std::vector<double> limits;
  SteadySolvers solvers = stuck_sliders();
  solvers.response = [&](const auto&, const auto&) { return std::make_unique<LimitKeeper>(limits); };
  (void)run(PreparedStudy(text), solvers);
  EXPECT_THAT(limits, ElementsAre(1.0, 3.0));  // mu = 0.5
  limits.clear();
  std::string unused = text;
  unused.replace(unused.find("stiffness = 0.5"), 15, "stiffness = \"0.5 * N0\"");
  (void)run(PreparedStudy(unused, {{"preload", 8.0}}), solvers);
  EXPECT_THAT(limits, ElementsAre(4.0, 4.0));
}

TEST(FrequencyResponse, LetsTheForceGrowWithTheFrequency) {
  // An unbalance m e Omega^2.
  const auto result = run(PreparedStudy(one_mass("angular_frequency = [0.5, 2.0]\n", "", "\"0.3 * Omega^2\"")));
  for (const std::size_t row : {0u, 1u}) {
    const double omega = row == 0 ? 0.5 : 2.0;
    const double expected = 0.3 * omega * omega / std::abs(dynamic_stiffness(1.5, omega));
    EXPECT_NEAR(result->at(row, "amplitude", "mass"), expected, 1e-14 * expected);
  }
}

TEST(FrequencyResponse, TakesTheSpeedOfARotorWithItsEngineOrderAndPreload) {
  // The force has three times the speed; so the response repeats with it, and the column says so.
  const PreparedStudy prepared(one_mass("angular_frequency = [0.2, 0.5]\nexcitation = \"speed\"\n",
                                        "speed = 0.3\npreload = \"2 * speed^2\"\n", "1.0", "\"preload\"",
                                        "\"3 * speed\""));
  const auto result = run(prepared);
  for (const std::size_t row : {0u, 1u}) {
    const double speed = row == 0 ? 0.2 : 0.5, omega = 3.0 * speed;
    const double expected = 1.0 / std::abs(dynamic_stiffness(1.5, omega));
    EXPECT_EQ(result->at(row, "angular_frequency"), speed);
    EXPECT_NEAR(result->at(row, "fundamental"), omega, 1e-15);
    EXPECT_NEAR(result->at(row, "amplitude", "mass"), expected, 1e-14 * expected);
  }
}

TEST(FrequencyResponse, TiesThePreloadToTheSpeedAndCountsNegativeOnesAsZero) {
  const PreparedStudy prepared(one_mass("angular_frequency = [1, 2, 3]\n", "", "1.0", "\"2 * Omega^2 - 4\""));
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

// m v' + c v = 0.5 - 0.2 + ...: it slides at 0.6 m/s in the mean, 0.6 pi metres in a period of pi seconds.
TEST(FrequencyResponse, SaysHowFarAStructureWalksOverItsSliders) {
  const std::string text =
      "[parameters]\nOmega = 2.0\n[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
      "[[damper]]\nbetween = [\"mass\", \"ground\"]\ndamping = 0.5\n"
      "[[slider]]\nname = \"contact\"\nbetween = [\"mass\", \"ground\"]\nstiffness = 10.0\n"
      "friction_coefficient = 0.5\nnormal_load = 0.4\n"
      "[[force]]\non = \"mass\"\namplitude = 0.1\nangular_frequency = \"Omega\"\n"
      "[[force]]\non = \"mass\"\namplitude = 0.5\nangular_frequency = 0.0\n"
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [2.0]\n";
  const auto result = run(PreparedStudy(text), steady_solvers({}));
  EXPECT_EQ(status_words()[static_cast<std::size_t>(result->at(0, "status"))], "drifting");
  EXPECT_NEAR(result->at(0, "input_work"), result->at(0, "viscous_work") + result->at(0, "dissipated", "contact"),
              1e-10);
  EXPECT_THAT(
      result->report.warnings,
      ElementsAre("at angular_frequency = 2 rad/s the structure walks over its sliders, \"mass\" by 1.88496 m a "
                  "period, and has no steady place; only a spring would give it one (1 point)"));
}

// Without damping nothing ends what begins at rest: (cos t - cos 2t) / 3 repeats after two periods of the force,
// between 1.125 / 3 at cos t = 1/4 and -2 / 3.
TEST(FrequencyResponse, CallsAnUndampedStartThatRepeatsAfterTwoPeriodsSubharmonic) {
  const std::string text =
      "[parameters]\nOmega = 2.0\n[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
      "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 1.0\n"
      "[[force]]\non = \"mass\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [2.0]\n"
      "solver = \"time_marching\"\nmethod = \"exponential\"\nstart = \"rest\"\n";
  const PreparedStudy prepared(text);
  const auto result = run(prepared, steady_solvers(plan_of(prepared).route));
  EXPECT_EQ(status_words()[static_cast<std::size_t>(result->at(0, "status"))], "subharmonic");
  EXPECT_NEAR(result->at(0, "amplitude", "mass"), 3.125 / 6.0, 1e-3);
}

TEST(FrequencyResponse, CallsAResonanceWithoutDampingInfinite) {
  const std::string text =
      "[parameters]\nOmega = 1.0\n[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
      "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 4.0\n"
      "[[force]]\non = \"mass\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [1.0, 2.0]\n";
  const auto result = run(PreparedStudy(text), steady_solvers({}));
  EXPECT_EQ(result->at(0, "status"), 0.0);
  EXPECT_NEAR(result->at(0, "amplitude", "mass"), 1.0 / 3.0, 1e-15);
  EXPECT_EQ(result->at(1, "status"), 4.0);  // unbounded
  EXPECT_EQ(result->at(1, "amplitude", "mass"), std::numeric_limits<double>::infinity());
  EXPECT_THAT(result->report.warnings, ElementsAre("at angular_frequency = 2 rad/s the loads meet a resonance without "
                                                   "damping, or push what nothing holds: the response is "
                                                   "infinite (1 point)"));
}

TEST(FrequencyResponse, GoesOnPastCombinationsThatNoModelCanHave) {
  const auto result = run(PreparedStudy(one_mass("angular_frequency = [1, 2]\nsweep = { k = [1, -1, 2] }\n")));
  EXPECT_EQ(result->report.status, RunStatus::done);
  ASSERT_EQ(result->table().rows.size(), 6u);
  EXPECT_EQ(result->at(2, "status"), 5.0);
  EXPECT_TRUE(std::isnan(result->at(2, "amplitude", "mass")));
  EXPECT_EQ(result->at(4, "status"), 0.0);
  ASSERT_EQ(result->report.warnings.size(), 1u);
  EXPECT_EQ(
      result->report.warnings[0],
      "at k = -1, angular_frequency = 1 rad/s nothing can be computed (2 points): study.toml:10:13: error: the spring "
      "between \"mass\" and \"ground\": stiffness must not be negative, got -1");
}

TEST(FrequencyText, TellsHertzBesideWhereAStudyExcitesByHertz) {
  EXPECT_EQ(frequency_text(7.5, 1.0), "angular_frequency = 7.5 rad/s");
  EXPECT_EQ(frequency_text(4.0 * std::numbers::pi, 0.5 / std::numbers::pi),
            "angular_frequency = 12.5663706 rad/s (2 Hz)");
}

}  // namespace
}  // namespace rubato::testing
