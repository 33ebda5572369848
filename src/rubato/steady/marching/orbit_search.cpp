#include <rubato/steady/marching/orbit_search.hpp>

#include <rubato/core/stopping.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/free_motions.hpp>

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double round_off = 1e-13;
constexpr double still = 1e-12;         // of the state: what a slider that kept its slip may have moved
constexpr double surely_drifts = 10;    // times the tolerance, in a period
constexpr int most_patience = 1 << 20;  // periods marched between leaps, which double where a leap misleads
constexpr int most_misled = 2;          // leaps, before the derivative of a period is measured

enum class Next { rests, marches, leaps };

/// One lane on its way.
class Lane {
 public:
  Lane(const OrbitSearchOptions& options, bool extrapolates) : options_(options), extrapolates_(extrapolates) {}

  OrbitReport report;
  bool is_done = false;
  bool is_misled = false;  ///< the last leap led away
  /// Leaps led away again and again, and the march that followed is over.
  bool needs_measure() const { return !is_done && misled_ > most_misled && plain_ == 0 && !is_measured_; }
  void measured(int periods) {
    report.marched += periods;
    is_measured_ = true;
  }

  /// Takes a marched period and says where the next one starts.
  struct Sizes {
    double state, change, leap;             ///< norms of the state, of its change over the period, of the guessed step
    double observed_change, observed_leap;  ///< of what is observed [m]
    bool leap_is_distance;                  ///< else it is only the best that is known
    double drift;                           ///< that was taken back
  };
  Next next(const Sizes& sizes) {
    const auto& [scale, change, leap, observed_change, observed_leap, leap_is_distance, drift] = sizes;
    ++report.marched;
    is_misled = false;
    report.residual = change == 0.0 ? 0.0 : change / scale;
    sizes_.push_back(scale);
    if (report.residual <= round_off) {
      report.distance = report.residual;
      report.observed_distance = observed_change;
    } else if (extrapolates_) {
      report.distance = leap_is_distance ? std::max(leap, change) / scale : infinity;
      report.observed_distance = leap_is_distance ? std::max(observed_leap, observed_change) : infinity;
    } else {
      report.distance = distance_by_decay();
      report.observed_distance = observed_change * (report.distance / report.residual);
    }
    const bool is_near = report.distance <= 10.0 * options_.tolerance;
    if (report.residual <= options_.tolerance && (is_near || !extrapolates_)) {
      const bool drifts = drift > surely_drifts * options_.tolerance * scale;
      if (++confirmed_ >= options_.confirmations && is_near && (drifts || drift <= options_.tolerance * scale)) {
        report.status = drifts ? SteadyStatus::drifting : SteadyStatus::converged;
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
      is_measured_ = false;
      ++misled_;
      plain_ = patience_;
      patience_ = std::min(2 * patience_, most_patience);
      best_ = infinity;
    }
    best_ = std::min(best_, report.residual);
    if (plain_ == 0) return Next::leaps;
    --plain_;
    return Next::marches;
  }

  /// Without extrapolation only: does the state repeat after several periods? Gives its change over those.
  std::optional<Vector> find_multiple(const Vector& state, double scale) {
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
      return history_[k] - state;
    }
    return std::nullopt;
  }

  /// Without repetition after the last period: does it stay as large as it was?
  void conclude() {
    const std::size_t quarter = sizes_.size() / 4;
    if (is_done || extrapolates_ || quarter < 8) return;
    const auto largest = [&](std::size_t part) {
      const auto from = sizes_.end() - static_cast<std::ptrdiff_t>((4 - part) * quarter);
      return *std::max_element(from, from + static_cast<std::ptrdiff_t>(quarter));
    };
    constexpr double settled = 0.01;
    if (std::abs(largest(3) - largest(2)) <= settled * largest(2)) report.status = SteadyStatus::quasi_periodic;
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
  int confirmed_ = 0, plain_ = 0, patience_ = 2, misled_ = 0;
  bool is_measured_ = false;
  double best_ = infinity;
};

// A slider that did not slip in the period keeps its slip: what is learnt from others is none of its business.
void keep_slips(const PeriodMap& map, const LaneArray& after, const LaneArray& residuals, LaneArray& steps) {
  for (Index l = 0; l < steps.cols(); ++l) {
    const double scale = after.col(l).head(map.slip_start()).matrix().norm();
    for (Index i = map.slip_start(); i < map.slip_start() + map.slips(); ++i)
      if (std::abs(residuals(i, l)) <= still * scale) steps(i, l) = 0.0;
  }
}

// Takes back what the state moved along rigid motions in a period; returns how far that was.
double take_back_drift(const PeriodMap& map, const Matrix& rigid, const Vector& before, Eigen::Ref<Vector> after) {
  if (rigid.cols() == 0) return 0.0;
  const double scale = after.head(map.slip_start()).norm();
  Matrix held = rigid.middleRows(map.slip_start(), map.slips());
  for (Index i = 0; i < held.rows(); ++i)
    if (std::abs(after[map.slip_start() + i] - before[map.slip_start() + i]) > still * scale) held.row(i).setZero();
  const Eigen::FullPivLU<Matrix> holds(held);
  if (holds.dimensionOfKernel() == 0) return 0.0;
  const Eigen::HouseholderQR<Matrix> basis(holds.kernel());
  const Matrix open = rigid * (basis.householderQ() * Matrix::Identity(rigid.cols(), holds.dimensionOfKernel()));
  const Vector drift = open * (open.transpose() * (after - before));
  after -= drift;
  return drift.norm();
}

}  // namespace

