#include <rubato/analysis/run_analyses.hpp>
#include <rubato/core/error.hpp>

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <thread>

namespace rubato::analysis {
namespace {

class Runner {
 public:
  Runner(const PreparedStudy& study, const RunSetup& setup)
      : study_(study), setup_(setup), reports_(study.analyses.size()) {}

  const std::vector<std::optional<RunReport>>& run() {
    const std::size_t jobs = std::min<std::size_t>(static_cast<std::size_t>(std::max(setup_.jobs, 1)), reports_.size());
    if (jobs == 1) {
      work(*study_.kind, false);
      return reports_;
    }
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < jobs; ++i)
      threads.emplace_back([this, own = study_.kind->for_thread()] { work(own ? *own : *study_.kind, true); });
    threads.clear();
    return reports_;
  }

 private:
  void work(const integrate::SystemKind& kind, bool has_neighbours) {
    for (std::size_t i = next_++; i < reports_.size() && !is_over_; i = next_++) {
      reports_[i] = run_one(i, kind, has_neighbours);
      if (reports_[i]->status == RunStatus::interrupted) is_over_ = true;
    }
  }

  RunReport run_one(std::size_t index, const integrate::SystemKind& kind, bool has_neighbours) {
    const auto progress = setup_.progress(index, has_neighbours);
    RunContext context{setup_.sink, *progress, setup_.stop, setup_.jobs,
                       setup_.journal ? setup_.journal(index) : nullptr};
    RunReport report;
    bool is_refused = false;
    try {
      report = run_analysis(study_.analyses[index], study_.planned[index],
                            {*study_.description, study_.overrides, study_.parameters, kind}, context);
    } catch (const std::bad_alloc&) {
      report = {RunStatus::failed, "memory ran out; observe fewer coordinates, or take a smaller model", {}};
    } catch (const InvalidInput& fault) {
      report = {RunStatus::failed, fault.where().file.empty() ? fault.message() : fault.what(), {}};
    } catch (const std::exception& fault) {
      report = {RunStatus::failed, fault.what(), {}};
      is_over_ = is_refused = true;  // what cannot be written now cannot be written later
    }
    if (setup_.tell) setup_.tell(index, report, is_refused);
    return report;
  }

  const PreparedStudy& study_;
  const RunSetup& setup_;
  std::vector<std::optional<RunReport>> reports_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> is_over_{false};
};

}  // namespace

std::vector<std::optional<RunReport>> run_analyses(const PreparedStudy& study, const RunSetup& setup) {
  return Runner(study, setup).run();
}

RunStatus note_unfinished(const PreparedStudy& study, const std::vector<std::optional<RunReport>>& reports,
                          results::Sink& sink) {
  RunStatus status = RunStatus::done;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const std::string& name = study.analyses[i].name;
    if (!reports[i]) {
      sink.conclude(name, "interrupted", "not begun", {});
      continue;
    }
    if (reports[i]->status == RunStatus::done) continue;
    sink.conclude(name, reports[i]->status == RunStatus::failed ? "failed" : "interrupted", reports[i]->message, {});
    if (status == RunStatus::done) status = reports[i]->status;
  }
  return status;
}

}  // namespace rubato::analysis
