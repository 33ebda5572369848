#include "work_problems.hpp"

#include <rubato/core/error.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include "support/models.hpp"

#include <numbers>
#include <utility>

namespace rubato::benchmarks {
namespace {

using Kind = WorkProblem::Kind;

system::LocallyNonlinear assembled(const model::StudyDescription& study, const numerics::Parameters& settings = {}) {
  return system::assemble(model::build(study.model, model::evaluate_parameters(study.parameters, settings)));
}

WorkProblem from_rest(std::string name, Kind kind, bool is_linear, system::LocallyNonlinear system, double duration) {
  system::State start = integrate::consistent_start(system, system.start());
  return {std::move(name), kind, is_linear, std::move(system), std::move(start), duration};
}

WorkProblem from_equilibrium(std::string name, Kind kind, bool is_linear, system::LocallyNonlinear system,
                             std::size_t held, double duration) {
  const auto& all = system.held_displacements();
  const auto equilibrium = integrate::find_equilibrium(system, {all.data(), std::min(held, all.size())});
  if (equilibrium.outcome != integrate::StaticOutcome::found) throw InvalidInput(name + ": no static start");
  system::State start = integrate::consistent_start(system, equilibrium.state);
  return {std::move(name), kind, is_linear, std::move(system), std::move(start), duration};
}

/// Five storeys hit by a pressure that rises at once and is gone after 20 ms, 5 s after the start.
model::StudyDescription blasted(model::StudyDescription building) {
  building.model.base_motion.reset();
  model::TableDescription pulse;
  pulse.file = "blast";
  pulse.times = {0.0, 5.0, 5.0, 5.02, 30.0};
  pulse.values = {0.0, 0.0, 300e3, 0.0, 0.0};  // [N] on each floor
  for (const char* on : {"L1.x", "L2.x", "L3.x", "L4.x", "L5.x"}) building.model.forces.push_back({on, pulse, {}});
  return building;
}

/// A chain of 50 masses with stiffness-proportional and mass-proportional damping, two of them released.
WorkProblem damped_chain() {
  constexpr Index n = 50;
  system::LocallyNonlinear::Parts parts;
  parts.stiffness = rubato::testing::chain(n, 0).stiffness();
  parts.mass = rubato::testing::chain(n, 0).mass();
  parts.damping = 0.01 * parts.mass + 0.02 * parts.stiffness;
  parts.coordinates = rubato::testing::chain(n, 0).coordinates();
  parts.start.q = Vector::Zero(n);
  parts.start.v = Vector::Zero(n);
  parts.start.q[n / 3] = 1.0;
  parts.start.v[n / 2] = 0.5;
  return from_rest("damped chain", Kind::smooth, true, system::LocallyNonlinear(std::move(parts)), 60.0);
}

}  // namespace

std::vector<WorkProblem> work_problems(const std::filesystem::path& examples) {
  const auto study = [&](const char* name) { return io::read_study(examples / name / "study.toml"); };
  std::vector<WorkProblem> all;
  all.push_back(from_rest("oscillator", Kind::smooth, true, assembled(study("oscillator-tolerance")),
                          40.0 * std::numbers::pi / std::sqrt(1000.0)));
  const model::StudyDescription frame = study("frame"), building = study("building");
  all.push_back(from_equilibrium("frame PMB", Kind::smooth, true, assembled(frame), 1, 0.12));
  all.push_back(from_equilibrium("frame PMM", Kind::smooth, true, assembled(frame), 2, 0.12));
  all.push_back(damped_chain());
  all.push_back(from_equilibrium("building without dampers", Kind::smooth, true,
                                 assembled(building, {{"slip_force", 0.0}}), 0, 20.0));
  all.push_back(from_rest("mass with slider", Kind::friction, false, assembled(study("single-mass-slider")), 50.0));
  all.push_back(
      from_rest("under-platform damper", Kind::friction, false, assembled(study("underplatform-damper")), 60.0));
  all.push_back(from_equilibrium("building", Kind::friction, false, assembled(building), 0, 20.0));
  all.push_back(from_rest("frame with a late stop", Kind::rare_event, false, assembled(study("late-stop")), 2.0));
  all.push_back(
      from_equilibrium("building under a blast", Kind::rare_event, false, assembled(blasted(building)), 0, 30.0));
  return all;
}

}  // namespace rubato::benchmarks
