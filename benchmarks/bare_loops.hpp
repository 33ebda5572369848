#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

// Average acceleration written out by hand, the load read from a table made beforehand or computed with one cosine a
// step. No driver, no state to keep, no check: the bound by which the public driver is judged.
namespace rubato::benchmarks {

inline std::vector<double> load_table(double angular_frequency, double h, long steps) {
  std::vector<double> values(static_cast<std::size_t>(steps));
  for (long i = 0; i < steps; ++i)
    values[static_cast<std::size_t>(i)] = std::cos(angular_frequency * h * double(i + 1));
  return values;
}

inline double angular_frequency_of(const system::LocallyNonlinear& system) {
  return std::get<model::HarmonicLaw>(system.loads().terms()[0].law).angular_frequency;
}

/// m a + c v + k q + fc = f cos(omega t) with one slider to the ground.
class BareOne {
 public:
  BareOne(const system::LocallyNonlinear& system, double h, long steps)
      : h_(h),
        omega_(angular_frequency_of(system)),
        m_(system.mass().coeff(0, 0)),
        c_(system.damping().coeff(0, 0)),
        k_(system.stiffness().coeff(0, 0)),
        kt_(system.sliders()[0].stiffness),
        limit_(system.sliders()[0].limit),
        table_(load_table(omega_, h, steps)) {}

  /// The last displacement.
  double run(long steps, bool with_cosine) const { return with_cosine ? loop<true>(steps) : loop<false>(steps); }

 private:
  template <bool with_cosine>
  double loop(long steps) const {
    const double h = h_, b = 0.25 * h * h, g = 0.5 * h;
    const double inverse = 1.0 / (m_ + g * c_ + b * k_), on_q = k_ * inverse, on_v = c_ * inverse;
    const double soften = 1.0 / (1.0 + kt_ * b * inverse);
    double q = 0.0, v = 0.0, a = 1.0 / m_, fc = 0.0;
    for (long i = 0; i < steps; ++i) {
      const double load = with_cosine ? std::cos(omega_ * (h * double(i + 1))) : table_[static_cast<std::size_t>(i)];
      const double qs = q + h * v + b * a, vs = v + g * a;
      const double free = load * inverse - on_q * qs - on_v * vs;
      fc = std::clamp((fc + kt_ * (qs - q + b * free)) * soften, -limit_, limit_);
      a = free - fc * inverse;
      q = qs + b * a;
      v = vs + g * a;
    }
    return q;
  }

  double h_, omega_, m_, c_, k_, kt_, limit_;
  std::vector<double> table_;
};

/// Five coordinates and two sliders (blades 1 and 3 against damper 4), matrices multiplied out beforehand: plain arrays
/// of a known size, every index a constant.
class BareDamper {
  static constexpr int n = 5;
  static constexpr int blade[2] = {1, 3};
  static constexpr int damper = 4;

 public:
  BareDamper(const system::LocallyNonlinear& system, double h, long steps)
      : h_(h), omega_(angular_frequency_of(system)), table_(load_table(omega_, h, steps)) {
    const Matrix m(system.mass()), c(system.damping()), k(system.stiffness());
    const Matrix inverse = (m + 0.5 * h * c + 0.25 * h * h * k).inverse();
    Vector load = Vector::Zero(n);
    const auto& term = system.loads().terms()[0];
    for (std::size_t i = 0; i < term.rows.size(); ++i) load[term.rows[i]] += term.weights[i];
    const Vector start = m.inverse() * load, on_load = inverse * load;
    const Matrix on_q = -inverse * k, on_v = -inverse * c;
    kt_ = system.sliders()[0].stiffness;
    limit_ = system.sliders()[0].limit;
    for (int i = 0; i < n; ++i) {
      start_[i] = start[i];
      on_load_[i] = on_load[i];
      for (int j = 0; j < n; ++j) {
        on_q_[j][i] = on_q(i, j);
        on_v_[j][i] = on_v(i, j);
      }
      for (int s = 0; s < 2; ++s) on_slider_[s][i] = inverse(i, blade[s]) - inverse(i, damper);
    }
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) q_[i][j] = 0.25 * h * h * kt_ * (on_slider_[j][blade[i]] - on_slider_[j][damper]);
  }

  double run(long steps, bool with_cosine) const { return with_cosine ? loop<true>(steps) : loop<false>(steps); }

 private:
  template <bool with_cosine>
  double loop(long steps) const {
    const double h = h_, b = 0.25 * h * h, g = 0.5 * h, kt = kt_, limit = limit_;
    const double d0 = 1.0 + q_[0][0], d1 = 1.0 + q_[1][1], c01 = q_[0][1], c10 = q_[1][0];
    const double inverse = 1.0 / (d0 * d1 - c01 * c10), i0 = 1.0 / d0, i1 = 1.0 / d1;
    double q[n] = {}, v[n] = {}, a[n], qs[n], vs[n];
    double f0 = 0.0, f1 = 0.0;
    std::copy(start_, start_ + n, a);
    for (long i = 0; i < steps; ++i) {
      const double load = with_cosine ? std::cos(omega_ * (h * double(i + 1))) : table_[static_cast<std::size_t>(i)];
      for (int k = 0; k < n; ++k) {
        qs[k] = q[k] + h * v[k] + b * a[k];
        vs[k] = v[k] + g * a[k];
      }
      for (int k = 0; k < n; ++k) a[k] = load * on_load_[k];
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) a[k] += on_q_[j][k] * qs[j] + on_v_[j][k] * vs[j];
      const double moved = qs[damper] - q[damper] + b * a[damper];
      const double t0 = f0 + kt * (qs[blade[0]] - q[blade[0]] + b * a[blade[0]] - moved);
      const double t1 = f1 + kt * (qs[blade[1]] - q[blade[1]] + b * a[blade[1]] - moved);
      f0 = (d1 * t0 - c01 * t1) * inverse;
      f1 = (d0 * t1 - c10 * t0) * inverse;
      if (std::abs(f0) > limit || std::abs(f1) > limit)
        for (int sweep = 0; sweep < 3; ++sweep) {  // weakly coupled: clamping in turn settles at once
          f0 = std::clamp((t0 - c01 * f1) * i0, -limit, limit);
          f1 = std::clamp((t1 - c10 * f0) * i1, -limit, limit);
        }
      for (int k = 0; k < n; ++k) {
        a[k] -= f0 * on_slider_[0][k] + f1 * on_slider_[1][k];
        q[k] = qs[k] + b * a[k];
        v[k] = vs[k] + g * a[k];
      }
    }
    return q[1];
  }

  double h_, omega_, kt_ = 0.0, limit_ = 0.0;
  std::vector<double> table_;
  double on_q_[n][n] = {}, on_v_[n][n] = {};  // by columns
  double on_load_[n] = {}, on_slider_[2][n] = {}, start_[n] = {};
  double q_[2][2];
};

}  // namespace rubato::benchmarks
