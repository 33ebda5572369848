#include <rubato/analysis/run_study.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include "support/assembled.hpp"
#include "support/frame.hpp"
#include "support/memory_sink.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace rubato::analysis {
namespace {

using integrate::find_equilibrium;
using integrate::StaticEquilibrium;
using integrate::StaticOutcome;
using testing::assembled;
using testing::place_of;
using testing::portal;

/// Analyses of a system that no sweep makes again.
StudyInput input_of(const integrate::SystemKind& kind) {
  static const model::StudyDescription no_study;
  static const numerics::Parameters none;
  return {no_study, none, none, kind};
}

/// The frame cut free at node 1 is a bent cantilever: beam along x, column along y. Displacements at points of it under
/// unit loads there by the principle of virtual work, with stretching, shear and bending: no stiffness matrix.
class BentCantilever {
 public:
  struct Load {
    double x, y;  // where, on the centre line
    double fx, fy, moment;
  };
  /// Work of the internal forces of `a` on the deformation by `b`: the displacement of `a` by `b` for unit loads.
  static double work(const Load& a, const Load& b) {
    // Both members from the free end to the fixed one; a load acts on what follows it.
    double sum = 0.0;
    const auto add = [&](double x0, double y0, double x1, double y1) {
      const double length = std::hypot(x1 - x0, y1 - y0), tx = (x1 - x0) / length, ty = (y1 - y0) / length;
      const auto internal = [&](const Load& load, double s) {
        const double x = x0 + s * tx, y = y0 + s * ty;
        const bool acts = is_before(load, x, y);
        struct {
          double axial, shear, moment;
        } result{0.0, 0.0, 0.0};
        if (!acts) return result;
        result.axial = load.fx * tx + load.fy * ty;
        result.shear = -load.fx * ty + load.fy * tx;
        result.moment = load.moment + (load.x - x) * load.fy - (load.y - y) * load.fx;
        return result;
      };
      // Products of linear functions on each half between the loads: Simpson's rule is exact there.
      const double cuts[] = {0.0, length / 3.0, 2.0 * length / 3.0, length};
      for (int k = 0; k < 3; ++k) {
        const double h = cuts[k + 1] - cuts[k], eps = 1e-12 * h;
        const double at[] = {cuts[k] + eps, cuts[k] + 0.5 * h, cuts[k + 1] - eps}, weight[] = {1.0, 4.0, 1.0};
        for (int i = 0; i < 3; ++i) {
          const auto p = internal(a, at[i]), q = internal(b, at[i]);
          sum += h / 6.0 * weight[i] *
                 (p.axial * q.axial / (young * area) + p.shear * q.shear / (5.0 / 6.0 * shear_modulus * area) +
                  p.moment * q.moment / (young * inertia));
        }
      }
    };
    add(3.0, 2.7, 0.0, 2.7);
    add(0.0, 2.7, 0.0, 0.0);
    return sum;
  }

