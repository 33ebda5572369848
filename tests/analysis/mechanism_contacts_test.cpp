#include <rubato/numerics/rotations.hpp>

#include <support/laid_studies.hpp>
#include <support/mechanism_study.hpp>
#include <support/ran_study.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

// Contacts between bodies, nodes and the ground: against the same contacts of structures, closed forms, an integrator
// of the tests' own, and what collisions must keep.
namespace rubato {
namespace {

using testing::MechanismStudy;
using Table = testing::MemorySink::Table;

constexpr double g = 9.81;

const std::string two_nodes = R"toml(
[[node]]
name = "a"
position = [0.0, 0.0]
[[node]]
name = "b"
position = [0.0, 1.0]
[[mass]]
node = "a"
mass = 1.0
[[mass]]
node = "b"
mass = 2.0
[[support]]
node = "a"
fix = ["rz"]
[[support]]
node = "b"
fix = ["rz"]
[[spring]]
between = ["a.x", "ground"]
stiffness = 100.0
[[spring]]
between = ["b.y", "a.y"]
stiffness = 150.0
[[spring]]
between = ["b.x", "a.x"]
stiffness = 50.0
[[force]]
on = "a.x"
expression = "20*sin(3*t)"
[[force]]
on = "b.y"
expression = "15*sin(5*t) - 8"
[[contact]]
name = "c"
between = ["a", "ground"]
normal_direction = [0.1, 1.0]
normal_stiffness = 1e4
tangential_stiffness = 5e3
friction_coefficient = 0.4
gap = 0.001
[[contact]]
name = "d"
between = ["b", "a"]
normal_direction = [0.0, 1.0]
normal_stiffness = 3e3
tangential_stiffness = 2e3
friction_coefficient = 0.3
gap = 0.002
[[contact]]
name = "e"
between = ["b", "ground"]
normal_direction = [-1.0, 0.0]
normal_stiffness = 2e4
gap = 0.01
)toml";

std::string run_for(double duration, const std::string& step) {
  return fmt::format("[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = {}\nstep = {}\n", duration, step);
}

const std::string elsewhere = "[[body]]\nname = \"other\"\nposition = [5.0, 5.0]\nmass = 1.0\ninertia = 1.0\n";

double apart(const Table& a, const Table& b, const std::string& variable, const std::string& label) {
  EXPECT_EQ(a.rows.size(), b.rows.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i)
    most = std::max(most, std::abs(a.rows[i][a.column(variable, label)] - b.rows[i][b.column(variable, label)]));
  return most;
}

double largest(const Table& of, const std::string& variable, const std::string& label) {
  double most = 0.0;
  for (const auto& row : of.rows) most = std::max(most, std::abs(row[of.column(variable, label)]));
  return most;
}

// The trapezoidal rule says the same of both.
TEST(ContactOfAMechanism, IsTheContactOfTheStructureInEqualSteps) {
  const std::string steps = run_for(1.0, "0.001") + "method = { name = \"newmark\", beta = 0.25, gamma = 0.5 }\n";
  const auto structure = testing::run_study(two_nodes + steps);
  const MechanismStudy ran(two_nodes + elsewhere + steps);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const Table &rows = ran.table("run"), &expected = structure.tables.at("run");
  for (const char* name : {"c", "d", "e"}) {
    EXPECT_LT(apart(rows, expected, "normal_force", name), 1e-5 * largest(expected, "normal_force", name)) << name;
    EXPECT_LT(apart(rows, expected, "gap", name), 1e-6 * largest(expected, "gap", name)) << name;
    EXPECT_NEAR(rows.rows.back()[rows.column("dissipated", name)],
                expected.rows.back()[expected.column("dissipated", name)], 1e-5);
  }
  for (const char* name : {"c", "d"}) {
    EXPECT_LT(apart(rows, expected, "tangential_force", name), 1e-5 * largest(expected, "tangential_force", name));
    EXPECT_LT(apart(rows, expected, "slip", name), 1e-6 * largest(expected, "slip", name)) << name;
  }
  EXPECT_LT(apart(rows, expected, "velocity", "b.x"), 1e-6 * largest(expected, "velocity", "b.x"));
  const Table &events = ran.table("run.events"), &expected_events = structure.tables.at("run.events");
  ASSERT_EQ(events.rows.size(), expected_events.rows.size());
  EXPECT_GT(events.rows.size(), 20U);
  for (const char* column : {"time", "event"}) EXPECT_LT(apart(events, expected_events, column, ""), 1e-9) << column;
}

TEST(ContactOfAMechanism, IsTheContactOfTheStructureInAutomaticSteps) {
  for (const std::string damping : {"", "normal_damping = 20.0\n"}) {
    const double near = damping.empty() ? 2e-5 : 6e-5;  // the force of a dashpot jumps where the ends meet
    const std::string output = "output = { interval = 0.05 }\n";
    std::string model = two_nodes;
    model.insert(model.find("gap = 0.002"), damping);
    const auto structure = testing::run_study(model + run_for(1.5, "{ tolerance = 1e-7 }") + output);
    const MechanismStudy ran(model + elsewhere + run_for(1.5, "{ tolerance = 1e-6 }") + output);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const Table &rows = ran.table("run"), &expected = structure.tables.at("run");
    for (const char* name : {"c", "d", "e"}) EXPECT_LT(apart(rows, expected, "gap", name), near) << name << damping;
    for (const char* name : {"c", "d"}) EXPECT_LT(apart(rows, expected, "slip", name), near) << name << damping;
    for (const char* name : {"c", "d", "e"})
      EXPECT_NEAR(ran.last("run", "dissipated", name), expected.rows.back()[expected.column("dissipated", name)], 2e-3)
          << name << damping;
    EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 2e-3) << damping;
  }
}

