#pragma once

#include <rubato/integrate/estimators/response_scales.hpp>
#include <rubato/numerics/formula_swings.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <cmath>
#include <memory>
#include <vector>

namespace rubato::integrate {

/// What estimators ask of the equations: how large a motion is, and how fast. A workspace: one a march.
class ErrorSpace {
 public:
  virtual ~ErrorSpace() = default;

  virtual Index size() const = 0;
  /// M x, kept until the next call.
  virtual const Vector& times_mass(const Vector& x) = 0;
  /// Size of the displacements of a state in the mass norm [m sqrt(kg)]; of a mechanism from where it started.
  virtual double displacement(const system::State& state) = 0;
  /// Size that errors are measured by even where nothing has moved yet [m sqrt(kg)].
  virtual double least_size() { return 0.0; }
  /// What rounding and Newton's method leave of the displacement of a step [m sqrt(kg)]: less is no error of the step.
  virtual double round_off() const { return 0.0; }
  /// Size that a state promises [m sqrt(kg)]; 0 where only what has moved counts.
  virtual double promised_size(const ResponseScales& scales) = 0;
  virtual ResponseScales scales(const system::State& state, const Vector& acceleration, double duration) = 0;
  /// Whether nothing brings back what goes too slowly: an error of speed then grows into one of place for the whole
  /// march.
  virtual bool turns_freely() const { return false; }
  virtual bool has_stops() const = 0;
  /// Whether a stop is closed.
  virtual bool touches(const system::State& state) const = 0;
  virtual bool is_damped() const = 0;
  /// |T x|_M^2 with the times T over which errors of a motion x are remembered (DampingMemory).
  virtual double remembered_squared(const Vector& x) = 0;
  /// The same without what creeps: of errors of velocity as the displacements that they become.
  virtual double decaying_squared(const Vector& x) = 0;

  double squared(const Vector& x) { return x.dot(times_mass(x)); }
  double norm(const Vector& x) { return std::sqrt(squared(x)); }
};

/// That of a structure; the system must outlive it.
/// @param duration  of the march, whose loads promise a size [s]
/// @param bounds    how they swing
std::unique_ptr<ErrorSpace> make_error_space(const system::LocallyNonlinear& system, double duration,
                                             const std::vector<numerics::StepBound>& bounds);

}  // namespace rubato::integrate
