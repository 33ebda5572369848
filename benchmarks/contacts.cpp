#include "measure.hpp"

#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <support/contact_problems.hpp>

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

// Frequency responses with contacts that slip and open, by harmonic balance and by marching: what a point costs.
namespace rubato::benchmarks {
namespace {

using namespace steady;

constexpr int points = 20;

struct Sweep {
  const char* name;
  system::LocallyNonlinear system;
  double from, to;  // [rad/s]
};

double seconds_a_point(const Sweep& sweep, SteadySolver& solver, int& failures) {
  failures = 0;
  const std::vector<double> seconds = median_times({[&] {
                                                     failures = 0;
                                                     solver.forget();
                                                     system::Excitation excitation = excitation_of(sweep.system);
                                                     SteadyResponse response;
                                                     for (int i = 0; i < points; ++i) {
                                                       excitation.angular_frequency =
                                                           sweep.from + (sweep.to - sweep.from) * i / (points - 1);
                                                       solver.solve(excitation, SteadyStart::rest, response);
                                                       failures += response.status != SteadyStatus::converged;
                                                     }
                                                   }},
                                                   3);
  return seconds.front() / points;
}

void measure(const Sweep& sweep) {
  const SteadyRequest request{{{0, ground}}};
  for (const double tolerance : {1e-3, 1e-4}) {
    HarmonicBalanceOptions options;
    options.tolerance = tolerance;
    HarmonicBalanceSolver balance(sweep.system, request, options);
    int failures = 0;
    const double seconds = seconds_a_point(sweep, balance, failures);
    fmt::print("| {} | harmonic_balance, {:g} | {:.3g} | {} |\n", sweep.name, tolerance, 1e3 * seconds, failures);
  }
  TimeMarchingSolver march(sweep.system, {}, request);
  int failures = 0;
  const double seconds = seconds_a_point(sweep, march, failures);
  fmt::print("| {} | time_marching | {:.3g} | {} |\n", sweep.name, 1e3 * seconds, failures);
}

}  // namespace
}  // namespace rubato::benchmarks

int main() {
  using namespace rubato;
  fmt::print("| 20 frequencies | route, tolerance | ms a point | unconverged |\n|---|---|---:|---:|\n");
  benchmarks::measure({"C: a mass on a contact, 0.8 to 1.6 rad/s", testing::coupled(1.2, true), 0.8, 1.6});
  benchmarks::measure({"W: a wedge between two blades, 8.2 to 9", testing::wedge(0.35, 3.0, 8.3), 8.2, 9.0});
  benchmarks::measure({"S: two tangential directions, 0.8 to 2", testing::in_space(), 0.8, 2.0});
}
