#include <rubato/steady/marching/orbit_extrapolation.hpp>

#include <Eigen/LU>
#include <Eigen/QR>

#include <cmath>

namespace rubato::steady {
namespace {

// Residuals that change by less than this part of a change of the state belong to a motion that nothing damps: what an
// extrapolation makes of their round-off is far away.
constexpr double least_decay = 1e-10;
constexpr std::size_t depth = 10;       // differences that Anderson's mixing remembers
constexpr Index largest_broyden = 160;  // size^2 numbers a lane
// Changes that must be seen before an extrapolation that knows nothing of the structure tells the distance: the slow
// modes of a lightly damped structure change a state little in a period, wherever it will end.
constexpr int telling_changes = 3;
constexpr double difference = 1e-7;  // of the state, by which it is moved to measure the derivative of a period

// (I - dP/dx)^-1 of a motion that decays by enough to be told from round-off.
bool is_damped(const Matrix& inverse) { return inverse.cwiseAbs().maxCoeff() < 1.0 / least_decay; }

}  // namespace

void BroydenExtrapolation::begin(PeriodMap& map, Index lanes) {
  has_last_ = false;
  first_ = map.linear_update();
  knows_structure_ = first_.size() > 0;
  if (!knows_structure_) first_ = Matrix::Identity(map.size(), map.size());
  if (lanes == lanes_ && map.size() == size_) return;
  lanes_ = lanes;
  size_ = map.size();
  inverse_.resize(size_ * size_, lanes_);
  updates_.assign(static_cast<std::size_t>(lanes_), 0);
  for (Index l = 0; l < lanes_; ++l) distrust(l);
}

bool BroydenExtrapolation::knows_distance(Index lane) const {
  return knows_structure_ || updates_[static_cast<std::size_t>(lane)] >= telling_changes;
}

void BroydenExtrapolation::distrust(Index lane) {
  if (lane >= lanes_) return;
  updates_[static_cast<std::size_t>(lane)] = 0;
  for (Index i = 0; i < size_; ++i)
    for (Index j = 0; j < size_; ++j) inverse_(i * size_ + j, lane) = first_(i, j);
}

// One column of dr/dx a period: Newton's method, where Broyden's has seen too many different motions.
int BroydenExtrapolation::measure(PeriodMap& map, const LaneArray& states, const std::vector<char>& asks) {
  LaneArray from = states, base, after;
  if (!map.advance(states, base, nullptr, 0)) return 1;
  std::vector<Matrix> derivative(static_cast<std::size_t>(lanes_), Matrix::Zero(size_, size_));
  Eigen::Array<double, 1, Eigen::Dynamic> shift = difference * states.matrix().colwise().norm().array();
  shift = (shift > 0.0).select(shift, difference);
  for (Index j = 0; j < size_; ++j) {
    from.row(j) += shift;
    if (!map.advance(from, after, nullptr, 0)) return static_cast<int>(j) + 2;
    from.row(j) = states.row(j);
    for (Index l = 0; l < lanes_; ++l)
      derivative[static_cast<std::size_t>(l)].col(j) = (after.col(l) - base.col(l)).matrix() / shift[l];
  }
  for (Index l = 0; l < lanes_; ++l) {
    if (!asks[static_cast<std::size_t>(l)]) continue;
    Matrix residual = Matrix::Identity(size_, size_) - derivative[static_cast<std::size_t>(l)];
    // A slider that sticks keeps its slip, whatever the rest does.
    for (Index i = map.slip_start(); i < map.slip_start() + map.slips(); ++i)
      if (residual.row(i).cwiseAbs().maxCoeff() < 1e-6) residual(i, i) = 1.0;
    const Matrix inverse = residual.inverse();
    if (!is_damped(inverse)) continue;
    for (Index i = 0; i < size_; ++i)
      for (Index j = 0; j < size_; ++j) inverse_(i * size_ + j, l) = inverse(i, j);
    updates_[static_cast<std::size_t>(l)] = telling_changes;
  }
  has_last_ = false;
  return static_cast<int>(size_) + 1;
}

void BroydenExtrapolation::update(const LaneArray& states, const LaneArray& residuals) {
  s_ = states - last_state_;
  y_ = residuals - last_residual_;
  hy_.setZero(size_, lanes_);
  sh_.setZero(size_, lanes_);
  const Index lanes = lanes_;
  for (Index i = 0; i < size_; ++i) {
    double* hy = hy_.data() + i * lanes;
    const double* s = s_.data() + i * lanes;
    for (Index j = 0; j < size_; ++j) {
      const double *h = inverse_.data() + (i * size_ + j) * lanes, *y = y_.data() + j * lanes;
      double* sh = sh_.data() + j * lanes;
      for (Index l = 0; l < lanes; ++l) {
        hy[l] += h[l] * y[l];
        sh[l] += s[l] * h[l];
      }
    }
  }
  // s^T H y, and where it says nothing (a lane that rests, a motion that nothing damps) no update.
  Eigen::Array<double, 1, Eigen::Dynamic> product = (s_ * hy_).colwise().sum();
  for (Index l = 0; l < lanes; ++l) {
    const double s_norm = s_.col(l).matrix().norm(), y_norm = y_.col(l).matrix().norm(),
                 hy_norm = hy_.col(l).matrix().norm();
    const bool is_telling = y_norm > least_decay * s_norm && std::abs(product[l]) > 1e-3 * s_norm * hy_norm;
    product[l] = is_telling ? -1.0 / product[l] : 0.0;
    updates_[static_cast<std::size_t>(l)] += is_telling ? 1 : 0;
  }
  for (Index i = 0; i < size_; ++i) hy_.row(i) = (s_.row(i) + hy_.row(i)) * product;
  for (Index i = 0; i < size_; ++i) {
    const double* a = hy_.data() + i * lanes;
    for (Index j = 0; j < size_; ++j) {
      double* h = inverse_.data() + (i * size_ + j) * lanes;
      const double* b = sh_.data() + j * lanes;
      for (Index l = 0; l < lanes; ++l) h[l] += a[l] * b[l];
    }
  }
}

void BroydenExtrapolation::next(const LaneArray& states, const LaneArray& residuals, LaneArray& steps) {
  if (has_last_) update(states, residuals);
  has_last_ = true;
  last_state_ = states;
  last_residual_ = residuals;
  steps.setZero(size_, lanes_);
  for (Index i = 0; i < size_; ++i)
    for (Index j = 0; j < size_; ++j) {
      const double *h = inverse_.data() + (i * size_ + j) * lanes_, *r = residuals.data() + j * lanes_;
      double* step = steps.data() + i * lanes_;
      for (Index l = 0; l < lanes_; ++l) step[l] += h[l] * r[l];
    }
}

bool AndersonExtrapolation::knows_distance(Index lane) const {
  return static_cast<int>(histories_[static_cast<std::size_t>(lane)].dr.size()) >= telling_changes;
}

void AndersonExtrapolation::distrust(Index lane) {
  if (lane < static_cast<Index>(histories_.size())) histories_[static_cast<std::size_t>(lane)] = {};
}

void AndersonExtrapolation::begin(PeriodMap&, Index lanes) { histories_.assign(static_cast<std::size_t>(lanes), {}); }

void AndersonExtrapolation::next(const LaneArray& states, const LaneArray& residuals, LaneArray& steps) {
  steps = residuals;
  for (Index l = 0; l < states.cols(); ++l) {
    History& history = histories_[static_cast<std::size_t>(l)];
    const Vector x = states.col(l), r = residuals.col(l);
    if (history.last_x.size() > 0) {
      const Vector dx = x - history.last_x, dr = r - history.last_r;
      if (dr.norm() > least_decay * dx.norm()) {
        history.dx.push_back(dx);
        history.dr.push_back(dr);
      }
      if (history.dx.size() > depth) {
        history.dx.pop_front();
        history.dr.pop_front();
      }
    }
    history.last_x = x;
    history.last_r = r;
    if (history.dr.empty()) continue;
    const auto count = static_cast<Index>(history.dr.size());
    Matrix differences(x.size(), count);
    for (Index k = 0; k < count; ++k) differences.col(k) = history.dr[static_cast<std::size_t>(k)];
    Eigen::ColPivHouseholderQR<Matrix> factor(differences);
    factor.setThreshold(1e-8);  // what is nearly dependent says nothing new
    const Vector weights = factor.solve(r);
    for (Index k = 0; k < count; ++k) {
      const auto place = static_cast<std::size_t>(k);
      steps.col(l) -= weights[k] * (history.dx[place] + history.dr[place]).array();
    }
  }
}

Matrix resolvent_of_power(const Matrix& propagator, int steps) {
  Matrix period = Matrix::Identity(propagator.rows(), propagator.cols()), power = propagator;
  for (int left = steps; left > 0; left /= 2) {
    if (left % 2 == 1) period = period * power;
    if (left > 1) power = power * power;
  }
  Matrix inverse = (Matrix::Identity(period.rows(), period.cols()) - period).inverse();
  return is_damped(inverse) ? inverse : Matrix();
}

std::unique_ptr<OrbitExtrapolation> make_extrapolation(Index size) {
  if (size <= largest_broyden) return std::make_unique<BroydenExtrapolation>();
  return std::make_unique<AndersonExtrapolation>();
}

}  // namespace rubato::steady
