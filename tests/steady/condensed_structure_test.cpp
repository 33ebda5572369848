#include <rubato/steady/harmonic_balance/condensed_structure.hpp>

#include "support/brick_cantilever.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

// Large structures seen through few columns: by modes in a basis of their own answers, against the factorisation.
namespace rubato::steady {
namespace {

using system::LocallyNonlinear;

/// A membrane of `side` x `side` masses of 1 kg with springs of 100 N/m, held at its edge, with C = 0.02 M + 1e-4 K;
/// three sliders and a load. Natural frequencies from 100^0.5 pi 2^0.5/(side + 1) to 28 rad/s.
LocallyNonlinear::Parts membrane(Index side, bool is_held = true) {
  const Index n = side * side;
  LocallyNonlinear::Parts parts;
  std::vector<Eigen::Triplet<double>> springs;
  const auto join = [&](Index a, Index b) {
    springs.emplace_back(a, a, 100.0);
    if (b == ground) return;
    springs.emplace_back(b, b, 100.0);
    springs.emplace_back(a, b, -100.0);
    springs.emplace_back(b, a, -100.0);
  };
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) {
      const Index at = i * side + j;
      if (i + 1 < side) join(at, at + side);
      if (j + 1 < side) join(at, at + 1);
      if (is_held)
        for (const Index edge : {i, j, side - 1 - i, side - 1 - j})
          if (edge == 0) join(at, ground);
    }
  parts.stiffness.resize(n, n);
  parts.stiffness.setFromTriplets(springs.begin(), springs.end());
  parts.mass.resize(n, n);
  parts.mass.setIdentity();
  parts.damping = 0.02 * parts.mass + 1e-4 * parts.stiffness;
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  parts.sliders = {
      {"a", n / 2 + 3, ground, 30.0, 0.1}, {"b", n / 3, n / 3 + 1, 50.0, 0.1}, {"c", 5, ground, 10.0, 0.1}};
  return parts;
}

/// Entries of G by both ways, against the largest of their row; frequencies up to 70 times the load's.
void expect_same(LocallyNonlinear::Parts parts, Index driven, double load_frequency, double allowed, int at_least,
                 bool is_floating = false) {
  const LocallyNonlinear system(std::move(parts));
  const std::vector<SteadyRequest::Observed> observed{{driven + 2, ground, {}}};
  CondensedStructure exact(system, observed), reduced(system, observed, {100, load_frequency, 1e-9});
  Matrix load = Matrix::Zero(system.size(), 1);
  load(driven, 0) = 1.0;
  exact.set_loads(load);
  reduced.set_loads(load);
  int others = 0;
  for (int i = is_floating ? 1 : 0; i <= 200; ++i) {
    const double w = 0.35 * static_cast<double>(i) * load_frequency;
    ComplexMatrix one, other;
    const auto first = exact.condense(w, 0.0, one), second = reduced.condense(w, 0.0, other);
    ASSERT_EQ(first, second) << w;
    ASSERT_EQ(one.rows(), other.rows());
    for (Index row = 0; row < one.rows(); ++row)
      EXPECT_LE((one.row(row) - other.row(row)).cwiseAbs().maxCoeff(), allowed * one.row(row).cwiseAbs().maxCoeff())
          << "at " << w << " rad/s, row " << row;
    if (one != other) ++others;
  }
  // Nearly all went by the basis: not to the last bit what the factorisation says.
  EXPECT_GT(others, at_least);
}

TEST(CondensedStructure, KnowsALargeStructureByItsAnswersAtFewFrequencies) {
  expect_same(membrane(24), 17, 0.1, 1e-7, 150);
}

TEST(CondensedStructure, DoesSoWhereDashpotsCoupleTheModes) {
  auto parts = membrane(24);
  for (const Index at : {40, 333, 500}) parts.damping.coeffRef(at, at) += 5.0;
  expect_same(std::move(parts), 17, 0.1, 1e-7, 80);
}

TEST(CondensedStructure, DoesSoWhereTheStructureFloats) { expect_same(membrane(20, false), 17, 0.1, 1e-7, 150, true); }

// A solid, of which both ways lose digits.
TEST(CondensedStructure, DoesSoForASolid) {
  testing::BrickCantilever blade;
  blade.across = blade.thick = 4;
  blade.along = 24;
  blade.thickness = 0.02;
  blade.length = 0.3;
  auto parts = blade.parts();
  const Index tip = blade.deflection(24), middle = blade.deflection(12);
  parts.sliders = {{"middle", middle, ground, 1e4, 1.0}};
  expect_same(std::move(parts), tip, 1000.0, 1e-6, 150);
}

}  // namespace
}  // namespace rubato::steady
