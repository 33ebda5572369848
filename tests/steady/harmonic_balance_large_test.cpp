#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/linear/linear_response.hpp>

#include "support/brick_cantilever.hpp"
#include "support/harmonic_response.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// Harmonic balance where a structure is too large for its modes.
namespace rubato::steady {
namespace {

using testing::expect_balance;
using testing::observing;
using testing::respond;
using testing::structure;

// A slender solid turns small differences of large forces into its motion: what it leaves of the load is round-off of
// 2e10 N/m times 0.01 m, and no sign of a resonance. First natural frequency 34.5 rad/s, damping Rayleigh's.
TEST(HarmonicBalanceOfLargeStructures, IsFiniteOnASlenderSolidWithDamping) {
  testing::BrickCantilever blade;
  blade.along = 100;
  auto parts = blade.parts();
  const Index tip = blade.deflection(100), middle = blade.deflection(50);
  parts.sliders = {{"stuck", middle, ground, 100.0, 1e9}};
  for (const double w : {18.8, 34.5, 56.5, 94.2}) {
    parts.loads = system::Loads({testing::harmonic(tip, 1.0, w)});
    const system::LocallyNonlinear stuck(parts);
    const SteadyResponse r = respond(stuck, observing({tip}));
    LinearResponse limit = stuck_limit(stuck, observing({tip}));
    SteadyResponse linear;
    limit.solve(excitation_of(stuck), SteadyStart::unloaded, linear);
    ASSERT_EQ(linear.status, SteadyStatus::converged);
    // Round-off of the solid itself, eps |K| |x| / |f| = 2e-16 * 2e10 N/m * 0.01 m / N, times what that moves.
    EXPECT_NEAR(r.amplitude[0], linear.amplitude[0], 1e-5 * linear.amplitude[0]) << w;
  }
  // Where it slips: against the modes of the same structure below 300 rows.
  testing::BrickCantilever small;
  small.across = 1;
  small.along = 24;
  auto few = small.parts();
  few.sliders = {{"slips", small.deflection(12), ground, 1e3, 0.3}};
  few.loads = system::Loads({testing::harmonic(small.deflection(24), 1.0, 135.0)});
  ASSERT_LE(small.rows(), 300);
  const SteadyResponse modes = respond(system::LocallyNonlinear(few), observing({small.deflection(24)}), 1e-4);
  EXPECT_GT(modes.slip_share[0], 0.0);
  // One mass more, loosely tied and without load, makes it too large for modes.
  const Index n = small.rows(), more = 301 - n;
  const auto extended = [&](SparseMatrix& matrix, double diagonal) {
    matrix.conservativeResize(n + more, n + more);
    for (Index i = n; i < n + more; ++i) matrix.insert(i, i) = diagonal;
  };
  extended(few.mass, 1.0);
  extended(few.damping, 1.0);
  extended(few.stiffness, 1e4);
  few.coordinates.clear();
  for (Index i = 0; i < n + more; ++i) few.coordinates.push_back("x" + std::to_string(i + 1));
  const SteadyResponse factor = respond(system::LocallyNonlinear(few), observing({small.deflection(24)}), 1e-4);
  EXPECT_NEAR(factor.amplitude[0], modes.amplitude[0], 2e-4 * modes.amplitude[0]);
}

// A chain of 400 at its first natural frequency, without damping: a slider of 1 mN does not hold back a load of 1 N,
// one of 10 N does. At an antinode friction takes 4 b limit, the load gives pi b.
TEST(HarmonicBalanceOfLargeStructures, SaysThatALargeStructureInResonanceIsUnbounded) {
  const Index n = 401;
  const double w = 2.0 * std::sin(std::numbers::pi / (2.0 * (static_cast<double>(n) + 1.0)));
  for (const double limit : {1e-3, 10.0}) {
    const auto chain = testing::chain(n, 1, limit);
    system::LocallyNonlinear::Parts parts;
    parts.mass = chain.mass();
    parts.damping = 0.0 * chain.damping();
    parts.stiffness = chain.stiffness();
    parts.sliders = chain.sliders();
    parts.loads = system::Loads({testing::harmonic(n / 2, 1.0, w)});
    parts.coordinates = chain.coordinates();
    const system::LocallyNonlinear system(std::move(parts));
    HarmonicBalanceSolver solver(system, observing({n / 2}));
    SteadyResponse r;
    solver.solve(excitation_of(system), SteadyStart::unloaded, r);
    EXPECT_EQ(r.status == SteadyStatus::unbounded, limit < 1.0) << limit;
    if (limit > 1.0) {
      EXPECT_EQ(r.status, SteadyStatus::converged);
    }
  }
}

// Sparse factorisation against a dense one: the condensation to few coordinates is exact, so both balance the same
// equations, to their residual of 2e-12 times the condition of the Jacobian. The loads of the second chain are spread.
TEST(HarmonicBalanceOfLargeStructures, TakesLargeSparseStructures) {
  for (const bool is_spread : {false, true}) {
    const auto chain = testing::chain(400, 4, 0.5);
    std::vector<system::LoadTerm> loads = chain.loads().terms();
    if (is_spread) {
      system::LoadTerm spread{{}, {}, model::HarmonicLaw{0.02, 0.7, 0.3}};
      for (Index i = 0; i < 400; ++i) {
        spread.rows.push_back(i);
        spread.weights.push_back(1.0 + 0.01 * static_cast<double>(i));
      }
      loads.push_back(spread);
    }
    system::LocallyNonlinear::Parts parts;
    parts.mass = chain.mass();
    parts.damping = chain.damping();
    parts.stiffness = chain.stiffness();
    parts.sliders = chain.sliders();
    parts.loads = system::Loads(loads);
    const system::LocallyNonlinear system(std::move(parts));
    const SteadyResponse r = respond(system, observing({130, 200}), 1e-4);
    expect_balance(r);
    EXPECT_GT(r.dissipated.sum(), 0.0);
    // Dense by force: an entry everywhere in C, too small to matter, makes the matrix full.
    Matrix full = Matrix(system.damping());
    for (Index i = 0; i < 400; ++i)
      for (Index j = 0; j < 400; ++j)
        if (full(i, j) == 0.0) full(i, j) = 1e-300;
    const auto dense =
        structure(Matrix(system.mass()), full, Matrix(system.stiffness()), system.sliders(), system.loads().terms());
    const SteadyResponse modes = respond(dense, observing({130, 200}), 1e-4);
    for (Index i = 0; i < 2; ++i) EXPECT_NEAR(r.amplitude[i], modes.amplitude[i], 1e-9 * modes.amplitude.maxCoeff());
  }
}

}  // namespace
}  // namespace rubato::steady