std::string disk_on_a_slope(double slope) {
  return fmt::format(R"toml(
[parameters]
a = {}
[gravity]
acceleration = ["9.81*sin(a)", "-9.81*cos(a)"]
[[body]]
name = "disk"
position = [0.0, 0.3]
mass = 2.0
inertia = 0.09
[[contact]]
name = "tread"
between = ["disk", "ground"]
radius = 0.3
normal_direction = [0.0, 1.0]
normal_stiffness = 2e5
normal_load = "2*9.81*cos(a)"
tangential_stiffness = 2e5
friction_coefficient = 0.4
)toml",
                     slope);
}

// Friction grows from nothing: k u'' against g sin(a) and k (1/m + r^2/J) u, until it is at its limit.
TEST(ContactOfAMechanism, LetsADiskRollOrSkidDownASlope) {
  constexpr double m = 2.0, inertia = 0.09, r = 0.3, k = 2e5, mu = 0.4, end = 2.0;
  const double given = k * (1.0 / m + r * r / inertia);
  for (const double slope : {0.2, 1.2}) {
    const MechanismStudy ran(disk_on_a_slope(slope) + run_for(end, "{ tolerance = 1e-7 }"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double along = g * std::sin(slope), limit = mu * m * g * std::cos(slope), omega = std::sqrt(given);
    const double speed = ran.last("run", "velocity", "disk.x"), spin = ran.last("run", "angular_velocity", "disk.rz");
    const double turn = 1.0 - limit * omega * omega / (k * along);  // the cosine at which it slips
    if (turn < -1.0) {
      const double force = k * along / given * (1.0 - std::cos(omega * end));
      const double impulse = k * along / given * (end - std::sin(omega * end) / omega);
      EXPECT_NEAR(speed, along * end - impulse / m, 2e-5);
      EXPECT_NEAR(spin, -impulse * r / inertia, 2e-4);
      EXPECT_NEAR(ran.last("run", "tangential_force", "tread"), -force, 2e-2 * limit);
      EXPECT_EQ(ran.last("run", "dissipated", "tread"), 0.0);
    } else {
      const double slips = std::acos(turn) / omega;
      const double impulse = k * along / given * (slips - std::sin(omega * slips) / omega) + limit * (end - slips);
      EXPECT_NEAR(speed, along * end - impulse / m, 2e-5);
      EXPECT_NEAR(spin, -impulse * r / inertia, 1e-4);
      EXPECT_GT(ran.last("run", "dissipated", "tread"), 10.0);
    }
    EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 1e-4);
  }
}

TEST(ContactOfAMechanism, CountsTheWayOfADiskFromWhereItIs) {
  std::string turned = disk_on_a_slope(0.2);
  turned.insert(turned.find("mass ="), "angle = 0.7\n");
  const MechanismStudy ran(turned + run_for(0.5, "{ tolerance = 1e-7 }"));
  const MechanismStudy expected(disk_on_a_slope(0.2) + run_for(0.5, "{ tolerance = 1e-7 }"));
  EXPECT_EQ(ran.at(0, "run", "slip", "tread"), 0.0);
  EXPECT_NEAR(ran.last("run", "slip", "tread"), expected.last("run", "slip", "tread"), 1e-7);
  EXPECT_NEAR(ran.last("run", "velocity", "disk.x"), expected.last("run", "velocity", "disk.x"), 1e-7);
}

/// A box that falls on its corners, by Stoermer and Verlet with the friction springs cut off at mu N: of first order
/// where they slip.
std::array<double, 6> tumbled(double dt, double end) {
  constexpr double m = 2.0, inertia = 0.3, kn = 2e4, kt = 1e4, mu = 0.4;
  const double arm[2] = {-0.3, 0.3};
  double x = 0.0, y = 0.52, angle = 0.0, vx = 1.5, vy = 0.0, w = 1.0, fx = 0.0, fy = -m * g, moment = 0.0;
  double force[2] = {}, before[2] = {-0.3, 0.3};
  const auto kick = [&](double h) {
    vx += h * fx / m;
    vy += h * fy / m;
    w += h * moment / inertia;
  };
  for (long step = std::lround(end / dt); step > 0; --step) {
    kick(0.5 * dt);
    x += dt * vx;
    y += dt * vy;
    angle += dt * w;
    const double c = std::cos(angle), s = std::sin(angle);
    fx = moment = 0.0;
    fy = -m * g;
    for (int i = 0; i < 2; ++i) {
      const double rx = c * arm[i] + s * 0.5, ry = s * arm[i] - c * 0.5;
      const double normal = std::max(0.0, -kn * (y + ry)), at = x + rx;
      force[i] = std::clamp(force[i] - kt * (at - before[i]), -mu * normal, mu * normal);
      before[i] = at;
      fx += force[i];
      fy += normal;
      moment += rx * normal - ry * force[i];
    }
    kick(0.5 * dt);
  }
  return {x, y, angle, vx, vy, w};
}

TEST(ContactOfAMechanism, TumblesABoxOverItsCorners) {
  std::string study = R"toml(
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "box"
position = [0.0, 0.52]
mass = 2.0
inertia = 0.3
velocity = [1.5, 0.0]
angular_velocity = 1.0
)toml";
  // The plane by a point of it, and by the clearance: the same.
  for (const std::string corner :
       {"name = \"l\"\nat = [-0.3, 0.02]\nto = [7.0, 0.0]", "name = \"r\"\nat = [0.3, 0.02]\ngap = 0.02"})
    study += "[[contact]]\n" + corner +
             "\nbetween = [\"box\", \"ground\"]\nnormal_direction = [0.0, 2.0]\nnormal_stiffness = 2e4\n"
             "tangential_stiffness = 1e4\nfriction_coefficient = 0.4\n";
  const MechanismStudy ran(study + run_for(1.0, "{ tolerance = 1e-6 }"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const std::array<double, 6> coarse = tumbled(4e-6, 1.0), fine = tumbled(2e-6, 1.0);
  const std::vector<std::pair<const char*, const char*>> columns{{"position", "box.x"}, {"position", "box.y"},
                                                                 {"angle", "box.rz"},   {"velocity", "box.x"},
                                                                 {"velocity", "box.y"}, {"angular_velocity", "box.rz"}};
  for (std::size_t i = 0; i < columns.size(); ++i)
    EXPECT_NEAR(ran.last("run", columns[i].first, columns[i].second), 2.0 * fine[i] - coarse[i], i < 3 ? 5e-5 : 3e-4)
        << columns[i].first << columns[i].second;
  EXPECT_GT(ran.last("run", "dissipated", "l") + ran.last("run", "dissipated", "r"), 1.0);
  EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 1e-3);
}

// Nothing from outside: momentum and moment of momentum stay, wherever the plane turns and the point slips.
TEST(ContactOfAMechanism, KeepsTheMomentumOfTwoBodiesInThePlane) {
  const MechanismStudy ran(R"toml(
[[body]]
name = "plate"
position = [0.3, -0.2]
angle = 0.4
mass = 3.0
inertia = 0.5
angular_velocity = -0.7
[[body]]
name = "wheel"
position = [0.1, 0.6]
angle = -1.0
mass = 1.0
inertia = 0.05
velocity = [0.8, -3.0]
angular_velocity = 12.0
[[contact]]
name = "touch"
between = ["wheel", "plate"]
at = [0.16, 0.55]
radius = 0.2
to = [0.3, 0.1]
normal_direction = [-0.3, 1.0]
normal_stiffness = 2e3
tangential_stiffness = 3e3
friction_coefficient = 0.5
normal_damping = 4.0
)toml" + run_for(1.0, "{ tolerance = 1e-7 }"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto momentum = [&](std::size_t row) {
    std::array<double, 3> sum{};
    const std::array<std::pair<const char*, std::array<double, 2>>, 2> bodies{
        {{"plate", {3.0, 0.5}}, {"wheel", {1.0, 0.05}}}};
    for (const auto& [name, mass] : bodies) {
      const auto number = [&, of = std::string(name)](const char* what, const char* axis) {
        return ran.at(row, "run", what, of + axis);
      };
      sum[0] += mass[0] * number("velocity", ".x");
      sum[1] += mass[0] * number("velocity", ".y");
      sum[2] +=
          mass[1] * number("angular_velocity", ".rz") + mass[0] * (number("position", ".x") * number("velocity", ".y") -
                                                                   number("position", ".y") * number("velocity", ".x"));
    }
    return sum;
  };
  const std::size_t end = ran.table("run").rows.size() - 1;
  EXPECT_GT(largest(ran.table("run"), "normal_force", "touch"), 50.0);
  EXPECT_GT(ran.last("run", "dissipated", "touch"), 0.5);
  EXPECT_GT(ran.last("run", "gap", "touch"), 0.05);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(momentum(end)[i], momentum(0)[i], 2e-5) << i;
  EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 1e-4);
}

