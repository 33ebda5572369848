#pragma once

#include <rubato/steady/steady_solver.hpp>

namespace rubato::steady {

/// What a march writes down on its way over one or more periods: S + 1 samples at equal times, both ends included.
struct PeriodRecord {
  /// Makes room for `steps` steps of a structure. Accelerations and works may stay unwanted.
  void reset(Index observed, const system::LocallyNonlinear& system, Index steps, bool accelerations, bool works);

  bool has_works = true;
  Index steps = 0;                              ///< S
  Matrix position, velocity, acceleration;      ///< of each observed [o x S+1] [m], [m/s], [m/s2]
  Matrix slider_force, displacement;            ///< fc and u of each slider [m x S+1] [N], [m]
  Vector law_work;                              ///< dissipated by each law, then each block [laws + blocks] [J]
  double viscous_work = 0.0, input_work = 0.0;  ///< sums of C v . dq and f . dq, means of both ends of each step [J]
};

/// Half peak to peak of each row of `value`, with its time derivative at the same samples: the extrema of the cubic
/// Hermite polynomials between the samples (error h^4).
Vector half_peak_to_peak(const Matrix& value, const Matrix& slope, double step);
/// The same of samples alone: the parabola through the largest and its neighbours, of values that repeat after the
/// last.
Vector half_peak_to_peak_of_samples(const Matrix& value);
/// Root mean square about zero of each row, by the trapezoidal rule over the record.
Vector root_mean_square(const Matrix& value);

/// What the samples of one period hold at orders j that the step h does not resolve, of each observed [m]: a method of
/// second order moves the resonances by about (j omega h)^2 / 12 of their frequency, and those of a lightly damped
/// structure lie within 1 / (2 j) of a harmonic, so that what rings there is uncertain by the part
///
///   w_j = (j omega h)^2 j / 6   of itself (all of it beyond 1; nothing below a tenth, where answers with different
///                               steps tell the error by themselves).
Vector unresolved_ringing(const PeriodRecord& record);

/// Reads amplitudes, means, harmonics, works, slip shares, transitions and offsets out of a record of `periods` periods
/// of the excitation. Integrals are trapezoidal sums (beyond all orders for a smooth periodic response, h^2 at the
/// transitions); the work of a slider is the sum of (fc0 + fc1)/2 times its slip, u - fc/kT. What concerns one period
/// (works, transitions) is an average over the periods. Status, residual, error, iterations stay untouched.
void read_record(const PeriodRecord& record, const system::Excitation& excitation, const Vector& slider_stiffness,
                 int periods, const SteadyRequest& request, SteadyResponse& response);

}  // namespace rubato::steady
