#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>

#include "bare_loops.hpp"
#include "measure.hpp"
#include "support/models.hpp"

#include <fmt/core.h>

#include <memory>

// A step of every method through the public driver, beside a loop of average acceleration written out by hand for the
// very model: what a step would cost without any generality.
namespace {

using namespace rubato;

constexpr long steps = 20'000;
constexpr int rounds = 15;

class March {
 public:
  March(const system::LocallyNonlinear& system, const std::string& method, double step)
      : system_(system), stepper_(integrate::make_stepper(integrate::make_method(method), system)), step_(step) {}
  void operator()() {
    system::State state = integrate::consistent_start(system_, system_.start());
    integrate::march(*stepper_, state, step_, step_ * static_cast<double>(steps));
    benchmarks::keep(state.q[0]);
  }

 private:
  const system::LocallyNonlinear& system_;
  std::unique_ptr<integrate::Stepper> stepper_;
  double step_;
};

void compare(const char* title, const system::LocallyNonlinear& system, double step, double target,
             const std::function<void()>& bare, const std::function<void()>& bare_with_cosine) {
  std::vector<std::string> names{"bare loop", "bare loop with its cosine"};
  std::vector<std::function<void()>> tasks{bare, bare_with_cosine};
  std::vector<std::unique_ptr<March>> marches;
  for (const auto& method : integrate::catalogue()) {
    if (method.name == "newmark" || method.name == "exact") continue;  // no numbers of its own; takes no step
    marches.push_back(std::make_unique<March>(system, method.name, step));
    names.push_back(method.name);
    tasks.emplace_back([march = marches.back().get()] { (*march)(); });
  }
  const auto times = benchmarks::median_times(tasks, rounds);
  fmt::print("\n{}\n{:<28}{:>10}{:>12}{:>22}\n", title, "", "ns/step", "/ bare", "/ bare with cosine");
  for (std::size_t i = 0; i < tasks.size(); ++i)
    fmt::print("{:<28}{:>10.1f}{:>12.2f}{:>22.2f}{}\n", names[i], 1e9 * times[i] / static_cast<double>(steps),
               times[i] / times[0], times[i] / times[1],
               names[i] == "generalized_alpha" ? fmt::format("   (asked for: at most {:.0f} ns)", target) : "");
}

}  // namespace

int main() {
  using namespace rubato::benchmarks;
  const double h1 = 0.01, h5 = 0.005, omega = 7.777;
  const auto one = rubato::testing::single_mass(0.15);
  BareOne bare_one(one, h1, steps);
  compare(
      "One coordinate with a slider", one, h1, 50.0, [&] { keep(bare_one.run(steps, false)); },
      [&] { keep(bare_one.run(steps, true)); });
  const auto damper = rubato::testing::damper_model(20.0, omega, -8.0);
  BareDamper bare_damper(damper, h5, steps);
  compare(
      "Damper model: five coordinates, two sliders", damper, h5, 120.0, [&] { keep(bare_damper.run(steps, false)); },
      [&] { keep(bare_damper.run(steps, true)); });
}
