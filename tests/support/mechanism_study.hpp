#pragma once

#include <support/run_mechanism.hpp>

#include <string>

namespace rubato::testing {

/// What an analysis of a study of a mechanism writes.
struct MechanismStudy : RanMechanism {
  explicit MechanismStudy(const std::string& text, std::size_t analysis = 0)
      : RanMechanism(run_mechanism_study(text, analysis)) {}
  const MemorySink::Table& table(const std::string& name) const { return sink.tables.at(name); }
  /// A number of a row.
  double at(std::size_t row, const std::string& name, const std::string& variable,
            const std::string& label = "") const {
    const auto& of = table(name);
    return of.rows.at(row)[of.column(variable, label)];
  }
  /// A number of the last row.
  double last(const std::string& name, const std::string& variable, const std::string& label = "") const {
    return at(table(name).rows.size() - 1, name, variable, label);
  }
};

}  // namespace rubato::testing
