#pragma once

#include <rubato/analysis/observed.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_transients.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/kinds/contact_limits.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Natural modes about a state at rest: the start, a static equilibrium, or where a transient leads; of a structure in
/// the limits of its sliders, `free`, all removed, and `stuck`, all of them springs kT. Without sliders there is the
/// limit `free` only. Or in the limits of contacts that the study asks for, of which those that slide may flutter.
struct ModesPlan {
  /// The transient that leads there, which the analysis marches again.
  struct Reached {
    std::shared_ptr<const TransientPlan> motion;
    std::string analysis;
    double time = 0.0;     ///< [s]
    bool settles = false;  ///< and on to the equilibrium next to it
  };

  Index count = 0;                                ///< the lowest so many of each limit
  bool is_asked = false;                          ///< the study gives the count
  std::vector<integrate::ContactLimit> contacts;  ///< the limits asked for; empty: those of the kind
  std::vector<Observed> observed;
  system::State state;  ///< at rest, with the multipliers of its loads; of one that is reached the start
  bool about_equilibrium = false;
  std::optional<Reached> reached;
  std::vector<std::string> warnings = {};
  /// The names of the limits: those asked for, or `free` and `stuck`.
  std::vector<std::string> limit_names() const;
  /// How many limits there are.
  Index limit_count(const integrate::SystemKind& kind) const {
    return contacts.empty() ? kind.limit_count() : static_cast<Index>(contacts.size());
  }

  std::string failure;  ///< why the equilibrium was not found: the analysis fails; empty: nothing did
};

/// Evaluates a description and finds the configuration. Throws InvalidInput, at its place, for a mechanism that cannot
/// be assembled, a transient that is none of the study's, a count that no such system has, and a model too large.
/// @param transients  to which it may refer; null: the study has none
ModesPlan plan_modes(const std::string& name, const Location& where, const model::ModesDescription& description,
                     const integrate::SystemKind& kind, const numerics::Parameters& parameters,
                     StudyTransients* transients = nullptr);

/// Writes the table of modes; rotations in space are about the axes of the nodes. Modes that did not converge, or that
/// a count shows to be missing, are a failure; those found are written. So is a configuration that is not stable.
RunReport run_modes(const std::string& name, const ModesPlan& plan, const integrate::SystemKind& kind,
                    RunContext& context);

}  // namespace rubato::analysis
