#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/integrate/mechanism/mechanism_modes.hpp>
#include <rubato/model/beams/exact_beam_space.hpp>
#include <rubato/model/beams/geometrically_exact.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/double_pendulum.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato {
namespace {

using integrate::find_equilibrium;
using numerics::Matrix3;
using numerics::Rotation;
using numerics::Vector3;
using std::numbers::pi;

constexpr double length = 1.0, bending = 2.0;
constexpr int elements = 10;

/// A cantilever along x in the plane, with a load along an axis of its free end.
system::Mechanism plane_cantilever(std::size_t axis, double load) {
  model::Mechanism m(2);
  Index last = m.add_node("0", {0.0, 0.0, 0.0}, {false, false, false});
  for (int i = 1; i <= elements; ++i) {
    const std::array<double, 3> from{length * (i - 1) / elements, 0.0, 0.0}, to{length * i / elements, 0.0, 0.0};
    const Index next = m.add_node(std::to_string(i), to);
    m.add_mass(next, 1.0 / elements, 1e-4);
    m.elements.push_back(
        model::make_plane_beam("beam", m.plane_node(last), m.plane_node(next), from, to, {1e4, 4e3, bending}));
    last = next;
  }
  m.forces.push_back({m.nodes[std::size_t(last)].place[axis], model::HarmonicLaw{load, 0.0, 0.0}});
  return system::Mechanism(std::move(m));
}

/// The same in space, with a moment about an axis across it.
system::Mechanism space_cantilever(double moment) {
  model::Mechanism m(3);
  Index last = m.add_space_node("0", Vector3::Zero(), Rotation::Identity(), {});
  std::vector<std::pair<Index, Index>> ends;
  for (int i = 1; i <= elements; ++i) {
    const Index next = m.add_space_node(std::to_string(i), {length * i / elements, 0.0, 0.0}, Rotation::Identity());
    m.add_space_body(next, 1.0 / elements, 1e-4 * Matrix3::Identity());
    ends.emplace_back(last, next);
    last = next;
  }
  std::vector<double> q;
  for (const auto& node : m.nodes) q.insert(q.end(), node.numbers.begin(), node.numbers.end());
  for (const auto& [one, two] : ends)
    m.elements.push_back(model::make_exact_beam_space("beam", m.space_node(one), m.space_node(two), q.data(),
                                                      Matrix3::Identity(), Matrix3::Identity(),
                                                      {{1e4, 4e3, 4e3}, {1.0, 3.0, bending}}));
  m.forces.push_back({m.nodes[std::size_t(last)].place[5], model::HarmonicLaw{moment, 0.0, 0.0}});
  return system::Mechanism(std::move(m));
}

// M = 2 pi E I/L rolls a cantilever into a circle (Simo and Vu-Quoc 1986): every element turns by 2 pi/10 against the
// next, and the chords make a regular polygon, which closes exactly.
TEST(MechanismEquilibrium, RollsACantileverIntoACircle) {
  const system::Mechanism mechanism = plane_cantilever(5, 2.0 * pi * bending / length);
  system::MechanismEquations equations(mechanism);
  const auto found = find_equilibrium(equations, mechanism.start());
  ASSERT_TRUE(found.is_found) << found.residual << " at " << found.worst;
  for (int i = 1; i <= elements; ++i) EXPECT_NEAR(found.state.q[3 * (i + 1) + 2], 2.0 * pi * i / elements, 1e-9) << i;
  EXPECT_NEAR(found.state.q[3 * (elements + 1)], 0.0, 1e-9);
  EXPECT_NEAR(found.state.q[3 * (elements + 1) + 1], 0.0, 1e-9);
}

TEST(MechanismEquilibrium, RollsACantileverIntoACircleInSpace) {
  const system::Mechanism mechanism = space_cantilever(2.0 * pi * bending / length);
  system::MechanismEquations equations(mechanism);
  const auto found = find_equilibrium(equations, mechanism.start());
  ASSERT_TRUE(found.is_found) << found.residual << " at " << found.worst;
  const double* tip = found.state.q.data() + 7 * (elements + 1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(tip[i], 0.0, 1e-9) << i;
  // One whole turn: the quaternion is that of no turn, of either sign.
  EXPECT_NEAR(std::abs(tip[3]), 1.0, 1e-12);
  const double* half = found.state.q.data() + 7 * (elements / 2 + 1);
  EXPECT_NEAR(std::abs(half[6]), 1.0, 1e-9);  // half a turn about z
}

// Hung a little beside the upright position, a pendulum comes to rest below: tension m g.
TEST(MechanismEquilibrium, OfAPendulumIsTheStableOne) {
  model::Mechanism m(2);
  const Index bob = m.add_node("bob", {std::sin(0.1), std::cos(0.1), 0.0}, {true, true, false});
  m.add_mass(bob, 3.0);
  m.joints.push_back(model::make_plane_distance("rod", m.plane_point(0, 0.0, 0.0),
                                                m.plane_point(bob, std::sin(0.1), std::cos(0.1)), 1.0));
  m.gravity = {0.0, -9.81, 0.0};
  const system::Mechanism mechanism(std::move(m));
  system::MechanismEquations equations(mechanism);
  const auto found = find_equilibrium(equations, mechanism.start());
  ASSERT_TRUE(found.is_found) << found.residual << " after " << found.iterations;
  EXPECT_NEAR(found.state.q[3], 0.0, 1e-9);
  EXPECT_NEAR(found.state.q[4], -1.0, 1e-12);
  EXPECT_NEAR(std::abs(found.state.multiplier[0]), 3.0 * 9.81, 1e-8);
  EXPECT_TRUE(found.is_stable);
}

// Angles a, b of the links: (m1 + m2) a'' + m2 b'' + (m1 + m2) g a = 0, m2 (a'' + b'') + m2 g b = 0 with links of 1 m,
// so that omega^2/g solves m1 x^2 - 2 (m1 + m2) x + (m1 + m2) = 0.
TEST(MechanismModes, OfTheHangingDoublePendulumAreThoseOfItsAngles) {
  model::Mechanism pendulum = testing::double_pendulum();
  pendulum.forces.clear();
  const system::Mechanism mechanism(std::move(pendulum));
  system::MechanismEquations equations(mechanism);
  const auto rest = find_equilibrium(equations, mechanism.start());
  ASSERT_TRUE(rest.is_found);
  EXPECT_TRUE(rest.is_stable);
  const auto modes = integrate::modes_about(equations, rest.state, 5);
  EXPECT_TRUE(modes.is_stable);
  EXPECT_EQ(modes.freedoms, 2);
  ASSERT_EQ(modes.found.modes.size(), 2u);
  const double root = std::sqrt(49.0 - 35.0);
  EXPECT_NEAR(modes.found.modes[0].angular_frequency, std::sqrt(9.81 * (7.0 - root) / 5.0), 1e-9);
  EXPECT_NEAR(modes.found.modes[1].angular_frequency, std::sqrt(9.81 * (7.0 + root) / 5.0), 1e-9);
  // The bobs swing sideways.
  for (const auto& mode : modes.found.modes)
    for (const Index vertical : {1, 3}) EXPECT_NEAR(std::abs(mode.shape[vertical]), 0.0, 1e-12);
}

/// A bob of 3 kg on a rod of 2 m that stands beside the vertical by an angle.
system::Mechanism upright_pendulum(double beside) {
  model::Mechanism m(2);
  const double x = 2.0 * std::sin(beside), y = 2.0 * std::cos(beside);
  const Index bob = m.add_node("bob", {x, y, 0.0}, {true, true, false});
  m.add_mass(bob, 3.0);
  m.joints.push_back(model::make_plane_distance("rod", m.plane_point(0, 0.0, 0.0), m.plane_point(bob, x, y), 2.0));
  m.gravity = {0.0, -9.81, 0.0};
  return system::Mechanism(std::move(m));
}

// It stands where it is put, and falls as exp(sqrt(g/l) t); beside that by more than the tolerance, 1e-10, it hangs.
TEST(MechanismEquilibrium, OfAPendulumThatStandsUprightIsNotStable) {
  const system::Mechanism mechanism = upright_pendulum(0.0);
  system::MechanismEquations equations(mechanism);
  const auto found = find_equilibrium(equations, mechanism.start());
  ASSERT_TRUE(found.is_found) << found.residual << " after " << found.iterations;
  EXPECT_FALSE(found.is_stable);
  EXPECT_NEAR(found.state.q[4], 2.0, 1e-12);
  EXPECT_NEAR(std::abs(found.state.multiplier[0]), 3.0 * 9.81, 1e-8);
  const auto modes = integrate::modes_about(equations, found.state, 1);
  EXPECT_FALSE(modes.is_stable);
  EXPECT_NEAR(modes.growth, std::sqrt(9.81 / 2.0), 1e-9);

  const system::Mechanism leaning = upright_pendulum(1e-7);
  system::MechanismEquations beside(leaning);
  const auto hanging = find_equilibrium(beside, leaning.start());
  ASSERT_TRUE(hanging.is_found) << hanging.residual << " after " << hanging.iterations;
  EXPECT_TRUE(hanging.is_stable);
  EXPECT_NEAR(hanging.state.q[4], -2.0, 1e-9);
}

// Euler's load of a cantilever is pi^2 E I/(4 l^2) = 4.93 N; ten elements and the shear move it by less than a percent.
TEST(MechanismEquilibrium, OfAStraightColumnIsStableUpToEulersLoad) {
  const double euler = pi * pi * bending / 4.0;
  for (const double share : {0.5, 0.95, 1.05, 2.0}) {
    const system::Mechanism mechanism = plane_cantilever(0, -share * euler);
    system::MechanismEquations equations(mechanism);
    const auto found = find_equilibrium(equations, mechanism.start());
    ASSERT_TRUE(found.is_found) << share;
    EXPECT_EQ(found.is_stable, share < 1.0) << share;
    EXPECT_NEAR(found.state.q[3 * (elements + 1)], length * (1.0 - share * euler / 1e4), 1e-9) << share;
  }
}

TEST(MechanismEquilibrium, IsNotFoundOfABodyThatFalls) {
  model::Mechanism m(2);
  m.add_mass(m.add_node("stone", {0.0, 0.0, 0.0}, {true, true, false}), 1.0);
  m.gravity = {0.0, -9.81, 0.0};
  const system::Mechanism mechanism(std::move(m));
  system::MechanismEquations equations(mechanism);
  const auto found = find_equilibrium(equations, mechanism.start());
  EXPECT_FALSE(found.is_found);
  EXPECT_EQ(found.worst, 1);
}

}  // namespace
}  // namespace rubato
