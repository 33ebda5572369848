#include <rubato/numerics/gmres.hpp>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

struct System {
  Matrix matrix;
  int products = 0;
  auto multiply() {
    return [this](const Vector& x, Vector& y) {
      ++products;
      y = matrix * x;
    };
  }
};

TEST(Gmres, NeedsAsManyProductsAsTheMatrixHasEigenvalues) {
  // One, but for a part of rank three: four different eigenvalues.
  Matrix left(30, 3), right(30, 3);
  for (Index i = 0; i < left.size(); ++i) {
    left.data()[i] = std::sin(double(i * i));
    right.data()[i] = std::cos(0.7 * double(i * i));
  }
  System system{Matrix::Identity(30, 30) + left * right.transpose()};
  const Vector b = Vector::LinSpaced(30, -1.0, 2.0);
  Vector x;
  Gmres gmres;
  const int products = gmres.solve(b, 1e-12, 10, system.multiply(), x);
  EXPECT_EQ(products, 4);
  EXPECT_EQ(system.products, products);
  EXPECT_LE((system.matrix * x - b).norm(), 2e-12 * b.norm());
}

TEST(Gmres, SaysWhereItsProductsWereNotEnough) {
  System system{Vector::LinSpaced(20, 1.0, 20.0).asDiagonal()};
  const Vector b = Vector::Ones(20);
  Vector x = Vector::Constant(20, 7.0);
  EXPECT_EQ(Gmres().solve(b, 1e-12, 5, system.multiply(), x), -1);
  EXPECT_EQ(x, Vector::Constant(20, 7.0));
}

TEST(Gmres, RefusesWhatIsNotFinite) {
  System system{Matrix::Identity(2, 2)};
  Vector x;
  EXPECT_EQ(Gmres().solve(Vector::Constant(2, std::numeric_limits<double>::quiet_NaN()), 1e-9, 5, system.multiply(), x),
            -1);
  system.matrix(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Gmres().solve(Vector::Ones(2), 1e-9, 5, system.multiply(), x), -1);
}

TEST(Gmres, LeavesZeroAlone) {
  System system{Matrix::Identity(2, 2)};
  Vector x;
  EXPECT_EQ(Gmres().solve(Vector::Zero(2), 1e-9, 5, system.multiply(), x), 0);
  EXPECT_EQ(x, Vector::Zero(2));
  EXPECT_EQ(system.products, 0);
}

}  // namespace
}  // namespace rubato::numerics