TEST(ContactOfAMechanism, KeepsTheMomentumOfTwoBodiesInSpace) {
  const MechanismStudy ran(R"toml(
[[body]]
name = "plate"
position = [0.0, 0.0, 0.0]
rotation = [0.2, -0.3, 0.1]
mass = 3.0
inertia = [0.3, 0.3, 0.3]
angular_velocity = [0.5, -0.4, 0.8]
[[body]]
name = "rod"
position = [0.1, 0.2, 0.6]
rotation = [0.5, 0.1, 0.2]
mass = 1.0
inertia = [0.06, 0.06, 0.06]
velocity = [0.9, -0.6, -3.0]
angular_velocity = [3.0, 1.0, -4.0]
[[contact]]
name = "touch"
between = ["rod", "plate"]
at = [0.2, 0.25, 0.3]
to = [0.0, 0.0, 0.1]
normal_direction = [0.1, -0.2, 1.0]
normal_stiffness = 2e3
tangential_stiffness = 3e3
friction_coefficient = 0.3
)toml" + run_for(0.5, "{ tolerance = 1e-7 }") +
                           "output = { every = 1 }\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_GT(largest(ran.table("run"), "normal_force", "touch"), 20.0);
  EXPECT_GT(ran.last("run", "dissipated", "touch"), 0.05);
  EXPECT_GT(ran.last("run", "gap", "touch"), 0.02);
  // Of balls of inertia the spin counts as it is, in the axes of the world: its length is enough along each.
  const auto momentum = [&](std::size_t row, const std::string& axis) {
    return 3.0 * ran.at(row, "run", "velocity", "plate." + axis) + ran.at(row, "run", "velocity", "rod." + axis);
  };
  const std::size_t end = ran.table("run").rows.size() - 1;
  for (const char* axis : {"x", "y", "z"}) EXPECT_NEAR(momentum(end, axis), momentum(0, axis), 2e-5) << axis;
  const auto moment = [&](std::size_t row) {
    numerics::Vector3 sum = numerics::Vector3::Zero();
    for (const auto& [name, mass, inertia] :
         {std::tuple<const char*, double, double>{"plate", 3.0, 0.3}, {"rod", 1.0, 0.06}}) {
      const auto vector = [&, of = std::string(name)](const char* what, const char* prefix) {
        numerics::Vector3 v;
        const char* axes[3] = {"x", "y", "z"};
        for (Index i = 0; i < 3; ++i) v[i] = ran.at(row, "run", what, of + "." + prefix + axes[i]);
        return v;
      };
      const numerics::Vector3 turn = vector("angle", "r");
      const numerics::Vector3 spin = numerics::rotation_of(turn) * vector("angular_velocity", "r");
      sum += inertia * spin + mass * vector("position", "").cross(vector("velocity", ""));
    }
    return sum;
  };
  for (Index i = 0; i < 3; ++i) EXPECT_NEAR(moment(end)[i], moment(0)[i], 2e-5) << i;
  EXPECT_LT(largest(ran.table("run.energy"), "residue", ""), 1e-4);
}

