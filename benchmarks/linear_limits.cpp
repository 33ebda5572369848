#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/linear/linear_response.hpp>

#include "measure.hpp"
#include "support/models.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

// What the linear limits of a large structure cost: the lowest ten modes, and 200 frequencies of a response, directly
// and by modes with residual vectors.
namespace {

using namespace rubato;
using benchmarks::cpu_seconds;

/// `side` by `side` masses between springs, the border held, with 20 sliders between neighbours.
system::LocallyNonlinear membrane(Index side) {
  const Index n = side * side;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 4.0);
    const auto join = [&](Index j) {
      entries.emplace_back(i, j, -1.0);
      entries.emplace_back(j, i, -1.0);
    };
    if (i % side > 0) join(i - 1);
    if (i >= side) join(i - side);
  }
  system::LocallyNonlinear::Parts parts;
  parts.stiffness.resize(n, n);
  parts.stiffness.setFromTriplets(entries.begin(), entries.end());
  parts.mass.resize(n, n);
  parts.mass.setIdentity();
  parts.damping = 0.001 * parts.mass + 0.002 * parts.stiffness;
  for (Index i = 0; i < 20; ++i) parts.sliders.push_back({"s", (i + 1) * (n / 22), (i + 1) * (n / 22) + 1, 1.0, 1.0});
  return system::LocallyNonlinear(std::move(parts));
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void modes(const char* name, const system::LocallyNonlinear& system) {
  const double start = cpu_seconds();
  const numerics::SymmetricModes found = numerics::lowest_modes(system.stiffness(), system.mass(), 10);
  fmt::print("{:<40} {:8.2f} s   missing {}, residual {:.0e}, {:.0f} MB so far\n", name, cpu_seconds() - start,
             found.missing, found.residual, peak_megabytes());
}

void responses(const char* name, const system::LocallyNonlinear& system, double highest) {
  const int frequencies = 200;
  system::Excitation excitation;
  excitation.harmonics = {{1, ComplexVector::Zero(system.size())}};
  excitation.harmonics[0].amplitude[system.size() / 3 + 17] = 1.0;
  const steady::SteadyRequest request{{{system.size() / 3 + 17}, {system.size() / 2}}, {1}, true};
  const auto sweep = [&](steady::LinearResponse solver, std::vector<double>& amplitudes) {
    steady::SteadyResponse response;
    for (int i = 1; i <= frequencies; ++i) {
      excitation.angular_frequency = highest * i / frequencies;
      solver.solve(excitation, steady::SteadyStart::unloaded, response);
      amplitudes.push_back(response.amplitude[1]);
    }
    return solver.goes_by_modes();
  };
  std::vector<double> direct, chosen;
  double start = cpu_seconds();
  sweep(steady::stuck_limit(system, request), direct);
  const double direct_time = cpu_seconds() - start;
  start = cpu_seconds();
  const bool by_modes = sweep(steady::stuck_limit(system, request, {frequencies, highest, 1e-9}), chosen);
  const double chosen_time = cpu_seconds() - start;
  double difference = 0.0;
  for (std::size_t i = 0; i < direct.size(); ++i)
    difference = std::max(difference, std::abs(direct[i] - chosen[i]) / direct[i]);
  fmt::print("{:<40} {:8.2f} s directly, {:.2f} s as chosen ({}), apart by {:.0e}, {:.0f} MB so far\n", name,
             direct_time, chosen_time, by_modes ? "modes" : "direct", difference, peak_megabytes());
}

}  // namespace

int main() {
  fmt::print("200 frequencies with all sliders stuck\n");
  responses("chain of 20,000", testing::chain(20'000, 20), 0.05);
  responses("membrane of 141 by 141", membrane(141), 0.15);
  fmt::print("lowest ten modes\n");
  modes("chain of 100,000", testing::chain(100'000, 0));
  modes("membrane of 316 by 316", membrane(316));
}
