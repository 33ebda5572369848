#include <rubato/integrate/structure_failure.hpp>

namespace rubato::integrate {
namespace {

const std::string& contact_name(Index contact, const system::LocallyNonlinear& system) {
  const Index stop = contact - system.slider_count(), law = contact - system.first_law();
  if (contact >= system.first_block()) return system.blocks()[static_cast<std::size_t>(system.block_at(contact))].name;
  if (law >= 0) return system.laws()[static_cast<std::size_t>(law)].name;
  return stop < 0 ? system.sliders()[static_cast<std::size_t>(contact)].name
                  : system.stops()[static_cast<std::size_t>(stop)].name;
}

}  // namespace

MarchFailure failure_of(const MarchReport& report, const system::LocallyNonlinear& system) {
  MarchFailure failure;
  failure.outcome = report.step.outcome;
  failure.t = report.failed_at;
  failure.step = report.failed_step;
  failure.contacts = system.has_laws() ? "laws" : system.stop_count() > 0 ? "sliders and stops" : "sliders";
  const Index worst = report.step.worst;
  if (worst >= 0)
    failure.worst = failure.outcome == StepOutcome::not_converged
                        ? contact_name(worst, system)
                        : system.coordinates()[static_cast<std::size_t>(worst)];
  return failure;
}

}  // namespace rubato::integrate
