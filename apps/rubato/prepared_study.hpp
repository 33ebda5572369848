#pragma once

#include "commands.hpp"

#include <rubato/analysis/prepared_study.hpp>
#include <rubato/io/source_files.hpp>

#include <memory>

namespace rubato::app {

/// A study as the options of the command ask for it.
struct CommandStudy {
  std::unique_ptr<const analysis::PreparedStudy> prepared;
  io::SourceFiles files;  ///< that the study names
};

/// Throws InvalidInput.
CommandStudy prepare(const StudyOptions& options);

}  // namespace rubato::app
