#pragma once

#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>

namespace rubato::integrate {

/// The time T over which errors of a motion x [n] are remembered, on the structure with its sliders free and its stops
/// open, within a duration 1/D:
///
///   |T x|_M = max(|2 (C + 2 D M)^-1 M x|_M, |(K + D C + D^2 M)^-1 C x|_M)
///
/// In a mode with damping c and stiffness k of a unit mass that is the larger of 2/(c + 2 D) and c/(k + D c + D^2): the
/// duration without damping, 2/c with little, and c/k where a mode is overdamped and creeps. Other than the quotient
/// x^T C x/(2 x^T M x), which what is stiff and damped rules however small its share of x is, it is a sum of the
/// memories of the modes. Where damping couples the modes it errs to the long side.
class DampingMemory {
 public:
  /// The system must outlive it. The matrices are factorised at the first use.
  /// @param duration  [s]
  DampingMemory(const system::LocallyNonlinear& system, double duration)
      : system_(system), duration_(duration), norm_(system) {}

  /// |T x|_M^2
  double squared(const Vector& x);
  /// Of what decays alone: |2 (C + 2 D M)^-1 M x|_M^2
  double decaying_squared(const Vector& x);

 private:
  struct Factors;

  void factorise();

  const system::LocallyNonlinear& system_;
  double duration_;
  MassNorm norm_;
  std::shared_ptr<Factors> factors_;
};

}  // namespace rubato::integrate
