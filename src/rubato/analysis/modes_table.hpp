#pragma once

#include <rubato/analysis/observed.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/integrate/equilibrium/free_motions.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// The limits of sliders unless others are asked for, in the order of their numbers.
inline const std::vector<std::string> mode_limits{"free", "stuck"};

/// One row a mode: limit, number, angular frequency, frequency, damping ratio, eigenvalue and shape (with phi^H M phi =
/// 1; its imaginary part where damping makes a mode of any limit complex).
/// @param names   of the limits
/// @param limits  the motions of each, in the order of the names
/// @param diameters  nodal diameters, of each of which every limit has motions, one after the other; none: no disk
void write_modes(const std::string& name, const std::vector<std::string>& names, const std::vector<Observed>& observed,
                 const std::vector<integrate::FreeMotions>& limits, results::Sink& sink,
                 const std::vector<Index>& diameters = {});

/// Why modes did not converge, and what to do about it.
std::string cause_of_poor_modes(const numerics::DampedModes& found);

/// Tells, of the modes of a limit, which are at 0 Hz and whether those are rigid motions or lie below the round-off of
/// the stiffness, and which are known to a few digits only because of it.
/// @param title  what they are of: "limit free: ", or nothing
void tell_round_off(const std::string& title, const numerics::DampedModes& found, RunReport& report);

}  // namespace rubato::analysis
