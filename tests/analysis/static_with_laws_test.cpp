#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include "support/assembled.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

// Static states of structures with other laws than sliders and stops.
namespace rubato::analysis {
namespace {

using integrate::find_equilibrium;
using integrate::StaticEquilibrium;
using integrate::StaticOutcome;

model::LawDescription bouc_wen(const char* first, const char* second, double stiffness) {
  model::LawDescription law;
  law.kind = law.name = "bouc_wen";
  law.between = {first, second};
  law.values = {stiffness, 0.0, 1.0, 0.5, 0.5, 1.0};
  return law;
}

// Three masses that only each other hold: round-off of the last pivot has either sign, and is no stiffness. Two of
// twelve such structures were told to rest 1e14 m away.
TEST(StaticWithLaws, RefusesAStructureThatFloats) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stiffness(1.0, 10.0);
  for (int i = 0; i < 60; ++i) {
    model::ModelDescription description;
    description.coordinates = {{"x", 1.0, 0.0, 0.0, {}}, {"y", 1.0, 0.0, 0.0, {}}, {"z", 1.0, 0.0, 0.0, {}}};
    description.springs = {{{"x", "y"}, {}, stiffness(random), {}}, {{"x", "z"}, {}, stiffness(random), {}}};
    description.held_forces = {{"y", 0.3, {}}};
    description.laws = {bouc_wen("y", "z", 0.7)};
    const StaticEquilibrium found = find_equilibrium(testing::assembled(description), {});
    EXPECT_EQ(found.outcome, StaticOutcome::mechanism) << i;
    EXPECT_EQ(found.moving, (std::vector<Index>{0, 1, 2})) << i;
  }
}

// A coordinate that nothing joins is named, not the one that a law holds.
TEST(StaticWithLaws, NamesWhatNothingResists) {
  model::ModelDescription description;
  description.coordinates = {{"held", 1.0, 0.0, 0.0, {}}, {"loose", 1.0, 0.0, 0.0, {}}};
  description.held_forces = {{"loose", 0.3, {}}};
  description.laws = {bouc_wen("held", "ground", 0.7)};
  const StaticEquilibrium found = find_equilibrium(testing::assembled(description), {});
  EXPECT_EQ(found.outcome, StaticOutcome::mechanism);
  EXPECT_EQ(found.moving, std::vector<Index>{1});
}

// Where every coordinate is held nothing is to be solved: what holds it is the force of the law, z = 1 - exp(-u) for n
// = 1.
TEST(StaticWithLaws, TellsTheReactionWhereEverythingIsHeld) {
  model::ModelDescription description;
  description.coordinates = {{"x", 1.0, 0.0, 0.0, {}}};
  description.laws = {bouc_wen("x", "ground", 0.7)};
  const std::vector<model::Held> held{{0, 0.5}};
  const StaticEquilibrium found = find_equilibrium(testing::assembled(description), held);
  ASSERT_EQ(found.outcome, StaticOutcome::found);
  EXPECT_NEAR(found.reaction[0], 0.7 * (1.0 - std::exp(-0.5)), 1e-14);
}

model::LawDescription spring(const std::string& first, const std::string& second, const std::string& force) {
  model::LawDescription law;
  law.kind = "nonlinear_spring";
  law.name = "before " + second;
  law.between = {first, second};
  law.values = {model::Quantity(force)};
  return law;
}

// Stiff springs that a soft one lets go 10 m: their forces follow from differences of places that are known to 1e-15
// m. What is left of the balance was taken for a structure that nothing resists.
TEST(StaticWithLaws, FindsStiffLawsThatHaveGoneFar) {
  for (const double stiffness : {1e3, 1e6, 1e9, 1e11})
    for (const int count : {2, 3, 4, 7, 20}) {
      SCOPED_TRACE(::testing::Message() << stiffness << ", " << count << " masses");
      model::ModelDescription description;
      std::string last = "ground";
      for (int i = 0; i < count; ++i) {
        const std::string name = fmt::format("x{}", i);
        description.coordinates.push_back({name, 1.0, 0.0, 0.0, {}});
        if (i == 0)
          description.springs.push_back({{name, last}, {}, 1.0, {}});
        else
          description.laws.push_back(spring(last, name, fmt::format("{}*u*(1 + u^2)", stiffness)));
        last = name;
      }
      description.held_forces = {{last, 10.0, {}}};
      const StaticEquilibrium found = find_equilibrium(testing::assembled(description), {});
      ASSERT_EQ(found.outcome, StaticOutcome::found);
      // Roundings of a place near 10 m are of 1e-15 m.
      for (Index i = 0; i + 1 < count; ++i) EXPECT_NEAR(found.state.slider_force[i], -10.0, 1e-9 + 1e-14 * stiffness);
      EXPECT_NEAR(found.state.q[0], 10.0, 1e-12 + 4e-14 * count * stiffness);
    }
}

}  // namespace
}  // namespace rubato::analysis
