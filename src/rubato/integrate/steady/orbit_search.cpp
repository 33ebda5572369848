#include <rubato/integrate/steady/orbit_search.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double round_off = 1e-13;

enum class Next { rests, marches, leaps };

/// One lane on its way.
class Lane {
 public:
  Lane(const OrbitSearchOptions& options, bool extrapolates) : options_(options), extrapolates_(extrapolates) {}

  OrbitReport report;
  bool is_done = false;
  bool is_misled = false;  ///< the last leap led away

  /// Takes a marched period and says where the next one starts.
  /// @param scale, change, leap  norms of the state, of its change over the period, of the extrapolated step
  Next next(double scale, double change, double leap) {
    ++report.marched;
    is_misled = false;
    report.residual = change == 0.0 ? 0.0 : change / scale;
    sizes_.push_back(scale);
    report.distance = extrapolates_ ? std::max(leap, change) / scale : distance_by_decay();
    if (change == 0.0) report.distance = 0.0;
    const bool is_near = report.distance <= 10.0 * options_.tolerance || report.residual <= round_off;
    if (report.residual <= options_.tolerance && (is_near || !extrapolates_)) {
      if (++confirmed_ >= options_.confirmations && is_near) {
        report.status = SteadyStatus::converged;
        is_done = true;
        return Next::rests;
      }
      return Next::marches;
    }
    confirmed_ = 0;
    if (!extrapolates_) return Next::marches;
    // Sliders that change between stick and slip can mislead an extrapolation; the march itself cannot diverge.
    if (report.residual > 4.0 * best_ || !std::isfinite(leap)) {
      is_misled = true;
      plain_ = patience_;
      patience_ *= 2;
      best_ = infinity;
    }
    best_ = std::min(best_, report.residual);
    if (plain_ == 0) return Next::leaps;
    --plain_;
    return Next::marches;
  }

  /// Without extrapolation only: does the state repeat after several periods?
  bool finds_multiple(const Vector& state, double scale) {
    history_.push_front(state);
    const auto longest = static_cast<std::size_t>(options_.max_multiple);
    if (history_.size() > longest + 1) history_.pop_back();
    hits_.resize(longest + 1, 0);
    for (std::size_t k = 2; k < history_.size(); ++k) {
      const double change = (history_[k] - state).norm();
      const bool repeats = report.residual > 100.0 * options_.tolerance && change <= options_.tolerance * scale;
      hits_[k] = repeats ? hits_[k] + 1 : 0;
      if (hits_[k] < static_cast<int>(k) * options_.confirmations) continue;
      report.status = SteadyStatus::subharmonic;
      report.multiple = static_cast<int>(k);
      report.residual = change / scale;
      is_done = true;
      return true;
    }
    return false;
  }

  /// Without repetition after the last period: bounded, or growing without bound?
  void conclude() {
    const std::size_t quarter = sizes_.size() / 4;
    if (is_done || quarter < 8) return;
    const auto largest = [&](std::size_t part) {
      const auto from = sizes_.end() - static_cast<std::ptrdiff_t>((4 - part) * quarter);
      return *std::max_element(from, from + static_cast<std::ptrdiff_t>(quarter));
    };
    const double second = largest(1), third = largest(2), last = largest(3);
    constexpr double settled = 0.01, growing = 1.2;
    if (last > growing * third && last - third > 0.9 * (third - second))
      report.status = SteadyStatus::unbounded;
    else if (!extrapolates_ && std::abs(last - third) <= settled * third)
      report.status = SteadyStatus::quasi_periodic;
  }

 private:
  double distance_by_decay() {
    residuals_.push_back(report.residual);
    constexpr std::size_t window = 3;
    if (residuals_.size() > window + 1) residuals_.pop_front();
    if (residuals_.size() <= window || residuals_.front() == 0.0) return infinity;
    const double rate = std::pow(report.residual / residuals_.front(), 1.0 / window);
    return rate < 1.0 ? report.residual / (1.0 - rate) : infinity;
  }

  const OrbitSearchOptions& options_;
  bool extrapolates_;
  std::deque<double> residuals_;
  std::vector<double> sizes_;
  std::deque<Vector> history_;
  std::vector<int> hits_;
  int confirmed_ = 0, plain_ = 0, patience_ = 2;
  double best_ = infinity;
};

// A slider that did not slip in the period keeps its slip: what is learnt from others is none of its business.
void keep_slips(const PeriodMap& map, const LaneArray& after, const LaneArray& residuals, LaneArray& steps) {
  constexpr double still = 1e-12;
  for (Index l = 0; l < steps.cols(); ++l) {
    const double scale = after.col(l).head(map.slip_start()).matrix().norm();
    for (Index i = map.slip_start(); i < map.slip_start() + map.slips(); ++i)
      if (std::abs(residuals(i, l)) <= still * scale) steps(i, l) = 0.0;
  }
}

}  // namespace

std::vector<OrbitReport> search_orbits(PeriodMap& map, const OrbitSearchOptions& options,
                                       OrbitExtrapolation* extrapolation, LaneArray& states) {
  const Index count = states.cols();
  std::vector<Lane> lanes(static_cast<std::size_t>(count), Lane(options, extrapolation != nullptr));
  LaneArray after, residuals, steps;
  if (extrapolation) extrapolation->begin(map, count);
  for (int period = 0; period < options.max_periods; ++period) {
    if (!map.advance(states, after, nullptr, 0)) {
      for (Lane& lane : lanes)
        if (!lane.is_done) lane.report.residual = infinity;
      break;
    }
    residuals = after - states;
    if (extrapolation) {
      extrapolation->next(states, residuals, steps);
      keep_slips(map, after, residuals, steps);
    }
    bool is_done = true;
    for (Index l = 0; l < count; ++l) {
      Lane& lane = lanes[static_cast<std::size_t>(l)];
      if (lane.is_done) continue;
      const double scale = after.col(l).head(map.slip_start()).matrix().norm();
      const double leap = extrapolation ? steps.col(l).matrix().norm() : 0.0;
      const Next next = lane.next(scale, residuals.col(l).matrix().norm(), leap);
      if (lane.is_misled) extrapolation->distrust(l);
      if (next == Next::leaps)
        states.col(l) += steps.col(l);
      else if (next == Next::marches)
        states.col(l) = after.col(l);
      if (!extrapolation && !lane.is_done) lane.finds_multiple(after.col(l).matrix(), scale);
      is_done = is_done && lane.is_done;
    }
    if (is_done) break;
  }
  std::vector<OrbitReport> reports;
  for (Lane& lane : lanes) {
    lane.conclude();
    reports.push_back(lane.report);
  }
  return reports;
}

}  // namespace rubato::integrate
