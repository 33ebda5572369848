#pragma once

#include <filesystem>

namespace rubato::report {

/// Writes the motion of the structures in a results file for ParaView: `FOLDER/ANALYSIS.pvd`, which lists the frames of
/// an analysis with their times, and the frames `FOLDER/ANALYSIS/0000.vtp`, ... (VTK XML PolyData: nodes where they
/// are, the lines between them, `displacement` [m] and `rotation` [rad] of each node). A transient has at most 2,000
/// frames, evenly spread over time; of complex modes the real part is written.
/// @return how many analyses were written: those that hold every degree of freedom of a structure
/// @throws InvalidInput when the results cannot be read, OutputError when a file cannot be written
int write_vtk(const std::filesystem::path& results_nc, const std::filesystem::path& folder);

}  // namespace rubato::report
