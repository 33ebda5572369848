#include <rubato/analysis/pieces.hpp>
#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/samples/sample_tables.hpp>
#include <rubato/analysis/samples/samples.hpp>
#include <rubato/core/stopping.hpp>

#include <fmt/format.h>

#include <optional>

namespace rubato::analysis {
namespace {

/// The sweep tells how far it is, its samples do not.
class Silence final : public Progress {
 public:
  void begin(const std::string&, double, const std::string&) override {}
  void advance(double) override {}
  void end() override {}
};

/// Numbers of the run that are key numbers too: how many steps it took.
void add_statistics(const RunReport& report, KeyNumbers& numbers) {
  for (const auto& [name, value] : report.statistics) {
    if (name != "steps") continue;
    const double steps = std::stod(value);
    numbers.add({"steps", "1", "accepted", "", {}}, std::span(&steps, 1));
  }
}

SampleResult solve(const SamplesPlan& plan, long number, const StudyInput& input, const SamplePlanner& plan_one,
                   const std::atomic<bool>& stop) {
  constexpr std::size_t most_warnings = 8;
  const StopScope scope(stop);
  SampleResult result;
  result.number = number;
  try {
    const SampleModel model(plan.sweep, number, input);
    const StudyInput at = model.input();
    const PlannedAnalysis planned = plan_one(plan.sample, at);
    SampleSink sink(kept_for_key_numbers(plan.sample, plan.keeps_samples));
    Silence silence;
    RunContext inner{sink, silence, stop, 1};
    const RunReport report = planned.run(at, inner);
    result.is_whole = report.status != RunStatus::interrupted;
    result.warning_count = static_cast<double>(report.warnings.size());
    result.warnings.assign(
        report.warnings.begin(),
        report.warnings.begin() + static_cast<std::ptrdiff_t>(std::min(report.warnings.size(), most_warnings)));
    if (report.status == RunStatus::failed) {
      result.status = SampleStatus::failed;
      result.reason = report.message;
    }
    if (report.status != RunStatus::done) return result;
    result.numbers = key_numbers_of(plan.sample, sink, at.kind);
    add_statistics(report, result.numbers);
    if (const KeptTable* main = plan.keeps_samples ? sink.find("") : nullptr) {
      result.row_blocks = main->layout.blocks;
      result.rows = main->rows;
    }
  } catch (const InvalidInput& fault) {
    result.status = SampleStatus::impossible;
    result.reason = fault.where().file.empty() ? fault.message() : fault.what();
  } catch (const Stopped&) {
    result.is_whole = false;
  }
  return result;
}

}  // namespace

RunReport run_samples(const std::string& name, const SamplesPlan& plan, const StudyInput& input,
                      const SamplePlanner& plan_one, RunContext& context) {
  const long count = plan.sweep.lines();
  SampleTables tables(name, plan, context.sink);
  context.progress.begin(name, static_cast<double>(count), "samples");
  SweepProgress progress(context.progress, 1);
  long next = 0;
  PieceWork<long, SampleResult> work;
  work.next = [&] { return next < count ? std::optional(next++) : std::nullopt; };
  work.recall = [&](long number, const std::vector<double>& values) {
    SampleResult result = SampleResult::unpacked(number, values);
    // The journal holds numbers; which columns they are is seen from one sample that is computed again.
    if (!result.numbers.values.empty() && !tables.is_laid()) {
      const SampleResult again = solve(plan, number, input, plan_one, context.stop);
      if (again.is_whole && again.status == SampleStatus::done)
        tables.lay(again);
      else
        result.is_whole = false;
    }
    progress.add(1);
    return result;
  };
  work.solve = [&](long number) {
    SampleResult result = solve(plan, number, input, plan_one, context.stop);
    if (result.is_whole) progress.add(1);
    return result;
  };
  work.write = [&](SampleResult& result) { tables.write(result); };
  (void)work_in_pieces(work, context);
  tables.finish();
  context.progress.advance(static_cast<double>(tables.written()));
  context.progress.end();

  RunReport report;
  if (tables.written() < count) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted after {} of {} samples", tables.written(), count);
  } else if (tables.count_of(SampleStatus::done) == 0.0) {
    report.status = RunStatus::failed;
    report.message = fmt::format("no sample has a result; the first, {}", tables.first_reason());
  }
  report.statistics = {{"samples", std::to_string(tables.written())}};
  for (std::size_t i = 0; i < sample_statuses.size(); ++i)
    if (const double of_status = tables.count_of(static_cast<SampleStatus>(i)); i == 0 || of_status > 0.0)
      report.statistics.emplace_back(sample_statuses[i], fmt::format("{:.0f}", of_status));
  report.warnings = tables.warnings();
  report.findings = tables.findings();
  return report;
}

}  // namespace rubato::analysis
