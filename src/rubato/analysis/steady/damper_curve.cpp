#include <rubato/analysis/pieces.hpp>
#include <rubato/analysis/steady/damper_curve.hpp>
#include <rubato/analysis/steady/damper_curve_line.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response_piece.hpp>
#include <rubato/analysis/steady/frequency_text.hpp>
#include <rubato/analysis/sweep_samples.hpp>
#include <rubato/core/stopping.hpp>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace rubato::analysis {
namespace {

/// Writes the rows of lines in their order, and keeps what is to be told at the end.
class Tables {
 public:
  Tables(const DamperCurvePlan& plan, const DamperCurveTables& layouts, results::Sink& sink)
      : plan_(plan), layouts_(layouts), main_(sink.open(layouts.main())), objectives_(plan.values.size()) {
    const bool is_random = plan.sweep.kind() == Sweep::Kind::random;
    if (!is_random && plan.objective == DamperCurvePlan::Objective::amplitude) linear_ = sink.open(layouts.linear());
    if (!is_random) peaks_ = sink.open(layouts.peaks());
    if (plan.has_optimum) optimum_ = sink.open(layouts.optimum());
    if (is_random) bands_ = sink.open(layouts.bands());
  }

  bool has_limits() const { return linear_ != nullptr; }

  void write(const DamperLineResult& result) {
    append(main_.get(), result.main, layouts_.main());
    append(linear_.get(), result.linear, layouts_.linear());
    append(peaks_.get(), result.peaks, layouts_.peaks());
    append(optimum_.get(), result.optimum, layouts_.optimum());
    if (!result.optimum.empty()) {
      last_optimum_ = result.optimum;
      ++optima_;
      if (static_cast<Optimum::Kind>(of_optimum("kind")) == Optimum::Kind::flat) {
        ++flat_;
      } else {
        const double at = result.optimum[plan_.sweep.names().size()];
        lowest_ = std::min(lowest_, at);
        highest_ = std::max(highest_, at);
      }
    }
    counts_.add(result.counts);
    if (!bands_) return;
    const std::size_t width = layouts_.main().row_width();
    for (std::size_t i = 0; (i + 1) * width <= result.main.size(); ++i)
      objectives_[i].push_back(result.main[i * width + layouts_.objective()]);
  }

  /// Writes what is known at the end only.
  void finish() {
    if (!bands_) return;
    for (std::size_t i = 0; i < objectives_.size(); ++i) {
      auto& samples = objectives_[i];
      const auto end = std::remove_if(samples.begin(), samples.end(), [](double x) { return std::isnan(x); });
      const auto missing = static_cast<double>(samples.end() - end);
      samples.erase(end, samples.end());
      std::vector<double> row{plan_.values[i]};
      for (const int percent : band_percents) row.push_back(percentile(samples, percent / 100.0));
      row.push_back(missing);
      bands_->append(row);
    }
  }

  const DamperCurveCounts& counts() const { return counts_; }

  /// What was found, in a line; empty where nothing was.
  std::string finding() const {
    if (last_optimum_.empty()) return {};
    const bool is_amplitude = plan_.objective == DamperCurvePlan::Objective::amplitude;
    const std::string what = is_amplitude ? "lowest amplitude" : "largest friction work";
    if (plan_.sweep.lines() > 1) {
      const std::string flat = flat_ == 0 ? "" : fmt::format("; {} do not depend on it there", flat_);
      if (flat_ == optima_)
        return fmt::format("{}: none of {} combinations depends on {}", what, optima_, plan_.parameter);
      return fmt::format("{} at {} = {:.7g} to {:.7g}, over {} combinations{}", what, plan_.parameter, lowest_,
                         highest_, optima_, flat);
    }
    const std::size_t at = plan_.sweep.names().size();
    const double frequency = last_optimum_[at + 1], objective = last_optimum_[layouts_.objective()];
    return fmt::format("{} {:.9g} {} at {} = {:.9g}, {}{}", what, objective, unit_of("objective"), plan_.parameter,
                       last_optimum_[at], frequency_text(frequency, plan_.excitation_factor), certificate()) +
           (plan_.is_truncated() ? fmt::format("; estimated error {:.1g}", of_optimum("error")) : std::string());
  }

