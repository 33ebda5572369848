#include <rubato/analysis/steady/damper_peaks.hpp>
#include <rubato/steady/linear/linear_limits.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

constexpr int most_rounds = 3;         // of finer and finer discretisations
constexpr double least_checked = 0.1;  // of the highest peak: whose errors are looked at

std::vector<std::size_t> line_places(const DamperCurvePlan& plan) {
  std::vector<std::size_t> places = plan.sweep.places();
  places.push_back(plan.place);
  return places;
}

/// With its place where it has one.
std::string reason_of(const InvalidInput& fault) { return fault.where().file.empty() ? fault.message() : fault.what(); }

}  // namespace

DamperPeaks::DamperPeaks(const DamperCurvePlan& plan, const StudyInput& input, const steady::SteadySolvers& solvers,
                         const std::atomic<bool>& stop)
    : plan_(plan),
      input_(input),
      make_(solvers),
      stop_(stop),
      drive_(input, plan.dependence, line_places(plan), plan.excitation),
      values_(plan.sweep.names().size() + 1) {}

void DamperPeaks::take_line(long line) { plan_.sweep.values(line, {values_.data(), values_.size() - 1}); }

/// Builds the structure at the present values unless it is there.
void DamperPeaks::require_structure(double point) {
  std::vector<double> wanted;
  for (std::size_t i = 0; i < plan_.is_structural.size(); ++i)
    if (plan_.is_structural[i]) wanted.push_back(values_[i]);
  if (plan_.structure_follows_parameter) wanted.push_back(values_.back());
  if (plan_.structure_follows_frequency) wanted.push_back(point);
  if (structure_ && wanted == structure_values_) return;
  solver_.reset();
  coarse_.reset();
  free_.reset();
  stuck_.reset();
  structure_.reset();
  structure_ = std::make_unique<SteadyModel>(build_steady_model(input_.study, drive_.parameters_at(values_, point)));
  const steady::SteadyRequest request = structure_->request(plan_.observed, plan_.request);
  solver_ = make_.response(structure_->system(), request);
  coarse_ = make_.coarse(structure_->system(), request);
  solver_->hold(held_, false);
  natural_ = steady::natural_frequencies(structure_->system(), plan_.highest);
  structure_values_ = std::move(wanted);
}

/// Goes to a value of the parameter; false where no model has it.
bool DamperPeaks::take(double parameter, bool begins_afresh) {
  values_.back() = parameter;
  try {
    require_structure(plan_.excitation_factor * plan_.from);
    if (structure_->about)
      require_swinging_loads(input_.study.model, drive_.parameters_at(values_, plan_.excitation_factor * plan_.from));
    drive_.take_line(values_, structure_->assembled);
    if (begins_afresh)
      for (const auto* solver : {&solver_, &free_, &stuck_})
        if (*solver) (*solver)->forget();
    return true;
  } catch (const InvalidInput& fault) {
    ++scan_.by_status[static_cast<std::size_t>(PointStatus::impossible)];
    if (scan_.reason.empty()) scan_.reason = reason_of(fault);
    return false;
  }
}

/// Goes to a frequency; false where no model has it.
bool DamperPeaks::take_point(double angular_frequency) {
  const double point = plan_.excitation_factor * angular_frequency;
  try {
    if (plan_.structure_follows_frequency) {
      require_structure(point);
      drive_.take_line(values_, structure_->assembled);
    }
    drive_.take_point(point, excitation_);
  } catch (const InvalidInput& fault) {
    ++scan_.by_status[static_cast<std::size_t>(PointStatus::impossible)];
    if (scan_.reason.empty()) scan_.reason = reason_of(fault);
    return false;
  }
  if (!scan_.has_negative_load && !drive_.negative_loads().empty()) {
    const auto& [slider, load] = drive_.negative_loads().front();
    scan_.has_negative_load = true;
    scan_.negative_slider = slider;
    scan_.negative_load = load;
  }
  return true;
}

bool DamperPeaks::evaluate(steady::SteadySolver& solver, double angular_frequency, Vector& values) {
  solver.solve(excitation_, steady::SteadyStart::unloaded, response_);
  ++solves_;
  const PointStatus status = point_status(response_.status);
  if (status == PointStatus::unbounded && scan_.by_status[static_cast<std::size_t>(status)] == 0)
    scan_.first_unbounded = angular_frequency;
  ++scan_.by_status[static_cast<std::size_t>(status)];
  if (status != PointStatus::converged) return false;
  if (plan_.objective == DamperCurvePlan::Objective::amplitude)
    values = response_.amplitude;
  else
    values.setConstant(1, response_.dissipated.sum() + response_.law_dissipated.sum());
  return true;
}

