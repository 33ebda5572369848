#pragma once

#include <rubato/analysis/run_study.hpp>

#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <string>

namespace rubato::testing {

/// What all analyses of a study of a structure write; each is checked first, as the command does.
inline MemorySink run_study(const std::string& text) {
  const PreparedStudy prepared(text);
  MemorySink sink;
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  for (const auto& one : prepared.study.analyses) {
    (void)analysis::check_analysis(one, prepared.input());
    const auto report = analysis::run_analysis(one, prepared.input(), context);
    EXPECT_EQ(report.status, analysis::RunStatus::done) << report.message;
  }
  return sink;
}

/// A number of a row.
inline double value_of(const MemorySink& sink, const std::string& table, const std::string& variable,
                       const std::string& label = "", std::size_t row = 0) {
  const auto& found = sink.tables.at(table);
  return found.rows.at(row).at(found.column(variable, label));
}

}  // namespace rubato::testing
