#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>

#include "measure.hpp"
#include "support/laws.hpp"
#include "support/models.hpp"

#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

// A step with laws by the general route beside the same step with sliders, whose forces are known in closed form.
namespace {

using namespace rubato;

constexpr long steps = 20'000;
constexpr int rounds = 15;

struct Contestant {
  std::string name;
  system::LocallyNonlinear system;
};

/// The under-platform damper with a law in the place of each slider.
system::LocallyNonlinear damper_on(const std::shared_ptr<const model::Law>& law) {
  const auto with_sliders = testing::damper_model(20.0, 7.777, -8.0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = with_sliders.mass();
  parts.damping = with_sliders.damping();
  parts.stiffness = with_sliders.stiffness();
  parts.laws = {{"law", "contact1", 1, 4, law}, {"law", "contact2", 3, 4, law}};
  parts.loads = system::Loads({testing::harmonic(1, 20.0, 7.777), testing::harmonic(3, -8.0, 7.777)});
  parts.coordinates = {"disk1", "blade1", "disk2", "blade2", "damper"};
  return system::LocallyNonlinear(std::move(parts));
}

void compare(const char* title, const std::vector<Contestant>& contestants, double step) {
  std::vector<std::function<void()>> tasks;
  std::vector<std::shared_ptr<integrate::Stepper>> steppers;
  for (const auto& [name, system] : contestants) {
    steppers.push_back(integrate::make_stepper(integrate::make_method("generalized_alpha"), system));
    tasks.emplace_back([stepper = steppers.back(), step, &system = system] {
      system::State state = integrate::consistent_start(system, system.start());
      integrate::march(*stepper, state, step, step * static_cast<double>(steps));
      benchmarks::keep(state.q[0]);
    });
  }
  const auto times = benchmarks::median_times(tasks, rounds);
  fmt::print("\n{}\n{:<36}{:>10}{:>12}\n", title, "", "ns/step", "/ sliders");
  for (std::size_t i = 0; i < tasks.size(); ++i)
    fmt::print("{:<36}{:>10.1f}{:>12.2f}{}\n", contestants[i].name, 1e9 * times[i] / static_cast<double>(steps),
               times[i] / times[0], i == 1 ? "   (asked for: at most 3)" : "");
}

}  // namespace

int main() {
  const auto bouc_wen = [](double stiffness, double n) {
    return testing::made("bouc_wen", {stiffness, 0.1, 1.0, 0.5, 0.5, n});
  };
  compare("One coordinate, a step of 0.01 s",
          {{"slider", testing::single_mass(0.15)},
           {"the same as a law", testing::single_mass_on(std::make_shared<testing::JenkinsLaw>(1.0, 0.15))},
           {"bouc_wen, n = 1", testing::single_mass_on(bouc_wen(1.0, 1.0))},
           {"bouc_wen, n = 1.5", testing::single_mass_on(bouc_wen(1.0, 1.5))},
           {"nonlinear_spring u + 0.1*u^3", testing::single_mass_on(testing::spring("u + 0.1*u^3"))}},
          0.01);
  compare("Damper model: five coordinates, two of them, a step of 0.005 s",
          {{"sliders", testing::damper_model(20.0, 7.777, -8.0)},
           {"the same as laws", damper_on(std::make_shared<testing::JenkinsLaw>(10.0, 10.0))},
           {"bouc_wen, n = 1", damper_on(bouc_wen(10.0, 1.0))},
           {"bouc_wen, n = 1.5", damper_on(bouc_wen(10.0, 1.5))},
           {"nonlinear_spring u + 0.1*u^3", damper_on(testing::spring("u + 0.1*u^3"))}},
          0.005);
}
