#include <rubato/model/model.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace rubato::model {
namespace {

/// Two masses on a spring between them and one to the ground, written as a C++ program would.
ModelDescription two_masses() {
  ModelDescription description;
  description.coordinates = {{"disk", 10.0, 0.0, 0.0, {}}, {"blade", "m", 0.25, "-v", {}}};
  description.springs = {{{"disk", "ground"}, {}, 100.0, {}}, {{"disk", "blade"}, {}, 50.0, {}}};
  return description;
}

const numerics::Parameters parameters{{"m", 2.0}, {"v", 3.0}};

std::string fault_of(const ModelDescription& description) {
  try {
    (void)build(description, parameters);
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

TEST(Model, TakesItsNumbersFromTheParameters) {
  const Model model = build(two_masses(), parameters);
  ASSERT_EQ(model.size(), 2);
  EXPECT_EQ(model.mass[1], 2.0);
  EXPECT_EQ(model.position[1], 0.25);
  EXPECT_EQ(model.velocity[1], -3.0);
  EXPECT_EQ(build(two_masses(), {{"m", 4.0}, {"v", 0.0}}).mass[1], 4.0);
}

TEST(Model, JoinsCoordinatesAndTheGround) {
  const Model model = build(two_masses(), parameters);
  ASSERT_EQ(model.springs.size(), 2u);
  EXPECT_EQ(model.springs[0].first, 0);
  EXPECT_EQ(model.springs[0].second, ground);
  EXPECT_EQ(model.springs[1].second, 1);
}

TEST(Model, AMisspeltGroundIsRecognised) {
  ModelDescription description = two_masses();
  description.springs[0].between = {"blade", "gruond"};
  try {
    build(description, parameters);
    FAIL() << "accepted";
  } catch (const InvalidInput& fault) {
    EXPECT_EQ(fault.message(),
              "the spring between \"blade\" and \"gruond\" joins \"gruond\", which is no coordinate; did you mean "
              "\"ground\"? (known: ground)");
  }
}

TEST(Model, SlidersSlipAtFrictionCoefficientTimesNormalLoad) {
  ModelDescription description = two_masses();
  SliderDescription slider;
  slider.name = "contact";
  slider.between = {"blade", "ground"};
  slider.stiffness = 10.0;
  slider.friction_coefficient = 0.5;
  slider.normal_load = "10 * m";
  description.sliders = {slider};
  EXPECT_EQ(build(description, parameters).sliders.at(0).limit, 10.0);
}

TEST(Model, FrequencyInHertzIsTurnedIntoRadiansPerSecond) {
  ModelDescription description = two_masses();
  HarmonicDescription harmonic;
  harmonic.amplitude = -2.0;
  harmonic.angular_frequency = 3.0;
  harmonic.frequency_in_hertz = true;
  description.forces = {{"blade", harmonic, {}}};
  const Model model = build(description, parameters);
  const auto& law = std::get<HarmonicLaw>(model.forces.at(0).law);
  EXPECT_EQ(law.amplitude, -2.0);
  EXPECT_DOUBLE_EQ(law.angular_frequency, 6.0 * std::numbers::pi);
}

// x = X cos(w t) has the acceleration -w^2 X cos(w t), v = V cos(w t) has -w V sin(w t) = w V cos(w t + pi/2).
TEST(Model, BaseMotionIsTurnedIntoAcceleration) {
  ModelDescription description = two_masses();
  BaseMotionDescription motion;
  HarmonicDescription harmonic;
  harmonic.amplitude = 0.5;
  harmonic.angular_frequency = 4.0;
  motion.law = harmonic;
  motion.of = BaseMotionDescription::Of::displacement;
  description.base_motion = motion;
  const Model of_displacement = build(description, parameters);
  const auto& displaced = std::get<HarmonicLaw>(of_displacement.base_motion->law);
  EXPECT_DOUBLE_EQ(displaced.amplitude * std::cos(displaced.phase), -8.0);

  description.base_motion->of = BaseMotionDescription::Of::velocity;
  description.base_motion->direction = {{"blade", 2.0}};
  const Model of_velocity = build(description, parameters);
  const double quarter = std::numbers::pi / 8.0;  // a quarter of the period
  // cos(pi): one rounding of the phase, 2e-16 of a slope that vanishes there.
  EXPECT_NEAR(value(of_velocity.base_motion->law, quarter), -2.0, 1e-14);
  EXPECT_EQ(of_velocity.base_motion->direction[0], 0.0);
  EXPECT_EQ(of_velocity.base_motion->direction[1], 2.0);
}

TEST(ModelFault, IsSaidWithoutAPlaceWhereThereIsNone) {
  ModelDescription description = two_masses();
  description.coordinates[1].mass = "m - 2";
  EXPECT_EQ(
      fault_of(description),
      "error: coordinate \"blade\": mass is 0, which makes the mass matrix singular; give it a mass, or remove the "
      "coordinate and join its springs in series");
  description = two_masses();
  description.springs[1].between[1] = "blad";
  EXPECT_EQ(
      fault_of(description),
      "error: the spring between \"disk\" and \"blad\" joins \"blad\", which is no coordinate; did you mean \"blade\"? "
      "(known: disk, blade)");
}

TEST(Parameters, AreReplacedByOverridesBeforeThoseThatUseThem) {
  const std::vector<ParameterDescription> described{{"a", 1.0, {}}, {"b", "2 * a", {}}};
  EXPECT_EQ(evaluate_parameters(described).at(1).second, 2.0);
  EXPECT_EQ(evaluate_parameters(described, {{"a", 5.0}}).at(1).second, 10.0);
}

TEST(ParametersFault, IsSaidOfAnOverrideThatNamesNone) {
  const auto fault = [](const std::vector<ParameterDescription>& described) -> std::string {
    try {
      (void)evaluate_parameters(described, {{"N1", 5.0}});
      return "accepted";
    } catch (const InvalidInput& error) {
      return error.what();
    }
  };
  EXPECT_EQ(fault({{"N0", 1.0, {}}}), "error: --set N1: no such parameter; did you mean \"N0\"? (known: N0)");
  EXPECT_EQ(fault({}), "error: --set N1: no such parameter; the study has no [parameters]");
}

}  // namespace
}  // namespace rubato::model
