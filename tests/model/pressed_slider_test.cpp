#include <rubato/core/error.hpp>
#include <rubato/model/model.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// Sliders whose normal load is a formula of t, or the force of another part.
namespace rubato::model {
namespace {

ModelDescription two_masses() {
  ModelDescription model;
  for (const char* name : {"x", "z"}) {
    CoordinateDescription coordinate;
    coordinate.name = name;
    coordinate.mass = 1.0;
    model.coordinates.push_back(coordinate);
  }
  StopDescription stop;
  stop.name = "wall";
  stop.between = {"z", "ground"};
  stop.gap = 0.0;
  stop.stiffness = 2.0;
  model.stops.push_back(stop);
  SliderDescription slider;
  slider.name = "rub";
  slider.between = {"x", "ground"};
  slider.stiffness = 3.0;
  slider.friction_coefficient = 0.5;
  slider.normal_load = 4.0;
  model.sliders.push_back(slider);
  return model;
}

std::string refusal_of(const ModelDescription& model) {
  try {
    build(model, {{"N0", 2.0}});
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return "";
}

TEST(PressedSlider, StaysInClosedFormUnderALoadThatStaysTheSame) {
  ModelDescription model = two_masses();
  for (const Quantity& load : {Quantity(4.0), Quantity("2*N0"), Quantity("N0 + tanh(N0)^0 + 1")}) {
    model.sliders.front().normal_load = load;
    EXPECT_FALSE(model.sliders.front().is_law());
    const Model built = build(model, {{"N0", 2.0}});
    EXPECT_TRUE(built.laws.empty());
    EXPECT_EQ(built.sliders.front().limit, 2.0);
  }
}

TEST(PressedSlider, IsALawUnderAFormulaOfTime) {
  ModelDescription model = two_masses();
  model.sliders.front().normal_load = "N0*(1 + t)";
  const Model built = build(model, {{"N0", 2.0}});
  EXPECT_TRUE(built.sliders.empty());
  ASSERT_EQ(built.laws.size(), 1U);
  EXPECT_EQ(built.laws.front().name, "rub");
  EXPECT_TRUE(built.laws.front().law->takes_normal());
  EXPECT_EQ(built.laws.front().normal.at(0.5, Side::right), 3.0);
}

TEST(PressedSlider, FindsThePartThatPresses) {
  ModelDescription model = two_masses();
  model.sliders.front().normal_law = "wall";
  const Model built = build(model, {});
  ASSERT_EQ(built.laws.size(), 1U);
  EXPECT_EQ(built.laws.front().normal.stop, 0);
  EXPECT_TRUE(built.laws.front().normal.depends_on_motion());
}

TEST(PressedSlider, IsRefusedWhereNothingPresses) {
  ModelDescription model = two_masses();
  model.sliders.front().normal_law = "wal";
  EXPECT_THAT(refusal_of(model), testing::HasSubstr("which is no stop and no law; did you mean \"wall\"?"));
  model.sliders.front().normal_law = "rub";
  EXPECT_THAT(refusal_of(model), testing::HasSubstr("rubs, it does not press"));
  model.sliders.front().normal_law = "";
  model.sliders.front().normal_load = "N1 + t";
  EXPECT_THAT(refusal_of(model), testing::HasSubstr("normal_load: "));
  model.sliders.front().normal_load = "1/t";
  EXPECT_THAT(refusal_of(model), testing::HasSubstr("normal_load is inf at t = 0"));
  model.sliders.front().normal_load = "t";
  model.sliders.push_back(model.sliders.front());
  EXPECT_THAT(refusal_of(model), testing::HasSubstr("two sliders are called \"rub\""));
}

TEST(PressedSlider, IsNotPressedByAContact) {
  ModelDescription model = two_masses();
  ContactDescription contact;
  contact.name = "pad";
  contact.normal = {{"z", 1.0}};
  contact.normal_stiffness = 2.0;
  model.contacts.push_back(contact);
  model.sliders.front().normal_law = "pad";
  EXPECT_EQ(
      refusal_of(model),
      "slider \"rub\": normal_load names the contact \"pad\", and contacts cannot press a slider; name a [[stop]] "
      "across it, or make the slider a [[contact]] of its own");
}

}  // namespace
}  // namespace rubato::model
