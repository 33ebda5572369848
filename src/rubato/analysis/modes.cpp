#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/failure_text.hpp>
#include <rubato/analysis/modes.hpp>
#include <rubato/analysis/modes_table.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/results/drawing/kind_drawing.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

/// What moves is held still, and has other modes than it has in motion.
void warn_of_motion(const system::State& state, const system::System& system, std::vector<std::string>& warnings) {
  Index place = 0;
  const double most = state.v.size() > 0 ? state.v.cwiseAbs().maxCoeff(&place) : 0.0;
  if (!(most > integrate::standstill)) return;
  warnings.push_back(fmt::format(
      "it moves there, \"{}\" by {:.4g} {}, and is held still: what its speed adds, centrifugal and "
      "Coriolis forces, is left out of these modes (what it stretches is in)",
      system.coordinates()[static_cast<std::size_t>(place)], most, system.is_rotation(place) ? "rad/s" : "m/s"));
}

ModesPlan::Reached reached_by(const integrate::ModesRequest& request, StudyTransients* transients) {
  static const std::vector<model::AnalysisDescription> none;
  const model::ReachedDescription& description = *request.description.about_reached;
  std::vector<std::string> known;
  for (const model::AnalysisDescription& analysis : transients ? transients->analyses() : none) {
    if (!std::holds_alternative<model::TransientDescription>(analysis.task)) continue;
    known.push_back(analysis.name);
    if (analysis.name != description.analysis) continue;
    ModesPlan::Reached reached;
    reached.motion = transients->plan(analysis);
    reached.analysis = analysis.name;
    reached.settles = description.settles;
    const double duration = reached.motion->march.duration;
    reached.time = description.time
                       ? model::evaluate(*description.time, request.parameters, request.title + "about: time")
                       : duration;
    if (!(reached.time >= 0.0 && reached.time <= duration))
      throw InvalidInput(description.time->where,
                         fmt::format("{}about: time must lie within the {} s of \"{}\", got {}", request.title,
                                     duration, analysis.name, reached.time));
    return reached;
  }
  throw InvalidInput(description.analysis_where,
                     fmt::format("{}about names \"{}\", which is no transient of this study{}", request.title,
                                 description.analysis, suggestion(description.analysis, known)));
}

/// Drives take no part in modes, as if they were locked; empty: there are none.
std::string held_drives(const std::vector<std::string>& drives) {
  if (drives.empty()) return {};
  return fmt::format("the drive{} of \"{}\" {} held still: these are the modes of what is left",
                     drives.size() == 1 ? "" : "s", fmt::join(drives, "\", \""), drives.size() == 1 ? "is" : "are");
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
system::State reach(const std::string& name, const ModesPlan::Reached& reached, const integrate::SystemKind& kind,
                    RunContext& context, RunReport& report) {
  const auto march = kind.marches().march(reached.motion->march);
  Listener listener(context);
  context.progress.begin(name, reached.time, "s of motion");
  const integrate::AdaptiveReport marched = march->go_to(reached.time, &listener, nullptr);
  context.progress.advance(march->state().t);
  context.progress.end();
  if (marched.march.end == integrate::MarchEnd::failed) {
    report.status = RunStatus::failed;
    const integrate::MarchFailure failure = march->failure(marched.march);
    report.message = text_of(failure, advice_on_step(failure, reached.motion->march));
  } else if (march->state().t < reached.time) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted at t = {} s of {} s", march->state().t, reached.time);
  }
  if (!report.message.empty()) return march->state();
  if (!reached.settles) {
    warn_of_motion(march->state(), kind.system(), report.warnings);
    return kind.held_still(march->state(), report.warnings);
  }
  const StopScope scope(context.stop);
  const integrate::Equilibrium found = kind.find_equilibrium(march->state(), {});
  report.message = complaint(found);
  if (!report.message.empty()) report.status = RunStatus::failed;
  return found.state;
}

/// The motions of each limit until someone asks to stop.
std::vector<integrate::FreeMotions> motions_of(const std::string& name, const ModesPlan& plan,
                                               const integrate::SystemKind& kind, const system::State& state,
                                               RunContext& context) {
  std::vector<integrate::FreeMotions> limits;
  const Index count = plan.limit_count(kind);
  context.progress.begin(name, static_cast<double>(count), "limits");
  try {
    const StopScope scope(context.stop);
    for (Index limit = 0; limit < count && !context.stop; ++limit) {
      limits.push_back(
          plan.contacts.empty()
              ? kind.free_motions(state, limit, plan.count)
              : integrate::free_motions_in(plan.contacts[static_cast<std::size_t>(limit)], kind, state, plan.count));
      context.progress.advance(static_cast<double>(limit + 1));
    }
  } catch (const Stopped&) {
    // Those that are there are kept.
  }
  context.progress.end();
  return limits;
}

