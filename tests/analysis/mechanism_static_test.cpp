#include <rubato/integrate/equilibrium/static_equilibrium.hpp>

#include "support/assembled.hpp"
#include "support/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Structures that are mechanisms: no equilibrium, and what moves is named.
namespace rubato::analysis {
namespace {

using integrate::find_equilibrium;
using integrate::StaticEquilibrium;
using integrate::StaticOutcome;
using testing::assembled;
using testing::place_of;
using testing::portal;

// Hinges at all four corners make a four-bar linkage, whose beam swings sideways.
TEST(StaticEquilibrium, OfAFourBarLinkageDoesNotExist) {
  model::ModelDescription description = portal(3.0, 4.0);
  for (auto& beam : description.structure.beams) beam.release = {{{"rz"}, {"rz"}}};
  const auto system = assembled(description);
  EXPECT_EQ(system.size(), 4);  // no corner shares a rotation with anything
  const StaticEquilibrium found = find_equilibrium(system, {});
  ASSERT_EQ(found.outcome, StaticOutcome::mechanism);
  std::vector<std::string> names;
  for (const Index i : found.moving) names.push_back(system.coordinates()[static_cast<std::size_t>(i)]);
  EXPECT_EQ(names, (std::vector<std::string>{"2.x", "3.x"}));
}

/// A bar from a clamped node "a" to "b" along `along`, hinged at both ends, with a unit load on b.`loaded`.
system::LocallyNonlinear hinged_bar(std::vector<double> along, model::BeamDescription::Formulation formulation,
                                    const std::string& loaded) {
  const bool in_plane = along.size() == 2;
  model::ModelDescription description = portal(3.0, 4.0);
  model::StructureDescription& bar = description.structure;
  bar.nodes.resize(2);
  bar.nodes[0].name = "a";
  bar.nodes[0].position.assign(along.size(), 0.0);
  bar.nodes[1].name = "b";
  bar.nodes[1].position.assign(along.begin(), along.end());
  bar.sections[0].shear_factor = {0.8};
  if (!in_plane) {
    bar.sections[0].inertia = {2e-6, 1e-6};
    bar.sections[0].torsion = 1e-7;
    bar.sections[0].shear_factor = {0.8, 0.7};
  }
  bar.beams.resize(1);
  bar.beams[0].nodes = {"a", "b"};
  bar.beams[0].formulation = formulation;
  bar.beams[0].release = {{{"rz"}, {"rz"}}};
  if (!in_plane) {
    // Off the axes of the model what is left of the inertia of a node must not be about a skew axis alone.
    const bool is_skew = along[0] * along[1] != 0.0;
    if (!is_skew) bar.beams[0].release = {{{"ry", "rz"}, {"ry", "rz"}}};
    bar.beams[0].orientation = {is_skew ? 0.0 : 0.3, 1.0, is_skew ? 0.0 : -0.2};
  }
  bar.supports.resize(1);
  bar.supports[0].node = "a";
  bar.supports[0].fix = {"x", "y", "rz"};
  if (!in_plane) bar.supports[0].fix = {"x", "y", "z", "rx", "ry", "rz"};
  description.held_forces = {{loaded, 1.0, {}}};
  return assembled(description);
}

// The far end swings about the near one, whatever the direction of the bar.
TEST(StaticEquilibrium, OfAHingedBarDoesNotExistInAnyDirection) {
  using Formulation = model::BeamDescription::Formulation;
  const double skew = 0.7;
  for (const Formulation formulation : {Formulation::euler_bernoulli, Formulation::timoshenko})
    for (const double length : {1.0, 0.3, 1.0 / 3.0, 7.0}) {
      const std::vector<std::pair<std::vector<double>, std::string>> bars{
          {{length, 0.0}, "b.y"},
          {{0.0, length}, "b.x"},
          {{length * std::cos(skew), length * std::sin(skew)}, "b.x"},
          {{length, 0.0, 0.0}, "b.y"},
          {{length, 0.0, 0.0}, "b.z"},
          {{0.0, 0.0, -length}, "b.x"},
          {{length * std::cos(skew), length * std::sin(skew), 0.0}, "b.y"}};
      for (const auto& [along, loaded] : bars) {
        const auto system = hinged_bar(along, formulation, loaded);
        const StaticEquilibrium found = find_equilibrium(system, {});
        ASSERT_EQ(found.outcome, StaticOutcome::mechanism) << loaded << " length " << length;
        EXPECT_EQ(std::count(found.moving.begin(), found.moving.end(), place_of(system, loaded)), 1) << loaded;
      }
    }
}

std::vector<std::string> moving(const system::LocallyNonlinear& system) {
  const StaticEquilibrium found = find_equilibrium(system, {});
  EXPECT_EQ(found.outcome, StaticOutcome::mechanism);
  std::vector<std::string> names;
  for (const Index i : found.moving) names.push_back(system.coordinates()[static_cast<std::size_t>(i)]);
  return names;
}

// Where the half beam ends in a truss, nothing keeps its end from rising.
TEST(Mechanism, NamesTheCoordinatesThatMove) {
  model::ModelDescription description = testing::portal_frame();
  model::TrussDescription truss;
  static_cast<model::LineDescription&>(truss) = description.structure.beams[0];
  description.structure.trusses = {truss};
  description.structure.beams.erase(description.structure.beams.begin());
  EXPECT_EQ(moving(assembled(description)), std::vector<std::string>{"1.y"});

  description = testing::portal_frame();
  description.structure.supports.pop_back();
  description.structure.supports[0].fix = {"x", "rz"};
  // What is left may slide down as a whole.
  EXPECT_EQ(moving(assembled(description)),
            (std::vector<std::string>{"1.y", "2.y", "3.y", "4.y", "5.y", "6.y", "7.y"}));
}

TEST(Mechanism, IsToldFromAFineMeshAndFromSoftSprings) {
  model::ModelDescription description = testing::portal_frame();
  for (auto& beam : description.structure.beams) beam.elements = 1000;
  EXPECT_EQ(find_equilibrium(assembled(description), {}).outcome, StaticOutcome::found);
  description.structure.supports[0].fix = {"x"};
  description.structure.supports[1].fix = {"y"};
  EXPECT_EQ(find_equilibrium(assembled(description), {}).outcome, StaticOutcome::mechanism);

  model::ModelDescription chain;
  chain.coordinates = {{"a", 1.0, 0.0, 0.0, {}}, {"b", 1.0, 0.0, 0.0, {}}};
  chain.springs = {{{"a", "b"}, {}, 1e9, {}}, {{"a", "ground"}, {}, 1e-3, {}}};
  chain.held_forces = {{"b", 1.0, {}}};
  const StaticEquilibrium soft = find_equilibrium(assembled(chain), {});
  ASSERT_EQ(soft.outcome, StaticOutcome::found);
  EXPECT_NEAR(soft.state.q[0], 1e3, 1.0);  // 1e12 roundings, less what refinement returns
  chain.springs.pop_back();
  EXPECT_EQ(moving(assembled(chain)), (std::vector<std::string>{"a", "b"}));
}
}  // namespace
}  // namespace rubato::analysis
