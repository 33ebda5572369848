#include <rubato/model/beams/line_element.hpp>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>

namespace rubato::model {
namespace {

LineProperties tube() {
  LineProperties p;
  p.young = 2.1e11;
  p.shear_modulus = 8e10;
  p.density = 7800.0;
  p.area = 2e-3;
  p.inertia_y = 3e-6;
  p.inertia_z = 1e-6;
  p.torsion = 1.5e-6;
  p.shear_area_y = 1.2e-3;
  p.shear_area_z = 0.9e-3;
  return p;
}

struct Matrices {
  LineMatrix stiffness, mass;
};

Matrices in_model_axes(const LineProperties& p, const Axis& along, const Axis& orientation, int dimension = 3) {
  Matrices m;
  local_matrices(p, dimension, along.norm(), m.stiffness, m.mass);
  const Eigen::Matrix3d axes = local_axes(along, orientation);
  const bool is_beam = p.kind == LineProperties::Kind::beam;
  turn_into_model_axes(axes, dimension, is_beam, m.stiffness);
  turn_into_model_axes(axes, dimension, is_beam, m.mass);
  return m;
}

// The six rigid motions of a line from the origin to `along`, as columns.
Eigen::Matrix<double, 12, 6> rigid_motions(const Axis& along) {
  Eigen::Matrix<double, 12, 6> motions = Eigen::Matrix<double, 12, 6>::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    motions(axis, axis) = motions(6 + axis, axis) = 1.0;
    const Axis turn = Axis::Unit(axis);
    motions.block<3, 1>(6, 3 + axis) = turn.cross(along);
    motions(3 + axis, 3 + axis) = motions(9 + axis, 3 + axis) = 1.0;
  }
  return motions;
}

const Axis along(1.2, -0.7, 2.1), orientation(0.3, 1.0, -0.2);

TEST(BeamInSpace, ResistsNoRigidMotion) {
  const Matrices m = in_model_axes(tube(), along, orientation);
  const auto motions = rigid_motions(along);
  // Six round-offs of the largest entry in each product.
  EXPECT_LT((m.stiffness * motions).cwiseAbs().maxCoeff(), 1e-14 * m.stiffness.cwiseAbs().maxCoeff());
  EXPECT_LT((m.stiffness - m.stiffness.transpose()).cwiseAbs().maxCoeff(), 1e-9 * m.stiffness.maxCoeff());
}

TEST(BeamInSpace, HasTheRigidInertiaOfASlenderRod) {
  for (const bool lumped : {false, true}) {
    LineProperties p = tube();
    p.lumped_mass = lumped;
    const Matrices m = in_model_axes(p, along, orientation);
    const auto motions = rigid_motions(along);
    const Eigen::Matrix<double, 6, 6> inertia = motions.transpose() * m.mass * motions;
    const double mass = p.density * p.area * along.norm();
    EXPECT_NEAR(inertia(0, 0), mass, 1e-12 * mass);
    EXPECT_NEAR(inertia(1, 1), mass, 1e-12 * mass);
    EXPECT_NEAR(inertia(2, 2), mass, 1e-12 * mass);
    EXPECT_NEAR(inertia(0, 1), 0.0, 1e-12 * mass);
    // First moment: the centre of mass lies in the middle.
    EXPECT_NEAR(inertia(0, 4), mass * along.z() / 2.0, 1e-12 * mass);
    if (lumped) continue;  // half masses at the ends have another moment of inertia
    // About the first end: rod m (L^2 1 - x x^T)/3 and the section's own rho L diag(Iy + Iz, Iy, Iz).
    const Eigen::Matrix3d axes = local_axes(along, orientation);
    const Eigen::Vector3d section(p.inertia_y + p.inertia_z, p.inertia_y, p.inertia_z);
    const Eigen::Matrix3d expected =
        mass / 3.0 * (along.squaredNorm() * Eigen::Matrix3d::Identity() - along * along.transpose()) +
        p.density * along.norm() * axes.transpose() * section.asDiagonal() * axes;
    EXPECT_LT((inertia.bottomRightCorner<3, 3>() - expected).cwiseAbs().maxCoeff(), 1e-12 * mass);
  }
}

// Tip load F across a cantilever: F L^3/(3 E I) + F L/(kappa A G); end moment: M L/(E I); torque: T L/(G J).
TEST(BeamInSpace, BendsTwistsAndStretchesAsACantilever) {
  const LineProperties p = tube();
  const double length = along.norm();
  const Matrices m = in_model_axes(p, along, orientation);
  const Eigen::Matrix3d axes = local_axes(along, orientation);
  const Eigen::Matrix<double, 6, 6> flexibility = m.stiffness.bottomRightCorner<6, 6>().inverse();
  const auto response = [&](int of, int to, int of_block, int to_block) {
    Eigen::Matrix<double, 6, 1> load = Eigen::Matrix<double, 6, 1>::Zero();
    load.segment<3>(3 * to_block) = axes.row(to);
    return axes.row(of).dot((flexibility * load).segment<3>(3 * of_block));
  };
  const auto expect = [](double found, double expected) { EXPECT_NEAR(found, expected, 1e-11 * expected); };
  expect(response(0, 0, 0, 0), length / (p.young * p.area));
  expect(response(1, 1, 0, 0),
         std::pow(length, 3) / (3 * p.young * p.inertia_z) + length / (p.shear_area_y * p.shear_modulus));
  expect(response(2, 2, 0, 0),
         std::pow(length, 3) / (3 * p.young * p.inertia_y) + length / (p.shear_area_z * p.shear_modulus));
  expect(response(0, 0, 1, 1), length / (p.shear_modulus * p.torsion));
  expect(response(1, 1, 1, 1), length / (p.young * p.inertia_y));
  expect(response(2, 2, 1, 1), length / (p.young * p.inertia_z));
  // A positive moment about z lifts the tip along y, one about y lowers it along z.
  expect(response(1, 2, 0, 1), length * length / (2 * p.young * p.inertia_z));
  expect(-response(2, 1, 0, 1), length * length / (2 * p.young * p.inertia_y));
}

// The same beam in the plane and in space.
TEST(BeamInThePlane, IsTheBeamInSpaceThatLiesInIt) {
  const Axis flat(0.8, -1.7, 0.0);
  const Matrices plane = in_model_axes(tube(), flat, Axis(1.7, 0.8, 0.0), 2);
  const Matrices space = in_model_axes(tube(), flat, Axis(1.7, 0.8, 0.0), 3);
  const int kept[] = {0, 1, 5, 6, 7, 11};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(plane.stiffness(i, j), space.stiffness(kept[i], kept[j]), 1e-12 * space.stiffness.maxCoeff());
      EXPECT_NEAR(plane.mass(i, j), space.mass(kept[i], kept[j]), 1e-12 * space.mass.maxCoeff());
    }
}

