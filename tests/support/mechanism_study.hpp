#pragma once

#include <rubato/analysis/run_study.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism.hpp>

#include <support/memory_sink.hpp>

#include <atomic>
#include <string>

namespace rubato::testing {

/// What the first analysis of a study of a mechanism writes.
struct MechanismStudy {
  MemorySink sink;
  analysis::RunReport report;

  explicit MechanismStudy(const std::string& text) {
    const auto study = io::read_study_text(text, "study.toml");
    const numerics::Parameters overrides, parameters = model::evaluate_parameters(study.parameters);
    const system::Mechanism mechanism(model::build_mechanism(study.model, parameters));
    const system::LocallyNonlinear empty({});
    const analysis::StudyInput input{study, overrides, parameters, empty, &mechanism};
    QuietProgress progress;
    const std::atomic<bool> stop{false};
    analysis::RunContext context{sink, progress, stop};
    report = analysis::run_analysis(study.analyses.front(), input, context);
  }
  const MemorySink::Table& table(const std::string& name) const { return sink.tables.at(name); }
  /// A number of the last row.
  double last(const std::string& name, const std::string& variable, const std::string& label = "") const {
    const auto& of = table(name);
    return of.rows.back()[of.column(variable, label)];
  }
};

}  // namespace rubato::testing
