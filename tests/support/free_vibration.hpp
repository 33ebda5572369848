#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::testing {

/// An undamped structure without loads or sliders, released from displacements q0 with velocities v0.
inline system::LocallyNonlinear released(const Matrix& mass, const Matrix& stiffness, const Vector& q0,
                                         const Vector& v0) {
  system::LocallyNonlinear::Parts parts;
  const Index n = mass.rows();
  parts.mass = mass.sparseView();
  parts.stiffness = stiffness.sparseView();
  parts.damping = SparseMatrix(n, n);
  parts.start.q = q0;
  parts.start.v = v0;
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  return system::LocallyNonlinear(std::move(parts));
}

inline system::LocallyNonlinear oscillator(double omega_squared, double q0 = 0.01) {
  return released(Matrix::Identity(1, 1), Matrix::Constant(1, 1, omega_squared), Vector::Constant(1, q0),
                  Vector::Zero(1));
}

/// Its exact motion, mode by mode.
class FreeVibration {
 public:
  explicit FreeVibration(const system::LocallyNonlinear& system) {
    const Matrix mass(system.mass());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(Matrix(system.stiffness()), mass);
    shapes_ = modes.eigenvectors();
    omega_ = modes.eigenvalues().cwiseSqrt();
    cosine_ = shapes_.transpose() * (mass * system.start().q);
    sine_ = (shapes_.transpose() * (mass * system.start().v)).cwiseQuotient(omega_);
  }
  /// The derivative of the given order of q at t.
  Vector at(double t, int order = 0) const {
    Vector y(omega_.size());
    for (Index i = 0; i < y.size(); ++i) {
      const double w = omega_[i], phase = w * t + order * std::acos(0.0);
      y[i] = std::pow(w, order) * (cosine_[i] * std::cos(phase) + sine_[i] * std::sin(phase));
    }
    return shapes_ * y;
  }
  const Vector& frequencies() const { return omega_; }

 private:
  Matrix shapes_;
  Vector omega_, cosine_, sine_;
};

/// The largest error of q in the mass norm, over the largest |q|_M.
template <class Truth>
class LargestError final : public integrate::Observer {
 public:
  LargestError(const system::LocallyNonlinear& system, const Truth& truth) : system_(system), truth_(truth) {}
  bool accepted(const system::State&, const system::State& after) override {
    const Vector exact = truth_(after.t), error = after.q - exact;
    largest_ = std::max(largest_, std::sqrt(error.dot(system_.mass() * error)));
    size_ = std::max(size_, std::sqrt(exact.dot(system_.mass() * exact)));
    return true;
  }
  double relative() const { return largest_ / size_; }

 private:
  const system::LocallyNonlinear& system_;
  Truth truth_;
  double largest_ = 0.0, size_ = 0.0;
};

}  // namespace rubato::testing
