#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

#include "measure.hpp"
#include "peers/damper_problem.hpp"
#include "support/models.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

// The transient of the damper model from rest, by Rubato and by two general integrators that locate every transition
// of the sliders and start anew there: CPU time at equal error.
namespace {

using namespace rubato;
using namespace rubato::benchmarks;

constexpr int periods = 40;
constexpr double omega = 7.777;
constexpr int rounds = 7;

struct Point {
  double error, seconds;
};

struct Contestant {
  std::string name;
  std::vector<std::function<Samples()>> ladder;  // from coarse to fine
};

class Sampler final : public integrate::Observer {
 public:
  Sampler(long every, Samples& samples) : every_(every), left_(every), samples_(samples) {}
  bool accepted(const system::State&, const system::State& after) override {
    if (--left_ > 0) return true;
    left_ = every_;
    samples_.push_back({after.q[0], after.q[1], after.q[2], after.q[3], after.q[4]});
    return true;
  }

 private:
  long every_, left_;
  Samples& samples_;
};

/// All that a run takes, the preparation of the method included.
Samples run_rubato(const system::LocallyNonlinear& system, const std::string& method, long steps_a_period) {
  Samples samples;
  samples.reserve(periods * samples_a_period);
  Sampler sampler(steps_a_period / samples_a_period, samples);
  const double period = 2.0 * std::acos(-1.0) / omega;
  const auto stepper = integrate::make_stepper(integrate::make_method(method), system);
  system::State state = integrate::consistent_start(system, system.start());
  integrate::march(*stepper, state, period / static_cast<double>(steps_a_period), periods * period, &sampler);
  return samples;
}

class ExactSampler final : public integrate::ExactVisitor {
 public:
  explicit ExactSampler(Samples& samples) : samples_(samples) {}
  bool sample(const system::State& state, const integrate::ExactWork&) override {
    samples_.push_back({state.q[0], state.q[1], state.q[2], state.q[3], state.q[4]});
    return true;
  }
  bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
    return true;
  }

 private:
  Samples& samples_;
};

Samples run_exact(const system::LocallyNonlinear& system) {
  Samples samples;
  samples.reserve(periods * samples_a_period);
  ExactSampler sampler(samples);
  const double interval = 2.0 * std::acos(-1.0) / omega / samples_a_period;
  std::vector<double> times;
  for (int i = 1; i <= periods * samples_a_period; ++i) times.push_back(i * interval);
  integrate::ExactFlow flow(system);
  system::State state = integrate::consistent_start(system, system.start());
  flow.advance(state, times.back(), times, sampler);
  return samples;
}

double largest_difference(const Samples& a, const Samples& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 5; ++k) largest = std::max(largest, std::abs(a[i][k] - b[i][k]));
  return largest;
}

/// Time at an error, interpolated on logarithms where the ladder comes below it for good.
double time_at(const std::vector<Point>& ladder, double error) {
  if (!(ladder.back().error <= error)) return std::numeric_limits<double>::quiet_NaN();
  std::size_t i = ladder.size() - 1;
  while (i > 0 && ladder[i - 1].error <= error) --i;
  if (i == 0) return ladder[0].seconds;
  const Point a = ladder[i - 1], b = ladder[i];
  const double share = std::log(a.error / error) / std::log(a.error / b.error);
  return a.seconds * std::pow(b.seconds / a.seconds, share);
}

std::vector<Point> measure(const Contestant& contestant, const Samples& reference, double amplitude) {
  std::vector<std::function<void()>> tasks;
  std::vector<Point> points;
  for (const auto& run : contestant.ladder) {
    points.push_back({largest_difference(run(), reference) / amplitude, 0.0});
    tasks.emplace_back([&run] { keep(run()[0][0]); });
  }
  const auto times = median_times(tasks, rounds);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].seconds = times[i];
  return points;
}

void compare(double normal_load, bool show_ladders) {
  const auto system = rubato::testing::damper_model(normal_load, omega, -8.0);
  const DamperProblem problem(system);
  const Samples reference = run_exact(system);
  double amplitude = 0.0;
  for (const auto& sample : reference)
    for (const double x : sample) amplitude = std::max(amplitude, std::abs(x));
  fmt::print(
      "\nN0 = {:.0f} N: largest displacement {:.4f} m; from the exact flow RKDOPRI5 at 1e-13 differs by {:.1e}\n",
      normal_load, amplitude, largest_difference(reference, run_odeint(problem, periods, 1e-13)) / amplitude);

  std::vector<Contestant> contestants;
  for (const char* method : {"average_acceleration", "generalized_alpha", "fox_goodwin", "rk4", "exponential"}) {
    contestants.push_back({std::string("Rubato ") + method, {}});
    for (long steps = 16; steps <= 16384; steps *= 2)
      for (const long n : {steps, steps * 3 / 2})
        contestants.back().ladder.emplace_back([&system, method, n] { return run_rubato(system, method, n); });
  }
  contestants.push_back({"Rubato exact", {[&system] { return run_exact(system); }}});
  std::vector<double> tolerances;
  for (double tolerance = 1e-1; tolerance > 1e-11; tolerance /= std::sqrt(10.0)) tolerances.push_back(tolerance);
  contestants.push_back({"Boost.odeint RKDOPRI5", {}});
  for (const double tolerance : tolerances)
    contestants.back().ladder.emplace_back([&problem, tolerance] { return run_odeint(problem, periods, tolerance); });
  for (const auto& [name, method] :
       {std::pair{"SUNDIALS CVODE Adams", Multistep::adams}, std::pair{"SUNDIALS CVODE BDF", Multistep::bdf}}) {
    contestants.push_back({name, {}});
    for (const double tolerance : tolerances)
      contestants.back().ladder.emplace_back(
          [&problem, tolerance, m = method] { return run_cvode(problem, periods, tolerance, m); });
  }

  constexpr std::array errors{1e-3, 1e-4, 1e-6};
  fmt::print("{:<32}{:>12}{:>12}{:>12}   [us] at that error\n", "", "1e-3", "1e-4", "1e-6");
  std::array<double, errors.size()> own_best, peers_best;
  own_best.fill(std::numeric_limits<double>::infinity());
  peers_best = own_best;
  for (const Contestant& contestant : contestants) {
    const std::vector<Point> points = measure(contestant, reference, amplitude);
    fmt::print("{:<32}", contestant.name);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double seconds = time_at(points, errors[i]);
      fmt::print("{:>12.0f}", 1e6 * seconds);
      double& best = contestant.name.starts_with("Rubato") ? own_best[i] : peers_best[i];
      best = std::fmin(best, seconds);
    }
    fmt::print("\n");
    if (!show_ladders) continue;
    for (const Point& point : points) fmt::print("    {:>10.2e}{:>12.0f} us\n", point.error, 1e6 * point.seconds);
  }
  fmt::print("{:<32}", "fastest of Rubato / of the peers");
  for (std::size_t i = 0; i < errors.size(); ++i) fmt::print("{:>12.2f}", own_best[i] / peers_best[i]);
  fmt::print("\n");
}

}  // namespace

/// With the word `ladders`, also the error and the time of each run.
int main(int count, char** words) {
  const bool show_ladders = count > 1 && std::string(words[1]) == "ladders";
  for (const double normal_load : {10.0, 20.0, 35.0}) compare(normal_load, show_ladders);
}
