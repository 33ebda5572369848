#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/numerics/eigen_damped.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// Natural modes of a linear model in the two limits of its sliders: `free`, all removed, and `stuck`, all of them
/// springs kT. A model without sliders has the limit `free` only.
struct ModesPlan {
  Index count = 0;  ///< the lowest so many of each limit
  std::vector<Observed> observed;
};

/// Evaluates a description. Throws InvalidInput, at its place, for a count that is no whole number from 1 to the number
/// of coordinates, and for more than a third of the modes of a model beyond 3,000 coordinates.
ModesPlan plan_modes(const std::string& name, const Location& where, const model::ModesDescription& description,
                     const system::LocallyNonlinear& system, const numerics::Parameters& parameters);

/// The modes of a limit: 0 `free`, 1 `stuck`.
struct LimitModes {
  std::size_t limit;
  numerics::DampedModes found;
};

/// Writes the table of run_modes.
void write_modes(const std::string& name, const std::vector<Observed>& observed, const std::vector<LimitModes>& all,
                 results::Sink& sink);

/// Why modes did not converge, and what to do about it.
std::string cause_of_poor_modes(const numerics::DampedModes& found);

/// Tells, of the modes of a limit, which are at 0 Hz and whether those are rigid motions or lie below the round-off of
/// the stiffness, and which are known to a few digits only because of it.
/// @param title  what they are of: "limit free: ", or nothing
void tell_round_off(const std::string& title, const numerics::DampedModes& found, RunReport& report);

/// One row a mode: limit, number, angular frequency, frequency, damping ratio, eigenvalue and shape (with phi^H M phi =
/// 1; its imaginary part where damping makes a mode of either limit complex). Modes that did not converge, or that a
/// count shows to be missing, are a failure; those found are written.
RunReport run_modes(const std::string& name, const ModesPlan& plan, const system::LocallyNonlinear& system,
                    RunContext& context);

}  // namespace rubato::analysis
