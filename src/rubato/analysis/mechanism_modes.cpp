#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/failure_text.hpp>
#include <rubato/analysis/mechanism_modes.hpp>
#include <rubato/analysis/mechanism_tables.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/mechanism/mechanism_modes.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace rubato::analysis {
namespace {

constexpr Index default_count = 20, largest = 3000;

constexpr double slow = 1e-6;  // [rad/s] or [m/s]: what moves no faster stands

double largest_speed(const system::State& state, Index& place) {
  return state.v.size() > 0 ? state.v.cwiseAbs().maxCoeff(&place) : 0.0;
}

/// The configuration given, held still; that its loads would move it is told.
system::State at_rest(const system::State& start, const system::Mechanism& mechanism,
                      std::vector<std::string>& warnings) {
  system::State state = start;
  Index fastest = 0;
  system::MechanismEquations equations(mechanism);
  if (!integrate::find_acceleration_at_rest(equations, state, model::Side::right)) return start;
  Vector force(mechanism.size()), gap(mechanism.constraint_count()), product(mechanism.size());
  equations.go_to(state, model::Side::right);
  equations.residual(force, gap);
  mechanism.times_mass(state.acceleration, product);
  constexpr double share = 1e-6, round_off = 1e-9;
  Index place = 0;
  const double most = state.acceleration.size() > 0 ? state.acceleration.cwiseAbs().maxCoeff(&place) : 0.0;
  if (product.norm() > share * force.norm() && most > round_off)
    warnings.push_back(
        fmt::format("the configuration is no equilibrium: \"{}\" accelerates by {:.4g} {}{}",
                    mechanism.coordinates()[static_cast<std::size_t>(place)], most,
                    mechanism.model().is_rotation[static_cast<std::size_t>(place)] != 0 ? "rad/s2" : "m/s2",
                    largest_speed(start, fastest) > slow ? "" : "; about = \"static\" finds one"));
  return state;
}

/// What is held still where it moves has other modes than it has in motion.
void warn_of_motion(const system::State& state, const system::Mechanism& mechanism,
                    std::vector<std::string>& warnings) {
  Index place = 0;
  const double most = largest_speed(state, place);
  if (!(most > slow)) return;
  warnings.push_back(
      fmt::format("it moves there, \"{}\" by {:.4g} {}, and is held still: what its speed adds, centrifugal and "
                  "Coriolis forces, is "
                  "left out of these modes (what it stretches is in)",
                  mechanism.coordinates()[static_cast<std::size_t>(place)], most,
                  mechanism.model().is_rotation[static_cast<std::size_t>(place)] != 0 ? "rad/s" : "m/s"));
}

MechanismModesPlan::Reached reached_by(const std::string& title, const model::ReachedDescription& description,
                                       const system::Mechanism& mechanism, const StudyInput& input) {
  std::vector<std::string> known;
  for (const model::AnalysisDescription& analysis : input.study.analyses) {
    const auto* transient = std::get_if<model::TransientDescription>(&analysis.task);
    if (!transient) continue;
    known.push_back(analysis.name);
    if (analysis.name != description.analysis) continue;
    MechanismModesPlan::Reached reached;
    reached.motion =
        plan_transient(analysis.name, analysis.where, *transient, MechanismTransient(mechanism), input.parameters);
    reached.analysis = analysis.name;
    reached.settles = description.settles;
    const double duration = reached.motion.duration;
    reached.time =
        description.time ? model::evaluate(*description.time, input.parameters, title + "about: time") : duration;
    if (!(reached.time >= 0.0 && reached.time <= duration))
      throw InvalidInput(description.time->where,
                         fmt::format("{}about: time must lie within the {} s of \"{}\", got {}", title, duration,
                                     analysis.name, reached.time));
    return reached;
  }
  throw InvalidInput(description.analysis_where,
                     fmt::format("{}about names \"{}\", which is no transient of this study{}", title,
                                 description.analysis, suggestion(description.analysis, known)));
}

/// Drives take no part in modes, as if they were locked; empty: there are none.
std::string held_drives(const model::Mechanism& model) {
  std::vector<std::string> names;
  for (const auto& drive : model.drives) names.push_back("\"" + drive.name + "\"");
  if (names.empty()) return {};
  return fmt::format("the drive{} of {} {} held still: these are the modes of what is left",
                     names.size() == 1 ? "" : "s", fmt::join(names, ", "), names.size() == 1 ? "is" : "are");
}

class Listener final : public integrate::Observer {
 public:
  explicit Listener(RunContext& context) : context_(context) {}
  bool accepted(const system::State&, const system::State& after) override {
    if (++steps_ % 64 == 0) context_.progress.advance(after.t);
    return !context_.stop.load(std::memory_order_relaxed);
  }

 private:
  RunContext& context_;
  long steps_ = 0;
};

/// Marches to the configuration that is asked for, and holds it still. What went wrong stands in the report.
system::State reach(const std::string& name, const MechanismModesPlan::Reached& reached,
                    const system::Mechanism& mechanism, RunContext& context, RunReport& report) {
  const auto march = MechanismTransient(mechanism).march(reached.motion);
  Listener listener(context);
  context.progress.begin(name, reached.time, "s of motion");
  const integrate::AdaptiveReport marched = march->go_to(reached.time, &listener, nullptr);
  context.progress.advance(march->state().t);
  context.progress.end();
  if (marched.march.end == integrate::MarchEnd::failed) {
    report.status = RunStatus::failed;
    const integrate::MarchFailure failure = march->failure(marched.march);
    report.message = text_of(failure, advice_on_step(failure, reached.motion));
  } else if (march->state().t < reached.time) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted at t = {} s of {} s", march->state().t, reached.time);
  }
  if (!report.message.empty()) return march->state();
  if (!reached.settles) {
    system::State held = march->state();
    std::fill(held.rubbing.begin(), held.rubbing.end(), model::friction_free);
    warn_of_motion(held, mechanism, report.warnings);
    return at_rest(held, mechanism, report.warnings);
  }
  const StopScope scope(context.stop);
  const integrate::Equilibrium found = integrate::MechanismKind(mechanism).find_equilibrium(march->state(), {});
  report.message = complaint(found);
  if (!report.message.empty()) report.status = RunStatus::failed;
  return found.state;
}

}  // namespace