std::string not_stable(const integrate::FreeMotions& motions, const ModesPlan& plan) {
  return fmt::format(
      "the {0} is not stable: a motion that the joints leave {3}, as exp({1:.4g}/s t); {2}",
      plan.about_equilibrium ? "equilibrium" : "configuration", motions.growth,
      plan.about_equilibrium ? "begin beside it to be led to one that is" : "about = \"static\" leads to one that is",
      motions.flutters ? "flutters, which loads without a potential make" : "goes away from it");
}

/// Why the modes of a limit are not those that were asked for; empty: they are.
std::string complaint_of(const integrate::FreeMotions& motions, std::size_t limit, const ModesPlan& plan,
                         const integrate::SystemKind& kind) {
  const numerics::DampedModes& found = motions.found;
  const auto held = static_cast<Index>(found.modes.size());
  if (motions.freedoms == 0) return {};
  if (!motions.is_stable) return not_stable(motions, plan);
  if (kind.is_constrained()) {
    if (!found.has_converged)
      return "the modes were not found to more than a few digits: " + cause_of_poor_modes(found);
    if (plan.is_asked && plan.count > motions.freedoms)
      return fmt::format("{} modes were asked for, and the joints leave {} motions", plan.count, motions.freedoms);
    return {};
  }
  if (found.missing > 0)
    return fmt::format("{} of the lowest {} modes of the limit {} were not found; ask for a few more or fewer",
                       std::min(found.missing, plan.count), plan.count, plan.limit_names()[limit]);
  if (held < plan.count || !found.has_converged)
    return fmt::format("of {} modes of the limit {} {}: {}", plan.count, plan.limit_names()[limit],
                       held == 0           ? "none was found"
                       : held < plan.count ? fmt::format("{} were found", held)
                                           : "not all were found to more than a few digits",
                       cause_of_poor_modes(found));
  return {};
}

/// Modes that grow. Two whose frequencies have met under friction flutter: one grows, its partner dies
/// away faster than damping alone makes it.
void tell_of_growth(const std::string& limit, const numerics::DampedModes& found, RunReport& report) {
  constexpr double worth_a_word = 1e-9;  // of |s|: well above the round-off of modes that stay as they are
  constexpr double met = 0.1;            // relative distance of the frequencies of two modes that may be such a pair
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const numerics::DampedMode& mode = found.modes[i];
    const double growth = mode.eigenvalue.real(), swing = mode.eigenvalue.imag();
    if (!(growth > worth_a_word * mode.angular_frequency)) continue;
    if (!(swing > worth_a_word * mode.angular_frequency)) {
      report.findings.push_back(fmt::format("limit {}: mode {} grows as exp({:.6g}/s t)", limit, i + 1, growth));
      report.warnings.push_back(fmt::format(
          "limit {}: mode {} goes away without swinging (divergence): the state is not stable", limit, i + 1));
      continue;
    }
    std::size_t partner = i;
    double nearest = met * swing;
    for (std::size_t k = 0; k < found.modes.size(); ++k) {
      const double away = std::abs(found.modes[k].eigenvalue.imag() - swing);
      if (k == i || !(found.modes[k].eigenvalue.real() < 0.0) || !(away <= nearest)) continue;
      partner = k;
      nearest = away;
    }
    report.findings.push_back(fmt::format("limit {}: mode {} at {:.6g} Hz grows as exp({:.6g}/s t)", limit, i + 1,
                                          swing / (2.0 * std::numbers::pi), growth));
    // Without numbers: a sweep tells equal warnings once, with the first sample that gave them.
    report.warnings.push_back(fmt::format(
        "limit {}: mode {} flutters{}: it grows, with a negative damping ratio, and the state about which it swings is "
        "not stable; what it grows to a transient shows",
        limit, i + 1,
        partner == i ? std::string() : fmt::format(", its frequency having met that of mode {}", partner + 1)));
  }
}