/// The scan is equally spaced, and looks besides wherever a harmonic of the loads meets a natural frequency: a peak is
/// narrow only where the sliders hardly dissipate, which is near one of the two limits.
PeakRange DamperPeaks::range() {
  PeakRange range{plan_.from, plan_.to, plan_.samples, {}, plan_.noise};
  const double middle = 0.5 * (plan_.from + plan_.to);
  if (!take_point(middle)) return range;
  for (const auto& harmonic : excitation_.harmonics) {
    const double ratio = middle / (harmonic.order * excitation_.angular_frequency);
    for (const double frequency : natural_) range.besides.push_back(ratio * frequency);
  }
  return range;
}

/// Besides where a coarse scan has extremes: of two close peaks the samples alone might show one. What it finds does
/// not depend on what was solved before, and its points are not told of. The first harmonics tell by their phases, too,
/// of a peak that lies between samples.
PeakRange DamperPeaks::range_with_extremes() {
  PeakRange wanted = range();
  const Scan told = scan_;
  const double solves = solves_;
  coarse_->forget();
  std::vector<std::pair<double, double>> scanned;
  const bool has_amplitudes = plan_.objective == DamperCurvePlan::Objective::amplitude;
  const auto sought = has_amplitudes ? static_cast<Index>(observed()) : Index{1};
  const auto extremes = find_extremes(
      [&](double w, Vector& values) {
        if (stop_.load() || !take_point(w) || !evaluate(*coarse_, w, objective_)) return false;
        const auto first = response_.harmonics.col(0);
        values.resize(sought + 3 * response_.amplitude.size());
        values << objective_, response_.amplitude, first.real(), first.imag();
        scanned.emplace_back(w, objective_.maxCoeff());
        return true;
      },
      wanted, sought);
  wanted.besides.insert(wanted.besides.end(), extremes.begin(), extremes.end());
  scan_ = told;
  solves_ = solves;
  high_places_.clear();
  const auto by_height = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto highest = std::max_element(scanned.begin(), scanned.end(), by_height);
  for (const auto& place : scanned)
    if (place == *highest || (place.second > 0.3 * highest->second &&
                              std::find(extremes.begin(), extremes.end(), place.first) != extremes.end()))
      high_places_.push_back(place);
  return wanted;
}

void DamperPeaks::hold(const std::optional<steady::SteadyDiscretisation>& held, bool with_error) {
  held_ = held;
  if (solver_) solver_->hold(held_, with_error);
}

void DamperPeaks::share(const std::optional<steady::SteadyDiscretisation>& shared) {
  is_shared_ = shared.has_value();
  hold(shared);
}

/// Adds what the response at a frequency needs to come within the tolerance.
void DamperPeaks::include_what_is_needed(double angular_frequency, std::optional<steady::SteadyDiscretisation>& sum) {
  solver_->hold(std::nullopt);
  solver_->forget();
  Vector values;
  if (stop_.load() || !take_point(angular_frequency) || !evaluate(*solver_, angular_frequency, values)) return;
  if (sum)
    sum->include(solver_->discretisation());
  else
    sum = solver_->discretisation();
}

std::optional<steady::SteadyDiscretisation> DamperPeaks::needed_at(double parameter, double angular_frequency) {
  std::optional<steady::SteadyDiscretisation> needed;
  if (!take(parameter, true)) return needed;
  include_what_is_needed(angular_frequency, needed);
  solver_->hold(held_, false);
  solver_->forget();
  return needed;
}

std::vector<Peak> DamperPeaks::peaks_between(const PeakRange& range) {
  return find_peaks(
      [&](double w, Vector& values) { return !stop_.load() && take_point(w) && evaluate(*solver_, w, values); }, range);
}

