#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace rubato::benchmarks {

/// Average acceleration written out for a model of a known size, marched until the state one period apart no longer
/// changes: plain arrays, one cosine a step, the matrices multiplied out for each frequency.
template <int n, int m>
class BareSteady {
 public:
  explicit BareSteady(const system::LocallyNonlinear& system)
      : mass_(system.mass()), damping_(system.damping()), stiffness_(system.stiffness()), load_(Vector::Zero(n)) {
    const auto& term = system.loads().terms()[0];
    for (std::size_t i = 0; i < term.rows.size(); ++i) load_[term.rows[i]] += term.weights[i];
    directions_ = Matrix::Zero(n, m);
    for (int i = 0; i < m; ++i) {
      const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
      if (slider.first != ground) directions_(slider.first, i) += 1.0;
      if (slider.second != ground) directions_(slider.second, i) -= 1.0;
      kt_[i] = slider.stiffness;
      limit_[i] = slider.limit;
    }
  }

  /// Half peak to peak of a coordinate; goes on from the state of the point before.
  double solve(double omega, int steps, int observed, double change, int most_periods) {
    const double h = 2.0 * std::acos(-1.0) / (omega * steps), b = 0.25 * h * h, g = 0.5 * h;
    const Matrix inverse = (mass_ + g * damping_ + b * stiffness_).inverse();
    const Matrix to_q = -inverse * stiffness_, to_v = -inverse * damping_, to_f = inverse * directions_;
    const Vector to_load = inverse * load_;
    double on_q[n][n], on_v[n][n], on_f[m][n], on_load[n], coupling[m][m], share[m], direction[m][n];
    for (int i = 0; i < n; ++i) {
      on_load[i] = to_load[i];
      for (int j = 0; j < n; ++j) {
        on_q[j][i] = to_q(i, j);
        on_v[j][i] = to_v(i, j);
      }
      for (int s = 0; s < m; ++s) {
        on_f[s][i] = to_f(i, s);
        direction[s][i] = directions_(i, s);
      }
    }
    for (int r = 0; r < m; ++r) {
      for (int s = 0; s < m; ++s) coupling[r][s] = b * kt_[r] * directions_.col(r).dot(to_f.col(s));
      share[r] = 1.0 / (1.0 + coupling[r][r]);
    }
    const Vector start = mass_.inverse() * (load_ - damping_ * as_vector(v_) - stiffness_ * as_vector(q_) -
                                            directions_ * as_forces(force_));
    double a[n];
    for (int i = 0; i < n; ++i) a[i] = start[i];
    double amplitude = 0.0;
    for (int period = 0; period < most_periods; ++period) {
      double first_q[n], first_v[n], low = q_[observed], high = low;
      std::copy(q_, q_ + n, first_q);
      std::copy(v_, v_ + n, first_v);
      for (int i = 0; i < steps; ++i) {
        const double load = std::cos(omega * (h * (i + 1)));
        double qs[n], vs[n], trial[m];
        for (int k = 0; k < n; ++k) {
          qs[k] = q_[k] + h * v_[k] + b * a[k];
          vs[k] = v_[k] + g * a[k];
        }
        for (int k = 0; k < n; ++k) a[k] = load * on_load[k];
        for (int j = 0; j < n; ++j)
          for (int k = 0; k < n; ++k) a[k] += on_q[j][k] * qs[j] + on_v[j][k] * vs[j];
        for (int s = 0; s < m; ++s) {
          double u = 0.0;
          for (int k = 0; k < n; ++k) u += direction[s][k] * (qs[k] - q_[k] + b * a[k]);
          trial[s] = force_[s] + kt_[s] * u;
        }
        for (int sweep = 0; sweep < (m > 1 ? 4 : 1); ++sweep)  // weakly coupled: settles at once
          for (int s = 0; s < m; ++s) {
            double free = trial[s];
            for (int r = 0; r < m; ++r)
              if (r != s) free -= coupling[s][r] * force_[r];
            force_[s] = std::clamp(free * share[s], -limit_[s], limit_[s]);
          }
        for (int s = 0; s < m; ++s)
          for (int k = 0; k < n; ++k) a[k] -= force_[s] * on_f[s][k];
        for (int k = 0; k < n; ++k) {
          q_[k] = qs[k] + b * a[k];
          v_[k] = vs[k] + g * a[k];
        }
        low = std::min(low, q_[observed]);
        high = std::max(high, q_[observed]);
      }
      amplitude = 0.5 * (high - low);
      double moved = 0.0, size = 0.0;
      for (int k = 0; k < n; ++k) {
        moved += std::pow(q_[k] - first_q[k], 2) + std::pow((v_[k] - first_v[k]) / omega, 2);
        size += std::pow(q_[k], 2) + std::pow(v_[k] / omega, 2);
      }
      if (moved <= change * change * size) break;
    }
    return amplitude;
  }

 private:
  static Vector as_vector(const double* values) { return Eigen::Map<const Vector>(values, n); }
  static Vector as_forces(const double* values) { return Eigen::Map<const Vector>(values, m); }
  Matrix mass_, damping_, stiffness_, directions_;
  Vector load_;
  double kt_[m], limit_[m], q_[n] = {}, v_[n] = {}, force_[m] = {};
};

}  // namespace rubato::benchmarks
