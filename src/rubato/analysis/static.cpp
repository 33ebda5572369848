#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/results/columns/kind_columns.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rubato::analysis {
namespace {

/// Forces, then moments, that hold prescribed displacements.
void append_reactions(const integrate::Equilibrium& found, results::TableLayout& layout, std::vector<double>& row) {
  std::vector<std::string> forces, moments;
  for (const auto& reaction : found.reactions) (reaction.is_moment ? moments : forces).push_back(reaction.coordinate);
  if (!forces.empty())
    layout.blocks.push_back({"reaction", "N", "force that holds the displacement", "held_displacement", forces});
  if (!moments.empty())
    layout.blocks.push_back({"reaction_moment", "N m", "moment that holds the rotation", "held_rotation", moments});
  for (const bool is_moment : {false, true})
    for (const auto& reaction : found.reactions)
      if (reaction.is_moment == is_moment) row.push_back(reaction.value);
}

std::vector<std::string> findings_of(const integrate::Equilibrium& found) {
  std::vector<std::string> findings;
  if (found.load_steps > 0)
    findings.push_back(fmt::format(
        "the loads were raised in {} steps: under all of them at once no equilibrium was found", found.load_steps));
  if (!found.holding.empty())
    findings.push_back(fmt::format("held by the lock of \"{}\"", fmt::join(found.holding, "\", \"")));
  if (!found.is_stable) findings.push_back("the equilibrium is not stable: beside it some motion goes away from it");
  return findings;
}

}  // namespace

model::ModelDescription without_friction(const model::ModelDescription& model) {
  model::ModelDescription result = model;
  const auto free = [](model::Quantity& coefficient) {
    coefficient.value = 0.0;
    coefficient.expression.clear();
  };
  for (model::SliderDescription& slider : result.sliders) free(slider.friction_coefficient);
  for (model::ContactDescription& contact : result.contacts)
    if (contact.friction_coefficient) free(*contact.friction_coefficient);
  return result;
}

StaticPlan plan_static(const std::string& name, const Location& where, const model::StaticDescription& description,
                       const integrate::SystemKind& kind) {
  StaticPlan plan;
  plan.title = "analysis \"" + name + "\": ";
  const integrate::StaticRequest request{plan.title, where, description};
  results::check_section_forces(kind, description.section_forces, plan.title);
  plan.held = kind.held_displacements(request);
  plan.start = kind.static_start(where, plan.warnings);
  if (kind.finds_equilibrium_at_once()) {
    plan.found = kind.find_equilibrium(plan.start, plan.held);
    plan.failure = complaint(*plan.found);
    if (is_certain(*plan.found)) throw InvalidInput(where, plan.title + plan.failure);
  }
  plan.observed = observed_or_all(description.observe, {kind.system(), kind.supports()});
  plan.section_forces = description.section_forces;
  return plan;
}

RunReport run_static(const std::string& name, const StaticPlan& plan, const integrate::SystemKind& kind,
                     RunContext& context) {
  const integrate::Equilibrium found = plan.found ? *plan.found : kind.find_equilibrium(plan.start, plan.held);
  RunReport report;
  report.warnings = plan.warnings;
  if (const std::string rounding = warning_of_rounding(found); !rounding.empty()) report.warnings.push_back(rounding);
  report.statistics = found.statistics;
  report.message = complaint(found);
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
    return report;
  }
  const auto columns = results::columns_of_equilibrium(kind, plan.observed, plan.section_forces, plan.title);
  results::TableLayout layout{name, "", "state", {{"state", "1", "number of the state", "", {}}}, {{"type", "static"}}};
  if (!found.holding.empty())
    layout.attributes.emplace_back("held_locks", fmt::format("{}", fmt::join(found.holding, "\n")));
  std::vector<double> row{0.0};
  for (const auto& group : columns.groups) {
    group->add(layout);
    group->append(found.state, row);
  }
  append_reactions(found, layout, row);
  context.sink.open(layout)->append(row);
  report.findings = findings_of(found);
  return report;
}

}  // namespace rubato::analysis
