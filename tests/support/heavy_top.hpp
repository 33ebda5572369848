#pragma once

#include <rubato/numerics/rotations.hpp>

#include <cmath>
#include <utility>

// The heavy top of Geradin and Cardona (2001) with the data of Bruels and Cardona (2010): 15 kg, its centre of mass 1 m
// along its second axis from a spherical joint to the ground, spinning at 150 rad/s about that axis.
namespace rubato::testing {

inline constexpr double top_mass = 15.0, top_gravity = 9.81;
inline const numerics::Vector3 top_arm(0.0, 1.0, 0.0), top_spin(0.0, 150.0, -4.61538);
inline const numerics::Vector3 top_inertia(0.234375, 0.46875, 0.234375);

/// Euler's equations about the foot, (J + m (1 - y y^T)) omega' + omega x (...) = y x R^T m g, by Runge-Kutta steps so
/// short that what is left is round-off: 1e-5 (150 rad/s * 1e-5 s)^4.
struct Top {
  numerics::Rotation turn = numerics::Rotation::Identity();
  numerics::Vector3 omega = top_spin, rate = numerics::Vector3::Zero();

  numerics::Vector3 acceleration(const numerics::Rotation& at, const numerics::Vector3& w) const {
    const numerics::Vector3 about_foot = top_inertia + top_mass * numerics::Vector3(1.0, 0.0, 1.0);
    const numerics::Vector3 weight = at.conjugate() * numerics::Vector3(0.0, 0.0, -top_mass * top_gravity);
    return (top_arm.cross(weight) - w.cross(about_foot.cwiseProduct(w))).cwiseQuotient(about_foot);
  }
  /// The rotation by increments of the body: R' = R omega; the vector of a short step follows v' = T(v)^-1 omega.
  void go(double end, double h) {
    using numerics::Vector3;
    for (long i = 0, n = std::lround(end / h); i < n; ++i) {
      const auto slope = [&](const Vector3& v, const Vector3& w) {
        return std::pair<Vector3, Vector3>(numerics::inverse_tangent_of(v) * w,
                                           acceleration(turn * numerics::rotation_of(v), w));
      };
      const auto [v1, w1] = slope(Vector3::Zero(), omega);
      const auto [v2, w2] = slope(0.5 * h * v1, omega + 0.5 * h * w1);
      const auto [v3, w3] = slope(0.5 * h * v2, omega + 0.5 * h * w2);
      const auto [v4, w4] = slope(h * v3, omega + h * w3);
      turn = (turn * numerics::rotation_of(h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4))).normalized();
      omega += h / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4);
    }
    rate = acceleration(turn, omega);
  }
  numerics::Vector3 position() const { return turn * top_arm; }
  /// The force of the top on its foot: m (g - a).
  numerics::Vector3 reaction() const {
    const numerics::Vector3 a = turn * (rate.cross(top_arm) + omega.cross(omega.cross(top_arm)));
    return top_mass * (numerics::Vector3(0.0, 0.0, -top_gravity) - a);
  }
};

}  // namespace rubato::testing