/// Of a truncated response all points share one discretisation, which the highest places of the scan need; where a
/// peak then errs more they are found again with what that needs.
std::vector<Peak> DamperPeaks::peaks(double parameter) {
  scan_ = {};
  if (!is_shared_) hold(std::nullopt);
  if (!take(parameter, true)) return {};
  const PeakRange wanted = range_with_extremes();
  if (!plan_.is_truncated() || is_shared_) return peaks_between(wanted);
  const Scan told = scan_;
  std::optional<steady::SteadyDiscretisation> needed;
  for (const auto& [w, height] : high_places_) include_what_is_needed(w, needed);
  scan_ = told;
  std::vector<Peak> found;
  for (int round = 0; round < most_rounds; ++round) {
    hold(needed);
    solver_->forget();
    found = peaks_between(wanted);
    if (found.empty() || !needed || stop_.load()) return found;
    const Scan of_peaks = scan_;
    const steady::SteadyDiscretisation before = *needed;
    bool is_enough = true;
    for (std::size_t i = 0; i < found.size() && found[i].value > least_checked * found.front().value; ++i)
      if (!(response_at(parameter, found[i]).error <= plan_.route.tolerance)) {
        is_enough = false;
        include_what_is_needed(found[i].at, needed);
      }
    scan_ = of_peaks;
    if (is_enough || before == *needed) break;
    scan_ = told;
  }
  solver_->hold(held_, false);
  return found;
}

std::optional<Peak> DamperPeaks::follow(double parameter, const Peak& known) {
  if (!take(parameter, false)) return std::nullopt;
  return follow_peak(
      [&](double w, Vector& values) { return !stop_.load() && take_point(w) && evaluate(*solver_, w, values); },
      range(), known);
}

std::vector<Peak> DamperPeaks::limit_peaks(double parameter, bool is_stuck) {
  if (!take(parameter, true)) return {};
  double unbounded = 0.0;
  auto peaks = find_peaks(
      [&](double w, Vector& values) {
        if (stop_.load() || !take_point(w)) return false;
        auto& solver = is_stuck ? stuck_ : free_;
        if (!solver)
          solver = (is_stuck ? make_.stuck : make_.free)(structure_->system(),
                                                         structure_->request(plan_.observed, plan_.request));
        solver->solve(excitation_, steady::SteadyStart::unloaded, response_);
        values = response_.amplitude;
        if (response_.status == steady::SteadyStatus::unbounded) unbounded = w;
        return response_.status == steady::SteadyStatus::converged;
      },
      range());
  if (unbounded > 0.0) peaks = {{0, unbounded, HUGE_VAL, 0.0, Peak::Kind::interior}};
  return peaks;
}

const steady::SteadyResponse& DamperPeaks::response_at(double parameter, const Peak& peak) {
  response_ = {};
  response_.status = steady::SteadyStatus::not_converged;
  if (!take(parameter, false) || !take_point(peak.at)) return response_;
  Vector values;
  const auto solve = [&] {
    solver_->hold(held_, true);
    const bool has_values = evaluate(*solver_, peak.at, values);
    solver_->hold(held_, false);
    return has_values;
  };
  const auto is_the_peak = [&] {
    return std::abs(values[peak.curve] - peak.value) <= plan_.route.tolerance * std::abs(peak.value);
  };
  bool has_values = solve();
  if (!held_) return response_;
  // Of several balances another may have been found than that of the peak, which is that of one of its sides.
  if (!has_values || !is_the_peak())
    for (const double side : {-1.0, 1.0}) {
      has_values = approach(peak.at, side) && solve();
      if (has_values && is_the_peak()) break;
    }
  if (!has_values) return response_;
  if (const double apart = std::abs(values[peak.curve] - peak.value); apart > 0.0)
    response_.error = std::max(response_.error, apart / std::abs(peak.value));
  if (!(response_.error <= plan_.route.tolerance)) response_.status = steady::SteadyStatus::not_converged;
  return response_;
}

/// Follows the response from one side up to a frequency, from afresh; false where the range has no such side.
bool DamperPeaks::approach(double angular_frequency, double side) {
  constexpr int most = 40;
  constexpr double reach = 0.3;
  const double from = std::clamp(angular_frequency * (1.0 + side * reach), plan_.from, plan_.to);
  if (from == angular_frequency) return false;
  const Scan told = scan_;
  solver_->forget();
  Vector values;
  for (int i = 0; i < most && !stop_.load(); ++i) {
    const double w = from + (angular_frequency - from) * static_cast<double>(i) / most;
    if (take_point(w)) (void)evaluate(*solver_, w, values);
  }
  scan_ = told;
  return take_point(angular_frequency);
}

std::string DamperPeaks::excursion() const {
  constexpr int samples = 64;
  if (!structure_ || !structure_->about || !response_.amplitude.allFinite() || response_.amplitude.size() == 0)
    return {};
  return structure_->about->told(structure_->about->excursion(solver_->waveform(samples).position));
}

}  // namespace rubato::analysis