 private:
  static constexpr double young = 206.01e9, shear_modulus = young / 2.6, area = 3.2e-3, inertia = 1.707e-6;
  static bool is_before(const Load& load, double x, double y) {
    return load.x >= x && load.y >= y;  // the way leads to the left, then down
  }
};

// Node 1 is held in x and rz and displaced by 6 mm in y (PMB), node 5 by 10 mm in x as well (PMM).
TEST(StaticEquilibrium, IsThatOfTheFrameByVirtualWork) {
  const system::LocallyNonlinear system = assembled(testing::portal_frame());
  const Index y1 = place_of(system, "1.y"), x5 = place_of(system, "5.x");
  const BentCantilever::Load loads[] = {
      {3.0, 2.7, 1, 0, 0}, {3.0, 2.7, 0, 0, 1}, {3.0, 2.7, 0, 1, 0}, {0.0, 1.8, 1, 0, 0}};
  Matrix flexibility(4, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) flexibility(i, j) = BentCantilever::work(loads[i], loads[j]);
  Vector bent(3), both(4);
  bent << 0.0, 0.0, 0.006;
  both << 0.0, 0.0, 0.006, 0.01;
  const Vector of_bent = flexibility.topLeftCorner(3, 3).lu().solve(bent), of_both = flexibility.lu().solve(both);

  const std::vector<model::Held> low{{y1, 0.006}}, middle{{y1, 0.006}, {x5, 0.01}};
  const StaticEquilibrium pmb = find_equilibrium(system, low), pmm = find_equilibrium(system, middle);
  ASSERT_EQ(pmb.outcome, StaticOutcome::found);
  ASSERT_EQ(pmm.outcome, StaticOutcome::found);
  // Condition number 1e7 of the stiffness, and the offset of 1e-12 in the integration above.
  EXPECT_NEAR(pmb.reaction[0], of_bent[2], 1e-9 * of_bent[2]);
  EXPECT_NEAR(pmb.state.q[x5], flexibility.row(3).head(3) * of_bent, 1e-12);
  EXPECT_NEAR(pmm.reaction[0], of_both[2], 1e-9 * std::abs(of_both[3]));
  EXPECT_NEAR(pmm.reaction[1], of_both[3], 1e-9 * std::abs(of_both[3]));
  // Clapeyron: the energy is half of force times displacement.
  EXPECT_NEAR(pmm.state.q.dot(system.stiffness() * pmm.state.q), 0.006 * of_both[2] + 0.01 * of_both[3], 1e-6);
}

// The shape functions are exact: nodes within change nothing but round-off. A rounding of the stiffness of an element
// against that of the whole, 12 E I/h^3 over 3 E I/L^3, is 4 N^3 eps = 2.4e-8 for N = 300.
TEST(StaticEquilibrium, DoesNotDependOnHowABeamIsDivided) {
  model::ModelDescription description = testing::portal_frame();
  const system::LocallyNonlinear coarse = assembled(description);
  for (auto& beam : description.structure.beams) beam.elements = 50;
  const system::LocallyNonlinear fine = assembled(description);
  const std::vector<model::Held> low{{place_of(coarse, "1.y"), 0.006}}, low_fine{{place_of(fine, "1.y"), 0.006}};
  const StaticEquilibrium a = find_equilibrium(coarse, low), b = find_equilibrium(fine, low_fine);
  ASSERT_EQ(b.outcome, StaticOutcome::found);
  EXPECT_NEAR(b.reaction[0], a.reaction[0], 2.4e-8 * a.reaction[0]);
  const double turn = a.state.q[place_of(coarse, "4.rz")];
  EXPECT_NEAR(b.state.q[place_of(fine, "4.rz")], turn, 2.4e-8 * turn);
}

/// A mass on sliders of 100 N/m, limits 1 N and 10 N, under a held force.
system::LocallyNonlinear between_sliders(double force) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = SparseMatrix(1, 1);
  parts.mass.insert(0, 0) = 1.0;
  parts.damping = parts.stiffness = SparseMatrix(1, 1);
  parts.sliders = {{"weak", 0, ground, 100.0, 1.0}, {"strong", 0, ground, 100.0, 10.0}};
  parts.held_forces = {{0, force}};
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

/// A cantilever of 2 m along (0.6, 0.8), clamped at "foot".
model::ModelDescription cantilever(int elements, bool lumped_mass) {
  model::ModelDescription description;
  auto& structure = description.structure;
  structure.nodes = {{"foot", {0.0, 0.0}, {}}, {"tip", {1.2, 1.6}, {}}};
  structure.materials = {{"steel", 2.1e11, 0.3, {}, 7850.0, {}}};
  structure.sections = {{"bar", 2e-2, {6e-5}, {}, {0.5}, {}}};
  model::BeamDescription beam;
  beam.name = "arm";
  beam.nodes = {"foot", "tip"};
  beam.section = "bar";
  beam.material = "steel";
  beam.elements = elements;
  beam.lumped_mass = lumped_mass;
  structure.beams = {beam};
  model::SupportDescription foot;
  foot.node = "foot";
  foot.fix = {"x", "y", "rz"};
  structure.supports = {foot};
  return description;
}

// Timoshenko (1921): under p across it, the tip moves by p L^4/(8 E I) + p L^2/(2 kappa A G) and turns by p L^3/(6 E
// I); under p along it, by p L^2/(2 E A). The condition number of 4 elements is some 1e5.
TEST(StaticEquilibrium, BendsACantileverUnderAnEvenLoad) {
  const double ei = 2.1e11 * 6e-5, ea = 2.1e11 * 2e-2, kag = 0.5 * 2e-2 * 2.1e11 / 2.6, length = 2.0, p = 3e4;
  for (const int elements : {1, 4})
    for (const bool lumped : {false, true}) {
      model::ModelDescription description = cantilever(elements, lumped);
      model::DistributedForceDescription across{"arm", {-0.8, 0.6}, model::HarmonicDescription{p, 0.0, 0.0}, {}};
      description.distributed_forces = {across};
      const auto bent = assembled(description);
      const Vector q = find_equilibrium(bent, {}).state.q;
      const double deflection = p * std::pow(length, 4) / (8.0 * ei) + p * length * length / (2.0 * kag);
      EXPECT_NEAR(q[place_of(bent, "tip.x")], -0.8 * deflection, 1e-10 * deflection);
      EXPECT_NEAR(q[place_of(bent, "tip.y")], 0.6 * deflection, 1e-10 * deflection);
      EXPECT_NEAR(q[place_of(bent, "tip.rz")], p * std::pow(length, 3) / (6.0 * ei), 1e-10 * deflection);

      description.distributed_forces[0].direction = {0.6, 0.8};
      const auto stretched = assembled(description);
      const Vector along = find_equilibrium(stretched, {}).state.q;
      const double extension = p * length * length / (2.0 * ea);
      EXPECT_NEAR(along[place_of(stretched, "tip.x")], 0.6 * extension, 1e-9 * extension);
    }
}

// Weight is an even load of rho A g.
TEST(StaticEquilibrium, BendsACantileverUnderItsWeight) {
  model::ModelDescription description = cantilever(3, false);
  description.gravity = model::GravityDescription{{0.0, -9.81}, {}};
  const auto heavy = assembled(description);
  description.gravity.reset();
  model::DistributedForceDescription weight{
      "arm", {0.0, -1.0}, model::HarmonicDescription{7850.0 * 2e-2 * 9.81, 0.0, 0.0}, {}};
  description.distributed_forces = {weight};
  const auto loaded = assembled(description);
  const Vector by_gravity = find_equilibrium(heavy, {}).state.q, by_load = find_equilibrium(loaded, {}).state.q;
  EXPECT_LT((by_gravity - by_load).norm(), 1e-12 * by_load.norm());
}

TEST(StaticEquilibrium, SharesTheLoadAmongSlidersThatStickAndSlip) {
  const StaticEquilibrium stuck = find_equilibrium(between_sliders(1.6), {});
  ASSERT_EQ(stuck.outcome, StaticOutcome::found);
  EXPECT_NEAR(stuck.state.q[0], 0.008, 1e-17);
  const StaticEquilibrium slipping = find_equilibrium(between_sliders(5.0), {});
  ASSERT_EQ(slipping.outcome, StaticOutcome::found);
  EXPECT_NEAR(slipping.state.q[0], 0.04, 1e-16);  // 4 N on the strong one
  EXPECT_NEAR(slipping.state.slider_force[0], 1.0, 1e-15);
  EXPECT_NEAR(slipping.state.slider_force[1], 4.0, 1e-14);
  EXPECT_EQ(find_equilibrium(between_sliders(12.0), {}).outcome, StaticOutcome::gives_way);
}

/// A mass under a weight between springs and stops.
system::LocallyNonlinear on_stops(double weight, double spring, std::vector<model::StopDescription> stops) {
  model::ModelDescription description;
  description.coordinates = {{"mass", 1.0, 0.0, 0.0, {}}};
  if (spring > 0.0) description.springs = {{{"mass", "ground"}, {}, spring, {}}};
  description.held_forces = {{"mass", weight, {}}};
  description.stops = std::move(stops);
  return assembled(description);
}

// Nothing but a stop may hold a mass: it comes to rest a gap and its weight over the stiffness away, also from far.
TEST(StaticEquilibrium, RestsOnAStop) {
  for (const double gap : {0.01, 0.0, -0.02, 3.0}) {
    const StaticEquilibrium found =
        find_equilibrium(on_stops(9.81, 0.0, {{"floor", {"mass", "ground"}, {}, {}, {}, gap, 1000.0, 5.0, {}}}), {});
    ASSERT_EQ(found.outcome, StaticOutcome::found) << gap;
    EXPECT_NEAR(found.state.q[0], gap + 9.81e-3, 1e-13 * std::max(1.0, std::abs(gap))) << gap;
    EXPECT_NEAR(found.state.slider_force[0], 9.81, 1e-9);
  }
  const StaticEquilibrium wrong_side =
      find_equilibrium(on_stops(-9.81, 0.0, {{"floor", {"mass", "ground"}, {}, {}, {}, 0.01, 1000.0, 0.0, {}}}), {});
  EXPECT_EQ(wrong_side.outcome, StaticOutcome::mechanism);
}

// With a spring k = 500 N/m: open below 5 N with a gap of 10 mm, beyond it both carry; a negative gap pushes by itself:
// 500 u + 1000 (u + 0.03) = 0. Between two stops only one carries.
TEST(StaticEquilibrium, ClosesAStopWhereTheSpringGivesThatFar) {
  const auto at = [](double weight, double gap) {
    const auto system = on_stops(weight, 500.0, {{"s", {"mass", "ground"}, {}, {}, {}, gap, 1000.0, 0.0, {}}});
    const StaticEquilibrium found = find_equilibrium(system, {});
    EXPECT_EQ(found.outcome, StaticOutcome::found);
    return found.state.q[0];
  };
  EXPECT_NEAR(at(4.0, 0.01), 0.008, 1e-16);
  EXPECT_NEAR(at(8.0, 0.01), 0.012, 1e-16);
  EXPECT_NEAR(at(0.0, -0.03), -0.02, 1e-16);
  const auto both = on_stops(9.81, 0.0,
                             {{"below", {"mass", "ground"}, {}, {}, {}, 0.01, 1000.0, 0.0, {}},
                              {"above", {"ground", "mass"}, {}, {}, {}, 0.01, 1000.0, 0.0, {}}});
  const StaticEquilibrium found = find_equilibrium(both, {});
  ASSERT_EQ(found.outcome, StaticOutcome::found);
  EXPECT_NEAR(found.state.q[0], 0.01981, 1e-14);
  EXPECT_EQ(found.state.slider_force[1], 0.0);
}

/// What is missing from equilibrium, over the largest load.
double imbalance(const system::LocallyNonlinear& system, const StaticEquilibrium& found) {
  Vector left = system.stiffness() * found.state.q;
  system.add_slider_forces(found.state.slider_force, 1.0, left);
  double largest = 0.0;
  for (const auto& force : system.held_forces()) {
    left[force.coordinate] -= force.value;
    largest = std::max(largest, std::abs(force.value));
  }
  return left.cwiseAbs().maxCoeff() / largest;
}

// The step to the equilibrium with the stop open would go far beyond the stop, and is cut where the energy is least: a
// state before the stop, of which nothing but the length of the step was wrong, is no equilibrium.
TEST(StaticEquilibrium, IsNotWhereAStepTowardsAStopWasCut) {
  for (const double stiffness : {1e3, 1e4, 1e9, 1e14}) {
    model::ModelDescription description;
    description.coordinates = {{"a", 1.0, 0.0, 0.0, {}}, {"b", 1.0, 0.0, 0.0, {}}};
    description.springs = {{{"a", "ground"}, {}, 500.0, {}}, {{"b", "a"}, {}, 150.0, {}}};
    description.held_forces = {{"a", -40.0, {}}, {"b", 30.0, {}}};
    description.stops = {{"s", {"b", "ground"}, {}, {}, {}, 0.1, stiffness, 0.0, {}}};
    const auto system = assembled(description);
    const StaticEquilibrium found = find_equilibrium(system, {});
    ASSERT_EQ(found.outcome, StaticOutcome::found) << stiffness;
    const double k = 150.0 + stiffness;  // 650 a - 150 b = -40, -150 a + k b = 30 + 0.1 stiffness, by Cramer's rule
    EXPECT_NEAR(found.state.q[1], (650.0 * (30.0 + 0.1 * stiffness) - 150.0 * 40.0) / (650.0 * k - 150.0 * 150.0),
                1e-12);
    EXPECT_LT(imbalance(system, found), 1e-14 * stiffness) << stiffness;
  }
}

// Chains with sliders and stops at random, of stiffness 1e-2 to 1e6 of the springs: every state found is an
// equilibrium.
TEST(StaticEquilibrium, BalancesAllForcesWhateverContactsThereAre) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 2 + trial % 5;
    model::ModelDescription description;
    const auto name = [](int i) { return i < 0 ? std::string("ground") : "c" + std::to_string(i); };
    const auto any_other = [&](int i) { return name(static_cast<int>(std::floor(uniform(-1.0, i)))); };
    for (int i = 0; i < n; ++i) {
      description.coordinates.push_back({name(i), 1.0, 0.0, 0.0, {}});
      description.springs.push_back({{name(i), i == 0 ? "ground" : any_other(i)}, {}, uniform(0.3, 3.0), {}});
      description.held_forces.push_back({name(i), uniform(-1.0, 1.0), {}});
      const double stiffness = std::pow(10.0, uniform(-2.0, 6.0));
      if (uniform(0.0, 1.0) < 0.5)
        description.stops.push_back(
            {"stop" + name(i), {name(i), any_other(i)}, {}, {}, {}, uniform(-0.2, 0.5), stiffness, 0.0, {}});
      else
        description.sliders.push_back(
            {"slider" + name(i), {any_other(i), name(i)}, {}, {}, {}, stiffness, uniform(0.0, 1.0), 1.0, {}});
    }
    const auto system = assembled(description);
    const StaticEquilibrium found = find_equilibrium(system, {});
    ASSERT_EQ(found.outcome, StaticOutcome::found) << trial;
    EXPECT_LT(imbalance(system, found), 1e-8) << trial;
  }
}

