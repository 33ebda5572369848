#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

// Forces of sliders on which reactions press, against central differences by the multipliers, and the matrix that knows
// them.
namespace rubato {
namespace {

using system::MechanismEquations;
using system::State;

/// A bar on a pin that presses on a slider of the pin and on one of a guide beside it.
const std::string study =
    "[[body]]\nname = \"bar\"\nmass = 2.0\ninertia = 0.1\nposition = [0.5, 0.1]\n"
    "[[body]]\nname = \"block\"\nmass = 1.5\ninertia = 0.2\nposition = [0.0, -3.0]\n"
    "[[joint]]\nname = \"pin\"\ntype = \"revolute\"\nbetween = [\"ground\", \"bar\"]\nat = [0.0, 0.0]\n"
    "[[joint]]\nname = \"guide\"\ntype = \"prismatic\"\nbetween = [\"bar\", \"block\"]\nat = [0.0, -3.0]\naxis = "
    "[1.0, 0.3]\n"
    "[[slider]]\nname = \"one\"\njoint = \"pin\"\nstiffness = 900.0\nfriction_coefficient = 0.2\nnormal_load = "
    "\"reaction\"\n"
    "[[slider]]\nname = \"two\"\njoint = \"guide\"\nstiffness = 700.0\nfriction_coefficient = 0.3\nnormal_load = { law "
    "= \"pin.reaction\" }\n"
    "[[slider]]\nname = \"three\"\njoint = \"guide\"\nstiffness = 900.0\nfriction_coefficient = 0.4\nnormal_load = "
    "\"reaction\"\n";

struct Pressed {
  Pressed()
      : mechanism(model::build_mechanism(io::read_study_text(study, "study.toml").model, {})), equations(mechanism) {
    start = mechanism.start();
    start.multiplier.setConstant(3.0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> draw(-1.0, 1.0);
    there = start;
    Vector way(mechanism.size());
    for (Index i = 0; i < way.size(); ++i) way[i] = draw(random);
    mechanism.retract(start.q, way, there.q);
    for (Index i = 0; i < there.v.size(); ++i) there.v[i] = draw(random);
    for (Index i = 0; i < there.multiplier.size(); ++i) there.multiplier[i] = 5.0 * draw(random);
    equations.begin_step(start);
  }
  /// f + G^T multiplier, with all that the multipliers make.
  Vector sum(const Vector& multiplier) {
    State state = there;
    state.multiplier = multiplier;
    Vector force(mechanism.size()), constraint(mechanism.constraint_count());
    equations.go_to_end(state, model::Side::left);
    equations.residual(force, constraint);
    equations.add_constraint_force(multiplier, 1.0, force);
    return force;
  }

  system::Mechanism mechanism;
  MechanismEquations equations;
  State start, there;
};

TEST(ReactionSlopes, AreThoseOfTheForces) {
  Pressed pressed;
  Vector force(pressed.mechanism.size()), constraint(pressed.mechanism.constraint_count());
  pressed.equations.go_to_end(pressed.there, model::Side::left);
  pressed.equations.residual(force, constraint);
  for (Index row = 0; row < constraint.size(); ++row) {
    constexpr double step = 1e-5;
    const Vector unit = Vector::Unit(constraint.size(), row);
    Vector slope = Vector::Zero(force.size());
    const Vector by_difference =
        (pressed.sum(pressed.there.multiplier + step * unit) - pressed.sum(pressed.there.multiplier - step * unit)) /
        (2.0 * step);
    pressed.equations.go_to_end(pressed.there, model::Side::left);
    pressed.equations.residual(force, constraint);
    pressed.equations.add_constraint_force(unit, 1.0, slope);
    EXPECT_LT((slope - by_difference).cwiseAbs().maxCoeff(), 1e-8) << row;
  }
  // Both of them slip: without them the slopes are those of the constraints alone.
  for (const std::size_t law : {0, 1, 2}) EXPECT_NE(pressed.equations.law_answer(law).by_normal, 0.0) << law;
}

TEST(ReactionSlopes, AreInTheMatrix) {
  Pressed pressed;
  auto& equations = pressed.equations;
  Vector force(pressed.mechanism.size()), constraint(pressed.mechanism.constraint_count());
  equations.go_to_end(pressed.there, model::Side::left);
  equations.linearise({1.0, 0.0, 0.0, 0.0, true}, pressed.there.multiplier, force, constraint);
  ASSERT_TRUE(equations.factorise());
  Vector x(force.size()), y(constraint.size());
  for (Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
  for (Index i = 0; i < y.size(); ++i) y[i] = std::cos(1.0 + 1.7 * static_cast<double>(i));
  Vector right(x.size()), below(y.size());
  pressed.mechanism.times_mass(x, right);
  equations.add_constraint_force(y, 1.0, right);
  equations.constraint_rate(x, below);
  equations.solve(right, below);
  EXPECT_LT((right - x).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((below - y).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace rubato
