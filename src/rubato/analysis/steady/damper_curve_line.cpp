#include <rubato/analysis/steady/damper_curve_line.hpp>
#include <rubato/core/stopping.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::size_t place(PointStatus status) { return static_cast<std::size_t>(status); }

/// Numbers that follow peaks from one value of the parameter to the next: a peak takes the number of the nearest one of
/// the same curve, unless that is a tenth of the frequencies away, or nearer to another.
class PeakNumbers {
 public:
  explicit PeakNumbers(const DamperCurvePlan& plan) : reach_(0.1 * (plan.to - plan.from)) {}

  std::vector<long> next(const std::vector<Peak>& peaks) {
    std::vector<long> numbers(peaks.size(), 0);
    std::vector<bool> is_taken(known_.size(), false);
    for (;;) {
      std::size_t best_new = peaks.size(), best_known = 0;
      double least = reach_;
      for (std::size_t i = 0; i < peaks.size(); ++i)
        for (std::size_t k = 0; k < known_.size(); ++k) {
          const double distance = std::abs(peaks[i].at - known_[k].peak.at);
          if (numbers[i] > 0 || is_taken[k] || peaks[i].curve != known_[k].peak.curve || distance > least) continue;
          least = distance;
          best_new = i;
          best_known = k;
        }
      if (best_new == peaks.size()) break;
      numbers[best_new] = known_[best_known].number;
      is_taken[best_known] = true;
    }
    known_.clear();
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      if (numbers[i] == 0) numbers[i] = ++last_;
      known_.push_back({peaks[i], numbers[i]});
    }
    return numbers;
  }

 private:
  struct Known {
    Peak peak;
    long number;
  };
  double reach_;
  std::vector<Known> known_;
  long last_ = 0;
};

void count_value(const DamperValue& value, double number, DamperCurveCounts& counts) {
  counts.of(value.status).note(number);
  counts.unconverged_samples += static_cast<double>(value.scan.by_status[place(PointStatus::not_converged)]);
  for (const long samples : value.scan.by_status) counts.solves += static_cast<double>(samples);
  if (value.moves_far) counts.excursions.note(number);
  if (value.scan.has_negative_load) counts.negative_loads.note(number);
  if (value.scan.by_status[place(PointStatus::drifting)] > 0) counts.walks.note(number);
  if (value.status == PointStatus::converged && value.peaks.front().kind != Peak::Kind::interior &&
      value.peaks.front().value > 0.0)
    counts.at_ends.note(number);
}

struct FoundOptimum {
  Optimum optimum;
  steady::SteadyResponse response;  ///< with the largest error of all active peaks
};

/// The optimum, all of whose values share one discretisation: that of the best value and its neighbours. Where the
/// error exceeds the tolerance it is sought again with what that needs.
std::optional<FoundOptimum> optimum_of(const DamperCurvePlan& plan, const std::vector<DamperValue>& values,
                                       const std::vector<double>& objectives, DamperPeaks& family) {
  constexpr int most_rounds = 3;
  const auto sought = [&] { return find_optimum(family, plan.values, objectives, plan.sign(), plan.noise); };
  std::optional<steady::SteadyDiscretisation> shared;
  const auto include = [&](const std::optional<steady::SteadyDiscretisation>& other) {
    if (shared && other) shared->include(*other);
    if (!shared) shared = other;
  };
  if (plan.is_truncated()) {
    std::size_t best = values.size();
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(objectives[i]) &&
          (best == values.size() || plan.sign() * objectives[i] < plan.sign() * objectives[best]))
        best = i;
    for (std::size_t i = best == 0 ? 0 : best - 1; i < values.size() && i <= best + 1; ++i)
      include(values[i].discretisation);
  }
  std::optional<FoundOptimum> found;
  for (int round = 0; round < most_rounds; ++round) {
    family.share(shared);
    const auto optimum = sought();
    if (!optimum) return std::nullopt;
    double error = 0.0;
    for (std::size_t i = optimum->active.size(); i-- > 0;) {
      found = {*optimum, family.response_at(optimum->parameter, optimum->active[i])};
      error = std::max(error, found->response.error);
    }
    found->response.error = error;
    if (!shared || error <= plan.route.tolerance) return found;
    const steady::SteadyDiscretisation before = *shared;
    for (const Peak& peak : optimum->active) include(family.needed_at(optimum->parameter, peak.at));
    if (before == *shared) return found;
  }
  return found;
}

}  // namespace

void DamperCurveCounts::add(const DamperCurveCounts& other) {
  StatusCounts::add(other);
  solves += other.solves;
  unconverged_samples += other.unconverged_samples;
  without_optimum += other.without_optimum;
  at_ends.add(other.at_ends);
  walks.add(other.walks);
}

std::vector<double> DamperLineResult::packed() const {
  std::vector<double> values{static_cast<double>(line)};
  counts.pack(values);
  values.insert(values.end(), {counts.solves, counts.unconverged_samples, counts.without_optimum, counts.at_ends.count,
                               counts.at_ends.first, counts.walks.count, counts.walks.first});
  for (const auto* rows : {&main, &linear, &peaks, &optimum}) {
    values.push_back(static_cast<double>(rows->size()));
    values.insert(values.end(), rows->begin(), rows->end());
  }
  return values;
}

