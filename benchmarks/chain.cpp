#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include "measure.hpp"
#include "support/models.hpp"

#include <fmt/core.h>
#include <malloc.h>
#include <Eigen/SparseCholesky>
#ifdef RUBATO_WITH_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include <algorithm>
#include <cstdlib>
#include <memory>

// A step of a long chain with 100 sliders beside one solve with the factor of its effective matrix: the least that an
// implicit step can cost.
namespace {

using namespace rubato;
using benchmarks::cpu_seconds;
using benchmarks::keep;

constexpr double step = 0.05;
constexpr Index most_sliders = 100;

double bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// S of average acceleration; the generalized-alpha method has another one of the same pattern and cost.
SparseMatrix effective_matrix(const system::LocallyNonlinear& system) {
  return system.mass() + SparseMatrix(0.5 * step * system.damping() + 0.25 * step * step * system.stiffness());
}

/// The march of a method, a fixed number of steps at a call; the bytes of its state and stepper are counted.
class March {
 public:
  March(const system::LocallyNonlinear& system, const std::string& method, long steps) : steps_(steps) {
    const double before = bytes_in_use();
    stepper_ = integrate::make_stepper(integrate::make_method(method), system);
    state_ = integrate::consistent_start(system, system.start());
    run();
    bytes_ = bytes_in_use() - before;
  }
  void run() {
    const double end = state_.t + static_cast<double>(steps_) * step;
    if (march(*stepper_, state_, step, end).end != integrate::MarchEnd::reached) fmt::print(stderr, "march failed\n");
  }
  double bytes() const { return bytes_; }

 private:
  long steps_;
  std::unique_ptr<integrate::Stepper> stepper_;
  system::State state_;
  double bytes_ = 0.0;
};

void compare(Index n) {
  const auto system = rubato::testing::chain(n, std::min(most_sliders, n / 100));
  const SparseMatrix effective = effective_matrix(system);
  const long repetitions = std::max<long>(2, 2'000'000 / n);
  const Vector right = Vector::LinSpaced(n, -1.0, 1.0);
  Vector x(n);

  std::vector<Index> last;
  for (const auto& slider : system.sliders()) last.push_back(slider.first);
  numerics::OrderedFactor ordered;
  ordered.analyse(effective, last);
  if (!ordered.factorise(effective)) return;
  const Eigen::SimplicialLDLT<SparseMatrix> eigen(effective);
#ifdef RUBATO_WITH_CHOLMOD
  Eigen::CholmodSimplicialLDLT<SparseMatrix> cholmod(effective);
#endif

  std::vector<std::unique_ptr<March>> marches;
  std::vector<std::string> names;
  std::vector<std::function<void()>> tasks;
  const auto add = [&](const std::string& name, const std::function<void()>& task) {
    names.push_back(name);
    tasks.push_back(task);
  };
  const auto repeat = [repetitions](auto once) {
    return [repetitions, once] {
      for (long i = 0; i < repetitions; ++i) once();
    };
  };
  add("solve, factor of the step", repeat([&] {
        x = right;
        ordered.forward(x, [](Index) {});
        ordered.backward(x, [](Index, double) {});
        keep(x[0]);
      }));
  add("solve, Eigen SimplicialLDLT", repeat([&] {
        x = eigen.solve(right);
        keep(x[0]);
      }));
#ifdef RUBATO_WITH_CHOLMOD
  add("solve, CHOLMOD simplicial", repeat([&] {
        x = cholmod.solve(right);
        keep(x[0]);
      }));
#endif
  const std::size_t solves = tasks.size();
  for (const char* method : {"generalized_alpha", "average_acceleration", "hht", "central_difference", "rk4"}) {
    marches.push_back(std::make_unique<March>(system, method, repetitions));
    add(method, [march = marches.back().get()] { march->run(); });
  }

  const auto times = benchmarks::median_times(tasks, 9);
  const double fastest = *std::min_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(solves));
  fmt::print("\n{} coordinates, {} sliders; factor: {:.0f} bytes a column\n", n, system.slider_count(),
             static_cast<double>(ordered.bytes()) / static_cast<double>(n));
  fmt::print("{:<30}{:>12}{:>14}{:>16}{:>18}{:>16}\n", "", "us", "ns/unknown", "/ same factor", "/ fastest solve",
             "bytes/unknown");
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const double once = times[i] / static_cast<double>(repetitions);
    fmt::print("{:<30}{:>12.1f}{:>14.2f}{:>16.2f}{:>18.2f}", names[i], 1e6 * once, 1e9 * once / static_cast<double>(n),
               times[i] / times[0], times[i] / fastest);
    if (i >= solves) fmt::print("{:>16.0f}", marches[i - solves]->bytes() / static_cast<double>(n));
    fmt::print("\n");
  }
}

}  // namespace

/// Sizes may be given; by default four, for proportionality.
int main(int count, char** words) {
  std::vector<rubato::Index> sizes;
  for (int i = 1; i < count; ++i) sizes.push_back(std::atol(words[i]));
  if (sizes.empty()) sizes = {1'000, 10'000, 100'000, 1'000'000};
  for (const rubato::Index n : sizes) compare(n);
}