 private:
  static void append(results::RowWriter* writer, const std::vector<double>& rows, const results::TableLayout& layout) {
    const std::size_t width = layout.row_width();
    if (!writer) return;
    for (std::size_t place = 0; place + width <= rows.size(); place += width)
      writer->append({rows.data() + place, width});
  }

  std::string unit_of(const std::string& variable) const {
    const auto& blocks = layouts_.optimum().blocks;
    return std::find_if(blocks.begin(), blocks.end(), [&](const auto& block) { return block.variable == variable; })
        ->unit;
  }

  double of_optimum(const std::string& variable) const {
    std::size_t place = 0;
    for (const auto& block : layouts_.optimum().blocks) {
      if (block.variable == variable) break;
      place += block.width();
    }
    return last_optimum_[place];
  }

  std::string certificate() const {
    const bool is_cut = static_cast<Peak::Kind>(of_optimum("place")) != Peak::Kind::interior;
    if (is_cut) return ", at an end of the frequencies: widen them";
    switch (static_cast<Optimum::Kind>(of_optimum("kind"))) {
      case Optimum::Kind::smooth:
        return ", where both derivatives vanish";
      case Optimum::Kind::kink:
        return ", where two peaks are equal";
      case Optimum::Kind::corner:
        return ", a corner of the curve";
      case Optimum::Kind::bound:
        return ", the end of the range, beyond which it goes on";
      case Optimum::Kind::flat:
        return ", and all around it";
      case Optimum::Kind::uncertified:
        return ", the best found, without a certificate";
    }
    return {};
  }

  const DamperCurvePlan& plan_;
  const DamperCurveTables& layouts_;
  std::unique_ptr<results::RowWriter> main_, linear_, peaks_, optimum_, bands_;
  DamperCurveCounts counts_;
  std::vector<std::vector<double>> objectives_;  ///< of random samples, by value of the parameter
  std::vector<double> last_optimum_;
  double lowest_ = HUGE_VAL, highest_ = -HUGE_VAL;
  long optima_ = 0, flat_ = 0;
};

std::string values_text(double count) { return fmt::format("{:.0f} value{}", count, count == 1.0 ? "" : "s"); }

class Warnings {
 public:
  /// @param family  solves values again to say more of them; null: it must not take the time
  Warnings(const DamperCurvePlan& plan, const StudyInput& input, const DamperCurveCounts& counts, DamperPeaks* family)
      : plan_(plan), input_(input), counts_(counts), family_(family) {}

  std::vector<std::string> all() {
    std::vector<std::string> warnings = plan_.warnings;
    if (const Tally& negative = counts_.negative_loads; negative.count > 0.0) {
      const auto scan = scan_of(negative.first);
      const std::string which =
          family_ ? fmt::format("the normal load of slider \"{}\" is {:.6g} N",
                                input_.study.model.sliders[scan.negative_slider].name, scan.negative_load)
                  : "a normal load is negative";
      warnings.push_back(fmt::format("at {} {}: it cannot be pulled, and counts as 0 ({} with negative loads)",
                                     place_of(negative.first), which, values_text(negative.count)));
    }
    if (counts_.at_ends.count > 0.0)
      warnings.push_back(fmt::format("at {} the largest lies at an end of the frequencies ({}); widen them",
                                     place_of(counts_.at_ends.first), values_text(counts_.at_ends.count)));
    if (const Tally& far = counts_.excursions; far.count > 0.0)
      warnings.push_back(
          fmt::format("at {} {} ({})", place_of(far.first), excursion_of(far.first), values_text(far.count)));
    if (const Tally& unbounded = counts_.of(PointStatus::unbounded); unbounded.count > 0.0)
      warnings.push_back(fmt::format(
          "at {} the loads meet a resonance without damping, or push what nothing holds: the response is infinite ({})",
          place_of(unbounded.first), values_text(unbounded.count)));
    if (counts_.walks.count > 0.0)
      warnings.push_back(
          fmt::format("at {} and some frequencies the structure walks over its sliders, and has no "
                      "steady place; they are left out ({})",
                      place_of(counts_.walks.first), values_text(counts_.walks.count)));
    if (const Tally& impossible = counts_.of(PointStatus::impossible); impossible.count > 0.0)
      warnings.push_back(fmt::format("at {} nothing can be computed ({}){}", place_of(impossible.first),
                                     values_text(impossible.count),
                                     family_ ? ": " + scan_of(impossible.first).reason : ""));
    if (const Tally& lost = counts_.of(PointStatus::not_converged); lost.count > 0.0)
      warnings.push_back(fmt::format("at {} the highest response did not converge ({})", place_of(lost.first),
                                     values_text(lost.count)));
    if (counts_.unconverged_samples > 0.0)
      warnings.push_back(fmt::format("{:.0f} of {:.0f} points solved did not converge: a peak may have been missed",
                                     counts_.unconverged_samples, counts_.solves));
    if (counts_.without_optimum > 0.0)
      warnings.push_back(fmt::format("{:.0f} of {} combinations have no optimum: no value of {} has a finite objective",
                                     counts_.without_optimum, plan_.sweep.lines(), plan_.parameter));
    return warnings;
  }

