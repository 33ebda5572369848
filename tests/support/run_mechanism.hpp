#pragma once

#include <rubato/analysis/run_study.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism.hpp>

#include <support/memory_sink.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <sstream>
#include <string>

namespace rubato::testing {

struct RanMechanism {
  MemorySink sink;
  analysis::RunReport report;
};

/// Runs an analysis of a study of a mechanism.
inline RanMechanism run_mechanism_study(const std::string& text, std::size_t analysis = 0) {
  const auto study = io::read_study_text(text, "study.toml");
  const numerics::Parameters overrides, parameters = model::evaluate_parameters(study.parameters);
  const system::Mechanism mechanism(model::build_mechanism(study.model, parameters));
  const integrate::MechanismKind kind(mechanism);
  const analysis::StudyInput input{study, overrides, parameters, kind};
  RanMechanism ran;
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{ran.sink, progress, stop};
  ran.report = analysis::run_analysis(study.analyses.at(analysis), input, context);
  return ran;
}

inline std::string example(const std::string& name) {
  std::ifstream file(std::string(RUBATO_EXAMPLES) + "/" + name + "/study.toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The text with one piece of it replaced.
inline std::string replaced(std::string text, const std::string& piece, const std::string& other) {
  const std::size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

/// The text with every such piece of it replaced.
inline std::string replaced_everywhere(std::string text, const std::string& piece, const std::string& other) {
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + other.size()))
    text.replace(at, piece.size(), other);
  return text;
}

}  // namespace rubato::testing
