#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/run_mechanism.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

using numerics::Rotation;
using numerics::Vector3;
using testing::replaced;
using testing::run_mechanism_study;

system::Mechanism built(const std::string& text) {
  const auto study = io::read_study_text(text, "study.toml");
  return system::Mechanism(model::build_mechanism(study.model, model::evaluate_parameters(study.parameters)));
}

/// Spin-up of a rotating beam (Kane, Ryan and Banerjee 1987; data of Simo and Vu-Quoc 1986): EA = 2.8e7 N,
/// G A = 1e7 N, EI = 1.4e4 N m2, 1.2 kg/m, 10 m. A strong servo turns its hinge to 6 rad/s within 15 s.
const std::string rotating_beam = R"study(
[[node]]
name = "hub"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [10.0, 0.0, 0.0]
[[material]]
name = "m"
young = 2.8e7
shear_modulus = 1.2e7
density = 1.2
[[section]]
name = "s"
area = 1.0
inertia = [5e-4, 5e-4]
torsion = 1e-3
shear_factor = 0.8333333333333334
[[beam]]
nodes = ["hub", "tip"]
section = "s"
material = "m"
formulation = "geometrically_exact"
elements = 8
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "hub"]
axis = [0.0, 0.0, 1.0]
moment = "1e5*((t < 15 ? 0.4*(t - 15/(2*pi)*sin(2*pi*t/15)) : 6) - rate)"
[[analysis]]
name = "spin"
type = "transient"
method = { name = "generalized_alpha", rho_inf = 0.6 }
step = 0.02
duration = 20.0
output = { times = [7.5, 20.0] }
)study";

// Steady: the stretch tan(k L)/k - L, k = 6 sqrt(rho A/EA). Elements of constant stretch with a consistent mass tell it
// low by (L/n)^2/L^2 of it or less, a sixty-fourth.
TEST(PublishedMechanisms, ASpinningBeamStretchesAsItsCentrifugalForceAsks) {
  const auto ran = run_mechanism_study(rotating_beam);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("spin");
  const auto& last = table.rows.back();
  const double k = 6.0 * std::sqrt(1.2 / 2.8e7), stretch = std::tan(10.0 * k) / k - 10.0;
  const double x = last[table.column("position", "tip.x")], y = last[table.column("position", "tip.y")];
  EXPECT_NEAR(std::hypot(x, y) - 10.0, stretch, stretch / 64.0);
  // The hinge turns 6 (15/2 + 5) = 75 rad less what the servo lags; the beam has come to rest on it.
  EXPECT_NEAR(last[table.column("angle", "hinge")], 75.0, 0.1);
  EXPECT_NEAR(last[table.column("angular_velocity", "hinge")], 6.0, 1e-3);
  EXPECT_NEAR(last[table.column("position", "tip.z")], 0.0, 1e-9);
  // Half way it lags behind its hinge by about 0.6 m (the published curve's trough is 0.575).
  const auto& half = table.rows.front();
  const double angle = half[table.column("angle", "hinge")];
  const double across = -half[table.column("position", "tip.x")] * std::sin(angle) +
                        half[table.column("position", "tip.y")] * std::cos(angle);
  EXPECT_LT(across, -0.4);
  EXPECT_GT(across, -0.7);
}

/// A flexible beam in free flight (after Simo and Vu-Quoc 1988, in space): forces and moments on one end rise and fall
/// within 5 s; then nothing acts.
const std::string flying_beam = R"study(
[[node]]
name = "one"
position = [6.0, 0.0, 0.0]
[[node]]
name = "two"
position = [0.0, 8.0, 0.0]
[[material]]
name = "m"
young = 1e4
shear_modulus = 1e4
density = 1.0
[[section]]
name = "s"
area = 1.0
inertia = [0.05, 0.05]
torsion = 0.05
shear_factor = 1.0
[[beam]]
nodes = ["one", "two"]
section = "s"
material = "m"
formulation = "geometrically_exact"
elements = 10
[[force]]
on = "one.x"
expression = "8*(t < 2.5 ? t/2.5 : (t < 5 ? (5 - t)/2.5 : 0))"
[[force]]
on = "one.rz"
expression = "-80*(t < 2.5 ? t/2.5 : (t < 5 ? (5 - t)/2.5 : 0))"
[[force]]
on = "one.rx"
expression = "16*(t < 2.5 ? t/2.5 : (t < 5 ? (5 - t)/2.5 : 0))"
[[force]]
on = "one.ry"
expression = "12*(t < 2.5 ? t/2.5 : (t < 5 ? (5 - t)/2.5 : 0))"
)study";

struct Momenta {
  Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
  double energy = 0.0;
};

Momenta momenta_of(const system::Mechanism& mechanism, const system::State& state) {
  Momenta sums;
  Vector momentum;
  mechanism.times_mass(state.v, momentum);
  const auto& nodes = mechanism.model().nodes;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const double* q = state.q.data() + 7 * i;
    const Index place = nodes[i].place[0];  // all free: six in a row
    const Vector3 linear = momentum.segment<3>(place), spin = momentum.segment<3>(place + 3);
    sums.linear += linear;
    sums.angular += Vector3(q[0], q[1], q[2]).cross(linear) + Rotation(q[3], q[4], q[5], q[6]) * spin;
  }
  system::MechanismEquations equations(mechanism);
  equations.go_to(state, model::Side::right);
  sums.energy = 0.5 * state.v.dot(momentum) + equations.stored_energy();
  return sums;
}

struct Flight {
  double linear, angular, energy;  ///< by how much each changed between 6 s and 9 s, over itself
};

