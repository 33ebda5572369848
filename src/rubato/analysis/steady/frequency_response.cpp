#include <rubato/analysis/pieces.hpp>
#include <rubato/analysis/steady/frequency_response.hpp>
#include <rubato/analysis/steady/frequency_response_piece.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/steady/frequency_text.hpp>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>

namespace rubato::analysis {
namespace {

/// Cuts a sweep into pieces, one after another, in the order of the rows. The cuts depend on the plan alone.
class Pieces {
 public:
  Pieces(const FrequencyResponsePlan& plan, int lanes)
      : plan_(plan), most_lines_(plan.waveform_points > 0 || plan.structure_follows_point ? 1 : lanes) {
    // Lines side by side stay whole: their rows would mix otherwise.
    constexpr std::size_t most_steps_side_by_side = 4096;
    if (plan.steps.size() > most_steps_side_by_side) most_lines_ = 1;
    steps_a_piece_ = most_lines_ > 1 ? plan.steps.size() : plan.steps_a_piece();
  }

  std::optional<SweepPiece> next() {
    if (line_ >= plan_.sweep.lines()) return std::nullopt;
    if (step_ == 0) lines_ = lines_together(line_);
    SweepPiece piece{line_, lines_, step_, std::min(steps_a_piece_, plan_.steps.size() - step_)};
    step_ += piece.steps;
    if (step_ == plan_.steps.size()) {
      step_ = 0;
      line_ += lines_;
    }
    return piece;
  }

 private:
  int lines_together(long first) {
    const std::size_t width = plan_.sweep.names().size();
    std::vector<double> values(width), others(width);
    plan_.sweep.values(first, values);
    int count = 1;
    for (; count < most_lines_ && first + count < plan_.sweep.lines(); ++count) {
      plan_.sweep.values(first + count, others);
      for (std::size_t i = 0; i < width; ++i)
        if (plan_.divides_lanes[i] && others[i] != values[i]) return count;
    }
    return count;
  }

  const FrequencyResponsePlan& plan_;
  int most_lines_, lines_ = 1;
  std::size_t steps_a_piece_ = 1, step_ = 0;
  long line_ = 0;
};

/// Writes the rows of pieces in their order.
class Tables {
 public:
  Tables(const std::string& name, const FrequencyResponsePlan& plan, const SweepTables& layouts, results::Sink& sink)
      : plan_(plan), layouts_(layouts), main_(sink.open(layouts.main.layout())) {
    linear_ = sink.open(layouts.linear.layout());
    if (plan.waveform_points > 0) waveforms_ = sink.open(layouts.waveforms.layout());
    if (plan.sweep.kind() != Sweep::Kind::random) return;
    bands_.emplace(name, plan);
    band_rows_ = sink.open(bands_->layout());
  }

  void write(const PieceResult& result) {
    append(*main_, result.main, layouts_.main.width());
    append(*linear_, result.linear, layouts_.linear.width());
    if (waveforms_) append(*waveforms_, result.waveforms, layouts_.waveforms.width());
    counts_.add(result.counts);
    if (bands_) take_bands(result);
  }

  /// Writes what is known at the end only.
  void finish() {
    if (bands_) bands_->write(*band_rows_);
  }

  const SweepCounts& counts() const { return counts_; }

 private:
  static void append(results::RowWriter& writer, const std::vector<double>& rows, std::size_t width) {
    for (std::size_t place = 0; place + width <= rows.size(); place += width)
      writer.append({rows.data() + place, width});
  }

  void take_bands(const PieceResult& result) {
    const std::size_t width = layouts_.main.width(), rows = result.main.size() / width;
    for (std::size_t row = 0; row < rows; ++row)
      bands_->take(result.piece.first_step + row % result.piece.steps,
                   {result.main.data() + row * width + layouts_.main.amplitudes(), plan_.observed.size()});
  }

