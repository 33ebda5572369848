#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rubato {
namespace {

using namespace integrate;

/// The simple pendulum of the IFToMM library of computational benchmark problems (Gonzalez, Dopico, Lugris and Cuadrado
/// 2006): a point of 1 kg on a rod of 1 m, level and at rest, 10 s.
model::Mechanism simple_pendulum() {
  model::Mechanism m(2);
  const Index mass = m.add_node("mass", {-1.0, 0.0, 0.0}, {true, true, false});
  m.add_mass(mass, 1.0);
  m.joints.push_back(
      model::make_plane_distance("rod", m.plane_point(0, 0.0, 0.0), m.plane_point(mass, -1.0, 0.0), 1.0));
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

struct Worst final : Observer {
  double energy = 0.0, length = 0.0;
  bool accepted(const system::State&, const system::State& after) override {
    energy = std::max(energy, std::abs(0.5 * after.v.squaredNorm() + 9.81 * after.q[4]));
    length = std::max(length, std::abs(std::hypot(after.q[3], after.q[4]) - 1.0));
    return true;
  }
};

Worst swung(double h) {
  const system::Mechanism mechanism(simple_pendulum());
  const auto stepper = make_stepper(make_method("generalized_alpha", {{"rho_inf", 0.9}}), mechanism);
  system::MechanismEquations equations(mechanism);
  system::State state = make_consistent(equations, mechanism.start()).state;
  shift_acceleration(equations, state, stepper->shift() * h);
  Worst worst;
  EXPECT_EQ(march(*stepper, state, h, 10.0, &worst).end, MarchEnd::reached);
  return worst;
}

TEST(SimplePendulum, KeepsItsEnergyWithSecondOrderAndItsLengthToNewtonsTolerance) {
  const Worst coarse = swung(2e-3), fine = swung(1e-3);
  EXPECT_GT(coarse.energy / fine.energy, 3.5);
  // (omega h)^2 of m g l, with a rate of turn of 4.4/s at the bottom.
  EXPECT_LT(fine.energy, 4.4 * 4.4 * 1e-6 * 9.81);
  EXPECT_LT(fine.length, 1e-10);
}

}  // namespace
}  // namespace rubato
