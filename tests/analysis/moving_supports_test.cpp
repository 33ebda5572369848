#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/transient.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/system/eliminate_supports.hpp>

#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>

namespace rubato::analysis {
namespace {

using integrate::find_equilibrium;
using integrate::StaticEquilibrium;
using integrate::StaticOutcome;

/// The tables of the first analysis, a transient.
testing::MemorySink run(const std::string& text) {
  const testing::PreparedStudy prepared(text);
  const auto& analysis = prepared.study.analyses.front();
  const auto& transient = std::get<model::TransientDescription>(analysis.task);
  const TransientPlan plan =
      plan_transient(analysis.name, analysis.where, transient, *prepared.kind, prepared.parameters);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  EXPECT_EQ(run_transient(analysis.name, plan, *prepared.kind, context).status, RunStatus::done);
  return sink;
}

const std::string driven_mass = R"(
[[coordinate]]
name = "base"
mass = 2.0
[[coordinate]]
name = "top"
mass = 1.5
[[spring]]
between = ["base", "top"]
stiffness = 150.0
)";

std::string transient(double step, double duration) {
  return "\n[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = " + std::to_string(step) +
         "\nduration = " + std::to_string(duration) + "\n";
}

struct Errors {
  double displacement = 0.0, reaction = 0.0, balance = 0.0;
};

// m q'' + k q = k A sin(w t) from rest; the base is pushed by r = 2 m0'' + k (x - q).
Errors errors_of_driven_mass(const std::string& law, double step) {
  const double w = 7.0, amplitude = 0.01, omega = 10.0;
  const auto sink = run(driven_mass + "[[displacement]]\non = \"base\"\n" + law + transient(step, 3.0));
  const auto& table = sink.tables.at("run");
  const auto& energy = sink.tables.at("run.energy");
  Errors errors;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    const double t = row[0], gain = amplitude * omega * omega / (omega * omega - w * w);
    const double q = gain * (std::sin(w * t) - w / omega * std::sin(omega * t));
    const double x = amplitude * std::sin(w * t), reaction = -2.0 * w * w * x + 150.0 * (x - q);
    EXPECT_NEAR(row[table.column("position", "base")], x, 1e-15);
    errors.displacement = std::max(errors.displacement, std::abs(row[table.column("position", "top")] - q));
    errors.reaction = std::max(errors.reaction, std::abs(row[table.column("reaction", "base")] - reaction));
    errors.balance = std::max(errors.balance, std::abs(energy.rows[i][energy.column("residue")]));
  }
  return errors;
}

TEST(MovingSupport, DrivesAMassAsTheClosedFormSaysWithSecondOrder) {
  const std::string formula = "expression = \"0.01*sin(7*t)\"\n";
  const Errors coarse = errors_of_driven_mass(formula, 0.01), fine = errors_of_driven_mass(formula, 0.005);
  // Two halvings away from the asymptotic regime the ratio lies within a tenth of 4.
  EXPECT_NEAR(coarse.displacement / fine.displacement, 4.0, 0.4);
  EXPECT_NEAR(coarse.reaction / fine.reaction, 4.0, 0.4);
  EXPECT_NEAR(coarse.balance / fine.balance, 4.0, 1.0);
  EXPECT_LT(fine.displacement, 1e-4);
}

TEST(MovingSupport, IsTheSameByAFormulaAndByItsHarmonic) {
  const std::string harmonic = "amplitude = 0.01\nangular_frequency = 7.0\nphase = \"-pi/2\"\n";
  EXPECT_NEAR(errors_of_driven_mass(harmonic, 0.01).displacement,
              errors_of_driven_mass("expression = \"0.01*sin(7*t)\"\n", 0.01).displacement, 1e-12);
}

/// A portal of two columns on feet that move sideways, and on fixed feet on a ground that moves.
std::string portal(bool by_supports) {
  std::string text = R"(
[[node]]
name = "a"
position = [0.0, 0.0]
[[node]]
name = "b"
position = [0.0, 3.0]
[[node]]
name = "c"
position = [4.0, 3.0]
[[node]]
name = "d"
position = [4.0, 0.0]
[[material]]
name = "steel"
young = 2e11
poisson = 0.3
density = 7800.0
[[section]]
name = "s"
area = 3e-3
inertia = 2e-6
shear_factor = 0.85
)";
  for (const char* ends : {"\"a\", \"b\"", "\"b\", \"c\"", "\"c\", \"d\""})
    text += std::string("[[beam]]\nnodes = [") + ends + "]\nsection = \"s\"\nmaterial = \"steel\"\nelements = 2\n";
  for (const char* foot : {"a", "d"})
    text += std::string("[[support]]\nnode = \"") + foot + "\"\nfix = [" + (by_supports ? "" : "\"x\", ") +
            "\"y\", \"rz\"]\n";
  text += "[damping]\nmodal_ratio = 0.03\n";
  if (by_supports)
    for (const char* foot : {"a.x", "d.x"})
      text += std::string("[[displacement]]\non = \"") + foot + "\"\nexpression = \"0.02*(1 - cos(30*t))\"\n";
  else
    text += "[base_motion]\nexpression = \"18*cos(30*t)\"\ndirection = { x = 1.0 }\n";
  return text +
         "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = 1e-3\nduration = 0.5\nobserve = [\"c.x\"]\n";
}

