#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <support/random_model.hpp>
#include <support/structure_by_newton.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

// One structure through both steppers: the one that condenses to the contacts, and Newton's method on all coordinates.
namespace rubato::integrate {
namespace {

Method random_method(testing::RandomNumbers& random) {
  switch (random.below(6)) {
    case 0:
      return make_method("hht", {{"alpha", -random.uniform(0.0, 0.3)}});
    case 1:
      return make_method("wbz", {{"rho_inf", random.uniform()}});
    case 2:
      return make_method("average_acceleration");
    case 3:
      return make_method("damped_newmark");
    case 4:
      return make_method("backward_difference");
    default:
      return make_method("generalized_alpha", {{"rho_inf", random.uniform()}});
  }
}

/// The same with one-sided stops, some of them damped, at gaps of the size of its motion.
system::LocallyNonlinear with_stops(const system::LocallyNonlinear& model, double size, double spring,
                                    testing::RandomNumbers& random) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = model.mass();
  parts.damping = model.damping();
  parts.stiffness = model.stiffness();
  parts.sliders = model.sliders();
  parts.loads = model.loads();
  parts.coordinates = model.coordinates();
  for (Index i = 0, count = 1 + random.below(3); i < count; ++i) {
    const Index first = random.below(model.size()), second = random.chance(0.5) ? ground : random.below(model.size());
    parts.stops.push_back(
        {"stop" + std::to_string(i), first, first == second ? ground : second, size * random.uniform(-0.2, 0.8),
         spring * random.decades(1.0, 100.0),
         random.chance(0.5) ? 0.0 : random.uniform(0.0, 2.0) * std::sqrt(spring * model.mass().diagonal().mean())});
  }
  return system::LocallyNonlinear(std::move(parts));
}

struct Motion final : Observer {
  std::vector<Vector> q, contact_force;
  bool accepted(const system::State&, const system::State& after) override {
    q.push_back(after.q);
    contact_force.push_back(after.slider_force);
    return true;
  }
  double size() const {
    double largest = 0.0;
    for (const Vector& x : q) largest = std::max(largest, x.cwiseAbs().maxCoeff());
    return largest;
  }
};

Motion condensed(const system::LocallyNonlinear& model, const Method& method, double h, int steps) {
  const auto stepper = make_stepper(method, model);
  system::State state = consistent_start(model, model.start());
  Motion motion;
  EXPECT_EQ(march(*stepper, state, h, h * steps, &motion).end, MarchEnd::reached);
  return motion;
}

/// By Newton's method; false where it does not converge.
bool march_by_newton(const system::LocallyNonlinear& model, const Method& method, double h, int steps, double size,
                     Motion& motion) {
  const testing::StructureByNewton whole(model);
  NewtonPlan plan;
  plan.tolerance = 1e-14;  // velocities err by that over the step, and carry it through the march
  plan.reference = size * std::sqrt(model.mass().diagonal().sum());
  plan.most_iterations = 100;
  const auto stepper = make_stepper(method, whole, plan);
  const auto equations = whole.equations();
  system::State state = whole.start();
  EXPECT_TRUE(find_acceleration(*equations, state, model::Side::right));
  return march(*stepper, state, h, h * steps, &motion).end == MarchEnd::reached;
}

double stiffest_contact(const system::LocallyNonlinear& model) {
  double stiffest = 0.0;
  for (const auto& slider : model.sliders()) stiffest = std::max(stiffest, slider.stiffness);
  for (const auto& stop : model.stops()) stiffest = std::max(stiffest, stop.stiffness);
  for (const auto& law : model.laws()) stiffest = std::max(stiffest, law.law->largest_stiffness());
  return stiffest;
}

/// Marches both and compares displacements, and contact forces by what the error of a displacement makes of them.
/// Newton's method may run in a circle across kinks where steps are long: then they are halved, for both.
void expect_the_same(const system::LocallyNonlinear& model, const Method& method, double h, int steps) {
  constexpr double same = 1e-9;
  for (int halving = 0; halving <= 4; ++halving, h *= 0.5) {
    const Motion one = condensed(model, method, h, steps);
    const double size = one.size();
    Motion other;
    if (!march_by_newton(model, method, h, steps, size, other)) continue;
    ASSERT_EQ(one.q.size(), other.q.size());
    // Newton's tolerance is a share of this size in the mass norm: the lightest coordinate may err by more of it.
    const double whole = size * std::sqrt(model.mass().diagonal().sum());
    const double of_lightest = whole / std::sqrt(model.mass().diagonal().minCoeff());
    for (std::size_t k = 0; k < one.q.size(); ++k) {
      const Vector apart = one.q[k] - other.q[k];
      ASSERT_LE(std::sqrt(apart.dot(model.mass() * apart)), same * whole) << "step " << k;
      if (model.contact_count() == 0) continue;
      ASSERT_LE((one.contact_force[k] - other.contact_force[k]).cwiseAbs().maxCoeff(),
                2.0 * same * stiffest_contact(model) * of_lightest)
          << "step " << k;
    }
    return;
  }
  FAIL() << "Newton's method does not converge in steps of " << h << " s";
}

TEST(TwoSteppers, AgreeOnFiftyStructuresWithSlidersAndStops) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    testing::RandomNumbers random(1000 + seed);
    const auto model = testing::random_model(seed);
    const Method method = random_method(random);
    const double spring = model.stiffness().diagonal().mean();
    const double h = random.decades(0.02, 0.5) * std::sqrt(model.mass().diagonal().mean() / spring);
    const double size = condensed(model, method, h, 200).size();
    expect_the_same(with_stops(model, size, spring, random), method, h, 200);
  }
}

// Those with steps in time, of up to 200 coordinates, each by its loads from its start.
TEST(TwoSteppers, AgreeOnTheStructuresAmongTheExamples) {
  int marched = 0;
  for (const auto& folder : std::filesystem::directory_iterator(RUBATO_EXAMPLES)) {
    SCOPED_TRACE(folder.path().filename().string());
    const auto study = io::read_study(folder.path() / "study.toml");
    if (model::is_mechanism(study.model)) continue;
    const auto parameters = model::evaluate_parameters(study.parameters);
    const auto structure = system::assemble(model::build(study.model, parameters, model::NegativeLoad::zero));
    if (structure.size() > 200 || structure.block_count() > 0) continue;  // the judge knows laws of one number
    const double h =
        0.5 * std::sqrt(structure.mass().diagonal().mean() / structure.stuck_stiffness().diagonal().mean());
    expect_the_same(structure, make_method("generalized_alpha", {{"rho_inf", 0.8}}), h, 300);
    ++marched;
  }
  EXPECT_GE(marched, 10);
}

}  // namespace
}  // namespace rubato::integrate