// Hinges at both ends of the beam leave two cantilevers: F H^3 / (3 EI) under F at each head.
TEST(StaticEquilibrium, OfAPortalWithHingesIsThatOfTwoCantilevers) {
  const double height = 3.0, force = 1e3;
  model::ModelDescription description = portal(height, 4.0);
  description.structure.beams[1].release = {{{"rz"}, {"rz"}}};
  description.held_forces = {{"2.x", force, {}}, {"3.x", force, {}}};
  const auto system = assembled(description);
  const StaticEquilibrium found = find_equilibrium(system, {});
  ASSERT_EQ(found.outcome, StaticOutcome::found);
  const double expected = force * std::pow(height, 3) / (3.0 * 2.1e11 * 1e-6);
  EXPECT_NEAR(found.state.q[place_of(system, "2.x")], expected, 1e-11 * expected);
  EXPECT_NEAR(found.state.q[place_of(system, "3.x")], expected, 1e-11 * expected);
}

/// A beam of 2 m in equal parts, held at both ends.
system::LocallyNonlinear held_beam(int elements, bool by_releases) {
  model::ModelDescription description = portal(2.0, 1.0);
  model::StructureDescription& beam = description.structure;
  beam.nodes.resize(2);
  beam.beams.resize(1);
  beam.beams[0].elements = elements;
  beam.supports[1].node = "2";
  if (by_releases)
    beam.beams[0].release = {{{"rz"}, {"rz"}}};
  else
    for (auto& support : beam.supports) support.fix = {"x", "y"};
  description.held_forces = {{"1-2:" + std::to_string(elements / 2) + ".x", 100.0, {}}};
  return assembled(description);
}

