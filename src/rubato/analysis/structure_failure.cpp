#include <rubato/analysis/structure_failure.hpp>

#include <fmt/format.h>

namespace rubato::analysis {
namespace {

std::string contact_name(Index contact, const system::LocallyNonlinear& system) {
  if (contact < 0) return "";
  const Index stop = contact - system.slider_count(), law = contact - system.first_law();
  if (law >= 0) return system.laws()[static_cast<std::size_t>(law)].name;
  return stop < 0 ? system.sliders()[static_cast<std::size_t>(contact)].name
                  : system.stops()[static_cast<std::size_t>(stop)].name;
}

}  // namespace

std::string failure_of(const integrate::MarchReport& report, const TransientPlan& plan,
                       const system::LocallyNonlinear& system) {
  const auto coordinate = [&](Index i) {
    return i >= 0 ? fmt::format(" at coordinate \"{}\"", system.coordinates()[static_cast<std::size_t>(i)]) : "";
  };
  std::string what, remedy;
  switch (report.step.outcome) {
    case integrate::StepOutcome::not_finite:
      what = "a number that is not finite appeared" + coordinate(report.step.worst);
      remedy =
          "look at the loads at that time, and whether the response grew before it (a smaller step, or an "
          "unconditionally stable method)";
      break;
    case integrate::StepOutcome::not_converged:
      what = fmt::format("the {} found no consistent state (worst: \"{}\")",
                         system.law_count() > 0    ? "laws"
                         : system.stop_count() > 0 ? "sliders and stops"
                                                   : "sliders",
                         contact_name(report.step.worst, system));
      remedy = "take a smaller step";
      break;
    case integrate::StepOutcome::singular:
      what = "the effective matrix of the step cannot be factorised";
      remedy = "look for a negative stiffness or damping, or take a smaller step";
      break;
    case integrate::StepOutcome::overdetermined:  // of mechanisms only
      break;
    case integrate::StepOutcome::too_small:
      what = "the error asked for a step below the smallest";
      remedy = plan.automatic ? advice_on_smallest(plan.automatic->plan, plan.duration) : "take a smaller step";
      break;
    case integrate::StepOutcome::crawls:
      what = "the run crawled: the last 2,000 steps were shorter than 1e-8 of the run";
      remedy =
          "look for a contact far stiffer than the rest (a smaller stiffness) and for contacts that change without end "
          "(a damper beside them, a slope in place of a jump), take a larger tolerance, a shorter run, or a fixed step";
      break;
    case integrate::StepOutcome::no_way_on:
    case integrate::StepOutcome::accepted:
      break;
  }
  return fmt::format("at t = {:.9g} s with the step {:.6g} s {}; {}", report.failed_at, report.failed_step, what,
                     remedy);
}

}  // namespace rubato::analysis
