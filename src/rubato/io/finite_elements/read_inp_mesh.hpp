#pragma once

#include <rubato/io/study_folder.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>

// Private to io.
namespace rubato::io {

/// Nodes, elements, node sets and materials of an input deck of CalculiX or Abaqus (`.inp`), with the files that it
/// includes. What else the deck holds is passed over; what would give nodes another place (parts, transformed systems,
/// generated nodes) is refused. Throws InvalidInput, with the line.
model::Mesh read_inp_mesh(const std::string& file, const StudyFolder& folder, const Location& where);

}  // namespace rubato::io