// The released rotations follow without resistance, which is what a pinned support leaves to them: the same deflection,
// F L^3 / (48 EI) in the middle. The mass of the static shape can only raise a frequency (Rayleigh): of eight elements
// by less than the share (h/L)^4 pi^4/720 of which the consistent mass errs by itself, times the ends' part.
TEST(StaticEquilibrium, WithReleasedEndsIsThatOfPinnedSupports) {
  const auto released = held_beam(8, true), pinned = held_beam(8, false);
  ASSERT_EQ(released.size() + 2, pinned.size());
  const double deflection = 100.0 * 8.0 / (48.0 * 2.1e11 * 1e-6);
  for (const auto* system : {&released, &pinned}) {
    const StaticEquilibrium found = find_equilibrium(*system, {});
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    EXPECT_NEAR(found.state.q[place_of(*system, "1-2:4.x")], deflection, 1e-10 * deflection);
  }
  const double exact = std::pow(std::numbers::pi / 2.0, 2) * std::sqrt(2.1e11 * 1e-6 / (7850.0 * 1e-3));
  const auto lowest = [](const system::LocallyNonlinear& system) {
    return std::sqrt(Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(Matrix(system.stiffness()), Matrix(system.mass()))
                         .eigenvalues()[0]);
  };
  EXPECT_GE(lowest(released), lowest(pinned) * (1.0 - 1e-12));
  EXPECT_NEAR(lowest(released) / exact, 1.0, std::pow(std::numbers::pi / 8.0, 4) / 720.0 * 8.0);
  EXPECT_LT(lowest(held_beam(16, true)) / exact - 1.0, (lowest(released) / exact - 1.0) / 8.0);
}

