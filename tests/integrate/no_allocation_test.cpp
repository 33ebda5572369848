#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include "support/double_pendulum.hpp"
#include "support/locking_bars.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Every allocation of this executable is counted: the linker sends malloc and its kin here (-Wl,--wrap), which is where
// Eigen and operator new end up.
namespace {
std::atomic<long> allocations{0};
}

extern "C" {
void* __real_malloc(std::size_t);
void* __real_calloc(std::size_t, std::size_t);
void* __real_realloc(void*, std::size_t);
void* __wrap_malloc(std::size_t size) {
  ++allocations;
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* place, std::size_t size) {
  ++allocations;
  return __real_realloc(place, size);
}
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* place = __real_malloc(size == 0 ? 1 : size)) return place;
  throw std::bad_alloc();
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

namespace rubato::integrate {
namespace {

// The first steps factorise and size what is theirs; a driver holds a second state, whose making is counted apart.
long allocations_of_a_thousand_steps(const system::LocallyNonlinear& system, const std::string& method) {
  const auto stepper = make_stepper(make_method(method), system);
  system::State a = consistent_start(system, system.start()), b = a;
  for (int i = 0; i < 50; ++i) {
    stepper->attempt(a, 0.01, 0.01 * (i + 1), b);
    std::swap(a, b);
  }
  const long before = allocations;
  for (int i = 50; i < 1050; ++i) {
    if (stepper->attempt(a, 0.01, 0.01 * (i + 1), b).outcome != StepOutcome::accepted) return -1;
    std::swap(a, b);
  }
  return allocations - before;
}

TEST(Step, AllocatesNothing) {
  for (const char* method : {"rk4", "dormand_prince", "central_difference", "average_acceleration", "wilson_theta",
                             "hht", "generalized_alpha", "exponential"}) {
    EXPECT_EQ(allocations_of_a_thousand_steps(testing::single_mass(0.15), method), 0) << method;
    EXPECT_EQ(allocations_of_a_thousand_steps(testing::damper_model(10.0, 7.7, -8.0), method), 0) << method;
    EXPECT_EQ(allocations_of_a_thousand_steps(testing::chain(40, 5, 0.05), method), 0) << method;
    EXPECT_EQ(allocations_of_a_thousand_steps(testing::chain(150, 12, 0.05), method), 0) << method;
  }
  EXPECT_EQ(allocations_of_a_thousand_steps(testing::plate(20, 4, 0.02), "generalized_alpha"), 0);
}

long allocations_of_steps(const system::Mechanism& mechanism) {
  const auto stepper = make_stepper(make_method("generalized_alpha"), mechanism);
  system::MechanismEquations equations(mechanism);
  system::State a = make_consistent(equations, mechanism.start()).state, b = a;
  long before = 0;
  for (int i = 0; i < 250; ++i) {
    if (i == 50) before = allocations;
    if (stepper->attempt(a, 0.002, 0.002 * (i + 1), b).outcome != StepOutcome::accepted) return -1;
    std::swap(a, b);
  }
  return allocations - before;
}

TEST(Step, OfAMechanismAllocatesNothing) {
  EXPECT_EQ(allocations_of_steps(system::Mechanism(testing::double_pendulum())), 0);
  EXPECT_EQ(allocations_of_steps(system::Mechanism(testing::locking_bars(testing::LockingLaw::latch).mechanism)), 0);
}

TEST(Step, OfASavedStateOfAMechanismRepeatsItsBits) {
  const system::Mechanism mechanism(testing::locking_bars(testing::LockingLaw::none).mechanism);
  const auto method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, mechanism);
  system::MechanismEquations equations(mechanism);
  system::State state = make_consistent(equations, mechanism.start()).state;
  march(*stepper, state, 1e-3, 0.1);
  system::State again = state;
  march(*stepper, state, 1e-3, 0.2);
  march(*make_stepper(method, mechanism), again, 1e-3, 0.2);
  EXPECT_EQ(again.q, state.q);
  EXPECT_EQ(again.v, state.v);
  EXPECT_EQ(again.multiplier, state.multiplier);
}

// Retry and restart are exact because there is nothing else than the state.
TEST(Step, OfASavedStateRepeatsItsBits) {
  const auto system = testing::chain(150, 12, 0.05);
  for (const char* method : {"generalized_alpha", "wilson_theta", "exponential", "rk4"}) {
    const auto stepper = make_stepper(make_method(method), system);
    system::State state = consistent_start(system, system.start());
    march(*stepper, state, 0.05, 10.0);
    const system::State saved = state;
    system::State end = state;
    march(*stepper, end, 0.05, 20.0);
    system::State again = saved;
    const auto fresh = make_stepper(make_method(method), system);
    march(*fresh, again, 0.05, 20.0);
    EXPECT_EQ(again.q, end.q) << method;
    EXPECT_EQ(again.v, end.v) << method;
    EXPECT_EQ(again.slider_force, end.slider_force) << method;
  }
}

TEST(Driver, CountsItsTimesAndShortensTheLastStep) {
  struct Times final : Observer {
    bool accepted(const system::State&, const system::State& after) override {
      times.push_back(after.t);
      return true;
    }
    std::vector<double> times;
  } times;
  const auto system = testing::single_mass();
  const auto stepper = make_stepper(make_method("generalized_alpha"), system);
  system::State state = consistent_start(system, system.start());
  march(*stepper, state, 0.1, 1.05, &times);
  ASSERT_EQ(times.times.size(), 11u);
  EXPECT_EQ(times.times[2], 0.1 * 3);  // a multiple, not a sum
  EXPECT_EQ(times.times.back(), 1.05);
}

}  // namespace
}  // namespace rubato::integrate