// Half a period of the spring, and what the weight adds: (2/w) (pi - atan(w v/g)).
TEST(ContactOfAMechanism, ThrowsABallBackFromATable) {
  const MechanismStudy ran(R"toml(
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
name = "ball"
position = [0.3, 0.0, 1.0]
mass = 1.0
inertia = [0.004, 0.004, 0.004]
velocity = [0.5, 0.0, 0.0]
angular_velocity = [3.0, 0.0, 1.0]
[[contact]]
name = "table"
between = ["ball", "ground"]
radius = 0.1
to = [4.0, 2.0, 0.0]
normal_direction = [0.0, 0.0, 3.0]
normal_stiffness = 1e4
)toml" + run_for(1.0, "{ tolerance = 1e-7 }"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double falls = std::sqrt(2.0 * 0.9 / g), speed = g * falls, omega = 100.0;
  const double lasts = 2.0 / omega * (std::acos(-1.0) - std::atan(omega * speed / g));
  const Table& events = ran.table("run.events");
  ASSERT_GE(events.rows.size(), 2U);
  const auto at = [&](std::size_t i) { return events.rows[i][events.column("time", "")]; };
  EXPECT_NEAR(at(0), falls, 1e-4);
  EXPECT_NEAR(at(events.rows.size() - 1), falls + lasts, 2e-4);
  const double since = 1.0 - falls - lasts;
  EXPECT_NEAR(ran.last("run", "position", "ball.z"), 0.1 + speed * since - 0.5 * g * since * since, 1e-5);
  EXPECT_NEAR(ran.last("run", "position", "ball.x"), 0.8, 1e-6);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "ball.rx"), 3.0, 1e-9);
  EXPECT_NEAR(ran.last("run", "gap", "table"), ran.last("run", "position", "ball.z") - 0.1, 1e-12);
}

}  // namespace
}  // namespace rubato