DamperLineResult DamperLineResult::unpacked(long line, const DamperCurveTables& tables,
                                            std::span<const double> values) {
  DamperLineResult result;
  result.line = line;
  PackedNumbers numbers(values);
  numbers.expect(static_cast<double>(line));
  DamperCurveCounts& counts = result.counts;
  counts.unpack(numbers);
  for (double* value : {&counts.solves, &counts.unconverged_samples, &counts.without_optimum, &counts.at_ends.count,
                        &counts.at_ends.first, &counts.walks.count, &counts.walks.first})
    *value = numbers.next();
  result.main = numbers.rows(tables.main().row_width());
  result.linear = numbers.rows(tables.linear().row_width());
  result.peaks = numbers.rows(tables.peaks().row_width());
  result.optimum = numbers.rows(tables.optimum().row_width());
  numbers.expect_end();
  return result;
}

namespace {

/// What became of a peak whose response is known: where points beside it do not converge it is the best found, and
/// none.
PointStatus status_of(const Peak& peak, const steady::SteadyResponse& response) {
  const PointStatus status = point_status(response.status);
  return status == PointStatus::converged && !peak.is_closed ? PointStatus::not_converged : status;
}

}  // namespace

DamperValue solve_value(DamperPeaks& family, double parameter, bool with_peaks, bool with_limits) {
  DamperValue value;
  value.is_done = true;
  value.peaks = family.peaks(parameter);
  value.scan = family.scan();
  value.discretisation = family.discretisation();
  const auto count = [&](PointStatus status) { return value.scan.by_status[place(status)]; };
  if (count(PointStatus::unbounded) > 0) {
    // However high the peaks beside it are: this one is infinite.
    value.status = PointStatus::unbounded;
    value.peaks = {{0, value.scan.first_unbounded, HUGE_VAL, 0.0, Peak::Kind::interior}};
    value.response = {};
    value.response.amplitude = Vector::Constant(static_cast<Index>(family.observed()), HUGE_VAL);
    value.response.residual = value.response.error = nothing;
  } else if (!value.peaks.empty()) {
    value.response = family.response_at(parameter, value.peaks.front());
    value.status = status_of(value.peaks.front(), value.response);
    value.moves_far = !family.excursion().empty();
  } else if (count(PointStatus::drifting) > 0) {
    value.status = PointStatus::drifting;
  } else if (count(PointStatus::impossible) > 0) {
    value.status = PointStatus::impossible;
  }
  for (std::size_t k = 0; with_peaks && k < value.peaks.size(); ++k) {
    const bool is_highest = k == 0;
    const auto& response = is_highest ? value.response : family.response_at(parameter, value.peaks[k]);
    value.peak_status.push_back(is_highest ? value.status : status_of(value.peaks[k], response));
    value.peak_error.push_back(response.error);
  }
  if (with_limits) {
    value.limits.emplace();
    for (const bool is_stuck : {false, true}) {
      const auto peaks = family.limit_peaks(parameter, is_stuck);
      if (!peaks.empty()) (*value.limits)[is_stuck ? 1 : 0] = peaks.front();
    }
  }
  return value;
}

DamperLineResult finish_line(const DamperCurvePlan& plan, const DamperCurveTables& tables, long line,
                             const std::vector<DamperValue>& values, DamperPeaks& family) {
  DamperLineResult result;
  result.line = line;
  std::vector<double> keys(plan.sweep.names().size());
  plan.sweep.values(line, keys);
  PeakNumbers numbers(plan);
  std::vector<double> objectives(values.size(), nothing);
  const double before = static_cast<double>(line) * static_cast<double>(plan.values.size());
  std::array<std::optional<Peak>, 2> limits;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const DamperValue& value = values[i];
    if (!value.is_done) {
      result.is_whole = false;
      break;
    }
    const double parameter = plan.values[i];
    std::optional<Peak> top;
    if (!value.peaks.empty()) top = value.peaks.front();
    if (value.status == PointStatus::converged) objectives[i] = top->value;
    tables.add(keys, parameter, top, value.peaks.size(), value.response, value.status, result.main);
    const auto found = numbers.next(value.peaks);
    for (std::size_t k = 0; k < value.peak_status.size(); ++k)
      tables.add_peak(keys, parameter, found[k], value.peaks[k], value.peak_error[k], value.peak_status[k],
                      result.peaks);
    if (value.limits) limits = *value.limits;
    tables.add_limits(keys, parameter, limits[0], limits[1], result.linear);
    count_value(value, before + static_cast<double>(i), result.counts);
  }
  if (!result.is_whole || !plan.has_optimum) return result;

  const double solved = family.solves();
  try {
    if (const auto optimum = optimum_of(plan, values, objectives, family)) {
      tables.add_optimum(keys, optimum->optimum, optimum->response, result.optimum);
    } else {
      result.counts.without_optimum += 1.0;
    }
  } catch (const Stopped&) {
    result.is_whole = false;
  }
  family.share(std::nullopt);
  result.counts.solves += family.solves() - solved;
  return result;
}

}  // namespace rubato::analysis
