#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

// The damper model as somebody would write it for a general integrator of ordinary differential equations: plain
// numbers, only the products that are not zero, and one smooth right-hand side between two transitions of the sliders.
namespace rubato::benchmarks {

using OdeState = std::array<double, 10>;  ///< q, then v: disk 1, blade 1, disk 2, blade 2, damper

class DamperProblem {
 public:
  static constexpr int coordinates = 5, sliders = 2;
  explicit DamperProblem(const system::LocallyNonlinear& system);

  /// The right-hand side for the present states of the sliders.
  void operator()(const double* y, double* rate, double t) const {
    const double load = std::cos(omega_ * t);
    double push = 0.0;
    for (int sector = 0; sector < 2; ++sector) {
      const int disk = 2 * sector, blade = disk + 1;
      const double *q = y, *v = y + 5;
      const double fc = force(sector, y);
      rate[disk] = v[disk];
      rate[blade] = v[blade];
      rate[5 + disk] = -(k_disk_ * q[disk] + k_join_ * q[blade] + c_disk_ * v[disk] + c_join_ * v[blade]) / m_disk_;
      rate[5 + blade] = -(k_join_ * q[disk] + k_blade_ * q[blade] + c_join_ * v[disk] + c_blade_ * v[blade]) - fc +
                        load_[sector] * load;
      push += fc;
    }
    rate[4] = y[9];
    rate[9] = push - k_damper_ * y[4] - c_damper_ * y[9];
  }

  /// d rate / d y, by columns [10 x 10].
  void jacobian(const std::function<void(int row, int column, double value)>& set) const;

  /// What vanishes, falling, at the next transition of a slider: L^2 - fc^2 while it sticks, the speed of its slip
  /// while it slips.
  double distance(int slider, const double* y) const {
    if (side_[slider] != 0) return side_[slider] * speed(slider, y);
    const double fc = force(slider, y);
    return limit_ * limit_ - fc * fc;
  }

  /// Lets a slider that has reached its transition take its next state.
  void change(int slider, const double* y);

  double period() const { return 2.0 * std::acos(-1.0) / omega_; }
  void drive(double angular_frequency) { omega_ = angular_frequency; }
  int transitions() const { return transitions_; }

 private:
  double force(int slider, const double* y) const {
    return side_[slider] != 0 ? side_[slider] * limit_ : offset_[slider] + kt_ * (y[2 * slider + 1] - y[4]);
  }
  double speed(int slider, const double* y) const { return y[5 + 2 * slider + 1] - y[9]; }

  double omega_, m_disk_, k_disk_, k_join_, k_blade_, k_damper_, c_disk_, c_join_, c_blade_, c_damper_;
  double load_[2] = {0.0, 0.0};
  double kt_, limit_;
  int side_[2] = {0, 0};  // 0 sticking, otherwise the sign of its force
  double offset_[2] = {0.0, 0.0};
  int transitions_ = 0;
};

/// Displacements at the samples, eight a period after the start.
using Samples = std::vector<std::array<double, 5>>;
inline constexpr int samples_a_period = 8;

/// A run from rest over so many periods with a tolerance, relative and absolute.
Samples run_odeint(DamperProblem problem, int periods, double tolerance);
enum class Multistep { adams, bdf };
Samples run_cvode(DamperProblem problem, int periods, double tolerance, Multistep method);

}  // namespace rubato::benchmarks