Flight flight_with(double h) {
  const system::Mechanism mechanism = built(flying_beam);
  const auto stepper =
      integrate::make_stepper(integrate::make_method("generalized_alpha", {{"rho_inf", 0.9}}), mechanism);
  system::MechanismEquations equations(mechanism);
  system::State state = integrate::make_consistent(equations, mechanism.start()).state;
  EXPECT_EQ(integrate::march(*stepper, state, h, 6.0).end, integrate::MarchEnd::reached);
  const Momenta before = momenta_of(mechanism, state);
  EXPECT_EQ(integrate::march(*stepper, state, h, 9.0).end, integrate::MarchEnd::reached);
  const Momenta after = momenta_of(mechanism, state);
  return {(after.linear - before.linear).norm() / before.linear.norm(),
          (after.angular - before.angular).norm() / before.angular.norm(),
          std::abs(after.energy - before.energy) / before.energy};
}

// Forces between nodes are opposite, so that steps keep the linear momentum to Newton's tolerance (1e-10 of the size,
// over a step; the auxiliary acceleration forgets the loads within the first second); the angular momentum and the
// energy they keep with the square of the step.
TEST(PublishedMechanisms, AFlexibleBeamInFreeFlightKeepsItsMomenta) {
  const Flight coarse = flight_with(0.005), fine = flight_with(0.0025);
  EXPECT_LT(coarse.linear, 1e-10);
  EXPECT_LT(fine.linear, 1e-10);
  EXPECT_NEAR(std::log2(coarse.angular / fine.angular), 2.0, 0.25);
  EXPECT_NEAR(std::log2(coarse.energy / fine.energy), 2.0, 0.25);
  EXPECT_LT(fine.angular, 1e-6);
  EXPECT_LT(fine.energy, 1e-6);
}

/// Bathe and Noh (2012): a spring of 1e7 N/m, through which the end moves as sin(1.2 t), then 1 kg, a spring of 1 N/m,
/// and 1 kg; at rest at the start. The stiff end is a force k sin(1.2 t) here, which is the same. Steps of 0.2618 s.
const std::string stiff_soft = R"study(
[[body]]
name = "two"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
position = [0.0, 0.0, 0.0]
[[body]]
name = "three"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
position = [1.0, 0.0, 0.0]
[[joint]]
name = "stiff"
type = "prismatic"
between = ["ground", "two"]
at = [0.0, 0.0, 0.0]
axis = [1.0, 0.0, 0.0]
force = "1e7*(sin(1.2*t) - displacement)"
[[joint]]
name = "soft"
type = "prismatic"
between = ["two", "three"]
at = [1.0, 0.0, 0.0]
axis = [1.0, 0.0, 0.0]
stiffness = 1.0
[[analysis]]
name = "chain"
type = "transient"
method = { name = "generalized_alpha", rho_inf = 0.5 }
step = 0.2618
duration = 20.0
)study";

// The first mass follows the end: its acceleration is -1.44 sin(1.2 t). The start, where the end moves and the mass
// does not, throws it back and forth with its own frequency of 3,162 rad/s, by 3e5 m/s2 in these steps; that decays by
// the spectral radius of 1/2 a step, to nothing after 46.
TEST(PublishedMechanisms, StiffSpringsMakeNoAccelerationsThatGrow) {
  const auto largest_error = [](const std::string& text) {
    const auto ran = run_mechanism_study(text);
    EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& table = ran.sink.tables.at("chain");
    double largest = 0.0;
    for (const auto& row : table.rows) {
      if (row[0] < 12.0) continue;
      const double exact = -1.44 * std::sin(1.2 * row[0]);
      largest = std::max(largest, std::abs(row[table.column("acceleration", "two.x")] - exact));
    }
    return largest;
  };
  // Second order: (1.2 * 0.2618)^2 of 1.44.
  EXPECT_LT(largest_error(stiff_soft), 0.15);
  // Without damping it stays; the control shows that the test would see it.
  const std::string undamped =
      replaced(replaced(stiff_soft, "rho_inf = 0.5", "rho_inf = 1.0"), "step =", "allow_unstable = true\nstep =");
  EXPECT_GT(largest_error(undamped), 100.0);
}

// A cube spun about a principal axis at 50 rad/s for 100 s, some 800 turns: its axes stay of length 1 and where they
// belong. Steps are exact for a constant angular velocity.
TEST(PublishedMechanisms, ABodySpunManyTurnsStaysABody) {
  const system::Mechanism mechanism = built(
      "[[body]]\nname = \"cube\"\nmass = 2.0\ninertia = [0.3, 0.4, 0.5]\nposition = [0.0, 0.0, 0.0]\n"
      "velocity = [1.0, 0.0, 0.0]\nangular_velocity = [0.0, 0.0, 50.0]\n");
  const auto stepper =
      integrate::make_stepper(integrate::make_method("generalized_alpha", {{"rho_inf", 0.9}}), mechanism);
  system::MechanismEquations equations(mechanism);
  system::State state = integrate::make_consistent(equations, mechanism.start()).state;
  EXPECT_EQ(integrate::march(*stepper, state, 0.01, 100.0).end, integrate::MarchEnd::reached);
  const Rotation turn(state.q[10], state.q[11], state.q[12], state.q[13]);
  EXPECT_NEAR(turn.norm(), 1.0, 1e-15);
  EXPECT_LT(
      numerics::vector_of(numerics::rotation_of({0.0, 0.0, std::remainder(5000.0, 2.0 * M_PI)}).conjugate() * turn)
          .norm(),
      1e-9);  // round-off of 10,000 steps
  EXPECT_NEAR(state.q[7], 100.0, 1e-9);
}

}  // namespace
}  // namespace rubato
