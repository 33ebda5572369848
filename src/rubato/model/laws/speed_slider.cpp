#include <rubato/model/laws/law_resolution.hpp>
#include <rubato/model/laws/only_transient.hpp>
#include <rubato/model/laws/speed_slider.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

class SpeedSlider final : public Law, public LawResolution, public OnlyTransient {
 public:
  SpeedSlider(double stiffness, numerics::Formula coefficient)
      : stiffness_(stiffness), coefficient_(std::move(coefficient)), at_rest_(coefficient_(0.0, std::array{0.0})) {}

  Index memory_size() const override { return 2; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    next[0] = next[1] = 0.0;
    if (!(to.normal > 0.0)) return {std::isnan(to.normal) ? to.normal : 0.0};
    const double travel = to.u - from.u;
    double by_u = stiffness_, by_normal = 0.0, trial = start(from, memory) + stiffness_ * travel;
    if (from.normal < 0.0) {  // the ends meet within the step
      const double rise = to.normal - from.normal;
      by_u = stiffness_ * to.normal / rise;
      by_normal = -stiffness_ * travel * from.normal / (rise * rise);
      trial = by_u * travel;
    }
    const double side = std::copysign(1.0, trial);
    const numerics::ValueAndSlope mu = coefficient(side, to.rate);
    const bool has_slipped = memory[1] * side > 0.0 && !(from.normal < 0.0);
    const double largest = has_slipped ? mu.value : std::max(mu.value, at_rest_);
    if (std::abs(trial) <= largest * to.normal) {
      next[0] = trial;
      return {trial, by_u, 0.0, by_normal};
    }
    next[0] = side * mu.value * to.normal;
    next[1] = side;
    return {next[0], 0.0, side * mu.slope * to.normal, side * mu.value};
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    if (!(point.normal > 0.0)) return {};
    const double force = start(point, memory), side = std::copysign(1.0, force);
    if (memory[1] == 0.0 && std::abs(force) < limit(side, point, false)) return {force, stiffness_, 0.0};
    // At its limit: it slips on, or comes back; from rest both.
    const numerics::ValueAndSlope mu = coefficient(side, point.rate);
    const double slip = side * point.rate > 0.0 ? 1.0 : point.rate == 0.0 ? 0.5 : 0.0;
    return {force, (1.0 - slip) * stiffness_, slip * side * mu.slope * point.normal, slip * side * mu.value};
  }

  double stored_energy(double, const double* memory) const override { return 0.5 * memory[0] * memory[0] / stiffness_; }