TEST(StaticAnalysis, WritesDisplacementsAnglesAndReactions) {
  model::ModelDescription description = testing::portal_frame();
  description.displacements = {{"1.y", 0.006, {}}, {"4.rz", 0.001, {}}};
  const system::LocallyNonlinear system = assembled(description);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  const model::AnalysisDescription analysis{"bent", model::StaticDescription{}, {}};
  EXPECT_EQ(run_analysis(analysis, input_of(integrate::StructureKind(system)), context).status, RunStatus::done);
  const auto& table = sink.tables.at("bent");
  ASSERT_EQ(table.rows.size(), 1u);
  ASSERT_EQ(table.rows[0].size(), table.layout.row_width());
  EXPECT_EQ(table.rows[0][table.column("position", "1.y")], 0.006);
  EXPECT_EQ(table.rows[0][table.column("angle", "4.rz")], 0.001);
  const auto found = find_equilibrium(system, system.held_displacements());
  EXPECT_EQ(table.rows[0][table.column("reaction", "1.y")], found.reaction[0]);
  EXPECT_EQ(table.rows[0][table.column("reaction_moment", "4.rz")], found.reaction[1]);
}

// Let go, the frame swings in its modes: q(t) = sum of phi_i cos(omega_i t) phi_i^T M q0. The largest error of a method
// of second order with d = 0 is (omega h)^2 omega T / 12 in each mode's phase.
TEST(TransientFromStatic, SwingsInItsModesWhenItIsLetGo) {
  model::ModelDescription description = testing::portal_frame();
  description.displacements = {{"1.y", 0.006, {}}};
  const system::LocallyNonlinear system = assembled(description);
  model::TransientDescription transient;
  transient.initial = model::StaticDescription{};
  transient.method.name = "average_acceleration";
  transient.step = 1e-5;
  transient.duration = 0.02;
  testing::MemorySink sink;
  testing::QuietProgress progress;
  std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  EXPECT_EQ(run_analysis({"swing", transient, {}}, input_of(integrate::StructureKind(system)), context).status,
            RunStatus::done);
  const auto& table = sink.tables.at("swing");
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes{Matrix(system.stiffness()), Matrix(system.mass())};
  const Vector start = find_equilibrium(system, system.held_displacements()).state.q;
  const Vector amplitude = modes.eigenvectors().transpose() * (system.mass() * start);
  const std::size_t column = table.column("position", "1.y");
  const Index y1 = place_of(system, "1.y");
  double bound = 0.0, largest = 0.0;
  for (Index i = 0; i < amplitude.size(); ++i) {
    const double omega = std::sqrt(modes.eigenvalues()[i]);
    bound += std::abs(amplitude[i] * modes.eigenvectors()(y1, i)) *
             std::min(2.0, std::pow(omega * 1e-5, 2) * omega * 0.02 / 12);
  }
  for (const auto& row : table.rows) {
    const Vector phase = (modes.eigenvalues().cwiseSqrt() * row[0]).array().cos();
    const double exact = modes.eigenvectors().row(y1).dot(amplitude.cwiseProduct(phase));
    largest = std::max(largest, std::abs(row[column] - exact));
  }
  EXPECT_LT(largest, bound);
  EXPECT_LT(bound, 1e-7);
  // The acceleration at release is that of equilibrium without what held it: phi (-omega^2) phi^T M q0.
  const Vector acceleration = modes.eigenvectors() * (-modes.eigenvalues().cwiseProduct(amplitude));
  EXPECT_NEAR(table.rows[0][table.column("acceleration", "1.y")], acceleration[y1], 1e-8 * std::abs(acceleration[y1]));
}

