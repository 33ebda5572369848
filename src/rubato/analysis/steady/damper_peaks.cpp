#include <rubato/analysis/steady/damper_peaks.hpp>
#include <rubato/steady/linear/linear_limits.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

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
  structure_ =
      std::make_unique<system::AssembledModel>(build_structure(input_.study, drive_.parameters_at(values_, point)));
  solver_ = make_.response(structure_->system, plan_.request);
  coarse_ = make_.coarse(structure_->system, plan_.request);
  natural_ = steady::natural_frequencies(structure_->system);
  structure_values_ = std::move(wanted);
}

/// Goes to a value of the parameter; false where no model has it.
bool DamperPeaks::take(double parameter, bool begins_afresh) {
  values_.back() = parameter;
  try {
    require_structure(plan_.excitation_factor * plan_.from);
    drive_.take_line(values_, *structure_);
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
      drive_.take_line(values_, *structure_);
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
    values.setConstant(1, response_.dissipated.sum());
  return true;
}

/// The scan is equally spaced, and looks besides wherever a harmonic of the loads meets a natural frequency: a peak is
/// narrow only where the sliders hardly dissipate, which is near one of the two limits.
PeakRange DamperPeaks::range() {
  PeakRange range{plan_.from, plan_.to, plan_.samples, {}};
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
  const bool has_amplitudes = plan_.objective == DamperCurvePlan::Objective::amplitude;
  const auto sought = has_amplitudes ? static_cast<Index>(observed()) : Index{1};
  const auto extremes = find_extremes(
      [&](double w, Vector& values) {
        if (stop_.load() || !take_point(w) || !evaluate(*coarse_, w, objective_)) return false;
        const auto first = response_.harmonics.col(0);
        values.resize(sought + 3 * response_.amplitude.size());
        values << objective_, response_.amplitude, first.real(), first.imag();
        return true;
      },
      wanted, sought);
  wanted.besides.insert(wanted.besides.end(), extremes.begin(), extremes.end());
  scan_ = told;
  solves_ = solves;
  return wanted;
}

std::vector<Peak> DamperPeaks::peaks(double parameter) {
  scan_ = {};
  if (!take(parameter, true)) return {};
  return find_peaks(
      [&](double w, Vector& values) { return !stop_.load() && take_point(w) && evaluate(*solver_, w, values); },
      range_with_extremes());
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
        if (!solver) solver = (is_stuck ? make_.stuck : make_.free)(structure_->system, plan_.request);
        solver->solve(excitation_, steady::SteadyStart::unloaded, response_);
        values = response_.amplitude;
        if (response_.status == steady::SteadyStatus::unbounded) unbounded = w;
        return response_.status == steady::SteadyStatus::converged;
      },
      range());
  if (unbounded > 0.0) peaks = {{0, unbounded, HUGE_VAL, 0.0, Peak::Kind::interior}};
  return peaks;
}

const steady::SteadyResponse& DamperPeaks::response_at(double parameter, double angular_frequency) {
  response_ = {};
  response_.status = steady::SteadyStatus::not_converged;
  if (!take(parameter, false) || !take_point(angular_frequency)) return response_;
  Vector values;
  (void)evaluate(*solver_, angular_frequency, values);
  return response_;
}

}  // namespace rubato::analysis
