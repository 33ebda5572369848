#include <rubato/steady/marching/lane_map.hpp>

#include <rubato/integrate/catalogue.hpp>
#include <rubato/steady/marching/stepper_map.hpp>

#include <support/models.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato::steady {
namespace {

SteadyRequest all_of(const system::LocallyNonlinear& system) {
  SteadyRequest request;
  for (Index i = 0; i < system.size(); ++i) request.observed.push_back({i, ground});
  return request;
}

// The damper model with static and higher loads, phases, a third slider, and dashpots that couple the modes if asked
// to.
system::LocallyNonlinear rich_model(bool couples_modes) {
  const auto base = testing::damper_model(20.0, 7.5);
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  Matrix damping(base.damping());
  if (couples_modes) damping(1, 1) += 0.7;
  parts.damping = testing::sparse(damping);
  parts.stiffness = base.stiffness();
  parts.sliders = base.sliders();
  parts.sliders.push_back({"third", 0, ground, 40.0, 3.0});
  parts.start.q = Vector::LinSpaced(5, -0.5, 1.0);
  parts.start.v = Vector::LinSpaced(5, 2.0, -3.0);
  parts.coordinates = base.coordinates();
  parts.loads = system::Loads({testing::harmonic(1, 20.0, 7.5, 0.3), testing::harmonic(3, -8.0, 7.5),
                               testing::harmonic(2, 5.0, 22.5, 1.0), testing::harmonic(4, 3.0, 0.0)});
  return system::LocallyNonlinear(std::move(parts));
}

PeriodRecord march(PeriodMap& map, const system::LocallyNonlinear& system, const system::Excitation& excitation,
                   int steps, int periods) {
  std::vector<PeriodRecord> records(1);
  records[0].reset(system.size(), system, static_cast<Index>(steps) * periods, true, true);
  EXPECT_TRUE(map.prepare({&excitation, 1}, steps));
  LaneArray now = LaneArray::Zero(map.size(), 1), next;
  map.encode(system.start(), now, 0);
  for (int i = 0; i < periods; ++i) {
    EXPECT_TRUE(map.advance(now, next, &records, static_cast<Index>(i) * steps));
    std::swap(now, next);
  }
  return records[0];
}

double largest_difference(const Matrix& a, const Matrix& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

TEST(LaneMap, TakesTheStepsOfTheSteppers) {
  for (const bool couples_modes : {false, true}) {
    const auto system = rich_model(couples_modes);
    const auto request = all_of(system);
    const system::Excitation excitation = excitation_of(system);
    for (const char* name :
         {"exponential", "average_acceleration", "generalized_alpha", "hht", "central_difference", "damped_newmark"}) {
      SCOPED_TRACE(name);
      const integrate::Method method = integrate::make_method(name);
      const auto lanes = make_lane_map(method, system, request);
      const auto steppers = make_stepper_map(method, system, request);
      ASSERT_NE(lanes, nullptr);
      const PeriodRecord a = march(*lanes, system, excitation, 100, 5);
      const PeriodRecord b = march(*steppers, system, excitation, 100, 5);
      // 500 steps in other coordinates, none of which amplifies: round-off of 1e-16 adds up to less than 1e-11.
      EXPECT_LT(largest_difference(a.position, b.position), 1e-11);
      EXPECT_LT(largest_difference(a.velocity, b.velocity), 1e-11);
      EXPECT_LT(largest_difference(a.acceleration, b.acceleration), 1e-10);
      EXPECT_LT(largest_difference(a.slider_force, b.slider_force), 1e-10);
      EXPECT_LT(largest_difference(a.displacement, b.displacement), 1e-11);
      EXPECT_NEAR(a.viscous_work, b.viscous_work, 1e-10 * std::abs(b.viscous_work));
      EXPECT_NEAR(a.input_work, b.input_work, 1e-10 * std::abs(b.viscous_work));
      // The sliders did slip and stick: the comparison would be idle otherwise.
      EXPECT_EQ(b.slider_force.row(0).maxCoeff(), excitation.limits[0]);
      EXPECT_LT(b.slider_force.row(0).cwiseAbs().minCoeff(), 0.9 * excitation.limits[0]);
    }
  }
}

TEST(LaneMap, GivesEveryLaneTheBitsOfAPointAlone) {
  const auto system = rich_model(false);
  const auto request = all_of(system);
  for (const char* name : {"exponential", "generalized_alpha"}) {
    SCOPED_TRACE(name);
    const auto map = make_lane_map(integrate::make_method(name), system, request);
    for (const std::size_t count : {std::size_t{2}, std::size_t{5}, std::size_t{16}}) {
      std::vector<system::Excitation> excitations(count, excitation_of(system));
      for (std::size_t l = 0; l < count; ++l) {
        excitations[l].limits *= 0.2 * static_cast<double>(l);
        excitations[l].harmonics[0].amplitude *= 1.0 + 0.1 * static_cast<double>(l);
      }
      ASSERT_TRUE(map->prepare(excitations, 60));
      LaneArray states(map->size(), static_cast<Index>(count)), together, alone;
      for (Index l = 0; l < states.cols(); ++l) map->encode(system.start(), states, l);
      ASSERT_TRUE(map->advance(states, together, nullptr, 0));
      for (Index l = 0; l < states.cols(); ++l) {
        ASSERT_TRUE(map->prepare({&excitations[static_cast<std::size_t>(l)], 1}, 60));
        ASSERT_TRUE(map->advance(states.col(l), alone, nullptr, 0));
        EXPECT_TRUE((alone.col(0) == together.col(l)).all()) << "lane " << l << " of " << count;
      }
    }
  }
}

TEST(LaneMap, LeavesAnUndampedResonanceToTheSteppers) {
  const auto system = testing::single_mass(0.15, 1.0, 0.0);
  const auto request = all_of(system);
  const auto map = make_lane_map(integrate::make_method("exponential"), system, request);
  const system::Excitation excitation = excitation_of(system);
  EXPECT_FALSE(map->prepare({&excitation, 1}, 64));
}

}  // namespace
}  // namespace rubato::steady
