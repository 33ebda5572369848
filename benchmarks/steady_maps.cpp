#include "bare_steady.hpp"
#include "measure.hpp"
#include "peers/steady_march.hpp"

#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>
#include <support/models.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

// Maps of steady amplitudes over preload and frequency by the three routes of the library, through their public
// interface, and by what somebody would write with a general integrator or by hand; each with its error.
namespace rubato::benchmarks {
namespace {

using namespace steady;

struct Map {
  const char* name;
  std::vector<double> preloads;
  double lowest, highest;
  int points;
  double friction;                  // coefficient: limit = friction * preload
  system::LocallyNonlinear system;  // with some preload
  SteadyRequest request;            // the first observed is what the peers are judged by
  double target_periodic, target_balance, target_exponential, target_average;  // [s] of the map; 0: none
  Index count() const { return static_cast<Index>(preloads.size()) * points; }
  double frequency(int i) const { return lowest + (highest - lowest) * i / (points - 1); }
  system::Excitation excitation(std::size_t preload) const {
    system::Excitation result = excitation_of(system);
    result.limits.setConstant(friction * preloads[preload]);
    return result;
  }
};

struct Answer {
  Matrix amplitude;  // [observed x points of the map], NaN where there is none
  int failures = 0;
};

Answer answer_of(const Map& map) {
  return {Matrix::Constant(static_cast<Index>(map.request.observed.size()), map.count(), std::nan("")), 0};
}

// One preload after the other, along the frequency.
Answer by_points(const Map& map, SteadySolver& solver) {
  Answer answer = answer_of(map);
  SteadyResponse response;
  for (std::size_t p = 0; p < map.preloads.size(); ++p) {
    solver.forget();
    system::Excitation excitation = map.excitation(p);
    for (int i = 0; i < map.points; ++i) {
      excitation.angular_frequency = map.frequency(i);
      solver.solve(excitation, SteadyStart::unloaded, response);
      answer.failures += response.status != SteadyStatus::converged;
      answer.amplitude.col(static_cast<Index>(p) * map.points + i) = response.amplitude;
    }
  }
  return answer;
}

// All preloads side by side, along the frequency.
Answer by_lanes(const Map& map, SteadySolver& solver) {
  Answer answer = answer_of(map);
  solver.forget();
  std::vector<system::Excitation> excitations;
  for (std::size_t p = 0; p < map.preloads.size(); ++p) excitations.push_back(map.excitation(p));
  std::vector<SteadyResponse> responses(excitations.size());
  for (int i = 0; i < map.points; ++i) {
    for (system::Excitation& excitation : excitations) excitation.angular_frequency = map.frequency(i);
    solver.solve_lanes(excitations, SteadyStart::unloaded, responses);
    for (std::size_t p = 0; p < responses.size(); ++p) {
      answer.failures += responses[p].status != SteadyStatus::converged;
      answer.amplitude.col(static_cast<Index>(p) * map.points + i) = responses[p].amplitude;
    }
  }
  return answer;
}

Answer by_marching(const Map& map, const char* method) {
  TimeMarchingOptions options;
  options.method = integrate::make_method(method);
  TimeMarchingSolver solver(map.system, options, map.request);
  return by_lanes(map, solver);
}

system::LocallyNonlinear with_preload(const Map& map, double preload) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = map.system.mass();
  parts.damping = map.system.damping();
  parts.stiffness = map.system.stiffness();
  parts.sliders = map.system.sliders();
  for (auto& slider : parts.sliders) slider.limit = map.friction * preload;
  parts.loads = map.system.loads();
  parts.coordinates = map.system.coordinates();
  return system::LocallyNonlinear(std::move(parts));
}

// A march of a peer for each preload; every `stride`-th frequency. Without preload there is no transition to find, and
// the peers, who look for some, are not asked.
template <class Start>
Answer by_peer(const Map& map, int stride, Start&& start) {
  Answer answer = answer_of(map);
  for (std::size_t p = 0; p < map.preloads.size(); ++p) {
    if (map.preloads[p] == 0.0) continue;
    auto solve = start(with_preload(map, map.preloads[p]));
    for (int i = 0; i < map.points; i += stride)
      answer.amplitude(0, static_cast<Index>(p) * map.points + i) = solve(map.frequency(i));
  }
  return answer;
}

struct Error {
  Index points = 0, beyond = 0;  // beyond: of more than 1e-3
  double median = 0.0, largest = 0.0;
};

// Against the largest amplitude observed at the point.
Error error_of(const Answer& answer, const Answer& exact) {
  std::vector<double> errors;
  for (Index j = 0; j < answer.amplitude.cols(); ++j) {
    double error = 0.0;
    for (Index i = 0; i < answer.amplitude.rows(); ++i)
      if (std::isfinite(answer.amplitude(i, j)))
        error = std::max(error, std::abs(answer.amplitude(i, j) - exact.amplitude(i, j)));
    if (std::isfinite(answer.amplitude(0, j))) errors.push_back(error / exact.amplitude.col(j).maxCoeff());
  }
  const auto beyond = std::count_if(errors.begin(), errors.end(), [](double error) { return error > 1e-3; });
  return {static_cast<Index>(errors.size()), static_cast<Index>(beyond), median(errors),
          *std::max_element(errors.begin(), errors.end())};
}

struct Row {
  std::string name;
  double seconds;
  Error error;
  int failures;
  double target;
};

template <class Problem, int n>
std::vector<Row> peers(const Map& map, const Answer& exact) {
  const int observed = static_cast<int>(map.request.observed[0].first);
  std::vector<Row> rows;
  const auto measured = [&](std::string name, auto&& task) {
    const double start = cpu_seconds();
    const Answer answer = task();
    const double seconds = cpu_seconds() - start;
    rows.push_back({std::move(name), seconds, error_of(answer, exact), 0, 0.0});
  };
  const MarchEnd end;
  measured("Boost.odeint, dopri5 with events", [&] {
    return by_peer(map, 1, [&](const system::LocallyNonlinear& system) {
      return [&, problem = Problem(system), y = std::array<double, 2 * n>{}](double omega) mutable {
        problem.drive(omega);
        return steady_odeint(problem, y, observed, end);
      };
    });
  });
  const int stride = n > 1 ? 10 : 2;
  measured(fmt::format("CVODE Adams, roots (1 frequency in {})", stride), [&] {
    return by_peer(map, stride, [&](const system::LocallyNonlinear& system) {
      return [&, problem = Problem(system), y = std::array<double, 2 * n>{}](double omega) mutable {
        problem.drive(omega);
        return steady_cvode(problem, y, observed, end);
      };
    });
  });
  // The fewest of these steps with which every point comes within 1e-3.
  for (const int steps : {100, 150, 200, 300, 400, 600, 800, 1200}) {
    measured(fmt::format("bare Newmark, {} steps a period", steps), [&] {
      return by_peer(map, 1, [&](const system::LocallyNonlinear& system) {
        return [&, march = BareSteady<n, Problem::sliders>(system), steps](double omega) mutable {
          return march.solve(omega, steps, observed, end.change, end.most_periods);
        };
      });
    });
    if (rows.back().error.largest <= 1e-3) break;
    if (steps < 1200) rows.pop_back();
  }
  return rows;
}

template <class Problem, int n>
void measure(const Map& map) {
  PeriodicSolver tight(map.system, map.request, {.tolerance = 1e-13});
  const Answer exact = by_points(map, tight);
  const std::vector<std::function<Answer()>> routes = {[&] {
                                                         PeriodicSolver solver(map.system, map.request);
                                                         return by_points(map, solver);
                                                       },
                                                       [&] {
                                                         HarmonicBalanceSolver solver(map.system, map.request);
                                                         return by_points(map, solver);
                                                       },
                                                       [&] { return by_marching(map, "exponential"); },
                                                       [&] { return by_marching(map, "average_acceleration"); }};
  std::vector<Row> rows = {{"**periodic**", 0.0, {}, 0, map.target_periodic},
                           {"**harmonic_balance**", 0.0, {}, 0, map.target_balance},
                           {"**time_marching**, exponential, lanes", 0.0, {}, 0, map.target_exponential},
                           {"**time_marching**, average acceleration, lanes", 0.0, {}, 0, map.target_average}};
  std::vector<std::function<void()>> tasks;
  for (std::size_t i = 0; i < routes.size(); ++i)
    tasks.push_back([&, i] {
      const Answer answer = routes[i]();
      rows[i].error = error_of(answer, exact);
      rows[i].failures = answer.failures;
    });
  const std::vector<double> seconds = median_times(tasks, 5);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].seconds = seconds[i];
  const std::vector<Row> others = peers<Problem, n>(map, exact);
  double fastest = 1e300;
  for (const Row& row : others) fastest = std::min(fastest, row.seconds / static_cast<double>(row.error.points));
  rows.insert(rows.end(), others.begin(), others.end());

