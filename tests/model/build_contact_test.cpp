#include <rubato/core/error.hpp>
#include <rubato/model/model.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

// Contacts: from directions or shares to the columns of their numbers, and what is refused.
namespace rubato::model {
namespace {

ModelDescription two_nodes(std::vector<double> at) {
  ModelDescription model;
  for (const char* name : {"a", "b"}) {
    NodeDescription node;
    node.name = name;
    for (const double x : at) node.position.emplace_back(x);
    model.structure.nodes.push_back(node);
    PointMassDescription mass;
    mass.node = name;
    mass.mass = 1.0;
    model.structure.masses.push_back(mass);
  }
  ContactDescription contact;
  contact.name = "c";
  contact.between = {"a", "b"};
  contact.normal_direction = at.size() == 2 ? std::vector<Quantity>{0.0, 2.0} : std::vector<Quantity>{0.0, 0.0, 2.0};
  contact.tangential_stiffness = 3.0;
  contact.normal_stiffness = 5.0;
  contact.friction_coefficient = 0.5;
  model.contacts.push_back(contact);
  return model;
}

ModelDescription two_coordinates() {
  ModelDescription model;
  for (const char* name : {"x", "z"}) {
    CoordinateDescription coordinate;
    coordinate.name = name;
    coordinate.mass = 1.0;
    model.coordinates.push_back(coordinate);
  }
  ContactDescription contact;
  contact.name = "c";
  contact.tangential = {{{"x", 1.0}}};
  contact.normal = {{"z", "w"}};
  contact.tangential_stiffness = 3.0;
  contact.normal_stiffness = 5.0;
  contact.friction_coefficient = 0.5;
  model.contacts.push_back(contact);
  return model;
}

std::string refusal_of(const ModelDescription& model) {
  try {
    build(model, {{"w", 2.0}});
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return "";
}

/// u of a number of the first contact where coordinates are displaced.
double number_of(const Model& model, std::size_t number, const std::vector<std::pair<std::string, double>>& moved) {
  double u = 0.0;
  for (const Share& share : model.blocks.front().columns[number])
    for (const auto& [name, value] : moved)
      if (model.coordinates[static_cast<std::size_t>(share.coordinate)] == name) u += share.weight * value;
  return u;
}

// n = +y of b, which a lies on: pressed where a goes down; t = e_z x n = -x.
TEST(Contact, OfNodesInThePlaneHasTheSignsOfItsNormal) {
  const Model model = build(two_nodes({0.0, 0.0}), {});
  ASSERT_EQ(model.blocks.size(), 1U);
  EXPECT_EQ(model.blocks.front().law->size(), 2);
  EXPECT_EQ(number_of(model, 0, {{"a.x", 1.0}}), -1.0);
  EXPECT_EQ(number_of(model, 0, {{"b.x", 1.0}}), 1.0);
  EXPECT_EQ(number_of(model, 0, {{"a.y", 1.0}}), 0.0);
  EXPECT_EQ(number_of(model, 1, {{"a.y", -1.0}}), 1.0);
  EXPECT_EQ(number_of(model, 1, {{"b.y", 1.0}, {"b.x", 4.0}}), 1.0);
}

TEST(Contact, OfNodesInSpaceHasTwoDirectionsAcrossItsNormal) {
  ModelDescription description = two_nodes({0.0, 0.0, 0.0});
  description.contacts.front().between = {"a", "ground"};
  description.contacts.front().tangential_direction = {1.0, 1.0, 0.0};
  const Model model = build(description, {});
  ASSERT_EQ(model.blocks.front().law->size(), 3);
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(number_of(model, 0, {{"a.x", 1.0}}), half, 1e-15);
  EXPECT_NEAR(number_of(model, 0, {{"a.y", 1.0}}), half, 1e-15);
  EXPECT_NEAR(number_of(model, 1, {{"a.x", 1.0}}), -half, 1e-15);  // n x t1
  EXPECT_NEAR(number_of(model, 1, {{"a.y", 1.0}}), half, 1e-15);
  EXPECT_NEAR(number_of(model, 2, {{"a.z", 1.0}}), -1.0, 1e-15);
  // Unless told the axis that is least along the normal.
  description.contacts.front().tangential_direction.clear();
  description.contacts.front().normal_direction = {0.0, 0.6, 0.8};
  EXPECT_NEAR(number_of(build(description, {}), 0, {{"a.x", 1.0}}), 1.0, 1e-15);
}

TEST(Contact, TakesSharesAsTheyAreAndDropsWhatDoesNotMove) {
  ModelDescription description = two_coordinates();
  description.contacts.front().tangential.front().emplace_back("ground", 3.0);
  const Model model = build(description, {{"w", 2.0}});
  EXPECT_EQ(number_of(model, 0, {{"x", 1.0}}), 1.0);
  EXPECT_EQ(number_of(model, 1, {{"z", 1.0}}), 2.0);
}

TEST(Contact, RubsNotWithoutACoefficientOfFriction) {
  ModelDescription description = two_nodes({0.0, 0.0, 0.0});
  description.contacts.front().friction_coefficient.reset();
  description.contacts.front().tangential_stiffness.reset();
  const Model model = build(description, {});
  EXPECT_EQ(model.blocks.front().law->size(), 1);
  EXPECT_NEAR(number_of(model, 0, {{"a.z", -1.0}}), 1.0, 1e-15);
}

TEST(Contact, IsPressedByItsLoadOrOpenByItsGap) {
  ModelDescription description = two_coordinates();
  EXPECT_EQ(build(description, {{"w", 2.0}}).blocks.front().law->clearance(), 0.0);
  description.contacts.front().gap = 0.1;
  EXPECT_EQ(build(description, {{"w", 2.0}}).blocks.front().law->clearance(), 0.1);
  description.contacts.front().gap.reset();
  description.contacts.front().normal_load = 10.0;
  EXPECT_EQ(build(description, {{"w", 2.0}}).blocks.front().law->clearance(), -2.0);
}

TEST(Contact, IsRefusedByName) {
  const auto of_nodes = [](const auto& change, std::vector<double> at = {0.0, 0.0, 0.0}) {
    ModelDescription description = two_nodes(std::move(at));
    change(description.contacts.front());
    return refusal_of(description);
  };
  const auto of_coordinates = [](const auto& change) {
    ModelDescription description = two_coordinates();
    change(description.contacts.front());
    return refusal_of(description);
  };
  using testing::HasSubstr;
  EXPECT_THAT(of_nodes([](auto& c) { c.tangential_direction = {1.0, 0.0, 0.1}; }), HasSubstr("not at a right angle"));
  EXPECT_THAT(of_nodes([](auto& c) { c.tangential_direction = {0.0, 0.0, 0.0}; }), HasSubstr("has no length"));
  EXPECT_THAT(of_nodes([](auto& c) { c.normal_direction = {0.0, 0.0, 0.0}; }), HasSubstr("has no length"));
  EXPECT_THAT(of_nodes([](auto& c) { c.normal_direction = {0.0, 1.0}; }), HasSubstr("takes 3 numbers"));
  EXPECT_THAT(of_nodes(
                  [](auto& c) {
                    c.tangential_direction = {1.0, 0.0, 0.0};
                  },
                  {0.0, 0.0}),
              HasSubstr("leave tangential_direction out"));
  EXPECT_THAT(of_nodes([](auto& c) { c.between = {"a", "c"}; }), HasSubstr("\"c\", which is no node"));
  EXPECT_THAT(of_nodes([](auto& c) { c.between = {"a", "a"}; }), HasSubstr("with itself"));
  EXPECT_THAT(of_nodes([](auto& c) { c.normal_stiffness = -1.0; }), HasSubstr("normal_stiffness must be positive"));
  EXPECT_THAT(of_nodes([](auto& c) { c.tangential_stiffness = 0.0; }),
              HasSubstr("tangential_stiffness must be positive"));
  EXPECT_THAT(of_nodes([](auto& c) { c.friction_coefficient = -0.1; }), HasSubstr("friction_coefficient"));
  EXPECT_THAT(of_nodes([](auto& c) { c.normal_load = -3.0; }), HasSubstr("give it a gap"));
  EXPECT_THAT(of_coordinates([](auto& c) { c.normal = {{"y", 1.0}}; }), HasSubstr("\"y\", which is no coordinate"));
  EXPECT_THAT(of_coordinates([](auto& c) { c.normal = {{"ground", 1.0}}; }), HasSubstr("no coordinate that moves"));
  EXPECT_THAT(of_coordinates([](auto& c) {
                c.normal.clear();
                c.tangential.clear();
                c.between = {"x", "ground"};
                c.normal_direction = {0.0, 1.0};
              }),
              HasSubstr("which is a coordinate and has no directions"));
  EXPECT_THAT(of_coordinates([](auto& c) { c.name = "x"; }), HasSubstr("results would mix them up"));
}

}  // namespace
}  // namespace rubato::model
