#include <rubato/steady/harmonic_balance/hysteresis_loop.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::steady {
namespace {
using std::numbers::pi;
}

void HysteresisLoop::pass(double stiffness, double limit, double mean, const Orders& orders,
                          const Complex* coefficients, double offset) {
  stiffness_ = stiffness;
  limit_ = limit;
  mean_ = mean;
  orders_ = orders;
  coefficients_ = coefficients;
  pieces_.clear();
  offset_ = 0.0;
  offset_is_bound_ = false;

  is_idle_ = limit == 0.0;
  slips_ = false;
  turning_.find(orders, coefficients);
  if (is_idle_) return;
  const auto points = turning_.points();
  const double highest = turning_.highest(), lowest = turning_.lowest();
  slips_ = stiffness * (highest - lowest) > 2.0 * limit;
  if (!slips_) {
    const double least = -limit - stiffness * (mean + lowest), most = limit - stiffness * (mean + highest);
    offset_ = std::clamp(offset, std::min(least, most), std::max(least, most));
    offset_is_bound_ = offset_ != offset;
    offset_at_top_ = offset_is_bound_ && offset_ == most;
    return;
  }

  Piece piece{};
  piece.reversal = points[0].angle;
  piece.u_reversal = highest;
  piece.force_reversal = limit;
  piece.at_reversal = points[0].unit_vector;
  const std::size_t stretches = turning_.is_half() ? points.size() - 1 : points.size();
  for (std::size_t i = 0; i < stretches; ++i) {
    const auto& low = points[i];
    auto high = points[i + 1 < points.size() ? i + 1 : 0];
    if (i + 1 == points.size()) high.angle += 2.0 * pi;
    const double trial = piece.force_reversal + stiffness * (high.value - piece.u_reversal);
    if (std::abs(trial) <= limit) continue;
    piece.sign = trial > 0.0 ? 1.0 : -1.0;
    piece.u_start = piece.u_reversal + (piece.sign * limit - piece.force_reversal) / stiffness;
    piece.at_start =
        angle_of_value(orders, coefficients, piece.u_start, low.angle, low.value, high.angle, high.value, piece.start);
    piece.end = high.angle;
    piece.u_end = high.value;
    piece.at_end = high.unit_vector;
    pieces_.push_back(piece);
    piece.at_reversal = piece.at_end;
    piece.reversal = piece.end;
    piece.u_reversal = piece.u_end;
    piece.force_reversal = piece.sign * limit;
  }

  // Two maxima of one height: the way from the last reversal back to the first is one of sticking.
  const double closing = points[0].angle + (turning_.is_half() ? pi : 2.0 * pi);
  if (piece.reversal < closing && !turning_.is_half()) {
    piece.sign = 0.0;
    piece.start = piece.end = closing;
    piece.u_start = piece.u_end = highest;
    piece.at_start = piece.at_end = points[0].unit_vector;
    pieces_.push_back(piece);
  }

  extend(orders.highest());
}

void HysteresisLoop::extend(int highest_order) {
  reach_ = highest_order;
  if (!slips_) return;
  const auto row = static_cast<std::size_t>(reach_ + 1), integrals = static_cast<std::size_t>(2 * reach_ + 1);
  powers_.resize(3 * pieces_.size() * row);
  slip_integrals_.resize(pieces_.size() * integrals);
  // In half a period odd orders meet odd ones: differences of their orders are even.
  const int stride = turning_.is_half() ? 2 : 1;
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    const Piece& piece = pieces_[j];
    Complex* out = powers_.data() + 3 * j * row;
    for (const Complex z : {piece.at_reversal, piece.at_start, piece.at_end}) {
      const Complex factor = stride == 1 ? z : product(z, z);
      Complex power = z;
      for (int k = 1; k <= reach_; k += stride) {
        out[k] = power;
        power = product(power, factor);
      }
      out += row;
    }
    Complex* const integral = slip_integrals_.data() + j * integrals;
    integral[0] = piece.end - piece.start;
    const Complex start = stride == 1 ? piece.at_start : product(piece.at_start, piece.at_start);
    const Complex end = stride == 1 ? piece.at_end : product(piece.at_end, piece.at_end);
    Complex ps = 1.0, pe = 1.0;
    for (int p = stride; p <= 2 * reach_; p += stride) {
      ps = product(ps, start);
      pe = product(pe, end);
      const double inverse = 1.0 / p;
      integral[p] = Complex((pe.imag() - ps.imag()) * inverse, (ps.real() - pe.real()) * inverse);
    }
  }
}

Complex HysteresisLoop::force(int k) const {
  if (is_idle_) return 0.0;
  const bool contained = (k - 1) % orders_.stride == 0 && k <= orders_.highest();
  const Complex uk = contained ? coefficients_[(k - 1) / orders_.stride] : 0.0;
  if (!slips_) return stiffness_ * uk;
  Complex sum = 0.0;
  for (std::size_t j = 0; j < pieces_.size(); ++j)
    for (int i = 0; i < orders_.count; ++i) {
      const int l = orders_.at(i);
      const Complex c = coefficients_[i];
      const Complex twice = product(c, slip_integral(j, l - k)) - product(std::conj(c), slip_integral(j, -l - k));
      sum += (0.5 * l) * Complex(-twice.imag(), twice.real());
    }
  if (turning_.is_half()) sum *= 2.0;
  // S / (i pi k)
  return stiffness_ * (uk - Complex(sum.imag(), -sum.real()) / (pi * k));
}

