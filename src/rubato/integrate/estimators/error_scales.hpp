#pragma once

#include <rubato/integrate/estimators/error_space.hpp>

namespace rubato::integrate {

/// By what a local error is measured: the size s of the response, its frequency omega, which turns an error of velocity
/// into one of displacement, and the time T over which errors add up.
///
/// omega^2 = <|y'|^2>/<|y|^2> of what the error is made of, both averaged over about a period; what the start promises
/// stands in for the past, since y alone may begin at zero. T^2 = <|T y|^2>/<|y|^2> with the memory of each motion in y
/// (DampingMemory): the whole march without damping, the time over which an error is forgotten with it. What costs
/// products with the matrices is looked at on every fourth step: it changes over periods.
///
/// A contact is passed in one go, and an error of its velocity stays in what follows as long as the speed stays as it
/// is: where it is lower,
///
///   Omega^2 = <(d|v|_M/dt)^2>/<|v|_M^2>
///
/// over all of the past without contacts stands for omega there.
class ErrorScales {
 public:
  /// @param derivative  of q that the y of accept() is: 3 or 1
  ErrorScales(ErrorSpace& space, double duration, int derivative);

  void start(const system::State& state);

  /// sqrt(|dq|_M^2 + |dv|_M^2/omega^2)/s; where nothing has moved before `to`, size and frequency are those of `to`.
  /// @param is_contact  a stop is closed at an end of the step
  double relative(double dq_squared, double dv_squared, const system::State& to, bool is_contact) const;

  /// The time T of a try, from what it remembers itself where that is due: on every fourth step, and on each of another
  /// length than the last, since a motion that has died makes way for one of another memory within a few steps that
  /// grow.
  /// @param shape  whose errors are remembered [n], |shape|_M^2 beside it
  double memory_of(const Vector& shape, double shape_squared, double h);

  /// The same time of errors of velocity that count as the displacements that they become, from a motion w [n] (the
  /// second derivative of q, |w|_M^2 beside it); to be asked for after memory_of().
  double decay_of(const Vector& w, double squared, double h);

  /// Takes in an accepted step, which memory_of() was asked for.
  /// @param y     |y|_M^2
  /// @param rate  |y'|_M^2, negative where unknown
  void accept(double y, double rate, const system::State& to, double h);

  double size() const { return size_; }
  double frequency() const;
  double speed_frequency() const;  ///< Omega [rad/s]
  double memory() const;
  double mean_square() const { return y_; }  ///< of y
  /// |q'''|_M to expect after start().
  double third_derivative() const { return third_at_start_; }

 private:
  /// A time T, T^2 = <|T y|^2>/<|y|^2>, from the looks at it.
  struct Memory {
    double remembered = 0.0, measured = 0.0;           // averages; 0: unknown
    double remembered_now = -1.0, measured_now = 0.0;  // of the last try; negative: not due
    double most(double duration) const;
    double with_now(double duration) const;
    void accept(double weight);
  };

  bool is_due(double squared, double h) const;
  void expect(const system::State& state);

  ErrorSpace& space_;
  double duration_;
  int derivative_;
  bool is_damped_;
  bool has_stops_;
  double size_ = 0.0, third_at_start_ = 0.0;
  double y_ = 0.0, rate_ = 0.0;  // averages of |y|^2 and |y'|^2
  Memory memory_, decay_;
  double last_step_ = 0.0;
  double speed_ = 0.0, speed_rate_ = 0.0;  // integrals of |v|^2 and (d|v|/dt)^2 over time
  double promised_ = 0.0;                  // Omega before anything has moved
  long steps_ = 0;
};

}  // namespace rubato::integrate
