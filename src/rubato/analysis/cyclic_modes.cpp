#include <rubato/analysis/cyclic_modes.hpp>
#include <rubato/analysis/modes_table.hpp>
#include <rubato/analysis/samples/samples_plan.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/equilibrium/cyclic_motions.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/model.hpp>
#include <rubato/results/drawing/kind_drawing.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {

bool is_cyclic(const StudyInput& input) {
  return input.study.model.finite_elements && input.study.model.finite_elements->cyclic;
}

void refuse_without_cyclic_condition(const model::AnalysisDescription& analysis, const StudyInput& input) {
  if (!is_cyclic(input)) return;
  const auto* modes = std::get_if<model::ModesDescription>(&analysis.task);
  if (!modes)
    throw InvalidInput(analysis.where,
                       fmt::format("analysis \"{}\": with [cyclic] only type = \"modes\" is taken yet: others know no "
                                   "condition between sectors, and would give the motion of a sector whose sides are "
                                   "free; leave [cyclic] out and hold or join the sides by parts of the study",
                                   analysis.name));
  if (swept_of(analysis))
    throw InvalidInput(analysis.where, fmt::format("analysis \"{}\": modes with [cyclic] are not swept yet; run the "
                                                   "study with --set for each value",
                                                   analysis.name));
}

namespace {

/// Those asked for, rising and each once; all unless given.
std::vector<Index> diameters_of(const model::ModesDescription& description, const model::CyclicSector& sector,
                                const StudyInput& input, const std::string& title, const Location& where) {
  std::vector<Index> diameters;
  for (const model::Quantity& quantity : description.nodal_diameters) {
    const double k = model::evaluate(quantity, input.parameters, title + "nodal_diameters");
    if (!(k >= 0.0 && k <= static_cast<double>(sector.largest_diameter()) && k == std::floor(k)))
      throw InvalidInput(quantity.where.line > 0 ? quantity.where : where,
                         fmt::format("{}nodal_diameters of {} sectors are whole numbers from 0 to {}, got {}; a "
                                     "larger one is another one in disguise: k and {} - k are a pair",
                                     title, sector.sectors(), sector.largest_diameter(), k, sector.sectors()));
    diameters.push_back(static_cast<Index>(k));
  }
  if (description.nodal_diameters.empty())
    for (Index k = 0; k <= sector.largest_diameter(); ++k) diameters.push_back(k);
  std::sort(diameters.begin(), diameters.end());
  diameters.erase(std::unique(diameters.begin(), diameters.end()), diameters.end());
  return diameters;
}

}  // namespace

CyclicModesPlan plan_cyclic_modes(const std::string& name, const Location& where,
                                  const model::ModesDescription& description, const StudyInput& input) {
  const std::string title = "analysis \"" + name + "\": ";
  const model::FiniteElements& elements = *input.study.model.finite_elements;
  if (description.contacts)
    throw InvalidInput(description.contacts_where,
                       title + "\"contacts\" does not go with [cyclic] yet; the limits are free and stuck");
  if (std::holds_alternative<model::ModalDamping>(input.study.model.damping))
    throw InvalidInput(where, title +
                                  "[damping] by modal ratios is of the modes of a sector whose sides are free; with "
                                  "[cyclic] take rayleigh, or a damping matrix");
  if (input.kind.supports())
    throw InvalidInput(where, title + "a [[displacement]] that moves does not go with [cyclic] yet; leave it out");
  const model::Model model = model::build(input.study.model, input.parameters);
  CyclicModesPlan plan{model::CyclicSector(*elements.cyclic, elements, model, input.parameters), {}, 0, {}, {}, 0.0};
  plan.count = std::min(input.kind.mode_count({title, where, description, input.parameters}), plan.sector.size());
  if (description.count && plan.sector.size() < plan.count)
    throw InvalidInput(where, fmt::format("{}count is {}, but a sector with one of its sides has {} modes", title,
                                          plan.count, plan.sector.size()));
  plan.diameters = diameters_of(description, plan.sector, input, title, where);
  plan.observed = observed_or_all(description.observe, {input.kind.system(), input.kind.supports()});
  plan.summary = fmt::format(
      "modes of {} sectors, {} of the nodal diameters 0 to {}: {} pairs of nodes at the sides, {:.1g} m apart at "
      "most{}",
      plan.sector.sectors(), plan.diameters.size(), plan.sector.largest_diameter(), plan.sector.pairs(),
      plan.sector.largest_distance(),
      plan.sector.is_exchanged() ? " (the set called left lies at the right: it follows the other one)" : "");
  plan.expected_bytes = 28.0 * static_cast<double>(plan.count * input.kind.limit_count()) *
                        static_cast<double>(plan.diameters.size()) * static_cast<double>(8 + 2 * plan.observed.size());
  return plan;
}

RunReport run_cyclic_modes(const std::string& name, const CyclicModesPlan& plan, const integrate::SystemKind& kind,
                           RunContext& context) {
  RunReport report;
  const Index limits = kind.limit_count();
  const auto diameters = static_cast<Index>(plan.diameters.size());
  std::vector<integrate::FreeMotions> all;
  context.progress.begin(name, static_cast<double>(limits * diameters), "nodal diameters");
  double residual = 0.0;
  bool is_verified = true;
  try {
    const StopScope scope(context.stop);
    for (Index limit = 0; limit < limits && !context.stop; ++limit) {
      for (const Index k : plan.diameters) {
        integrate::FreeMotions motions = integrate::cyclic_motions(kind, plan.sector, {k, limit, plan.count});
        residual = std::max(residual, motions.found.residual);
        is_verified = is_verified && motions.found.missing >= 0;
        const std::string place =
            fmt::format("limit {}, nodal diameter {}: ", mode_limits[static_cast<std::size_t>(limit)], k);
        tell_round_off(place, motions.found, report);
        const auto held = static_cast<Index>(motions.found.modes.size());
        if (report.message.empty() && (held < plan.count || !motions.found.has_converged || motions.found.missing > 0))
          report.message =
              fmt::format("{}of {} modes {} were found to all digits: {}", place, plan.count,
                          held < plan.count ? std::to_string(held) : "not all", cause_of_poor_modes(motions.found));
        all.push_back(std::move(motions));
        context.progress.advance(static_cast<double>(all.size()));
      }
    }
  } catch (const Stopped&) {
    // Those that are there are kept.
  }
  context.progress.end();
  write_modes(name, mode_limits, plan.observed, all, context.sink, plan.diameters);
  results::draw_configuration(name, kind, kind.start(), context.sink);
  report.statistics.emplace_back("residual", fmt::format("{:.1e}", residual));
  if (!is_verified) report.statistics.emplace_back("completeness", "not verified");
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
  } else if (static_cast<Index>(all.size()) < limits * diameters) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted after {} of {} nodal diameters", all.size(), limits * diameters);
  }
  return report;
}

}  // namespace rubato::analysis