void HysteresisLoop::derivative(int k, int l, Complex& by_real, Complex& by_imaginary) const {
  by_real = k == l && !is_idle_ ? stiffness_ : 0.0;
  by_imaginary = Complex(0.0, by_real.real());
  if (!slips_) return;
  Complex real = 0.0, imaginary = 0.0;
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    if (pieces_[j].sign == 0.0) continue;
    const int r = static_cast<int>(3 * j);
    const Complex change = powers(r + 1)[l] - powers(r)[l];
    const Complex at_start = std::conj(powers(r + 1)[k]);
    const Complex down = slip_integral(j, l - k), up = slip_integral(j, -l - k);
    const Complex difference = down - up, sum = down + up;
    real += change.real() * at_start + (0.5 * l) * Complex(-difference.imag(), difference.real());
    imaginary -= change.imag() * at_start + (0.5 * l) * sum;
  }
  const double factor = stiffness_ * (turning_.is_half() ? 2.0 : 1.0) / (pi * k);
  by_real -= factor * Complex(real.imag(), -real.real());
  by_imaginary -= factor * Complex(imaginary.imag(), -imaginary.real());
}

double HysteresisLoop::mean_force() const {
  if (is_idle_) return 0.0;
  if (!slips_) return stiffness_ * mean_ + offset_;
  if (turning_.is_half()) return 0.0;
  double sum = 0.0;
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    const Piece& p = pieces_[j];
    const int r = static_cast<int>(3 * j);
    sum += (p.start - p.reversal) * (p.force_reversal - stiffness_ * p.u_reversal);
    for (int i = 0; i < orders_.count; ++i) {
      const int k = orders_.at(i);
      sum += stiffness_ * product(coefficients_[i], powers(r + 1)[k] - powers(r)[k]).imag() / k;
    }
    sum += (p.end - p.start) * p.sign * limit_;
  }
  return sum / (2.0 * pi);
}

void HysteresisLoop::mean_derivative(int l, double& by_real, double& by_imaginary) const {
  by_real = by_imaginary = 0.0;
  if (turning_.is_half() || is_idle_) return;
  if (!slips_) {
    if (!offset_is_bound_) return;
    // The offset follows the turning point that reaches the limit.
    const auto points = turning_.points();
    if (points.empty()) return;
    const auto& at = offset_at_top_ ? points.front()
                                    : *std::min_element(points.begin(), points.end(),
                                                        [](const auto& a, const auto& b) { return a.value < b.value; });
    by_real = -stiffness_ * std::cos(l * at.angle);
    by_imaginary = stiffness_ * std::sin(l * at.angle);
    return;
  }
  for (std::size_t j = 0; j < pieces_.size(); ++j) {
    const Piece& p = pieces_[j];
    const int r = static_cast<int>(3 * j);
    const Complex change = powers(r + 1)[l] - powers(r)[l], before = powers(r)[l];
    const double length = p.start - p.reversal;
    by_real += change.imag() / l - length * before.real();
    by_imaginary += change.real() / l + length * before.imag();
  }
  by_real *= stiffness_ / (2.0 * pi);
  by_imaginary *= stiffness_ / (2.0 * pi);
}

double HysteresisLoop::dissipated() const {
  double sum = 0.0;
  for (const Piece& p : pieces_) sum += limit_ * std::abs(p.u_end - p.u_start);
  return turning_.is_half() ? 2.0 * sum : sum;
}

double HysteresisLoop::slip_share() const {
  if (is_idle_) return 1.0;
  double sum = 0.0;
  for (const Piece& p : pieces_) sum += p.end - p.start;
  return sum / (turning_.is_half() ? pi : 2.0 * pi);
}

long HysteresisLoop::transitions() const {
  long sum = 0;
  for (const Piece& p : pieces_) sum += p.sign == 0.0 ? 0 : 2;
  return turning_.is_half() ? 2 * sum : sum;
}

double HysteresisLoop::force_at(double angle) const {
  if (is_idle_) return 0.0;
  const auto u_at = [&](double at) { return evaluate(orders_, coefficients_, unit(at)).value; };
  if (!slips_) return stiffness_ * (mean_ + u_at(angle)) + offset_;
  const double period = turning_.is_half() ? pi : 2.0 * pi, first = pieces_.front().reversal;
  const double passed = std::floor((angle - first) / period);
  const bool mirrored = turning_.is_half() && std::fmod(std::abs(passed), 2.0) == 1.0;
  const double place = angle - passed * period, side = mirrored ? -1.0 : 1.0;
  for (const Piece& p : pieces_) {
    if (place > p.end) continue;
    if (place >= p.start) return side * p.sign * limit_;
    return side * std::clamp(p.force_reversal + stiffness_ * (u_at(place) - p.u_reversal), -limit_, limit_);
  }
  return side * pieces_.back().sign * limit_;
}

}  // namespace rubato::steady
