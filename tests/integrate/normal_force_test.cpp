#include <rubato/core/error.hpp>
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/integrate/law_energy.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/model/laws/jenkins.hpp>

#include "support/laws.hpp"
#include "support/models.hpp"
#include "support/pressed.hpp"
#include "support/random_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

// Sliders and stops as laws of the general route against their closed forms, and friction under normal forces that do
// not stay the same against motions that were found by other means.
namespace rubato::integrate {
namespace {

constexpr double mu = testing::rubbed_mu;

model::LawBetween as_law(const model::Slider& slider) {
  model::LawBetween law{slider.name, "slider", slider.first, slider.second, model::make_jenkins(slider.stiffness, mu)};
  law.normal.value = slider.limit / mu;
  return law;
}
model::LawBetween as_law(const model::Stop& stop) {
  return {stop.name, "stop", stop.first, stop.second, model::make_one_sided_spring(stop.stiffness, stop.gap)};
}

system::LocallyNonlinear::Parts parts_of(const system::LocallyNonlinear& system) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = system.mass();
  parts.damping = system.damping();
  parts.stiffness = system.stiffness();
  parts.loads = system.loads();
  parts.coordinates = system.coordinates();
  parts.sliders = system.sliders();
  return parts;
}

/// A random structure with sliders and undamped stops, in closed form or by laws in the same order of contacts.
system::LocallyNonlinear random_contacts(std::uint64_t seed, bool by_law) {
  const system::LocallyNonlinear drawn = testing::random_model(seed, {2, 12, 6});
  testing::RandomNumbers random(seed + 1000);
  system::LocallyNonlinear::Parts parts = parts_of(drawn);
  double largest = 0.0;
  for (const auto& slider : drawn.sliders()) largest = std::max(largest, slider.limit / slider.stiffness);
  for (Index i = 0, count = random.below(4); i < count; ++i) {
    const Index first = random.below(drawn.size());
    const auto& near = drawn.sliders().front();
    parts.stops.push_back({"stop" + std::to_string(i + 1), first, ground, largest * random.uniform(-0.1, 0.3),
                           near.stiffness * random.decades(0.3, 30.0), 0.0});
  }
  if (!by_law) return system::LocallyNonlinear(std::move(parts));
  for (const auto& slider : parts.sliders) parts.laws.push_back(as_law(slider));
  for (const auto& stop : parts.stops) parts.laws.push_back(as_law(stop));
  parts.sliders.clear();
  parts.stops.clear();
  return system::LocallyNonlinear(std::move(parts));
}

struct Histories final : Observer {
  bool accepted(const system::State&, const system::State& after) override {
    q.push_back(after.q);
    force.push_back(after.slider_force);
    return true;
  }
  std::vector<Vector> q, force;
};

/// The largest difference of two histories over the largest value of the same column, at most over all columns.
double difference(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  Vector largest = Vector::Zero(a.front().size()), apart = largest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = largest.cwiseMax(a[i].cwiseAbs());
    apart = apart.cwiseMax((a[i] - b[i]).cwiseAbs());
  }
  double worst = 0.0;
  for (Index i = 0; i < largest.size(); ++i)
    if (apart[i] > 0.0) worst = std::max(worst, apart[i] / largest[i]);
  return worst;
}

double step_of(const system::LocallyNonlinear& system) {
  double frequency = 0.0;
  for (const auto& term : system.loads().terms())
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law))
      frequency = std::max(frequency, harmonic->angular_frequency);
  return 2.0 * std::numbers::pi / frequency / 60.0;
}

struct States final : Observer {
  bool accepted(const system::State& before, const system::State& after) override {
    if (all.empty()) all.push_back(before);
    all.push_back(after);
    return true;
  }
  std::vector<system::State> all;
};

