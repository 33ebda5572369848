#include <rubato/integrate/steady/orbit_search.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double round_off = 1e-13;
// Residuals that change by less than this part of a change of the state belong to a motion that nothing damps: what an
// extrapolation makes of their round-off is far away.
constexpr double least_decay = 1e-9;

/// One lane on its way.
class Lane {
 public:
  Lane(const OrbitSearchOptions& options, bool extrapolates) : options_(options), extrapolates_(extrapolates) {}

  OrbitReport report;
  bool is_done = false;

  /// Takes a marched period and says where the next one starts.
  Vector next(const Vector& x, const Vector& y, Index motion) {
    ++report.marched;
    const Vector residual = y - x;
    const double scale = y.head(motion).norm(), difference = residual.norm();
    report.residual = difference == 0.0 ? 0.0 : difference / scale;
    sizes_.push_back(scale);
    estimate_distance();
    const bool is_small = report.residual <= options_.tolerance;
    const bool is_near = report.distance <= 10.0 * options_.tolerance || report.residual <= round_off;
    // While the residuals are small the march goes on by itself: their decay is the estimate of the distance.
    confirmed_ = is_small ? confirmed_ + 1 : 0;
    if (confirmed_ >= options_.confirmations) {
      if (is_near) {
        report.status = SteadyStatus::converged;
        is_done = true;
        return x;
      }
      if (extrapolates_) confirmed_ = 0;
    }
    if (!extrapolates_ && find_multiple(y, scale)) {
      is_done = true;
      return y;
    }
    if (!extrapolates_ || confirmed_ > 0) {
      if (extrapolates_) extrapolation_.clear();
      return y;
    }
    // Sliders that change between stick and slip can mislead an extrapolation; the march itself cannot diverge.
    if (report.residual > 4.0 * best_) {
      extrapolation_.clear();
      plain_ = patience_ = 2 * patience_;
      best_ = std::numeric_limits<double>::infinity();
    }
    best_ = std::min(best_, report.residual);
    if (plain_ > 0) {
      --plain_;
      return y;
    }
    return extrapolation_.next(x, residual);
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
  void estimate_distance() {
    residuals_.push_back(report.residual);
    constexpr std::size_t window = 3;
    if (residuals_.size() > window + 1) residuals_.pop_front();
    const double rate = residuals_.size() > window && residuals_.front() > 0.0
                            ? std::pow(report.residual / residuals_.front(), 1.0 / window)
                            : 0.0;
    report.distance = rate < 1.0 ? report.residual / (1.0 - rate) : std::numeric_limits<double>::infinity();
  }

  bool find_multiple(const Vector& y, double scale) {
    history_.push_front(y);
    const auto longest = static_cast<std::size_t>(options_.max_multiple);
    if (history_.size() > longest + 1) history_.pop_back();
    hits_.resize(longest + 1, 0);
    for (std::size_t k = 2; k < history_.size(); ++k) {
      const bool repeats =
          report.residual > 100.0 * options_.tolerance && (history_[k] - y).norm() <= options_.tolerance * scale;
      hits_[k] = repeats ? hits_[k] + 1 : 0;
      if (hits_[k] < static_cast<int>(k) * options_.confirmations) continue;
      report.status = SteadyStatus::subharmonic;
      report.multiple = static_cast<int>(k);
      report.residual = (history_[k] - y).norm() / scale;
      return true;
    }
    return false;
  }

  const OrbitSearchOptions& options_;
  bool extrapolates_;
  PeriodExtrapolation extrapolation_;
  std::deque<double> residuals_;
  std::vector<double> sizes_;
  std::deque<Vector> history_;
  std::vector<int> hits_;
  int confirmed_ = 0, plain_ = 2, patience_ = 2;
  double best_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void PeriodExtrapolation::clear() {
  dx_.clear();
  dr_.clear();
  last_x_.resize(0);
}

Vector PeriodExtrapolation::next(const Vector& x, const Vector& residual) {
  if (last_x_.size() > 0) {
    const Vector dx = x - last_x_, dr = residual - last_r_;
    if (dr.norm() > least_decay * dx.norm()) {
      dx_.push_back(dx);
      dr_.push_back(dr);
    }
    if (dx_.size() > depth_) {
      dx_.pop_front();
      dr_.pop_front();
    }
  }
  last_x_ = x;
  last_r_ = residual;
  Vector result = x + residual;
  if (dr_.empty()) return result;
  Matrix differences(x.size(), static_cast<Index>(dr_.size()));
  for (std::size_t k = 0; k < dr_.size(); ++k) differences.col(static_cast<Index>(k)) = dr_[k];
  Eigen::ColPivHouseholderQR<Matrix> factor(differences);
  factor.setThreshold(1e-8);  // what is nearly dependent says nothing new
  const Vector weights = factor.solve(residual);
  for (std::size_t k = 0; k < dr_.size(); ++k) result -= weights[static_cast<Index>(k)] * (dx_[k] + dr_[k]);
  return result;
}

std::vector<OrbitReport> search_orbits(PeriodMap& map, const OrbitSearchOptions& options, bool extrapolates,
                                       LaneArray& states) {
  std::vector<Lane> lanes(static_cast<std::size_t>(states.cols()), Lane(options, extrapolates));
  LaneArray after;
  for (int period = 0; period < options.max_periods; ++period) {
    if (!map.advance(states, after, nullptr, 0)) {
      for (Lane& lane : lanes) lane.report.residual = std::numeric_limits<double>::infinity();
      break;
    }
    bool is_done = true;
    for (Index l = 0; l < states.cols(); ++l) {
      Lane& lane = lanes[static_cast<std::size_t>(l)];
      if (lane.is_done) continue;
      states.col(l) = lane.next(states.col(l).matrix(), after.col(l).matrix(), map.slip_start());
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