  fmt::print("\n{}: {} points, {} without convergence in the reference\n\n", map.name, map.count(), exact.failures);
  fmt::print(
      "| | us a point | median error | largest | beyond 1e-3 | unconverged | / fastest peer | map, ms | target, ms "
      "|\n");
  fmt::print("|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const Row& row : rows) {
    const double a_point = row.seconds / static_cast<double>(row.error.points);
    fmt::print("| {} | {:.3g} | {:.1e} | {:.1e} | {} | {} | {:.2g} | {:.3g} | {} |\n", row.name, 1e6 * a_point,
               row.error.median, row.error.largest, row.error.beyond, row.failures, a_point / fastest,
               1e3 * a_point * static_cast<double>(map.count()),
               row.target > 0.0 ? fmt::format("{:.3g}", 1e3 * row.target) : std::string());
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace rubato::benchmarks

int main() {
  using namespace rubato::benchmarks;
  using rubato::ground;
  measure<SingleMassProblem, 1>({"Map A, single mass",
                                 {0.2, 0.5, 1, 2, 4},
                                 0.5,
                                 2.0,
                                 200,
                                 0.5,
                                 rubato::testing::single_mass(0.5, 1.0, 0.05),
                                 {{{0, ground}}},
                                 5e-3,
                                 5e-3,
                                 0.0,
                                 0.0});
  for (const double second : {-20.0, -8.0})
    measure<DamperProblem, 5>(
        {second == -20.0 ? "Map B, damper model, forces +20, -20 N" : "Map B, damper model, forces +20, -8 N",
         {0, 5, 10, 25, 50, 100, 200, 500, 1000},
         6.0,
         9.0,
         200,
         0.5,
         rubato::testing::damper_model(10.0, 7.0, second),
         {{{1, ground}, {3, ground}}},
         90e-3,
         8e-3,
         300e-3,
         800e-3});
}