// Impacts magnify differences of round-off, so that with stops each step is compared by itself, from the same state.
TEST(ContactsAsLaws, MoveInEqualStepsAsTheirClosedForms) {
  int closed_once = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const auto closed = random_contacts(seed, false), by_law = random_contacts(seed, true);
    const double h = step_of(closed);
    for (const char* name : {"generalized_alpha", "exponential"}) {
      SCOPED_TRACE(name);
      States states;
      const auto stepper = make_stepper(make_method(name), closed);
      system::State state = consistent_start(closed, closed.start());
      ASSERT_EQ(march(*stepper, state, h, 150 * h, &states, nullptr).end, MarchEnd::reached);
      Histories expected, found;
      const auto of_laws = make_stepper(make_method(name), by_law);
      system::State to = by_law.start();
      for (std::size_t i = 1; i < states.all.size(); ++i) {
        system::State from = states.all[i - 1];
        from.memory = from.slider_force.head(closed.slider_count());
        if (closed.stop_count() == 0 && i > 1) from = to;
        const double t1 = states.all[i].t;
        ASSERT_EQ(of_laws->attempt(from, t1 - from.t, t1, to).outcome, StepOutcome::accepted) << i;
        expected.accepted(from, states.all[i]);
        found.accepted(from, to);
      }
      EXPECT_LT(difference(expected.q, found.q), 1e-9);
      EXPECT_LT(difference(expected.force, found.force), 1e-9);
      for (const Vector& force : expected.force) {
        if (force.size() == closed.slider_count() || !(force.tail(closed.stop_count()).maxCoeff() > 0.0)) continue;
        ++closed_once;
        break;
      }
    }
  }
  EXPECT_GT(closed_once, 10);
}

TEST(ContactsAsLaws, RestWhereTheirClosedFormsDo) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const auto closed = random_contacts(seed, false), by_law = random_contacts(seed, true);
    const StaticEquilibrium expected = find_equilibrium(closed, {}), found = find_equilibrium(by_law, {});
    ASSERT_EQ(expected.outcome, StaticOutcome::found);
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    const double size = expected.state.q.cwiseAbs().maxCoeff();
    EXPECT_LE((found.state.q - expected.state.q).cwiseAbs().maxCoeff(), 1e-10 * size);
  }
}

TEST(ContactsAsLaws, HaveTheModesOfBothLimits) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const auto closed = random_contacts(seed, false), by_law = random_contacts(seed, true);
    if (std::any_of(closed.stops().begin(), closed.stops().end(), [](const auto& stop) { return stop.gap < 0.0; }))
      continue;  // pressed where nothing has moved: modes have stops open, and laws as they are there
    const auto same = [](const SparseMatrix& a, const SparseMatrix& b) { return (a - b).norm() <= 1e-14 * a.norm(); };
    EXPECT_TRUE(same(closed.free_stiffness(), by_law.free_stiffness()));
    EXPECT_TRUE(same(closed.stuck_stiffness(), by_law.stuck_stiffness()));
    EXPECT_TRUE(same(closed.closed_stiffness(), by_law.closed_stiffness()));
    EXPECT_TRUE(by_law.has_friction());
    EXPECT_EQ(StructureKind(by_law).limit_count(), 2);
  }
}

TEST(ContactsAsLaws, MoveInAutomaticStepsAsTheirClosedForms) {
  const double tolerance = 1e-5;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const auto closed = random_contacts(seed, false), by_law = random_contacts(seed, true);
    std::vector<Vector> ends;
    double largest = 0.0;
    for (const auto* system : {&closed, &by_law}) {
      const Method method = make_method("generalized_alpha");
      const double end = 60.0 * step_of(*system);
      const auto stepper = make_stepper(method, *system);
      const auto estimator = make_estimator(LocalError{tolerance}, method, *system, *stepper, end, {});
      StepPlan plan;
      plan.largest = end / 20.0;
      Histories histories;
      system::State state = consistent_start(*system, system->start());
      const AdaptiveReport report = march(*stepper, *estimator, plan, *system, state, end, &histories, nullptr);
      ASSERT_EQ(report.march.end, MarchEnd::reached);
      ends.push_back(state.q);
      for (const Vector& q : histories.q) largest = std::max(largest, q.cwiseAbs().maxCoeff());
    }
    // Each is within a few tolerances of the solution.
    EXPECT_LT((ends[0] - ends[1]).cwiseAbs().maxCoeff(), 20.0 * tolerance * largest);
  }
}

/// Largest and smallest x of a march, and the work of its first law.
struct Extent final : Observer {
  explicit Extent(const system::LocallyNonlinear& of) : system(of) {}
  bool accepted(const system::State& before, const system::State& after) override {
    high = std::max(high, after.q[0]);
    low = std::min(low, after.q[0]);
    for (Index j = 0; j < system.law_count(); ++j)
      if (system.laws()[static_cast<std::size_t>(j)].law->takes_normal())
        work += dissipated_by_law(system, j, before, after);
    return true;
  }
  const system::LocallyNonlinear& system;
  double high = -HUGE_VAL, low = HUGE_VAL, work = 0.0;
};

