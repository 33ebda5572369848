#include <rubato/model/laws/slip_on_circle.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

using Pair = SlipOnCircle::Pair;

double dot(const Pair& a, const Pair& b) { return a[0] * b[0] + a[1] * b[1]; }
Pair turned(const Pair& a) { return {-a[1], a[0]}; }  // by a right angle
double square(double x) { return x * x; }

/// ln(1 + z)/z and its derivative.
double logarithm_over(double z) { return z == 0.0 ? 1.0 : std::log1p(z) / z; }
double slope_of_logarithm_over(double z) {
  constexpr double small = 1e-2;
  if (std::abs(z) > small) return (1.0 / (1.0 + z) - logarithm_over(z)) / z;
  double sum = 0.0, power = 1.0;
  for (int k = 1; k <= 8; ++k) {
    sum += (k % 2 == 0 ? 1.0 : -1.0) * k / (k + 1.0) * power;
    power *= z;
  }
  return sum;
}

}  // namespace

SlipOnCircle::SlipOnCircle(const Pair& force, const Pair& du, double begin, double end, double stiffness,
                           double coefficient, Index directions)
    : du_(du),
      begin_(begin),
      end_(end),
      stiffness_(stiffness),
      mu_(coefficient),
      limit_(coefficient * end),
      is_line_(directions == 1),
      size_(std::hypot(du[0], du[1])) {
  leave_the_circle(force);
  go_round();
}

// |T0 + kT x du|^2 = mu^2 (N0 + x dN)^2, a x^2 + b x + c = 0 with c <= 0: what is allowed is convex, and the end lies
// outside, so that one root is within the piece where c < 0; a piece that begins on the circle leaves at once where
// b >= 0.
void SlipOnCircle::leave_the_circle(const Pair& force) {
  const double rise = end_ - begin_;
  const double a = square(stiffness_ * size_) - square(mu_ * rise);
  const double b = 2.0 * (stiffness_ * dot(force, du_) - mu_ * mu_ * begin_ * rise);
  const double c = std::min(0.0, dot(force, force) - square(mu_ * begin_));
  const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * c));
  if (b >= 0.0)
    share_ = b + root > 0.0 ? -2.0 * c / (b + root) : 0.0;
  else
    share_ = (root - b) / (2.0 * a);
  share_ = std::clamp(share_, 0.0, 1.0);
  slope_ = 2.0 * a * share_ + b;
  left_normal_ = begin_ + share_ * rise;
  left_ = {force[0] + stiffness_ * share_ * du_[0], force[1] + stiffness_ * share_ * du_[1]};
  const double size = std::hypot(left_[0], left_[1]);
  begin_n_ = size > 0.0 ? Pair{left_[0] / size, left_[1] / size} : Pair{1.0, 0.0};
}

// With the angle a from du to n and R = exp(-path): cos a = ((1 + c) - R^2 (1 - c))/(2 Z), sin a = R s/Z at the end,
// Z = ((1 + c) + R^2 (1 - c))/2, of c and s at x. By d: d a = -sin a d(path) along du, (1 - R/Z)/path across it, and
// (R/Z) of the angle at x.
void SlipOnCircle::go_round() {
  const bool turns = !is_line_ && left_normal_ > 0.0 && end_ > 0.0;
  if (turns) {
    const double z = (end_ - left_normal_) / left_normal_, h = logarithm_over(z), slope = slope_of_logarithm_over(z);
    inverse_mean_ = h / left_normal_;
    by_end_ = slope / square(left_normal_);
    by_left_ = -(h + (1.0 + z) * slope) / square(left_normal_);
  }
  if (!(size_ > 0.0) || is_line_) {
    direction_ = n_ = begin_n_;
    if (is_line_ && size_ > 0.0) direction_ = {std::copysign(1.0, du_[0]), 0.0};
    plus_ = 1.0 + dot(n_, direction_);
    minus_ = 2.0 - plus_;
    return;
  }
  direction_ = {du_[0] / size_, du_[1] / size_};
  const Pair sum{begin_n_[0] + direction_[0], begin_n_[1] + direction_[1]};
  const Pair difference{begin_n_[0] - direction_[0], begin_n_[1] - direction_[1]};
  plus_ = 0.5 * dot(sum, sum);
  minus_ = 0.5 * dot(difference, difference);
  if (!turns) {  // to du at once
    n_ = direction_;
    kept_ = carried_ = across_ = 0.0;
    return;
  }
  path_ = stiffness_ * (1.0 - share_) * size_ * inverse_mean_ / mu_;
  kept_ = std::exp(-path_);
  const double turning = 0.5 * (plus_ + kept_ * kept_ * minus_);
  if (!(turning > 0.0)) {  // against du, to the last bit
    n_ = begin_n_;
    return;
  }
  const double sine = dot(turned(direction_), begin_n_);
  const double cosine = 0.5 * (plus_ - kept_ * kept_ * minus_) / turning;
  sine_ = kept_ * sine / turning;
  n_ = {cosine * direction_[0] - sine_ * direction_[1], cosine * direction_[1] + sine_ * direction_[0]};
  carried_ = kept_ / turning;
  const double lost = path_ > 0.0 ? -std::expm1(-path_) / path_ : 1.0;
  across_ = lost * (1.0 - kept_ + (plus_ - 1.0) * (1.0 + kept_)) / (2.0 * turning);
}

