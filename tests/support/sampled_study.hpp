#pragma once

#include <rubato/analysis/run_study.hpp>
#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/io/read_study.hpp>

#include "support/memory_sink.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace rubato::testing {

/// A study of whatever system, and an analysis of it that is run as the command does.
class SampledStudy {
 public:
  explicit SampledStudy(const std::string& text, const numerics::Parameters& settings = {})
      : study_(io::read_study_text(text, "study.toml")),
        overrides_(settings),
        parameters_(model::evaluate_parameters(study_.parameters, settings)),
        kind_(integrate::assemble_kind(study_.model, parameters_)) {}

  struct Ran {
    MemorySink sink;
    analysis::RunReport report;
    analysis::AnalysisOutline outline;

    double value(const std::string& table, std::size_t row, const std::string& variable,
                 const std::string& label = "") const {
      const auto& found = sink.tables.at(table);
      return found.rows.at(row).at(found.column(variable, label));
    }
    const std::vector<std::vector<double>>& rows(const std::string& table) const { return sink.tables.at(table).rows; }
  };

  analysis::AnalysisOutline check(std::size_t number = 0) const {
    return analysis::check_analysis(study_.analyses.at(number), input());
  }

  /// @param interrupt_after  samples; the run is asked to stop then; -1: it is not
  Ran run(int threads = 1, results::Journal* journal = nullptr, double interrupt_after = -1.0,
          std::size_t number = 0) const {
    Ran ran;
    std::atomic<bool> stop{false};
    struct Watch final : analysis::Progress {
      void begin(const std::string&, double, const std::string&) override {}
      void advance(double done) override {
        if (after >= 0.0 && done >= after) flag = true;
      }
      void end() override {}
      std::atomic<bool>& flag;
      double after;
      Watch(std::atomic<bool>& f, double a) : flag(f), after(a) {}
    } progress(stop, interrupt_after);
    analysis::RunContext context{ran.sink, progress, stop, threads, journal};
    const auto planned = analysis::plan_analysis(study_.analyses.at(number), input());
    ran.outline = planned.outline;
    ran.report = analysis::run_analysis(study_.analyses.at(number), planned, input(), context);
    return ran;
  }

  analysis::StudyInput input() const { return {study_, overrides_, parameters_, *kind_}; }

 private:
  model::StudyDescription study_;
  numerics::Parameters overrides_, parameters_;
  std::unique_ptr<const integrate::SystemKind> kind_;
};

/// The message of what a study refuses; empty: it does not.
inline std::string refusal_of(const std::string& text, std::size_t number = 0) {
  try {
    (void)SampledStudy(text).check(number);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return {};
}

}  // namespace rubato::testing
