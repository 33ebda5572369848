#include <rubato/analysis/mechanism_failure.hpp>
#include <rubato/analysis/mechanism_march.hpp>
#include <rubato/integrate/mechanism/mechanism_space.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/integrate/mechanism/mechanism_stepper.hpp>

#include <fmt/format.h>

#include <variant>

namespace rubato::analysis {
namespace {

constexpr double resolution = 1e-12;      // of events, over the duration
constexpr double least_tolerance = 1e-9;  // below, steps measure what Newton's method leaves: see the known issues

}  // namespace

MechanismMarch::MechanismMarch(const MechanismPlan& plan, const system::Mechanism& mechanism)
    : plan_(plan),
      mechanism_(mechanism),
      timeline_(mechanism, resolution * plan.transient.duration),
      state_(plan.transient.start) {
  const TransientPlan& transient = plan.transient;
  const AutomaticStep& step = *transient.automatic;
  integrate::NewtonPlan newton;
  const bool is_per_time = !std::holds_alternative<integrate::InertiaJump>(step.estimator);
  newton.projects_velocities = plan.project_velocities || (is_per_time && !has_equal_steps()) ||
                               std::holds_alternative<integrate::PiControl>(step.plan.controller);
  newton.avoids_singular_ends = !has_equal_steps();
  stepper_ = integrate::make_mechanism_stepper(transient.method, mechanism, newton, plan.allow_unstable);
  estimator_ = integrate::make_estimator(
      step.estimator, std::get<integrate::GeneralizedAlpha>(transient.method.formula),
      integrate::make_error_space(mechanism, transient.start, step.tolerance), transient.start, transient.duration);
  if (!has_equal_steps()) return;  // with steps that change it is carried over by the march
  system::MechanismEquations equations(mechanism);
  integrate::shift_acceleration(equations, state_, stepper_->shift() * step.plan.first);
}

bool MechanismMarch::has_equal_steps() const {
  return std::holds_alternative<integrate::FixedStep>(plan_.transient.automatic->plan.controller);
}

integrate::AdaptiveReport MechanismMarch::go_to(double end, integrate::Observer* observer, integrate::TryLog* log) {
  return integrate::march(*stepper_, *estimator_, plan_.transient.automatic->plan, timeline_, state_, end, observer,
                          log);
}

std::string MechanismMarch::failure(const integrate::AdaptiveReport& report) const {
  const AutomaticStep& step = *plan_.transient.automatic;
  const std::string advice =
      !has_equal_steps() && step.tolerance < least_tolerance
          ? fmt::format(
                "the tolerance {:.3g} is below {:.3g}, where the error of a step is what Newton's method leaves: "
                "take a larger one",
                step.tolerance, least_tolerance)
          : advice_on_smallest(step.plan, plan_.transient.duration);
  return failure_of(report.march, mechanism_, state_, {timeline_.chattering(), timeline_.events()}, advice);
}

}  // namespace rubato::analysis