// Przemieniecki (1968), the classic matrices over 420; half the mass and m L^2/78 where lumped.
TEST(Bending, HasTheClassicMassWithoutShear) {
  const double l = 2.0, per_length = 3.0, unit = per_length * l / 420.0;
  const Bending b = bending_of(1.0, 0.0, per_length, 0.0, l, false);
  Eigen::Matrix4d expected;
  expected << 156, 22 * l, 54, -13 * l, 22 * l, 4 * l * l, 13 * l, -3 * l * l, 54, 13 * l, 156, -22 * l, -13 * l,
      -3 * l * l, -22 * l, 4 * l * l;
  EXPECT_LT((b.mass - unit * expected).cwiseAbs().maxCoeff(), 1e-14);
  const Bending lumped = bending_of(1.0, 0.0, per_length, 0.0, l, true);
  EXPECT_NEAR(lumped.mass(0, 0), 3.0, 1e-15);
  EXPECT_NEAR(lumped.mass(1, 1), 6.0 * l * l / 78.0, 1e-15);
}

// With h(x) the exact static shape functions of deflection and rotation, M = int rho A h h^T + rho I theta theta^T.
// Integrated here by Gauss's rule with five points, exact to the ninth power.
TEST(Bending, HasTheMassOfTheExactShapeFunctions) {
  const double l = 1.7, phi = 0.9, per_length = 3.0, rotary = 0.4;
  const double points[] = {0.0, 0.5384693101056831, 0.9061798459386640};
  const double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  Eigen::Matrix4d expected = Eigen::Matrix4d::Zero();
  for (int i = -2; i <= 2; ++i) {
    const double s = 0.5 * (1.0 + (i < 0 ? -1.0 : 1.0) * points[std::abs(i)]), s2 = s * s, s3 = s2 * s;
    const double c = 1.0 / (1.0 + phi);
    // Deflection and rotation of the section; at the ends the identity, moment linear, shear constant.
    const Eigen::Vector4d h(c * (1 + phi - phi * s - 3 * s2 + 2 * s3),
                            c * l * ((1 + phi / 2) * s - (2 + phi / 2) * s2 + s3), c * (phi * s + 3 * s2 - 2 * s3),
                            c * l * (-phi / 2 * s + (phi / 2 - 1) * s2 + s3));
    const Eigen::Vector4d theta(c * 6 / l * (s2 - s), c * (1 + phi - (4 + phi) * s + 3 * s2), c * 6 / l * (s - s2),
                                c * ((phi - 2) * s + 3 * s2));
    expected += 0.5 * l * weights[std::abs(i)] * (per_length * h * h.transpose() + rotary * theta * theta.transpose());
  }
  const Bending b = bending_of(1.0, phi, per_length, rotary, l, false);
  EXPECT_LT((b.mass - expected).cwiseAbs().maxCoeff(), 1e-13);
}