namespace {

/// Those of the motions that leave every law where it is.
Matrix not_seen_by_laws(const system::LocallyNonlinear& system, const Matrix& motions) {
  Matrix seen(system.contact_count() - system.first_law(), motions.cols());
  for (Index k = 0; k < motions.cols(); ++k)
    for (Index j = 0; j < seen.rows(); ++j)
      seen(j, k) = system.relative_displacement(system.first_law() + j, motions.col(k));
  return kernel_of(seen, motions);
}

}  // namespace

Matrix rigid_motions(PeriodMap& map, const system::LocallyNonlinear& system) {
  Matrix motions(map.size(), 0);
  if (system.size() > largest_rigid || system.slider_count() == 0) return motions;
  const numerics::SymmetricModes modes = numerics::all_modes(system.stiffness(), system.mass());
  Matrix shapes = modes.shapes.leftCols((modes.eigenvalues.array() == 0.0).count());
  if (system.has_laws() && shapes.cols() > 0) shapes = not_seen_by_laws(system, shapes);
  const Index count = shapes.cols();
  if (count == 0) return motions;
  motions.resize(map.size(), count);
  LaneArray states(map.size(), 1);
  system::State state = system.start();
  map.encode(state, states, 0);
  const Vector origin = states.col(0);
  for (Index k = 0; k < count; ++k) {
    state.q = system.start().q + shapes.col(k);
    map.encode(state, states, 0);
    motions.col(k) = states.col(0).matrix() - origin;
  }
  const Eigen::HouseholderQR<Matrix> basis(motions);
  return basis.householderQ() * Matrix::Identity(motions.rows(), count);
}

std::vector<OrbitReport> search_orbits(PeriodMap& map, const OrbitSearchOptions& options,
                                       OrbitExtrapolation* extrapolation, LaneArray& states) {
  const Index count = states.cols();
  std::vector<Lane> lanes(static_cast<std::size_t>(count), Lane(options, extrapolation != nullptr));
  LaneArray after, residuals, steps = LaneArray::Zero(states.rows(), count);
  std::vector<char> asks(lanes.size(), 0);
  std::vector<double> drifts(lanes.size(), 0.0);
  if (extrapolation) extrapolation->begin(map, count);
  for (int period = 0; period < options.max_periods; ++period) {
    stop_if_asked();
    if (!map.advance(states, after, nullptr, 0)) {
      for (Lane& lane : lanes)
        if (!lane.is_done) lane.report.residual = infinity;
      break;
    }
    for (Index l = 0; l < count; ++l) {
      Vector reached = after.col(l);
      drifts[static_cast<std::size_t>(l)] = take_back_drift(map, options.rigid, states.col(l), reached);
      after.col(l) = reached;
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
      // The larger of both ends: a motion from rest that repeats after several periods comes back to rest.
      const double scale = std::max(after.col(l).head(map.slip_start()).matrix().norm(),
                                    states.col(l).head(map.slip_start()).matrix().norm());
      const Next next =
          lane.next({scale, residuals.col(l).matrix().norm(), steps.col(l).matrix().norm(),
                     map.observed_size(residuals, l), map.observed_size(steps, l),
                     extrapolation && extrapolation->knows_distance(l), drifts[static_cast<std::size_t>(l)]});
      if (lane.is_misled) extrapolation->distrust(l);
      if (next == Next::leaps)
        states.col(l) += steps.col(l);
      else if (next == Next::marches)
        states.col(l) = after.col(l);
      if (!extrapolation && !lane.is_done)
        if (const auto rest = lane.find_multiple(after.col(l).matrix(), scale)) {
          residuals.col(l) = *rest;
          lane.report.observed_distance = map.observed_size(residuals, l);
        }
      is_done = is_done && lane.is_done;
    }
    if (is_done) break;
    if (!extrapolation) continue;
    bool any_asks = false;
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      asks[l] = lanes[l].needs_measure();
      any_asks = any_asks || asks[l];
    }
    if (!any_asks) continue;
    const int periods = extrapolation->measure(map, states, asks);
    for (std::size_t l = 0; l < lanes.size(); ++l)
      if (asks[l]) lanes[l].measured(periods);
  }
  std::vector<OrbitReport> reports;
  for (Lane& lane : lanes) {
    lane.conclude();
    reports.push_back(lane.report);
  }
  return reports;
}

}  // namespace rubato::steady
