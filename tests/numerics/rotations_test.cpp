#include <rubato/numerics/rotations.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rubato::numerics {
namespace {

Vector3 random_vector(std::mt19937& random, double largest) {
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  return largest / std::sqrt(3.0) * Vector3(draw(random), draw(random), draw(random));
}

TEST(Rotations, AreTheExponentialOfTheirVector) {
  // exp(skew(v)) by its series, whose terms fall below round-off within 40.
  std::mt19937 random(1);
  for (const double size : {1e-9, 1e-4, 0.05, 0.2, 1.0, 3.0}) {
    const Vector3 v = random_vector(random, size);
    Matrix3 series = Matrix3::Identity(), term = Matrix3::Identity();
    for (int i = 1; i < 40; ++i) {
      term = term * skew(v) / i;
      series += term;
    }
    EXPECT_LT((rotation_of(v).toRotationMatrix() - series).norm(), 1e-14);
    EXPECT_LT((vector_of(rotation_of(v)) - v).norm(), 1e-14 * size + 1e-300);
  }
}

TEST(Rotations, HaveTheShortestVector) {
  const Vector3 v(0.0, 0.0, 1.5 * std::numbers::pi);
  EXPECT_NEAR(vector_of(rotation_of(v))[2], -0.5 * std::numbers::pi, 1e-15);
  EXPECT_NEAR(vector_of(rotation_of(Vector3(std::numbers::pi, 0.0, 0.0))).norm(), std::numbers::pi, 1e-15);
}

TEST(Rotations, TurnIncrementsOfTheVectorIntoThoseOfTheBody) {
  std::mt19937 random(2);
  for (const double size : {1e-9, 0.01, 0.099, 0.101, 1.0, 3.0}) {
    const Vector3 v = random_vector(random, size);
    const Matrix3 tangent = tangent_of(v);
    EXPECT_LT((tangent * inverse_tangent_of(v) - Matrix3::Identity()).norm(), 1e-14);
    for (int i = 0; i < 3; ++i) {
      const double step = 1e-5;
      const Vector3 along = step * Vector3::Unit(i);
      const Vector3 turned = vector_of(rotation_of(v - along).conjugate() * rotation_of(v + along)) / (2.0 * step);
      EXPECT_LT((tangent.col(i) - turned).norm(), 1e-9) << size;
    }
  }
}

TEST(Rotations, KnowTheSlopeOfTheirInverseTangent) {
  std::mt19937 random(3);
  for (const double size : {1e-9, 0.01, 0.099, 0.101, 1.0, 3.0}) {
    const Vector3 v = random_vector(random, size), m = random_vector(random, 1.0);
    const Matrix3 slope = slope_of_transposed_inverse_tangent(v, m);
    for (int i = 0; i < 3; ++i) {
      const Vector3 along = 1e-5 * Vector3::Unit(i);
      const Vector3 difference =
          inverse_tangent_of(v + along).transpose() * m - inverse_tangent_of(v - along).transpose() * m;
      EXPECT_LT((slope.col(i) - difference / 2e-5).norm(), 1e-9) << size;
    }
  }
}

TEST(Rotations, MeetTheirSeriesWithoutAStep) {
  // Closed forms and series at both sides of where they change: the values differ by the slope only.
  const Vector3 axis = Vector3(1.0, 2.0, -2.0) / 3.0, m(0.3, -0.2, 0.9);
  const Vector3 below = (0.1 - 1e-13) * axis, above = (0.1 + 1e-13) * axis;
  EXPECT_LT((tangent_of(below) - tangent_of(above)).norm(), 1e-12);
  EXPECT_LT((inverse_tangent_of(below) - inverse_tangent_of(above)).norm(), 1e-12);
  EXPECT_LT((slope_of_transposed_inverse_tangent(below, m) - slope_of_transposed_inverse_tangent(above, m)).norm(),
            1e-11);
}

}  // namespace
}  // namespace rubato::numerics
