#pragma once

#include <rubato/io/source_files.hpp>
#include <rubato/model/description.hpp>

#include <filesystem>
#include <string>

namespace rubato::io {

/// Reads a study file with the tables and matrices that it names, which lie relative to it. Nothing is evaluated;
/// values keep their places. Throws InvalidInput, with file, line and column, for a file that cannot be read or that is
/// no study.
/// @param path   as the user wrote it: messages repeat it
/// @param files  where given, the files that the study names are added to it as they are read
model::StudyDescription read_study(const std::filesystem::path& path, SourceFiles* files = nullptr);

/// The same from text.
/// @param name    stands for the file in messages
/// @param folder  where tables and matrices lie
model::StudyDescription read_study_text(const std::string& text, const std::string& name,
                                        const std::filesystem::path& folder = ".", SourceFiles* files = nullptr);

}  // namespace rubato::io