// A pinned Euler-Bernoulli beam: omega_1 = pi^2 sqrt(E I / (rho A L^4)); eight consistent elements err by less than
// (pi / 8)^4 / 720 relative, half of that in the frequency; lumped ones by the square of the element.
TEST(Bending, GivesThePinnedBeamItsFirstFrequency) {
  const int elements = 8;
  const auto first_frequency = [&](bool lumped) {
    const double l = 1.0 / elements;
    const Bending b = bending_of(1.0, 0.0, 1.0, 0.0, l, lumped);
    const int n = 2 * (elements + 1);
    Matrix k = Matrix::Zero(n, n), m = Matrix::Zero(n, n);
    for (int e = 0; e < elements; ++e) {
      k.block(2 * e, 2 * e, 4, 4) += b.stiffness;
      m.block(2 * e, 2 * e, 4, 4) += b.mass;
    }
    k.row(0).setZero(), k.col(0).setZero(), k.row(n - 2).setZero(), k.col(n - 2).setZero();
    k(0, 0) = k(n - 2, n - 2) = 1e12;  // pinned: far above the spectrum that is looked at
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(k, m);
    return std::sqrt(modes.eigenvalues()[0]) / (M_PI * M_PI) - 1.0;
  };
  EXPECT_GT(first_frequency(false), 0.0);
  EXPECT_LT(first_frequency(false), std::pow(M_PI / elements, 4) / 720.0);
  EXPECT_LT(std::abs(first_frequency(true)), 0.05 * std::pow(M_PI / elements, 2));
}

