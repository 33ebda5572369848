#include <rubato/model/finite_elements/reduction.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::model {
namespace {

void tell(const std::vector<FrequencyEstimate>& estimates, const char* limit, std::vector<std::string>& facts) {
  for (std::size_t i = 0; i < estimates.size(); ++i)
    facts.push_back(fmt::format("{} frequency {}: {:.9g} Hz, estimated error {:.1e}", limit, i + 1,
                                estimates[i].frequency, estimates[i].error));
}

/// The report of a model that has become smaller, under its lock; null: there is none.
const ReductionReport* reduced(const ReductionDescription& description) {
  if (description.method == ReductionMethod::none || !description.store->report) return nullptr;
  const ReductionReport& report = *description.store->report;
  return report.interface + report.modes < report.before && !report.free.empty() ? &report : nullptr;
}

}  // namespace

double ReductionReport::worst() const {
  double worst = 0.0;
  for (const auto* estimates : {&free, &stuck})
    for (const FrequencyEstimate& estimate : *estimates) worst = std::max(worst, estimate.error);
  return worst;
}

std::vector<std::string> facts_of(const ReductionDescription& description) {
  const std::lock_guard lock(description.store->mutex);
  std::vector<std::string> facts;
  if (!description.store->report) return facts;
  const ReductionReport& report = *description.store->report;
  if (report.modes == 0 && report.interface == report.before) {
    facts.push_back(fmt::format("nothing is left to reduce: all {} coordinates are named by parts, `observe` or `keep`",
                                report.before));
    return facts;
  }
  facts.push_back(fmt::format(
      "{}: {} coordinates before, {} after: {} that parts, `observe` and `keep` name, and {} {}{}",
      report.method == ReductionMethod::rubin ? "rubin" : "craig_bampton", report.before,
      report.interface + report.modes, report.interface, report.modes - report.statics,
      report.method == ReductionMethod::rubin ? "free modes" : "modes of the rest",
      report.statics > 0
          ? fmt::format(", and {} static shape{} of even accelerations", report.statics, report.statics == 1 ? "" : "s")
          : ""));
  if (report.method != ReductionMethod::rubin && report.next > 0.0)
    facts.push_back(
        fmt::format("the first mode that was left out, with the named coordinates held, has {:.6g} Hz", report.next));
  tell(report.free, report.stuck.empty() ? "" : "free", facts);
  tell(report.stuck, "stuck", facts);
  return facts;
}

std::string doubt_of(const ReductionDescription& description) {
  constexpr double large = 0.01;
  const std::lock_guard lock(description.store->mutex);
  if (!description.store->report || !(description.store->report->worst() > large)) return "";
  const ReductionReport& report = *description.store->report;
  std::string first;
  for (const auto* estimates : {&report.free, &report.stuck})
    for (std::size_t i = 0; i < estimates->size() && first.empty(); ++i)
      if ((*estimates)[i].error > large)
        first =
            fmt::format("{} of {:.6g} Hz, by about {:.1e}", i + 1, (*estimates)[i].frequency, (*estimates)[i].error);
  return fmt::format(
      "[reduction]: with {} mode{} some of the first {} frequencies are more than 1 % too high, the first "
      "number {}; take more modes, or error = 1e-4",
      report.modes - report.statics, report.modes - report.statics == 1 ? "" : "s", report.free.size(), first);
}

std::string beyond_estimates(const ReductionDescription& description, double highest) {
  const std::lock_guard lock(description.store->mutex);
  const ReductionReport* const report = reduced(description);
  if (!report) return "";
  double judged = report->free.back().frequency;
  if (!report->stuck.empty()) judged = std::min(judged, report->stuck.back().frequency);
  if (!(highest > judged)) return "";
  return fmt::format(
      "it goes up to {:.6g} Hz, and the errors of [reduction] are estimated up to {:.6g} Hz, the first {} frequencies; "
      "beyond them the reduced model may be another one: take frequencies = ... of [reduction] larger",
      highest, judged, report->free.size());
}

std::string modes_beyond_estimates(const ReductionDescription& description, Index count) {
  const std::lock_guard lock(description.store->mutex);
  const ReductionReport* const report = reduced(description);
  const auto judged = report ? static_cast<Index>(report->free.size()) : count;
  if (count <= judged) return "";
  return fmt::format(
      "it asks for {} modes, and the errors of [reduction] are estimated of the first {}: take frequencies = {} of "
      "[reduction]",
      count, judged, count);
}

}  // namespace rubato::model