  /// The force times the slip, which both go in straight lines while it slips.
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double* next) const override {
    const double begin = start(from, memory);
    // A limit that jumps lets the spring go back to what is left.
    const double let_go = 0.5 * (memory[0] * memory[0] - begin * begin) / stiffness_;
    const double rise = to.normal - from.normal, travel = to.u - from.u;
    // The part of the step in which the ends are together.
    const double met = from.normal < 0.0 && to.normal > 0.0 ? -from.normal / rise : 0.0;
    const double parted = from.normal > 0.0 && to.normal < 0.0 ? -from.normal / rise : 1.0;
    if (!(from.normal > 0.0 || to.normal > 0.0)) return let_go;
    const double trial = begin + stiffness_ * (parted - met) * travel, side = std::copysign(1.0, trial);
    const double first = limit(side, from, memory[1] * side > 0.0), last = limit(side, to, true);
    const double outside = std::abs(trial) - last, inside = std::max(0.0, first - side * begin);
    if (!(outside > 0.0) || (to.normal > 0.0 && next[1] == 0.0)) return let_go;
    const double since = last + (first - last) * outside / (outside + inside);
    return let_go + 0.5 * (since + last) * outside / stiffness_;
  }

  /// Where friction falls with the speed an implicit step may find slip long before the force has come to its limit.
  double unresolved(const LawPoint& from, const LawPoint& to) const override {
    constexpr double largest_fall = 0.1;  // of the friction at rest
    if (!(from.normal > 0.0 || to.normal > 0.0) || !(at_rest_ > 0.0)) return 0.0;
    const double slow = std::min(std::abs(from.rate), std::abs(to.rate));
    const double fast = std::max(std::abs(from.rate), std::abs(to.rate));
    const double side = std::copysign(1.0, std::abs(to.rate) > std::abs(from.rate) ? to.rate : from.rate);
    const double fall = coefficient(side, side * slow).value - coefficient(side, side * fast).value;
    return std::max(0.0, fall) / (largest_fall * at_rest_);
  }

  Contact contact(const LawPoint& point, const double* memory, double near) const override {
    constexpr double round_off = 256.0 * std::numeric_limits<double>::epsilon();
    const double meeting = near * point.normal_rate;
    if (!(point.normal > -meeting) || (point.normal <= 0.0 && meeting <= 0.0)) return Contact::open;
    const double force = start(point, memory), side = std::copysign(1.0, force == 0.0 ? point.rate : force);
    const bool slips_still = memory[1] * side > 0.0;
    const double most = limit(side, point, slips_still), left = most - std::abs(force), speed = side * point.rate;
    if (!slips_still && left > std::max(round_off * most, near * stiffness_ * std::abs(speed))) return Contact::sticks;
    if (near > 0.0 && !(speed > 0.0)) return Contact::sticks;
    return side > 0.0 ? Contact::slips_forwards : Contact::slips_backwards;
  }

  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    // What presses may be a force that is never below zero: open there, and closed beyond.
    constexpr double inside = std::numeric_limits<double>::min();
    const Contact begins = contact(from, memory, near);
    if (begins == Contact::open) return to.normal == 0.0 ? inside : -to.normal;
    if (begins == Contact::sticks) {
      const double trial = start(from, memory) + stiffness_ * (to.u - from.u);
      return limit(std::copysign(1.0, trial), to, false) - std::abs(trial);
    }
    return std::min(begins == Contact::slips_forwards ? to.rate : -to.rate,
                    to.normal == 0.0 && to.normal_rate == 0.0 ? -inside : to.normal);
  }

  bool takes_normal() const override { return true; }
  bool depends_on_rate() const override { return true; }
  double sticking_stiffness() const override { return stiffness_; }
  double largest_stiffness() const override { return stiffness_; }

  const char* why_no_steady_response() const override {
    return "has a friction_coefficient that depends on the rate, which steady responses do not carry; run a transient, "
           "or "
           "take a [[lugre]] element, whose friction falls with the speed too";
  }

 private:
  /// mu while it slips to a side, with its slope by the rate.
  numerics::ValueAndSlope coefficient(double side, double rate) const {
    if (!(side * rate > 0.0)) return {at_rest_, 0.0};
    const numerics::ValueAndSlope mu = coefficient_.with_slope(0, 0.0, std::array{rate});
    if (mu.value >= 0.0) return mu;
    return {std::numeric_limits<double>::quiet_NaN(), 0.0};  // no friction: the step fails
  }

  /// What the force may be: while it sticks at least as at rest.
  double limit(double side, const LawPoint& point, bool slips) const {
    const double mu = coefficient(side, point.rate).value;
    return (slips ? mu : std::max(mu, at_rest_)) * std::max(0.0, point.normal);
  }

  /// The force at the start of a step, within what is allowed then.
  double start(const LawPoint& from, const double* memory) const {
    const double side = std::copysign(1.0, memory[0]), most = limit(side, from, memory[1] * side > 0.0);
    return std::clamp(memory[0], -most, most);
  }

  double stiffness_;               // kT [N/m]
  numerics::Formula coefficient_;  // mu, of the rate
  double at_rest_;                 // mu at no speed
};

}  // namespace

std::shared_ptr<const Law> make_speed_slider(double stiffness, numerics::Formula coefficient) {
  return std::make_shared<SpeedSlider>(stiffness, std::move(coefficient));
}

}  // namespace rubato::model
