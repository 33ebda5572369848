#include <rubato/numerics/rotations.hpp>

#include <cmath>

namespace rubato::numerics {
namespace {

// Below this angle [rad] the closed forms lose digits to cancellation and the series end at round-off.
constexpr double small_angle = 0.1;

/// (1 - cos a)/a^2
double versine_share(double a) {
  const double half = 0.5 * a;
  if (half < 1e-8) return 0.5;
  const double share = std::sin(half) / half;
  return 0.5 * share * share;
}

/// (a - sin a)/a^3
double sine_defect_share(double a) {
  if (a > small_angle) return (a - std::sin(a)) / (a * a * a);
  const double s = a * a;
  return (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))) / 6.0;
}

/// c(a) = (1 - (a/2) cot(a/2))/a^2 and c'(a)/a
struct Cotangent {
  double share, slope;
};
Cotangent cotangent_share(double a) {
  const double s = a * a;
  // Bernoulli numbers: c = 1/12 + s/720 + s^2/30240 + s^3/1209600 + s^4/47900160 + ...
  if (a < small_angle)
    return {1.0 / 12 + s * (1.0 / 720 + s * (1.0 / 30240 + s * (1.0 / 1209600 + s / 47900160))),
            2.0 * (1.0 / 720 + s * (2.0 / 30240 + s * (3.0 / 1209600 + s * (4.0 / 47900160))))};
  const double half = 0.5 * a, cotangent = std::cos(half) / std::sin(half), sine = std::sin(half);
  const double share = (1.0 - half * cotangent) / s;
  // d/da (1 - (a/2) cot(a/2)) = -cot(a/2)/2 + a/(4 sin^2(a/2))
  const double slope = (-0.5 * cotangent + 0.25 * a / (sine * sine)) / s - 2.0 * share / a;
  return {share, slope / a};
}

}  // namespace

Matrix3 skew(const Vector3& v) {
  Matrix3 matrix;
  matrix << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return matrix;
}

Rotation rotation_of(const Vector3& v) {
  const double half = 0.5 * v.norm();
  const double share = half < 1e-8 ? 0.5 : 0.5 * std::sin(half) / half;
  return {std::cos(half), share * v[0], share * v[1], share * v[2]};
}

Vector3 vector_of(const Rotation& rotation) {
  const Vector3 imaginary = rotation.w() < 0.0 ? Vector3(-rotation.vec()) : Vector3(rotation.vec());
  const double sine = imaginary.norm(), cosine = std::abs(rotation.w());
  if (sine < 1e-8) return 2.0 * imaginary / cosine;
  return 2.0 * std::atan2(sine, cosine) / sine * imaginary;
}

Matrix3 tangent_of(const Vector3& v) {
  const double angle = v.norm();
  const Matrix3 s = skew(v);
  return Matrix3::Identity() - versine_share(angle) * s + sine_defect_share(angle) * s * s;
}

Matrix3 inverse_tangent_of(const Vector3& v) {
  const Matrix3 s = skew(v);
  return Matrix3::Identity() + 0.5 * s + cotangent_share(v.norm()).share * s * s;
}

Matrix3 slope_of_transposed_inverse_tangent(const Vector3& v, const Vector3& m) {
  // T^-T m = m - v x m / 2 + c v x (v x m)
  const auto [share, slope] = cotangent_share(v.norm());
  const Vector3 once = v.cross(m), twice = v.cross(once);
  return 0.5 * skew(m) + slope * twice * v.transpose() - share * (skew(once) + skew(v) * skew(m));
}

}  // namespace rubato::numerics
