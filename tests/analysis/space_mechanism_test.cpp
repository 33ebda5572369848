#include <rubato/core/error.hpp>

#include <support/bricard.hpp>
#include <support/heavy_top.hpp>
#include <support/run_mechanism.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using numerics::Vector3;
using std::numbers::pi;
using testing::example;
using ::testing::HasSubstr;
using testing::replaced;
using testing::run_mechanism_study;
using Table = testing::MemorySink::Table;

/// Three columns of a row.
Vector3 vector_in(const Table& table, std::size_t row, const std::array<std::string, 3>& variables,
                  const std::array<std::string, 3>& labels) {
  Vector3 vector;
  for (Index i = 0; i < 3; ++i)
    vector[i] = table.rows[row][table.column(variables[std::size_t(i)], labels[std::size_t(i)])];
  return vector;
}
Vector3 position_of(const Table& table, std::size_t row, const std::string& body) {
  return vector_in(table, row, {"position", "position", "position"}, {body + ".x", body + ".y", body + ".z"});
}
Vector3 turn_of(const Table& table, std::size_t row, const std::string& body) {
  return vector_in(table, row, {"angle", "angle", "angle"}, {body + ".rx", body + ".ry", body + ".rz"});
}
Vector3 force_of(const Table& table, std::size_t row, const std::string& joint) {
  return vector_in(table, row, {"reaction_x", "reaction_y", "reaction_z"}, {joint, joint, joint});
}
Vector3 moment_of(const Table& table, std::size_t row, const std::string& joint) {
  return vector_in(table, row, {"reaction_moment_x", "reaction_moment_y", "reaction_moment_z"}, {joint, joint, joint});
}