 private:
  std::pair<long, std::size_t> split(double number) const {
    const auto width = static_cast<double>(plan_.values.size());
    const auto line = static_cast<long>(number / width);
    return {line, static_cast<std::size_t>(number - static_cast<double>(line) * width)};
  }

  std::string place_of(double number) const {
    const auto [line, value] = split(number);
    std::vector<double> values(plan_.sweep.names().size());
    plan_.sweep.values(line, values);
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
      text += fmt::format("{} = {:.6g}, ", plan_.sweep.names()[i], values[i]);
    return text + fmt::format("{} = {:.6g}", plan_.parameter, plan_.values[value]);
  }

  DamperPeaks::Scan scan_of(double number) {
    if (!family_) return {};
    const auto [line, value] = split(number);
    family_->take_line(line);
    (void)family_->peaks(plan_.values[value]);
    return family_->scan();
  }

  /// What the highest peak of a value of a mechanism does beyond small motions.
  std::string excursion_of(double number) {
    const std::string any = "the highest peak is no small motion";
    if (!family_) return any;
    const auto [line, value] = split(number);
    family_->take_line(line);
    const auto peaks = family_->peaks(plan_.values[value]);
    if (peaks.empty()) return any;
    (void)family_->response_at(plan_.values[value], peaks.front());
    const std::string told = family_->excursion();
    return told.empty() ? any : told;
  }

  const DamperCurvePlan& plan_;
  const StudyInput& input_;
  const DamperCurveCounts& counts_;
  DamperPeaks* family_;
};

/// Solves lines of the sweep; the values of one side by side where there are few lines.
class Lines {
 public:
  Lines(const DamperCurvePlan& plan, const StudyInput& input, const steady::SteadySolvers& solvers,
        const DamperCurveTables& layouts, bool with_limits, SweepProgress& progress, const std::atomic<bool>& stop)
      : plan_(plan), layouts_(layouts), with_limits_(with_limits), progress_(progress), stop_(stop), families_([&] {
          return std::make_unique<DamperPeaks>(plan, input, solvers, stop);
        }) {}

