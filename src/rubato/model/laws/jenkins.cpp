#include <rubato/model/laws/jenkins.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

class Jenkins final : public Law, public LawSlopes {
 public:
  Jenkins(double stiffness, double friction_coefficient) : stiffness_(stiffness), mu_(friction_coefficient) {}

  Index memory_size() const override { return 1; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    next[0] = 0.0;
    if (!(to.normal > 0.0)) return {std::isnan(to.normal) ? to.normal : 0.0};
    const double limit = mu_ * to.normal, travel = to.u - from.u;
    double by_u = stiffness_, by_normal = 0.0;
    double trial = start(from, memory) + stiffness_ * travel;
    if (from.normal < 0.0) {  // the ends meet within the step
      const double rise = to.normal - from.normal, touching = to.normal / rise;
      by_u = stiffness_ * touching;
      by_normal = -stiffness_ * travel * from.normal / (rise * rise);
      trial = by_u * travel;
    }
    if (std::abs(trial) <= limit) {
      next[0] = trial;
      return {trial, by_u, 0.0, by_normal};
    }
    next[0] = std::copysign(limit, trial);
    return {next[0], 0.0, 0.0, std::copysign(mu_, trial)};
  }

  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    double next = 0.0;
    const LawAnswer answer = advance(from, memory, to, &next);
    const bool is_kept = answer.by_u == stiffness_ && std::abs(memory[0]) <= mu_ * from.normal;
    for (const int row : {0, 5}) {
      slopes[row] = answer.by_u;
      slopes[row + 2] = -answer.by_u;
      slopes[row + 4] = is_kept ? 1.0 : 0.0;
    }
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    const double limit = mu_ * point.normal, force = memory[0];
    if (!(limit > 0.0)) return {};
    if (std::abs(force) < limit) return {force, stiffness_, 0.0};
    // At its limit: it slips on, or comes back; from rest both.
    const double slip = force * point.rate > 0.0 ? 1.0 : point.rate == 0.0 ? 0.5 : 0.0;
    return {std::copysign(limit, force), (1.0 - slip) * stiffness_, 0.0, slip * std::copysign(mu_, force)};
  }

  double stored_energy(double, const double* memory) const override { return 0.5 * memory[0] * memory[0] / stiffness_; }

  /// mu N times the slip, both of which go in straight lines while it slips.
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double*) const override {
    const double begin = start(from, memory);
    // A load that jumps lets the spring go back to the limit that is left.
    const double let_go = 0.5 * (memory[0] * memory[0] - begin * begin) / stiffness_;
    const double rise = to.normal - from.normal, travel = to.u - from.u;
    // The part of the step in which the ends are together, and what presses at its ends.
    const double met = from.normal < 0.0 && to.normal > 0.0 ? -from.normal / rise : 0.0;
    const double parted = from.normal > 0.0 && to.normal < 0.0 ? -from.normal / rise : 1.0;
    const double first = std::max(from.normal, 0.0), last = std::max(to.normal, 0.0);
    if (!(first > 0.0 || last > 0.0)) return let_go;
    const double trial = begin + stiffness_ * (parted - met) * travel, side = std::copysign(1.0, trial);
    const double outside = std::abs(trial) - mu_ * last, inside = mu_ * first - side * begin;
    if (!(outside > 0.0)) return let_go;
    const double slipping = outside / (outside + inside);  // share of that part
    const double since = last + (first - last) * slipping, slip = outside / stiffness_;
    return let_go + 0.5 * mu_ * (since + last) * slip;
  }

  Contact contact(const LawPoint& point, const double* memory, double near) const override {
    constexpr double round_off = 256.0 * std::numeric_limits<double>::epsilon();
    const double meeting = near * point.normal_rate;
    if (!(point.normal > -meeting) || (point.normal <= 0.0 && meeting <= 0.0)) return Contact::open;
    const double limit = mu_ * std::max(point.normal, 0.0), force = start(point, memory);
    const double side = std::copysign(1.0, force == 0.0 ? point.rate : force);
    const double speed = slip_rate(point, side);  // with which it would slip
    const double left = limit - std::abs(force);
    if (left > std::max(round_off * limit, near * stiffness_ * std::abs(speed))) return Contact::sticks;
    if (near > 0.0 && !(speed > 0.0)) return Contact::sticks;
    return side > 0.0 ? Contact::slips_forwards : Contact::slips_backwards;
  }

  bool is_exact_between_guards() const override { return true; }
  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    // What presses may be a force that is never below zero: open there, and closed beyond.
    constexpr double inside = std::numeric_limits<double>::min();
    const Contact begins = contact(from, memory, near);
    switch (begins) {
      case Contact::open:
        return to.normal == 0.0 ? inside : -to.normal;
      case Contact::slips_forwards:
      case Contact::slips_backwards:
        return std::min(slip_rate(to, begins == Contact::slips_forwards ? 1.0 : -1.0),
                        to.normal == 0.0 && to.normal_rate == 0.0 ? -inside : to.normal);
      default:
        return mu_ * to.normal - std::abs(start(from, memory) + stiffness_ * (to.u - from.u));
    }
  }

  bool takes_normal() const override { return true; }
  double sticking_stiffness() const override { return stiffness_; }
  double largest_stiffness() const override { return stiffness_; }
  bool is_odd() const override { return true; }

 private:
  /// The speed at which it slips to a side: of u - f/k, where f is at the limit of that side.
  double slip_rate(const LawPoint& at, double side) const { return side * at.rate - mu_ * at.normal_rate / stiffness_; }

  /// The force at the start of a step, within what presses then.
  double start(const LawPoint& from, const double* memory) const {
    const double limit = mu_ * std::max(from.normal, 0.0);
    return std::clamp(memory[0], -limit, limit);
  }

  double stiffness_, mu_;
};

}  // namespace

std::shared_ptr<const Law> make_jenkins(double stiffness, double friction_coefficient) {
  return std::make_shared<Jenkins>(stiffness, friction_coefficient);
}

}  // namespace rubato::model
