#pragma once

#include <rubato/model/description.hpp>

#include <filesystem>
#include <string>

namespace rubato::io {

/// Reads a study file with the tables and matrices that it names, which lie relative to it. Nothing is evaluated;
/// values keep their places. Throws InvalidInput, with file, line and column, for a file that cannot be read or that is
/// no study.
/// @param path  as the user wrote it: messages repeat it
model::StudyDescription read_study(const std::filesystem::path& path);

/// The same from text.
/// @param name    stands for the file in messages
/// @param folder  where tables and matrices lie
model::StudyDescription read_study_text(const std::string& text, const std::string& name,
                                        const std::filesystem::path& folder = ".");

}  // namespace rubato::io