MechanismModesPlan plan_mechanism_modes(const std::string& name, const Location& where,
                                        const model::ModesDescription& description, const system::Mechanism& mechanism,
                                        const StudyInput& input) {
  const numerics::Parameters& parameters = input.parameters;
  const std::string title = "analysis \"" + name + "\": ";
  if (mechanism.size() > largest)
    throw InvalidInput(where, fmt::format("{}modes of a mechanism are found for up to {} coordinates, and it has {}; "
                                          "divide its beams into fewer elements",
                                          title, largest, mechanism.size()));
  MechanismModesPlan plan;
  if (description.count) {
    const Location& place = description.count->where.line > 0 ? description.count->where : where;
    const double count = model::evaluate(*description.count, parameters, title + "count");
    if (!(count >= 1.0) || count != std::floor(count) || !(count <= static_cast<double>(largest)))
      throw InvalidInput(place,
                         fmt::format("{}count must be a whole number from 1 to {}, got {}", title, largest, count));
    plan.modes.count = static_cast<Index>(count);
  }
  plan.modes.observed = observed_or_all(description.observe, {mechanism});
  if (description.about_reached) {
    plan.reached = reached_by(title, *description.about_reached, mechanism, input);
    plan.warnings = plan.reached->motion.warnings;
    return plan;
  }
  plan.state = integrate::assembled_start(where, mechanism, plan.warnings, false);
  if (!description.about_equilibrium) {
    plan.state = at_rest(plan.state, mechanism, plan.warnings);
    return plan;
  }
  plan.about_equilibrium = true;
  integrate::Equilibrium found = integrate::MechanismKind(mechanism).find_equilibrium(plan.state, {});
  plan.failure = complaint(found);
  plan.state = std::move(found.state);
  return plan;
}

RunReport run_mechanism_modes(const std::string& name, const MechanismModesPlan& plan,
                              const system::Mechanism& mechanism, RunContext& context) {
  RunReport report;
  report.warnings = plan.warnings;
  report.message = plan.failure;
  if (plan.reached && !plan.reached->motion.failure.empty())
    report.message = fmt::format("\"{}\" leads nowhere: {}", plan.reached->analysis, plan.reached->motion.failure);
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
    return report;
  }
  const system::State state = plan.reached ? reach(name, *plan.reached, mechanism, context, report) : plan.state;
  if (!report.message.empty()) return report;
  const StopScope scope(context.stop);
  system::MechanismEquations equations(mechanism);
  const Index count = plan.modes.count > 0 ? plan.modes.count : default_count;
  const integrate::MechanismModes modes = integrate::modes_about(equations, state, count);
  if (plan.reached)
    report.findings.push_back(fmt::format("about {}where \"{}\" is at t = {} s",
                                          plan.reached->settles ? "the equilibrium next to " : "",
                                          plan.reached->analysis, plan.reached->time));
  const std::string drives = held_drives(mechanism.model());
  if (!drives.empty()) report.findings.push_back(drives);
  report.statistics = {{"freedoms", std::to_string(modes.freedoms)},
                       {"residual_free", fmt::format("{:.1e}", modes.found.residual)}};
  if (modes.leaves_out_skew)
    report.warnings.push_back(fmt::format(
        "the stiffness is not symmetric, by {:.2g} of its size: loads that follow their body have no potential "
        "(nor has a configuration that is no equilibrium); with more than 400 freedoms these modes leave that part "
        "out, and tell nothing of flutter, which a transient does",
        modes.skew));
  write_modes(name, plan.modes.observed, {{0, modes.found}}, context.sink);
  write_configuration(name, mechanism.model(), std::span(state.q.data(), static_cast<std::size_t>(state.q.size())),
                      context.sink);
  if (modes.is_stable) tell_round_off("", modes.found, report);
  if (modes.freedoms == 0)
    report.findings.push_back("there are no modes: the joints and locks leave no motion");
  else if (!modes.is_stable)
    report.message = fmt::format(
        "the {0} is not stable: a motion that the joints leave {3}, as exp({1:.4g}/s t); {2}",
        plan.about_equilibrium ? "equilibrium" : "configuration", modes.growth,
        plan.about_equilibrium ? "begin beside it to be led to one that is" : "about = \"static\" leads to one that is",
        modes.flutters ? "flutters, which loads without a potential make" : "goes away from it");
  else if (!modes.found.has_converged)
    report.message = "the modes were not found to more than a few digits: " + cause_of_poor_modes(modes.found);
  else if (plan.modes.count > modes.freedoms)
    report.message =
        fmt::format("{} modes were asked for, and the joints leave {} motions", plan.modes.count, modes.freedoms);
  if (!report.message.empty()) report.status = RunStatus::failed;
  return report;
}

}  // namespace rubato::analysis