// A mass slides to rest under N = 2 + 3 t by a stiff slider: v = v0 - mu (2 t + 1.5 t^2), and all of its energy is
// rubbed away, mu times the integral of N |v|.
TEST(NormalForces, OfTimeSlowASlidingMassDown) {
  const double v0 = 4.0, end = 1.0;
  const auto system = testing::rubbed_mass("2 + 3*t", 0.0, 0.0, 1e7, {}, v0);
  const double slowed = v0 - mu * (2.0 * end + 1.5 * end * end);
  for (const char* name : {"generalized_alpha", "average_acceleration", "exponential", "hht"}) {
    SCOPED_TRACE(name);
    const auto stepper = make_stepper(make_method(name), system);
    system::State state = consistent_start(system, system.start());
    Extent extent(system);
    const MarchReport report = march(*stepper, state, 1e-3, end, &extent, nullptr);
    ASSERT_EQ(report.end, MarchEnd::reached);
    EXPECT_NEAR(state.v[0], slowed, 2e-3);
    EXPECT_NEAR(extent.work, 0.5 * (v0 * v0 - state.v[0] * state.v[0]), 4e-3);
    EXPECT_NEAR(state.slider_force[0], mu * (2.0 + 3.0 * end), 1e-9);
  }
}

// x'' + .05 x' + x + T = cos(w t), kT = 1, mu = .5, N = max(0, 1 + N1 cos(w t + .8)), steady: by the exact piecewise
// linear flow. At N1 = 1.4 the contact opens for a quarter of the period.
TEST(NormalForces, OfTimeGiveAMassTheOrbitsOfTheExactFlow) {
  struct Case {
    double n1, w, half, mean, work;
  };
  for (const Case& one : {Case{0.6, 1.2, 2.57607723215, 0.165776059116, 3.98070295516},
                          Case{1.4, 1.1, 4.93916171184, 0.190314705882, 7.85518605667}}) {
    SCOPED_TRACE(one.w);
    char normal[80];
    std::snprintf(normal, sizeof normal, "1 + %.17g*cos(%.17g*t + 0.8)", one.n1, one.w);
    const auto system = testing::rubbed_mass(normal, 1.0, 0.05, 1.0, {testing::harmonic(0, 1.0, one.w)});
    const double period = 2.0 * std::numbers::pi / one.w;
    const auto stepper = make_stepper(make_method("average_acceleration"), system);
    system::State state = consistent_start(system, system.start());
    ASSERT_EQ(march(*stepper, state, period / 2000, 80 * period, nullptr, nullptr).end, MarchEnd::reached);
    Extent extent(system);
    march(*stepper, state, period / 2000, 81 * period, &extent, nullptr);
    EXPECT_NEAR(0.5 * (extent.high - extent.low), one.half, 2e-5 * one.half);
    EXPECT_NEAR(extent.work, one.work, 5e-5 * one.work);
  }
}

// From rest, w = 1.5, by the exact piecewise linear flow: the contact slips, opens and closes in each period.
TEST(NormalForces, OfAStopGiveTheTransientOfTheExactFlow) {
  struct At {
    double t, x, z, v_x, v_z;
  };
  const At table[] = {{2, 0.11695858069, 0.50322887692, -0.70554036835, -0.6326149258},
                      {5, 0.33930416409, 1.0868517489, 1.2816767399, -1.1480219463},
                      {10, 0.73944505064, -0.81201523249, 0.78103151874, -2.957631051},
                      {20, -0.8378802497, -4.2181442438, -0.69345501431, 1.5407873702},
                      {50, -1.2699636324, -1.0231479574, 0.2091093392, 2.9730336982}};
  const auto system = testing::coupled(1.5, false);
  std::vector<double> errors;
  for (const double h : {2e-3, 1e-3}) {
    const auto stepper = make_stepper(make_method("average_acceleration"), system);
    system::State state = consistent_start(system, system.start());
    Extent extent(system);
    double worst = 0.0;
    for (const At& at : table) {
      ASSERT_EQ(march(*stepper, state, h, at.t, &extent, nullptr).end, MarchEnd::reached);
      worst = std::max({worst, std::abs(state.q[0] - at.x), std::abs(state.q[1] - at.z), std::abs(state.v[0] - at.v_x),
                        std::abs(state.v[1] - at.v_z)});
    }
    errors.push_back(worst);
    EXPECT_NEAR(extent.work, 9.8447349027, 1e-3);
  }
  EXPECT_LT(errors[1], 3e-5);
  EXPECT_GT(errors[0] / errors[1], 2.5);  // of second order
}

