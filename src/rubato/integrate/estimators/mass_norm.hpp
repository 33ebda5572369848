#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// |x|_M = sqrt(x^T M x): metres and radians add in it as energies do.
class MassNorm {
 public:
  explicit MassNorm(const system::LocallyNonlinear& system) : system_(system), product_(system.size()) {
    if (system.has_diagonal_mass()) diagonal_ = system.mass().diagonal();
  }

  /// M x, kept until the next call.
  const Vector& times(const Vector& x) {
    if (diagonal_.size() > 0)
      product_ = diagonal_.cwiseProduct(x);
    else
      product_.noalias() = system_.mass() * x;
    return product_;
  }
  double squared(const Vector& x) { return x.dot(times(x)); }
  double operator()(const Vector& x) { return std::sqrt(squared(x)); }

 private:
  const system::LocallyNonlinear& system_;
  Vector diagonal_, product_;
};

}  // namespace rubato::integrate