/// Tells of the modes of a limit, and gives the first complaint to the report.
void tell_of(const integrate::FreeMotions& motions, std::size_t limit, const ModesPlan& plan,
             const integrate::SystemKind& kind, RunReport& report) {
  if (kind.is_constrained()) report.statistics.emplace_back("freedoms", std::to_string(motions.freedoms));
  report.statistics.emplace_back("residual_" + plan.limit_names()[limit],
                                 fmt::format("{:.1e}", motions.found.residual));
  if (motions.found.missing < 0)
    report.statistics.emplace_back("completeness_" + plan.limit_names()[limit], "not verified");
  if (motions.leaves_out_skew)
    report.warnings.push_back(fmt::format(
        "the stiffness is not symmetric, by {:.2g} of its size: loads that follow their body have no potential "
        "(nor has a configuration that is no equilibrium); with more than 400 freedoms these modes leave that part "
        "out, and tell nothing of flutter, which a transient does",
        motions.skew));
  if (motions.is_stable)
    tell_round_off(plan.limit_count(kind) > 1 ? fmt::format("limit {}: ", plan.limit_names()[limit]) : "",
                   motions.found, report);
  if (!plan.contacts.empty()) tell_of_growth(plan.limit_names()[limit], motions.found, report);
  if (motions.freedoms == 0) report.findings.push_back("there are no modes: the joints and locks leave no motion");
  if (report.message.empty()) report.message = complaint_of(motions, limit, plan, kind);
}

/// The limits of contacts, with the static state where one of them asks for it.
void plan_contacts(const integrate::ModesRequest& request, const integrate::SystemKind& kind, ModesPlan& plan) {
  plan.contacts = integrate::contact_limits(request, kind);
  if (std::none_of(plan.contacts.begin(), plan.contacts.end(),
                   [](const integrate::ContactLimit& limit) { return limit.needs_static_state(); }))
    return;
  integrate::Equilibrium found = kind.find_equilibrium(plan.state, {});
  plan.failure = complaint(found);
  plan.state = std::move(found.state);
}

}  // namespace

std::vector<std::string> ModesPlan::limit_names() const {
  if (contacts.empty()) return mode_limits;
  std::vector<std::string> names;
  for (const integrate::ContactLimit& limit : contacts) names.push_back(limit.name);
  return names;
}

ModesPlan plan_modes(const std::string& name, const Location& where, const model::ModesDescription& description,
                     const integrate::SystemKind& kind, const numerics::Parameters& parameters,
                     StudyTransients* transients) {
  const std::string title = "analysis \"" + name + "\": ";
  const integrate::ModesRequest request{title, where, description, parameters};
  if (!description.nodal_diameters.empty())
    throw InvalidInput(description.nodal_diameters_where,
                       title + "\"nodal_diameters\" are of a disk of equal sectors; add [cyclic], or leave them out");
  ModesPlan plan;
  plan.count = kind.mode_count(request);
  plan.is_asked = description.count.has_value();
  plan.observed = observed_or_all(description.observe, {kind.system(), kind.supports()});
  if (description.about_reached) {
    plan.reached = reached_by(request, transients);
    plan.warnings = plan.reached->motion->march.warnings;
    return plan;
  }
  plan.state = kind.static_start(where, plan.warnings);
  if (description.contacts) {
    plan_contacts(request, kind, plan);
    return plan;
  }
  if (!description.about_equilibrium) {
    plan.state = kind.held_still(plan.state, plan.warnings);
    return plan;
  }
  plan.about_equilibrium = true;
  integrate::Equilibrium found = kind.find_equilibrium(plan.state, {});
  plan.failure = complaint(found);
  plan.state = std::move(found.state);
  return plan;
}

RunReport run_modes(const std::string& name, const ModesPlan& plan, const integrate::SystemKind& kind,
                    RunContext& context) {
  RunReport report;
  report.warnings = plan.warnings;
  report.message = plan.failure;
  if (plan.reached && !plan.reached->motion->march.failure.empty())
    report.message =
        fmt::format("\"{}\" leads nowhere: {}", plan.reached->analysis, plan.reached->motion->march.failure);
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
    return report;
  }
  const system::State state = plan.reached ? reach(name, *plan.reached, kind, context, report) : plan.state;
  if (!report.message.empty()) return report;
  const auto limits = motions_of(name, plan, kind, state, context);
  if (plan.reached)
    report.findings.push_back(fmt::format("about {}where \"{}\" is at t = {} s",
                                          plan.reached->settles ? "the equilibrium next to " : "",
                                          plan.reached->analysis, plan.reached->time));
  if (const std::string drives = held_drives(kind.drives()); !drives.empty()) report.findings.push_back(drives);
  write_modes(name, plan.limit_names(), plan.observed, limits, context.sink);
  results::draw_configuration(name, kind, state, context.sink);
  for (std::size_t limit = 0; limit < limits.size(); ++limit) tell_of(limits[limit], limit, plan, kind, report);
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
  } else if (static_cast<Index>(limits.size()) < plan.limit_count(kind)) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted after {} of {} limits", limits.size(), plan.limit_count(kind));
  }
  return report;
}

}  // namespace rubato::analysis