TEST(SpaceStudies, RunTheHeavyTop) {
  const auto ran = run_mechanism_study(example("heavy-top"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_TRUE(ran.report.warnings.empty()) << ran.report.warnings.front();
  const auto& table = ran.sink.tables.at("motion");
  const std::size_t row = 200;  // t = 1 s
  EXPECT_DOUBLE_EQ(table.rows[row][0], 1.0);
  testing::Top exact;
  exact.go(1.0, 1e-5);
  // The tolerance is a share of the whole motion, of which the spin is the most: sqrt(0.47 kg m2) 150 rad/s in 1.5 s
  // make 154 m sqrt(kg), 1e-4 of it 4 mm of 15 kg.
  EXPECT_LT((position_of(table, row, "top") - exact.position()).norm(), 4e-3);
  const auto turn = numerics::rotation_of(turn_of(table, row, "top"));
  EXPECT_LT(numerics::vector_of(exact.turn.conjugate() * turn).norm(), 2e-2);  // after 24 turns
  // On the second part, the top; as exact as its acceleration of (4.6 rad/s)^2.
  EXPECT_LT((force_of(table, row, "foot") + exact.reaction()).norm(), 1e-2 * exact.reaction().norm());
  EXPECT_LT(moment_of(table, row, "foot").norm(), 1e-9 * exact.reaction().norm());
  const auto& ledger = ran.sink.tables.at("motion.energy");
  const double kinetic = ledger.rows.front()[ledger.column("kinetic")];
  EXPECT_LT(std::abs(ledger.rows.back()[ledger.column("residue")]), 1e-3 * kinetic);
}

// Its rows repeat each other to the digits in which the start is given, and to more of them at 1.25 s.
TEST(SpaceStudies, RunBricardsMechanismAtATightTolerance) {
  std::string text = testing::replaced(example("bricard"), "tolerance = 1e-3", "tolerance = 1e-6");
  text = testing::replaced(text, "duration = 10.0", "duration = 2.0");
  const auto ran = run_mechanism_study(text);
  EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
}

TEST(SpaceStudies, RunBricardsMechanismAndNameItsRedundancy) {
  const auto ran = run_mechanism_study(example("bricard"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_THAT(ran.report.warnings[0], HasSubstr("what other joints say"));
  const auto& table = ran.sink.tables.at("motion");
  testing::Bricard exact;
  double largest = 0.0;
  for (std::size_t second = 1; second <= 10; ++second) {
    exact.go(1.0, 1e-3);
    const auto motion = exact.motion();
    EXPECT_LT(motion.gap, 1e-11) << "the reference does not close";
    const std::size_t row = 50 * second;
    ASSERT_DOUBLE_EQ(table.rows[row][0], double(second));
    const Vector3 middle = 0.5 * (motion.corner[2] + motion.corner[3]);
    largest = std::max(largest, (position_of(table, row, "rod 3") - middle).norm());
    // Hinge 1 turns by how far a has left 90 degrees, about the axis -y of the reference. The bound is that of the
    // middle of a rod below, half a metre from its hinge.
    EXPECT_NEAR(table.rows[row][table.column("angle", "hinge 1")], 0.5 * pi - exact.a, 4.4e-3) << second;
  }
  // The tolerance 1e-3 is a share of the motion: five rods of 1 kg that go 1 m, 2.2 m sqrt(kg), if all of it is one
  // rod's.
  EXPECT_LT(largest, 2.2e-3);
  const auto& ledger = ran.sink.tables.at("motion.energy");
  double residue = 0.0, kinetic = 0.0;
  for (const auto& row : ledger.rows) {
    residue = std::max(residue, std::abs(row[ledger.column("residue")]));
    kinetic = std::max(kinetic, row[ledger.column("kinetic")]);
  }
  EXPECT_LT(residue, 1e-3 * kinetic);
}

// M = 2 pi E I/L: the chords of the elements make a regular polygon, which closes exactly. Its curvature holds the
// moment in every section, the wall's included.
TEST(SpaceStudies, RollUpACantilever) {
  const auto ran = run_mechanism_study(example("roll-up"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("rolled");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_LT(position_of(table, 0, "end").norm(), 1e-8);
  for (int i = 1; i < 20; ++i) {
    const std::string node = "strip:" + std::to_string(i);
    const double angle = 2.0 * pi * i / 20.0, shortest = angle > pi ? angle - 2.0 * pi : angle;
    if (i != 10) {
      EXPECT_NEAR(turn_of(table, 0, node)[2], shortest, 1e-8) << node;
    }
    // The polygon of 20 chords of 1/20 m.
    const double radius = 0.5 / 20.0 / std::sin(pi / 20.0);
    const Vector3 centre = position_of(table, 0, "strip:10") * 0.5;
    EXPECT_NEAR((position_of(table, 0, node) - centre).norm(), radius, 1e-8) << node;
  }
  const auto modes = run_mechanism_study(example("roll-up"), 1);
  ASSERT_EQ(modes.report.status, analysis::RunStatus::done) << modes.report.message;
  EXPECT_EQ(modes.sink.tables.at("modes").rows.size(), 4u);
}

// Two turns: the chords go round a regular polygon of ten sides twice. Under a moment about an axis of its end that
// turns with it the strip springs out of its plane before, so that no way leads downhill to this equilibrium.
TEST(SpaceStudies, RollUpACantileverTwice) {
  const auto ran = run_mechanism_study(replaced(example("roll-up"), "turns = 1.0", "turns = 2.0"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("rolled");
  EXPECT_LT(position_of(table, 0, "end").norm(), 1e-8);
  EXPECT_LT(position_of(table, 0, "strip:10").norm(), 1e-8);
  const Vector3 centre = position_of(table, 0, "strip:5") * 0.5;
  const double radius = 0.5 / 20.0 / std::sin(pi / 10.0);
  for (int i = 1; i < 20; ++i)
    EXPECT_NEAR((position_of(table, 0, "strip:" + std::to_string(i)) - centre).norm(), radius, 1e-8) << i;
  ASSERT_EQ(ran.report.findings.size(), 2u);
  EXPECT_THAT(ran.report.findings[0], HasSubstr("the loads were raised in"));
  EXPECT_THAT(ran.report.findings[1], HasSubstr("not stable"));
}

/// A wheel on an axle along (1, 2, 2)/3, driven by a constant moment.
const std::string wheel = R"(
[[body]]
name = "wheel"
mass = 3.0
inertia = [0.5, 0.5, 0.5]
position = [1.0, 0.0, 0.0]
[[joint]]
name = "axle"
type = "revolute"
between = ["ground", "wheel"]
at = [1.0, 0.0, 0.0]
axis = [1.0, 2.0, 2.0]
angle = 0.25
moment = 4.0
[[analysis]]
name = "spin"
type = "transient"
step = 0.02
duration = 10.0
)";

// 4 N m on 0.5 kg m2: 8 rad/s2, exact for a method that is exact on parabolas; 64 turns in 10 s.
TEST(SpaceStudies, CountTheTurnsOfARevoluteJoint) {
  const auto ran = run_mechanism_study(wheel);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("spin");
  for (const auto& row : table.rows) {
    const double t = row[0];
    EXPECT_NEAR(row[table.column("angle", "axle")], 0.25 + 4.0 * t * t, 1e-8 * (1.0 + t * t));
    EXPECT_NEAR(row[table.column("angular_velocity", "axle")], 8.0 * t, 1e-8 * (1.0 + t));
    EXPECT_NEAR(row[table.column("angular_acceleration", "axle")], 8.0, 1e-7);
  }
  const auto& ledger = ran.sink.tables.at("spin.energy");
  EXPECT_NEAR(ledger.rows.back()[ledger.column("load_work")], 1600.0, 1e-5);
}

// The moment makes no reaction about the axis, and the wheel is in balance: nothing else acts.
TEST(SpaceStudies, TellReactionsByTheAxesOfTheWorldAboutThePointOfTheJoint) {
  const auto ran =
      run_mechanism_study(replaced(replaced(wheel, "at = [1.0, 0.0, 0.0]", "at = [0.0, 0.0, 0.0]"), "[[analysis]]",
                                   "[gravity]\nacceleration = [0.0, 0.0, -10.0]\n[[analysis]]"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("spin");
  // At the start the centre of mass hangs at r = (1, 0, 0) beside the axle through the origin, n = (1, 2, 2)/3:
  // about n, J = 0.5 + m |n x r|^2; the moment about the origin is that of the weight less what accelerates.
  const Vector3 n(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0), r = Vector3::UnitX(), weight(0.0, 0.0, -30.0);
  const double inertia = 0.5 + 3.0 * n.cross(r).squaredNorm();
  const double rate = (4.0 + n.dot(r.cross(weight))) / inertia;
  const Vector3 force = 3.0 * rate * n.cross(r) - weight;
  EXPECT_LT((force_of(table, 0, "axle") - force).norm(), 1e-9 * force.norm());
  // J alpha = n x ... about the centre: 0.5 rate n = M + (-r) x F + 4 n with M the moment of the joint at its point.
  const Vector3 moment = 0.5 * rate * n + r.cross(force) - 4.0 * n;
  EXPECT_LT((moment_of(table, 0, "axle") - moment).norm(), 1e-9 * force.norm());
  EXPECT_NEAR(moment_of(table, 0, "axle").dot(n), 0.0, 1e-9);
}

// A screw of lead p turns a force along its axis into turns: (m p^2/(2 pi)^2 + J) angle'' = force p/(2 pi).
TEST(SpaceStudies, RunAScrewOverManyTurns) {
  const auto ran = run_mechanism_study(R"(
[[body]]
name = "nut"
mass = 2.0
inertia = [0.01, 0.01, 0.01]
position = [0.0, 0.0, 0.0]
[[joint]]
name = "thread"
type = "screw"
between = ["ground", "nut"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
lead = 0.2
[[force]]
on = "nut.z"
expression = "3"
[[analysis]]
name = "fall"
type = "transient"
step = 0.01
duration = 5.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("fall");
  const double a = 0.2 / (2.0 * pi), rate = 3.0 * a / (2.0 * a * a + 0.01);
  const auto& last = table.rows.back();
  EXPECT_NEAR(last[table.column("angle", "thread")], 0.5 * rate * 25.0, 1e-6);
  EXPECT_GT(last[table.column("angle", "thread")], 4.0 * 2.0 * pi);
  EXPECT_NEAR(last[table.column("displacement", "thread")], a * 0.5 * rate * 25.0, 1e-7);
}

// A rigid rotation of everything changes nothing but the rotation: the same coordinates and reactions, turned. What
// differs is round-off, Newton's tolerance of 1e-10, and what a chain of pendulums makes of them.
TEST(SpaceStudies, AreObjective) {
  const numerics::Rotation turn = numerics::rotation_of({0.7, -1.1, 0.4});
  const auto text = [](const numerics::Rotation& by) {
    const auto vector = [&](const Vector3& v) {
      const Vector3 w = by * v;
      std::string all;
      for (Index i = 0; i < 3; ++i) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%s%.17g", i == 0 ? "[" : ", ", w[i] + 0.0);
        std::string number = buffer;
        if (number.find_first_of(".e") == std::string::npos) number += ".0";
        all += number;
      }
      return all + "]";
    };
    const Vector3 rotation = numerics::vector_of(by);
    char turned[120];
    std::snprintf(turned, sizeof turned, "[%.17f, %.17f, %.17f]", rotation[0], rotation[1], rotation[2]);
    return "[[body]]\nname = \"a\"\nmass = 2.0\ninertia = [0.3, 0.4, 0.5]\nposition = " + vector({0.5, 0.0, 0.0}) +
           "\nrotation = " + turned +
           "\n[[body]]\nname = \"b\"\nmass = 1.0\ninertia = [0.1, 0.2, 0.15]\nposition = " + vector({1.0, 0.5, 0.0}) +
           "\nrotation = " + turned +
           "\nangular_velocity = [0.0, 2.0, 0.0]\n"
           "[[joint]]\nname = \"J\"\ntype = \"universal\"\nbetween = [\"ground\", \"a\"]\nat = [0.0, 0.0, 0.0]\naxis "
           "= " +
           vector({0.0, 1.0, 0.0}) + "\nsecond_axis = " + vector({0.0, 0.0, 1.0}) +
           "\n[[joint]]\nname = \"K\"\ntype = \"revolute\"\nbetween = [\"a\", \"b\"]\nat = " + vector({1.0, 0.0, 0.0}) +
           "\naxis = " + vector({0.0, 1.0, 0.0}) +
           "\nstiffness = 3.0\n[gravity]\nacceleration = " + vector({0.0, 0.0, -9.81}) +
           "\n[[analysis]]\nname = \"m\"\ntype = \"transient\"\nstep = 0.01\nduration = 1.0\n";
  };
  const auto one = run_mechanism_study(text(numerics::Rotation::Identity())), two = run_mechanism_study(text(turn));
  const auto &before = one.sink.tables.at("m"), &after = two.sink.tables.at("m");
  ASSERT_EQ(before.rows.size(), after.rows.size());
  for (const std::size_t row : {std::size_t{0}, std::size_t{50}, std::size_t{100}}) {
    for (const char* body : {"a", "b"})
      EXPECT_LT((turn * position_of(before, row, body) - position_of(after, row, body)).norm(), 1e-8) << row;
    for (const char* joint : {"J", "K"}) {
      EXPECT_LT((turn * force_of(before, row, joint) - force_of(after, row, joint)).norm(), 1e-5) << row;
      EXPECT_LT((turn * moment_of(before, row, joint) - moment_of(after, row, joint)).norm(), 1e-5) << row;
    }
    EXPECT_NEAR(before.rows[row][before.column("angle", "K")], after.rows[row][after.column("angle", "K")], 1e-8);
  }
}

}  // namespace
}  // namespace rubato
