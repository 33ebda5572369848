#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/integrate/step_report.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>

namespace rubato::integrate {

/// The one implementation of the generalized-alpha step (see GeneralizedAlpha), behind which Newmark, HHT, WBZ and
/// Wilson-theta stand. With the predictors qs = q0 + h v0 + h^2 (1/2 - beta) A0 and vs = v0 + h (1 - gamma) A0 it
/// solves
///
///   S A1 = l - alpha_m M A0 - C vc - K qc - B ((1 - alpha_f) fc1 + alpha_f fc0)
///   S = (1 - alpha_m) M + (1 - alpha_f) (gamma h C + beta h^2 K)
///   qc = (1 - alpha_f) qs + alpha_f q0,   vc = (1 - alpha_f) vs + alpha_f v0
///
/// where l is the load weighted between the ends (linear forces of weighted states are weighted forces). The contacts
/// see their own displacement only through the contact compliance W = beta h^2 (1 - alpha_f) B^T S^-1 B.
class AlphaStep {
 public:
  virtual ~AlphaStep() = default;

  /// Builds and factorises S for a step. Returns false if it is not positive definite.
  virtual bool prepare(double h) = 0;

  /// Writes q, v, slider_force and auxiliary_acceleration of `to` for the step prepared last.
  /// @param load  the weighted value of the law of each load term
  virtual StepReport solve(const system::State& from, const double* load, system::State& to) = 0;
};

/// Coordinates up to which matrices are full: beyond, a chain is faster sparse and a full matrix not much slower.
inline constexpr Index largest_dense_size = 64;

/// Dense with the size known at compile time (up to eight coordinates), dense, or sparse.
std::unique_ptr<AlphaStep> make_alpha_step(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system);

std::unique_ptr<AlphaStep> make_dense_alpha_step(const GeneralizedAlpha& parameters,
                                                 const system::LocallyNonlinear& system);
std::unique_ptr<AlphaStep> make_sparse_alpha_step(const GeneralizedAlpha& parameters,
                                                  const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
