#pragma once

#include <rubato/analysis/observed.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/finite_elements/cyclic.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// Modes of a disk of equal sectors by nodal diameter, in the limits of sliders within a sector.
struct CyclicModesPlan {
  model::CyclicSector sector;
  std::vector<Index> diameters;  ///< 0 to N/2
  Index count = 0;               ///< the lowest so many of each diameter and limit
  std::vector<Observed> observed;
  std::string summary;
  double expected_bytes = 0.0;
};

/// Whether the study has [cyclic].
bool is_cyclic(const StudyInput& input);

/// Throws InvalidInput, at the analysis, where the study has [cyclic] and the analysis does not know the condition
/// between sectors: the motions of a sector whose sides are free are other ones.
void refuse_without_cyclic_condition(const model::AnalysisDescription& analysis, const StudyInput& input);

/// Throws InvalidInput where the sides do not pair, and for keys that modes of a disk do not take.
CyclicModesPlan plan_cyclic_modes(const std::string& name, const Location& where,
                                  const model::ModesDescription& description, const StudyInput& input);

/// Writes the table of modes with the column nodal_diameter; shapes are those of sector 0.
RunReport run_cyclic_modes(const std::string& name, const CyclicModesPlan& plan, const integrate::SystemKind& kind,
                           RunContext& context);

}  // namespace rubato::analysis
