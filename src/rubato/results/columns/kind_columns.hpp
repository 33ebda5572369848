#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/integrate/march.hpp>
#include <rubato/results/columns/observed_columns.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::results {

/// Columns with what they look at.
struct OwnedColumns {
  std::shared_ptr<void> workspace;
  ColumnGroups groups;
};

/// What an equilibrium shows: positions of what is observed; of a structure force and slip of its contacts; of a
/// mechanism the coordinates that its joints leave free, reactions, laws and section forces. Throws InvalidInput for a
/// beam that is not there.
/// @param kind   must outlive the columns
/// @param title  of the analysis, for the error
OwnedColumns columns_of_equilibrium(const integrate::SystemKind& kind, const std::vector<Observed>& observed,
                                    const model::SectionForcesDescription& section_forces, const std::string& title);

/// What a march shows: columns_of_motion() of its system.
/// @param march  lent to the columns
ColumnGroups columns_of_motion(integrate::March& march, const std::vector<Observed>& observed,
                               const model::SectionForcesDescription& section_forces);

/// Refuses section forces of what has none, and of a beam that is not there. Throws InvalidInput at its place.
/// @param title  of the analysis, for the error
void check_section_forces(const integrate::SystemKind& kind, const model::SectionForcesDescription& wanted,
                          const std::string& title);

}  // namespace rubato::results
