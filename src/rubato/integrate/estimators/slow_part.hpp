#pragma once

#include <rubato/core/types.hpp>

namespace rubato::integrate {

/// The part of a motion x(t) [n] that is slower than a cut-off, by three equal poles:
///
///   y1' = cut (x - y1),   y2' = cut (y1 - y2),   y3' = cut (y2 - y3),   |y3/x| = (1 + (omega/cut)^2)^(-3/2)
///
/// with backward Euler over steps of any length: without memory where cut h is large. Until they remember enough the
/// poles are means over what there has been since the start, so that a pulse there is forgotten as it is spread over
/// more time: that after an impact on what is damped is gone in nanoseconds, and would have been held at its peak.
class SlowPart {
 public:
  explicit SlowPart(Index n);

  /// What x leads to at the end of a step, as value() and rate(); nothing is remembered unless accept() follows.
  /// @param change  x h [n]
  /// @param cut     [rad/s], may change from step to step
  void look(const Vector& change, double h, double cut);
  void accept();

  /// The next x counts in full, as if the motion had always been so: it starts, or has jumped.
  void forget() { is_new_ = true; }

  const Vector& value() const { return value_; }  ///< y3 of the last look() [n]
  const Vector& rate() const { return rate_; }    ///< y3'

 private:
  Vector first_, second_, third_;  // y1, y2, y3
  Vector value_, rate_;
  Vector x_;
  double share_ = 0.0, h_ = 0.0;  // of the last look
  double elapsed_ = 0.0;          // since the first
  bool is_new_ = true;
};

}  // namespace rubato::integrate
