#include <rubato/core/error.hpp>
#include <rubato/integrate/methods/steppers.hpp>
#include <rubato/integrate/stepper.hpp>

namespace rubato::integrate {

std::unique_ptr<Stepper> make_stepper(const Method& method, const system::LocallyNonlinear& system) {
  struct Visitor {
    const system::LocallyNonlinear& system;
    std::unique_ptr<Stepper> operator()(const RungeKutta& m) const { return make_runge_kutta_stepper(m, system); }
    std::unique_ptr<Stepper> operator()(const GeneralizedAlpha& m) const { return make_alpha_stepper(m, system); }
    std::unique_ptr<Stepper> operator()(const WilsonTheta& m) const { return make_wilson_stepper(m, system); }
    std::unique_ptr<Stepper> operator()(const Exponential&) const { return make_exponential_stepper(system); }
    std::unique_ptr<Stepper> operator()(const Exact&) const {
      throw InvalidInput("the method exact takes no step; it runs through the event-driven flow");
    }
  };
  return std::visit(Visitor{system}, method.formula);
}

system::State consistent_start(const system::LocallyNonlinear& system, system::State given) {
  system::EquilibriumAcceleration acceleration(system);
  system.set_stop_forces(given);
  if (given.memory.size() == 0) given.memory = Vector::Zero(system.memory_size());
  system.set_law_forces(given, model::Side::right);
  given.auxiliary_acceleration.resize(system.size());
  acceleration(given, given.auxiliary_acceleration);
  return given;
}

}  // namespace rubato::integrate
