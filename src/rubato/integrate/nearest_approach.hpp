#pragma once

#include <fmt/format.h>

#include <limits>
#include <string>

namespace rubato::integrate {

/// How near a motion came to a limit that it may never reach, at the ends of its steps.
class NearestApproach {
 public:
  /// @param distance  to the limit, negative beyond it [m] or [rad]
  void note(double t, double distance) {
    if (distance >= nearest_) return;
    nearest_ = distance;
    at_ = t;
  }
  void reach() { is_reached_ = true; }
  /// Empty where it was reached.
  /// @param what  "the stop of "hinge""
  std::string told(const std::string& what, bool is_angle) const {
    if (is_reached_ || !(nearest_ > 0.0) || nearest_ == far) return {};
    return fmt::format("{} is never reached: it is nearest at t = {:.4g} s, {:.4g} {} away", what, at_, nearest_,
                       is_angle ? "rad" : "m");
  }

 private:
  static constexpr double far = std::numeric_limits<double>::infinity();
  double nearest_ = far, at_ = 0.0;
  bool is_reached_ = false;
};

}  // namespace rubato::integrate