TEST(Truss, HasStiffnessAlongItsAxisAndMassInAllDirections) {
  LineProperties p = tube();
  p.kind = LineProperties::Kind::truss;
  const Matrices m = in_model_axes(p, along, orientation);
  ASSERT_EQ(m.stiffness.rows(), 6);
  const double length = along.norm(), k = p.young * p.area / length, mass = p.density * p.area * length;
  const Eigen::Matrix3d expected = k / (length * length) * along * along.transpose();
  EXPECT_LT((m.stiffness.topLeftCorner<3, 3>() - expected).cwiseAbs().maxCoeff(), 1e-13 * k);
  EXPECT_LT((m.stiffness.topRightCorner<3, 3>() + expected).cwiseAbs().maxCoeff(), 1e-13 * k);
  EXPECT_LT((m.mass.topLeftCorner<3, 3>() - mass / 3.0 * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            1e-13 * mass);
  EXPECT_LT((m.mass.topRightCorner<3, 3>() - mass / 6.0 * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            1e-13 * mass);
}

LineProperties plane_beam() {
  LineProperties p;
  p.young = 2.0e11;
  p.density = 7800.0;
  p.area = 1e-3;
  p.inertia_z = 1e-7;
  return p;
}

// A beam pinned at its first end: 3 EI/L^3 over (y1, y2, rz2), and the mass of its static shapes 1 - 3s/2 + s^3/2,
// 3s/2 - s^3/2 and L (s^3 - s)/2, whose products integrate to 33/140, 39/280, ... (s from 0 to 1).
TEST(Release, OfARotationMakesThePinnedElement) {
  const LineProperties p = plane_beam();
  const double length = 1.7, bending = p.young * p.inertia_z / std::pow(length, 3), l = length;
  LineMatrix stiffness, mass;
  local_matrices(p, 2, length, stiffness, mass);
  ASSERT_TRUE(release(1u << 2, stiffness, mass));
  Eigen::Matrix3d expected;
  expected << 3.0, -3.0, 3.0 * l, -3.0, 3.0, -3.0 * l, 3.0 * l, -3.0 * l, 3.0 * l * l;
  Eigen::Matrix3d inertia;
  inertia << 198.0, 117.0, -33.0 * l, 117.0, 408.0, -72.0 * l, -33.0 * l, -72.0 * l, 16.0 * l * l;
  inertia *= p.density * p.area * length / 840.0;
  const int rows[] = {1, 4, 5};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(stiffness(rows[i], rows[j]), bending * expected(i, j), 1e-12 * bending * expected.norm());
      EXPECT_NEAR(mass(rows[i], rows[j]), inertia(i, j), 1e-12 * inertia.norm());
    }
  EXPECT_EQ(stiffness.row(2).norm() + stiffness.col(2).norm() + mass.row(2).norm() + mass.col(2).norm(), 0.0);
}

TEST(Release, OfBothRotationsLeavesATruss) {
  LineProperties p = plane_beam(), q = p;
  q.kind = LineProperties::Kind::truss;
  LineMatrix stiffness, mass, truss_stiffness, truss_mass;
  local_matrices(p, 2, 1.7, stiffness, mass);
  local_matrices(q, 2, 1.7, truss_stiffness, truss_mass);
  ASSERT_TRUE(release(1u << 2 | 1u << 5, stiffness, mass));
  const int rows[] = {0, 1, 3, 4};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      EXPECT_NEAR(stiffness(rows[i], rows[j]), truss_stiffness(i, j), 1e-12 * truss_stiffness.norm());
      EXPECT_NEAR(mass(rows[i], rows[j]), truss_mass(i, j), 1e-12 * truss_mass.norm());
    }
}

// Nothing bends a beam whose ends turn freely: no round-off may hold it across its axis, however long, thick or soft in
// shear it is. The other terms are those of a rod.
TEST(Release, OfBothRotationsLeavesExactlyNoBendingStiffness) {
  LineProperties p = plane_beam();
  p.shear_modulus = 0.4 * p.young;
  p.inertia_y = 3e-7;
  p.torsion = 2e-7;
  for (const int dimension : {2, 3})
    for (const double shear_area : {0.0, 1e-3, 8e-4 / 3.0, 1e-9})
      for (const double length : {0.1, 1.0, 1.7, 1.0 / 3.0, 200.0}) {
        p.shear_area_y = p.shear_area_z = shear_area;
        LineMatrix stiffness, mass;
        local_matrices(p, dimension, length, stiffness, mass);
        const unsigned bending = dimension == 2 ? 1u << 2 | 1u << 5 : 1u << 4 | 1u << 5 | 1u << 10 | 1u << 11;
        ASSERT_TRUE(release(static_cast<std::uint16_t>(bending), stiffness, mass));
        LineMatrix expected = LineMatrix::Zero(stiffness.rows(), stiffness.cols());
        const auto add_rod = [&](int first, int second, double k) {
          expected(first, first) = expected(second, second) = k;
          expected(first, second) = expected(second, first) = -k;
        };
        add_rod(0, dimension == 2 ? 3 : 6, p.young * p.area / length);
        if (dimension == 3) add_rod(3, 9, p.shear_modulus * p.torsion / length);
        EXPECT_EQ(stiffness, expected) << dimension << " " << shear_area << " " << length;
      }
}

TEST(Release, RefusesWhatNothingResists) {
  for (const std::uint16_t released :
       {1u << 0 | 1u << 3, 1u << 1 | 1u << 4, 1u << 1 | 1u << 2 | 1u << 5, 1u << 2 | 1u << 4 | 1u << 5}) {
    LineMatrix stiffness, mass;
    local_matrices(plane_beam(), 2, 1.7, stiffness, mass);
    const LineMatrix before = stiffness;
    EXPECT_FALSE(release(released, stiffness, mass)) << released;
    EXPECT_EQ(stiffness, before);
  }
}

}  // namespace
}  // namespace rubato::model