  const FrequencyResponsePlan& plan_;
  const SweepTables& layouts_;
  std::unique_ptr<results::RowWriter> main_, linear_, waveforms_, band_rows_;
  std::optional<BandTable> bands_;
  SweepCounts counts_;
};

/// "N0 = 10, angular_frequency = 7.5 rad/s"
std::string place_of(const FrequencyResponsePlan& plan, double point) {
  const auto steps = static_cast<double>(plan.steps.size());
  const auto line = static_cast<long>(point / steps);
  const auto step = static_cast<std::size_t>(point - static_cast<double>(line) * steps);
  std::vector<double> values(plan.sweep.names().size());
  plan.sweep.values(line, values);
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{} = {:.6g}, ", plan.sweep.names()[i], values[i]);
  return text + frequency_text(plan.frequencies[plan.steps[step].frequency], plan.excitation_factor);
}

std::string points_text(double count) { return fmt::format("{:.0f} point{}", count, count == 1.0 ? "" : "s"); }

/// ", "damper" by 0.12 m a period": of what is observed, that which goes farthest.
std::string drift_text(const FrequencyResponsePlan& plan, const Vector& drift) {
  if (drift.size() == 0) return {};
  Index farthest = 0;
  const double distance = drift.cwiseAbs().maxCoeff(&farthest);
  const Observed& what = plan.observed[static_cast<std::size_t>(farthest)];
  return distance > 0.0
             ? fmt::format(", \"{}\" by {:.6g} {} a period", what.label, distance, what.is_rotation ? "rad" : "m")
             : std::string();
}

/// @param solver  solves points again to say more of them; null: it must not take the time
std::vector<std::string> warnings_of(const FrequencyResponsePlan& plan, const StudyInput& input,
                                     const SweepCounts& counts, PieceSolver* solver) {
  std::vector<std::string> warnings = plan.warnings;
  const auto split = [&](double point) {
    const auto line = static_cast<long>(point / static_cast<double>(plan.steps.size()));
    return std::pair(
        line, static_cast<std::size_t>(point - static_cast<double>(line) * static_cast<double>(plan.steps.size())));
  };
  if (const Tally& negative = counts.negative_loads; negative.count > 0.0) {
    const auto [line, step] = split(negative.first);
    if (!solver)
      warnings.push_back(
          fmt::format("at {} a normal load is negative: it cannot be pulled, and counts as 0 ({} with "
                      "negative loads)",
                      place_of(plan, negative.first), points_text(negative.count)));
    else
      for (const auto& [slider, load] : solver->negative_loads(line, step)) {
        warnings.push_back(fmt::format(
            "at {} the normal load of slider \"{}\" is {:.6g} N: it cannot be pulled, and counts "
            "as 0 ({} with negative loads)",
            place_of(plan, negative.first), input.study.model.sliders[slider].name, load, points_text(negative.count)));
        break;
      }
  }
  if (const Tally& far = counts.excursions; far.count > 0.0) {
    const auto [line, step] = split(far.first);
    const std::string told = solver ? solver->excursion(line, step) : "the motion is no small one";
    warnings.push_back(
        fmt::format("at {} {} ({} with such a motion)", place_of(plan, far.first), told, points_text(far.count)));
  }
  if (const Tally& unbounded = counts.of(PointStatus::unbounded); unbounded.count > 0.0)
    warnings.push_back(fmt::format(
        "at {} the loads meet a resonance without damping, or push what nothing holds: the response is infinite ({})",
        place_of(plan, unbounded.first), points_text(unbounded.count)));
  if (const Tally& drifting = counts.of(PointStatus::drifting); drifting.count > 0.0) {
    const auto [line, step] = split(drifting.first);
    warnings.push_back(
        fmt::format("at {} the structure walks over its sliders{}, and has no steady place; only a "
                    "spring would give it one ({})",
                    place_of(plan, drifting.first), solver ? drift_text(plan, solver->drift(line, step)) : "",
                    points_text(drifting.count)));
  }
  if (const Tally& impossible = counts.of(PointStatus::impossible); impossible.count > 0.0) {
    const auto [line, step] = split(impossible.first);
    warnings.push_back(fmt::format("at {} nothing can be computed ({}){}", place_of(plan, impossible.first),
                                   points_text(impossible.count), solver ? ": " + solver->reason(line, step) : ""));
  }
  if (const Tally& lost = counts.of(PointStatus::not_converged); lost.count > 0.0)
    warnings.push_back(
        fmt::format("at {} the solution did not converge ({}): the rows hold the best that was found; try another "
                    "solver = ..., or a looser tolerance",
                    place_of(plan, lost.first), points_text(lost.count)));
  return warnings;
}

}  // namespace

RunReport run_frequency_response(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input,
                                 const steady::SteadySolvers& solvers, RunContext& context) {
  const SweepTables layouts{{name, plan, input}, {name, plan}, {name, plan, input}};
  context.progress.begin(name, plan.points(), "points");
  SweepProgress progress(context.progress, plan.system(input).size() > 100 ? 1 : 64);
  tbb::enumerable_thread_specific<std::unique_ptr<PieceSolver>> workers;
  const auto worker = [&]() -> PieceSolver& {
    auto& mine = workers.local();
    if (!mine) mine = std::make_unique<PieceSolver>(plan, input, solvers, layouts, progress, context.stop);
    return *mine;
  };
  Tables tables(name, plan, layouts, context.sink);
  Pieces pieces(plan, worker().lanes());

  PieceWork<SweepPiece, PieceResult> work;
  work.next = [&] { return pieces.next(); };
  work.recall = [&](const SweepPiece& piece, const std::vector<double>& values) {
    PieceResult result = PieceResult::unpacked(piece, layouts, values);
    progress.add(static_cast<long>(result.counts.total()));
    return result;
  };
  work.solve = [&](const SweepPiece& piece) { return worker().solve(piece); };
  work.write = [&](const PieceResult& result) { tables.write(result); };
  (void)work_in_pieces(work, context);
  tables.finish();
  const SweepCounts& counts = tables.counts();
  context.progress.advance(counts.total());
  context.progress.end();

  RunReport report;
  if (counts.total() < plan.points()) {
    report.status = RunStatus::interrupted;
    report.message = fmt::format("interrupted after {:.0f} of {:.0f} points", counts.total(), plan.points());
  } else if (const double lost = counts.of(PointStatus::not_converged).count + counts.of(PointStatus::impossible).count;
             lost == counts.total()) {
    report.status = RunStatus::failed;
    report.message = "no point was solved; the warnings and the column `status` say why";
  }
  report.statistics = {{"points", fmt::format("{:.0f}", counts.total())}};
  counts.describe(report.statistics);
  report.statistics.emplace_back("iterations", fmt::format("{:.0f}", counts.iterations));
  report.warnings = warnings_of(plan, input, counts, report.status == RunStatus::interrupted ? nullptr : &worker());
  return report;
}

}  // namespace rubato::analysis