std::string verdict(const model::AnalysisDescription& analysis, const system::LocallyNonlinear& system) {
  try {
    (void)check_analysis(analysis, input_of(integrate::StructureKind(system)));
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
}

TEST(StaticFault, NamesTheMotionThatNothingResists) {
  model::ModelDescription description = testing::portal_frame();
  description.structure.supports.pop_back();
  EXPECT_EQ(verdict({"bent", model::StaticDescription{}, {}}, assembled(description)),
            "analysis \"bent\": the structure is a mechanism: nothing resists a motion of \"1.y\", \"2.y\", \"3.y\", "
            "\"4.y\", \"5.y\", \"6.y\" and 1 more; support it, join it, or hold a displacement");
  EXPECT_EQ(
      verdict({"pull", model::StaticDescription{}, {}}, between_sliders(12.0)),
      "analysis \"pull\": there is no equilibrium: where \"weak\", \"strong\" slip nothing else resists a motion of "
      "\"mass\"; lower the load, or support it");
}

TEST(StaticFault, NamesADisplacementThatIsNotHeld) {
  model::ModelDescription description = testing::portal_frame();
  description.displacements = {{"1.y", 0.006, {}}};
  model::StaticDescription wanted;
  wanted.displacements = {{{"1.x", "", {}}}};
  EXPECT_EQ(
      verdict({"bent", wanted, {}}, assembled(description)),
      "analysis \"bent\": displacements names \"1.x\", of which there is no [[displacement]]; did you mean \"1.y\"? "
      "(known: 1.y)");
}

TEST(StaticFault, SaysThatPositionsAreFoundAndNotGiven) {
  model::ModelDescription chain;
  chain.coordinates = {{"a", 1.0, 0.5, 0.0, {}}};
  chain.springs = {{{"a", "ground"}, {}, 1e3, {}}};
  model::TransientDescription transient;
  transient.initial = model::StaticDescription{};
  transient.step = 1e-3;
  transient.duration = 1.0;
  EXPECT_EQ(
      verdict({"swing", transient, {}}, assembled(chain)),
      "analysis \"swing\": initial = \"static\" finds the positions, and coordinate \"a\" is given one; remove it, "
      "or hold it by a [[displacement]]");
}

}  // namespace
}  // namespace rubato::analysis
