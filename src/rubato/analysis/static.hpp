#pragma once

#include <rubato/analysis/observed.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A static analysis with all its values.
struct StaticPlan {
  std::string title;  ///< heads the messages
  std::vector<Observed> observed;
  model::SectionForcesDescription section_forces;
  std::vector<model::Held> held;
  system::State start;                          ///< of the search
  std::optional<integrate::Equilibrium> found;  ///< empty: the search belongs to the run
  std::vector<std::string> warnings = {};       ///< of what the start took
  std::string failure = {};                     ///< why the run will find none, where that is known; empty: it is not
};

/// The model with sliders and contacts that slip freely: mu = 0. Other laws stay.
model::ModelDescription without_friction(const model::ModelDescription& model);

/// Evaluates a description. Throws InvalidInput.
StaticPlan plan_static(const std::string& name, const Location& where, const model::StaticDescription& description,
                       const integrate::SystemKind& kind);

/// Writes the equilibrium as a table of one row: positions, what the parts carry, and the reactions on held
/// displacements. One that is not found is a failure, and nothing is written. One that is not stable is told, and locks
/// that hold are.
RunReport run_static(const std::string& name, const StaticPlan& plan, const integrate::SystemKind& kind,
                     RunContext& context);

}  // namespace rubato::analysis
