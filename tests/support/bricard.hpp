#pragma once

#include <rubato/numerics/rotations.hpp>

#include <array>
#include <cmath>
#include <numbers>

// Bricard's mechanism of the IFToMM library (A04) by a route of its own: one coordinate, and Lagrange's equation. The
// three hinges of odd number turn alike, and so do the three others (`gap` tells that it closes): from a = b = 90
// degrees at the start, with
//
//   cos a + cos b + cos a cos b = 0
//
// a closed smooth curve, along which  da/ds = sin b (1 + cos a),  db/ds = -sin a (1 + cos b)  vanish nowhere.
namespace rubato::testing {

class Bricard {
 public:
  using Vector3 = numerics::Vector3;
  static constexpr int rods = 5;
  static constexpr double gravity = 9.81;

  /// Where the rods are, and how they move with ds/dt = 1.
  struct Motion {
    std::array<Vector3, rods + 1> corner;  ///< ends of the rods; the first is the ground's
    double potential = 0.0, mass = 0.0;    ///< [J], [kg m2] of s
    double gap = 0.0;                      ///< by which the last hinge fails to meet the ground [m], [-]
  };

  double a = 0.5 * std::numbers::pi, b = 0.5 * std::numbers::pi, rate = 0.0;

  Motion motion() const { return motion_at(a, b); }
  double energy() const {
    const Motion now = motion();
    return now.potential + 0.5 * now.mass * rate * rate;
  }
  void go(double duration, double h) {
    for (long i = 0, n = std::lround(duration / h); i < n; ++i) step(h);
  }

 private:
  using State = std::array<double, 3>;

  static State slope(const State& y) {
    const auto [a, b, rate] = y;
    return {rate * a_rate(a, b), rate * b_rate(a, b), acceleration(y)};
  }
  void step(double h) {
    const State y{a, b, rate};
    const auto ahead = [&](const State& k, double by) {
      return State{y[0] + by * k[0], y[1] + by * k[1], y[2] + by * k[2]};
    };
    const State k1 = slope(y), k2 = slope(ahead(k1, 0.5 * h)), k3 = slope(ahead(k2, 0.5 * h)), k4 = slope(ahead(k3, h));
    const auto sum = [&](std::size_t i) { return y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]); };
    a = sum(0);
    b = sum(1);
    rate = sum(2);
  }

  static double a_rate(double a, double b) { return std::sin(b) * (1.0 + std::cos(a)); }
  static double b_rate(double a, double b) { return -std::sin(a) * (1.0 + std::cos(b)); }

  /// m s'' = -(dm/ds s'^2/2 + dV/ds), slopes by differences of fourth order along the curve.
  static double acceleration(const State& y) {
    constexpr double e = 1e-3;
    const auto at = [&](double by) {
      // A step along the curve to the fourth order, of which the differences see the fifth.
      const auto k = [&](double a, double b) { return std::array<double, 2>{a_rate(a, b), b_rate(a, b)}; };
      const auto k1 = k(y[0], y[1]);
      const auto k2 = k(y[0] + 0.5 * by * k1[0], y[1] + 0.5 * by * k1[1]);
      const auto k3 = k(y[0] + 0.5 * by * k2[0], y[1] + 0.5 * by * k2[1]);
      const auto k4 = k(y[0] + by * k3[0], y[1] + by * k3[1]);
      return motion_at(y[0] + by / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0]),
                       y[1] + by / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1]));
    };
    const Motion one = at(e), two = at(2.0 * e), minus = at(-e), minus_two = at(-2.0 * e);
    const auto difference = [&](double Motion::*of) {
      return (8.0 * (one.*of - minus.*of) - (two.*of - minus_two.*of)) / (12.0 * e);
    };
    const double mass = motion_at(y[0], y[1]).mass;
    return -(0.5 * difference(&Motion::mass) * y[2] * y[2] + difference(&Motion::potential)) / mass;
  }

  /// The chain of rods from the ground, turned hinge by hinge from its shape at the start.
  static Motion motion_at(double a, double b) {
    const std::array<Vector3, rods + 1> start{Vector3(0, 0, 0),  Vector3(1, 0, 0),  Vector3(1, -1, 0),
                                              Vector3(1, -1, 1), Vector3(0, -1, 1), Vector3(0, 0, 1)};
    // Axes that lead from one rod into the next by a positive turn of 90 degrees, and the ground's rod from (0, 0, 1).
    const std::array<Vector3, rods + 1> axis{Vector3(0, -1, 0), Vector3(0, 0, -1), Vector3(-1, 0, 0),
                                             Vector3(0, -1, 0), Vector3(0, 0, -1), Vector3(-1, 0, 0)};
    constexpr double length = 1.0, width = 0.1, quarter = 0.5 * std::numbers::pi;
    const double across = (length * length + width * width) / 12.0, along = width * width / 6.0;
    Motion result;
    numerics::Rotation turn = numerics::Rotation::Identity();
    Vector3 at = start[0], velocity = Vector3::Zero(), omega = Vector3::Zero();
    result.corner[0] = at;
    for (std::size_t i = 0; i < rods; ++i) {
      const bool is_odd = i % 2 == 0;
      omega += turn * axis[i] * (is_odd ? a_rate(a, b) : b_rate(a, b));
      turn = turn * numerics::rotation_of(((is_odd ? a : b) - quarter) * axis[i]);
      const Vector3 rod = turn * (start[i + 1] - start[i]);
      const Vector3 middle_speed = velocity + 0.5 * omega.cross(rod);
      const double spin = omega.dot(rod);
      result.mass += middle_speed.squaredNorm() + across * (omega.squaredNorm() - spin * spin) + along * spin * spin;
      result.potential += gravity * (at + 0.5 * rod)[1];
      velocity += omega.cross(rod);
      at += rod;
      result.corner[i + 1] = at;
    }
    result.gap = (at - start[rods]).norm() + (turn * axis[rods] - axis[rods]).norm() + velocity.norm();
    return result;
  }
};

}  // namespace rubato::testing