// The order in which laws are written, and whether what presses is a stop or a law, do not matter.
TEST(NormalForces, OfALawAreThoseOfTheStopThatItIs) {
  std::vector<Histories> histories(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto system = testing::coupled(1.2, i > 0, i == 2);
    for (const char* name : {"generalized_alpha", "exponential", "rk4", "central_difference", "wilson_theta"}) {
      const auto stepper = make_stepper(make_method(name), system);
      system::State state = consistent_start(system, system.start());
      ASSERT_EQ(march(*stepper, state, 0.01, 30.0, &histories[i], nullptr).end, MarchEnd::reached) << name;
    }
  }
  for (std::size_t i = 1; i < 3; ++i) EXPECT_LT(difference(histories[0].q, histories[i].q), 1e-9) << i;
}

TEST(NormalForces, OfAStopAreMetByAutomaticSteps) {
  const auto system = testing::coupled(1.5, false);
  const double tolerance = 1e-6;
  const Method method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, system);
  const auto estimator = make_estimator(LocalError{tolerance}, method, system, *stepper, 20.0, {});
  StepPlan plan;
  plan.largest = 0.3;
  system::State state = consistent_start(system, system.start());
  const AdaptiveReport report = march(*stepper, *estimator, plan, system, state, 20.0, nullptr, nullptr);
  ASSERT_EQ(report.march.end, MarchEnd::reached);
  EXPECT_NEAR(state.q[0], -0.8378802497, 4.2 * 20.0 * tolerance);
  EXPECT_NEAR(state.q[1], -4.2181442438, 4.2 * 20.0 * tolerance);
}

/// Two blades and a wedge damper: x1, x2, xd, yd; contact planes inclined by 35 degrees, pressed by a load of 6.
system::LocallyNonlinear wedge(double friction) {
  const double b = 35.0 * std::numbers::pi / 180.0, c = std::cos(b), s = std::sin(b);
  Vector mass(4), stiffness(4), damping(4);
  mass << 1, 1, 0.05, 0.05;
  stiffness << 60, 66, 0, 0;
  damping << 0.08, 0.08, 0.05, 0.05;
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(mass.asDiagonal().toDenseMatrix());
  parts.stiffness = testing::sparse(stiffness.asDiagonal().toDenseMatrix());
  parts.damping = testing::sparse(damping.asDiagonal().toDenseMatrix());
  parts.loads = system::Loads({testing::harmonic(3, 6.0, 0.0)});
  parts.coordinates = {"x1", "x2", "xd", "yd"};
  const auto law = [&](std::string name, std::shared_ptr<const model::Law> of, std::vector<model::Share> shares) {
    return model::LawBetween{std::move(name), "law", ground, ground, std::move(of), std::move(shares)};
  };
  const auto normal = model::make_one_sided_spring(45.0, 0.0), rubs = model::make_jenkins(30.0, friction);
  parts.laws = {law("t1", rubs, {{2, c}, {0, -c}, {3, s}}), law("n1", normal, {{2, -s}, {0, s}, {3, c}}),
                law("t2", rubs, {{2, c}, {1, -c}, {3, -s}}), law("n2", normal, {{2, s}, {1, -s}, {3, c}})};
  parts.laws[0].normal.law = 1;
  parts.laws[2].normal.law = 3;
  return system::LocallyNonlinear(std::move(parts));
}

// Both contacts slip under the load that grows from zero; without friction they press by a quarter more.
TEST(NormalForces, OfLawsHoldAWedgeWhereItSlipped) {
  const double with[] = {-0.014063739232, 0.012785217483, -0.00063926087416, 0.08919663591};
  const double without[] = {-0.03501037691, 0.031827615373, -0.0015913807687, 0.12275293946};
  for (const double friction : {0.35, 0.0}) {
    const StaticEquilibrium found = find_equilibrium(wedge(friction), {});
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    for (Index i = 0; i < 4; ++i) EXPECT_NEAR(found.state.q[i], (friction > 0.0 ? with : without)[i], 2e-11);
    EXPECT_NEAR(found.state.slider_force[1], friction > 0.0 ? 2.9414538987 : 3.6623237663, 1e-9);
    EXPECT_NEAR(found.state.slider_force[0], friction * found.state.slider_force[1], 1e-12);
  }
}

TEST(NormalForces, ThatPressOnEachOtherAreRefused) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.damping = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.coordinates = {"mass"};
  parts.laws = {{"one", "slider", 0, ground, model::make_jenkins(1.0, mu)},
                {"two", "slider", 0, ground, model::make_jenkins(1.0, mu)}};
  parts.laws[0].normal.law = 1;
  parts.laws[1].normal.law = 0;
  EXPECT_THROW(system::LocallyNonlinear{std::move(parts)}, InvalidInput);
}

}  // namespace
}  // namespace rubato::integrate