// Relative to feet that move together a structure only feels their acceleration; what is damped relative to them as
// well. Both are the same equations, integrated by the same method: to round-off of the stiffest terms.
TEST(MovingSupports, ThatMoveTogetherAreAMovingGround) {
  const auto by_supports = run(portal(true)), by_ground = run(portal(false));
  const auto &moved = by_supports.tables.at("run"), &relative = by_ground.tables.at("run");
  ASSERT_EQ(moved.rows.size(), relative.rows.size());
  double largest = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < moved.rows.size(); ++i) {
    const double ground_moves = 0.02 * (1.0 - std::cos(30.0 * moved.rows[i][0]));
    const double by_ground_motion = relative.rows[i][relative.column("position", "c.x")];
    largest = std::max(largest, std::abs(by_ground_motion));
    difference = std::max(difference,
                          std::abs(moved.rows[i][moved.column("position", "c.x")] - ground_moves - by_ground_motion));
  }
  // The method integrates the ground's motion in the one and is told it in the other: its own error of second order,
  // (w h)^2/12 of 0.04 m.
  EXPECT_GT(largest, 5e-3);
  EXPECT_LT(difference, 5e-5);
}

TEST(MovingSupports, AreNotDampedWhereAllMovesAlike) {
  // Free, given, free: all at one velocity.
  Matrix stiffness(3, 3);
  stiffness << 2, -2, 0, -2, 5, -3, 0, -3, 3;
  Matrix damping(2, 2);
  damping << 0.7, 0.1, 0.1, 0.4;
  const model::Prescribed given{1, {}, {}, {}};
  const SparseMatrix all = system::relative_damping(damping.sparseView(), stiffness.sparseView(), std::span(&given, 1));
  EXPECT_LT((all * Vector::Ones(3)).norm(), 1e-14);
  EXPECT_LT((Matrix(all) - Matrix(all).transpose()).norm(), 1e-15);
  EXPECT_LT((Matrix(system::free_part(all, std::span(&given, 1))) - damping).norm(), 1e-14);
}

TEST(MovingSupport, StandsInAStaticStateWhereItStarts) {
  const testing::PreparedStudy prepared(driven_mass +
                                        "[[displacement]]\non = \"base\"\nexpression = \"0.02*cos(5*t) + 3*t\"\n");
  const StaticEquilibrium found = find_equilibrium(prepared.system, {});
  ASSERT_EQ(found.outcome, StaticOutcome::found);
  EXPECT_NEAR(found.state.q[0], 0.02, 1e-15);
}

std::string message_of(const std::string& text) {
  try {
    (void)run(driven_mass + text + transient(0.01, 1.0));
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return "";
}

TEST(MovingSupport, IsRefusedWithThePlaceAndTheRemedy) {
  const std::string law = "[[displacement]]\non = \"base\"\nexpression = \"t\"\n";
  EXPECT_NE(message_of(law + law).find("another one"), std::string::npos);
  EXPECT_NE(message_of(law + "[[displacement]]\non = \"base\"\nvalue = 1.0\n").find("another one holds it"),
            std::string::npos);
  EXPECT_NE(message_of(law + "[[displacement]]\non = \"top\"\nexpression = \"t\"\n").find("nothing is left"),
            std::string::npos);
  EXPECT_NE(message_of("[[displacement]]\non = \"base\"\nexpression = \"1/t\"\n").find("no finite value"),
            std::string::npos);
  EXPECT_NE(message_of(law + "[[slider]]\nbetween = [\"base\", \"top\"]\nstiffness = 1.0\nfriction_coefficient = 1.0\n"
                             "normal_load = 1.0\n")
                .find("light mass"),
            std::string::npos);
}

// Between rows far from its ends, where it is not bent, the spline errs by h^4/384 times the fourth derivative.
TEST(Spline, PassesThroughItsRowsAndErrsWithTheFourthPowerOfTheirDistance) {
  const auto error = [](double h) {
    model::TableLaw table;
    for (double t = 0.0; t < 6.0 + 0.5 * h; t += h) {
      table.times.push_back(t);
      table.values.push_back(std::sin(t));
    }
    model::SplineLaw spline = model::spline_through(table);
    double largest = 0.0;
    for (double t = 2.0; t < 4.0; t += 0.1 * h)
      largest = std::max(largest, std::abs(model::value(spline, t) - std::sin(t)));
    for (std::size_t i = 0; i < table.times.size(); ++i)
      EXPECT_NEAR(model::value(spline, table.times[i]), table.values[i], 1e-15);
    // Derivatives are those of the spline itself.
    for (const double t : {0.33, 1.77, 5.13}) {
      const double d = 1e-4;
      for (int order = 0; order < 2; ++order) {
        spline.order = order;
        const double slope = (model::value(spline, t + d) - model::value(spline, t - d)) / (2.0 * d);
        spline.order = order + 1;
        EXPECT_NEAR(model::value(spline, t), slope, 1e-7);
      }
    }
    return largest;
  };
  const double coarse = error(0.2), fine = error(0.1);
  EXPECT_NEAR(coarse / fine, 16.0, 1.6);
  EXPECT_NEAR(coarse, std::sin(2.0) * std::pow(0.2, 4) / 384.0, 0.1 * coarse);
}

// Where the analysis ends with the table, its last row shows the speed of the spline there, and not that of a support
// that has come to rest.
TEST(Spline, HasItsSpeedAtTheLastRowOfATableThatEndsWithTheAnalysis) {
  const model::TableLaw table{{0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0, 3.0}, model::TableLaw::Beyond::error, ""};
  model::SplineLaw speed = model::spline_through(table);
  speed.order = 1;
  for (const model::Side side : {model::Side::left, model::Side::right})
    EXPECT_NEAR(model::value(speed, 3.0, side), 1.0, 1e-15);
  speed.holds_beyond = true;  // it rests from there on
  EXPECT_NEAR(model::value(speed, 3.0, model::Side::left), 1.0, 1e-15);
  EXPECT_EQ(model::value(speed, 3.0, model::Side::right), 0.0);
}

}  // namespace
}  // namespace rubato::analysis