  DamperLineResult solve(long line, bool side_by_side) {
    std::vector<DamperValue> values(plan_.values.size());
    const StopScope scope(stop_);
    const auto solve_one = [&](std::size_t i) {
      if (stop_.load()) return;
      const StopScope scope_of_thread(stop_);
      DamperPeaks& family = *families_.local();
      family.take_line(line);
      try {
        DamperValue value = solve_value(family, plan_.values[i], plan_.sweep.kind() != Sweep::Kind::random,
                                        with_limits_ && (i == 0 || plan_.limits_follow_parameter));
        if (stop_.load()) return;  // what was broken off is no result
        values[i] = std::move(value);
      } catch (const Stopped&) {
        return;
      }
      progress_.add(1);
    };
    if (side_by_side)
      tbb::parallel_for(std::size_t{0}, values.size(), solve_one, tbb::simple_partitioner());
    else
      for (std::size_t i = 0; i < values.size(); ++i) solve_one(i);
    DamperPeaks& family = *families_.local();
    family.take_line(line);
    DamperLineResult result = finish_line(plan_, layouts_, line, values, family);
    if (stop_.load()) {
      result.is_whole = false;
      result.optimum.clear();
      result.counts.without_optimum = 0.0;  // nobody has looked for it
    }
    return result;
  }

 private:
  const DamperCurvePlan& plan_;
  const DamperCurveTables& layouts_;
  bool with_limits_;
  SweepProgress& progress_;
  const std::atomic<bool>& stop_;
  tbb::enumerable_thread_specific<std::unique_ptr<DamperPeaks>> families_;
};

}  // namespace

steady::SteadySolvers damper_curve_solvers(const DamperCurvePlan& plan) {
  steady::SteadyRoute route = plan.route;
  // Peaks are where differences of amplitudes vanish: these want all digits (see find_peaks).
  if (!plan.is_truncated()) route.tolerance = 1e-13;
  return steady::steady_solvers(route);
}

RunReport run_damper_curve(const std::string& name, const DamperCurvePlan& plan, const StudyInput& input,
                           const steady::SteadySolvers& solvers, RunContext& context) {
  const DamperCurveTables layouts(name, plan, input);
  Tables tables(plan, layouts, context.sink);
  context.progress.begin(name, plan.points(), "values");
  SweepProgress progress(context.progress, 1);
  Lines lines(plan, input, solvers, layouts, tables.has_limits(), progress, context.stop);

  const bool side_by_side = plan.sweep.lines() < pieces_at_once(context);
  long next = 0;
  PieceWork<long, DamperLineResult> work;
  work.next = [&] { return next < plan.sweep.lines() ? std::optional(next++) : std::nullopt; };
  work.recall = [&](long line, const std::vector<double>& values) {
    DamperLineResult result = DamperLineResult::unpacked(line, layouts, values);
    progress.add(static_cast<long>(result.counts.total()));
    return result;
  };
  work.solve = [&](long line) { return lines.solve(line, side_by_side); };
  work.write = [&](const DamperLineResult& result) { tables.write(result); };
  const bool was_interrupted = work_in_pieces(work, context);
  tables.finish();
  const DamperCurveCounts& counts = tables.counts();
  context.progress.advance(counts.total());
  context.progress.end();

  RunReport report;
  const double lost = counts.of(PointStatus::not_converged).count + counts.of(PointStatus::impossible).count;
  if (was_interrupted || counts.total() < plan.points()) {
    report.status = RunStatus::interrupted;
    report.message =
        counts.total() < plan.points() || !plan.has_optimum
            ? fmt::format("interrupted after {:.0f} of {:.0f} values", counts.total(), plan.points())
            : fmt::format("interrupted after all {:.0f} values, in the search for the optimum", counts.total());
  } else if (lost == counts.total()) {
    report.status = RunStatus::failed;
    report.message = "no value has a peak; the warnings and the column `status` say why";
  }
  report.statistics = {{"values", fmt::format("{:.0f}", counts.total())},
                       {"solver", steady::route_name(plan.route.kind)},
                       {"points_solved", fmt::format("{:.0f}", counts.solves)}};
  counts.describe(report.statistics);
  DamperPeaks witness(plan, input, solvers, context.stop);
  report.warnings = Warnings(plan, input, counts, report.status == RunStatus::interrupted ? nullptr : &witness).all();
  if (const std::string finding = tables.finding(); !finding.empty()) report.findings = {finding};
  if (!plan.chosen_for.empty())
    report.findings.push_back(fmt::format("solved by harmonic_balance: {}", plan.chosen_for));
  return report;
}

}  // namespace rubato::analysis