/// Of T at the end, for changes of du and of N at the end.
Pair SlipOnCircle::change(double by_x, double by_y, double by_end) const {
  const Pair du{by_x, by_y};
  const double share =
      slope_ > 0.0
          ? -(2.0 * stiffness_ * share_ * dot(left_, du) - 2.0 * mu_ * mu_ * left_normal_ * share_ * by_end) / slope_
          : 0.0;
  const double left_normal = share_ * by_end + share * (end_ - begin_);
  const Pair left{stiffness_ * (share_ * du[0] + share * du_[0]), stiffness_ * (share_ * du[1] + share * du_[1])};
  const double left_limit = mu_ * left_normal_;
  const double angle = left_limit > 0.0 ? dot(turned(begin_n_), left) / left_limit : 0.0;
  const double rate = stiffness_ / mu_, along = rate * (1.0 - share_) * inverse_mean_;
  const double along_changes =
      rate * (-share * inverse_mean_ + (1.0 - share_) * (by_left_ * left_normal + by_end_ * by_end));
  const Pair w{along_changes * du_[0] + along * du[0], along_changes * du_[1] + along * du[1]};
  const double turn = -sine_ * dot(direction_, w) + across_ * dot(turned(direction_), w) + carried_ * angle;
  const Pair aside = turned(n_);
  return {mu_ * by_end * n_[0] + limit_ * turn * aside[0], mu_ * by_end * n_[1] + limit_ * turn * aside[1]};
}

Pair SlipOnCircle::by_travel(Index j) const { return change(j == 0 ? 1.0 : 0.0, j == 0 ? 0.0 : 1.0, 0.0); }

// mu N times the rate of slip, n.du - mu dN/kT.
double SlipOnCircle::dissipated() const {
  const double mean = 0.5 * (left_normal_ + end_), travel = (1.0 - share_) * size_;
  const double against = is_line_ ? minus_ * mean * travel * mu_ : lag();
  return mu_ * mean * travel - against - 0.5 * mu_ * mu_ * (end_ - left_normal_) * (end_ + left_normal_) / stiffness_;
}

// The integral of mu N (1 - cos a) |du|, by the path p as its variable: N = N_a exp(k p), tan(a/2) = tan(a_a/2)
// exp(-p).
double SlipOnCircle::lag() const {
  const double travel = (1.0 - share_) * size_;
  if (!(minus_ > 0.0 && travel > 0.0 && left_normal_ > 0.0)) return 0.0;
  constexpr double most = 20.0;  // exp(-2 most) is below round-off
  const double growth = mu_ * (end_ - left_normal_) / (stiffness_ * travel);
  double reach = plus_ > 0.0 ? most + 0.5 * std::log(std::max(1.0, minus_ / plus_)) : HUGE_VAL;
  if (growth < 0.0) reach = std::min(reach, -most / growth);
  if (end_ > 0.0) reach = std::min(reach, path_);
  // Gauss and Legendre with five points.
  constexpr double at[5] = {-0.906179845938664, -0.5384693101056831, 0.0, 0.5384693101056831, 0.906179845938664};
  constexpr double weight[5] = {0.23692688505618908, 0.47862867049936647, 0.5688888888888889, 0.47862867049936647,
                                0.23692688505618908};
  const auto panels = static_cast<int>(std::clamp(std::ceil(2.0 * reach * (1.0 + std::abs(growth))), 1.0, 400.0));
  const double half = 0.5 * reach / panels;
  double sum = 0.0;
  for (int panel = 0; panel < panels; ++panel)
    for (int i = 0; i < 5; ++i) {
      const double p = half * (2 * panel + 1 + at[i]), kept = minus_ * std::exp(-2.0 * p);
      sum += half * weight[i] * std::exp(2.0 * growth * p) * 2.0 * kept / (plus_ + kept);
    }
  return square(mu_ * left_normal_) / stiffness_ * sum;
}

}  // namespace rubato::model
