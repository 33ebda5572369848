#include <rubato/model/beams/line_element.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <array>
#include <limits>

namespace rubato::model {
namespace {

// Adds a bending matrix to the rows `at` (deflection and rotation of both ends); `sense` = -1 where a positive rotation
// lowers the deflection: about y, in the x-z plane.
void scatter(const Eigen::Matrix4d& bending, const std::array<int, 4>& at, double sense, LineMatrix& out) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double sign = (i % 2 == j % 2) ? 1.0 : sense;
      out(at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(j)]) += sign * bending(i, j);
    }
}

// Two ends that share a linear field: stiffness k [1 -1; -1 1], mass m/6 [2 1; 1 2], or m/2 each.
void add_rod(double stiffness, double mass, bool lumped, int first, int second, LineMatrix& k, LineMatrix& m) {
  k(first, first) += stiffness;
  k(second, second) += stiffness;
  k(first, second) -= stiffness;
  k(second, first) -= stiffness;
  m(first, first) += lumped ? mass / 2.0 : mass / 3.0;
  m(second, second) += lumped ? mass / 2.0 : mass / 3.0;
  if (lumped) return;
  m(first, second) += mass / 6.0;
  m(second, first) += mass / 6.0;
}

Bending bending_about(double inertia, double shear_area, const LineProperties& p, double length) {
  const double phi = shear_parameter(p.young, inertia, p.shear_modulus, shear_area, length);
  return bending_of(p.young * inertia, phi, p.density * p.area, shear_area > 0.0 ? p.density * inertia : 0.0, length,
                    p.lumped_mass);
}

}  // namespace

double shear_parameter(double young, double inertia, double shear_modulus, double shear_area, double length) {
  return shear_area > 0.0 ? 12.0 * young * inertia / (shear_area * shear_modulus * length * length) : 0.0;
}

Bending bending_of(double bending_stiffness, double phi, double mass_per_length, double rotary_inertia, double length,
                   bool lumped) {
  const double l = length, l2 = length * length;
  Bending b;
  const double k = bending_stiffness / (l2 * l * (1.0 + phi));
  const double near = (4.0 + phi) * l2, far = (2.0 - phi) * l2;
  b.stiffness << 12.0, 6.0 * l, -12.0, 6.0 * l,  //
      6.0 * l, near, -6.0 * l, far,              //
      -12.0, -6.0 * l, 12.0, -6.0 * l,           //
      6.0 * l, far, -6.0 * l, near;
  b.stiffness *= k;

  const double phi2 = phi * phi;
  const double t11 = 13.0 / 35.0 + 7.0 * phi / 10.0 + phi2 / 3.0;
  const double t12 = (11.0 / 210.0 + 11.0 * phi / 120.0 + phi2 / 24.0) * l;
  const double t13 = 9.0 / 70.0 + 3.0 * phi / 10.0 + phi2 / 6.0;
  const double t14 = (13.0 / 420.0 + 3.0 * phi / 40.0 + phi2 / 24.0) * l;
  const double t22 = (1.0 / 105.0 + phi / 60.0 + phi2 / 120.0) * l2;
  const double t24 = (1.0 / 140.0 + phi / 60.0 + phi2 / 120.0) * l2;
  if (lumped) {
    const double half = 0.5 * mass_per_length * l;
    const double rotary = half * t22 / t11 + 0.5 * rotary_inertia * l;
    b.mass = Eigen::Vector4d(half, rotary, half, rotary).asDiagonal();
    return b;
  }
  Eigen::Matrix4d translational, rotary;
  translational << t11, t12, t13, -t14,  //
      t12, t22, t14, -t24,               //
      t13, t14, t11, -t12,               //
      -t14, -t24, -t12, t22;
  const double r11 = 6.0 / 5.0, r12 = (1.0 / 10.0 - phi / 2.0) * l;
  const double r22 = (2.0 / 15.0 + phi / 6.0 + phi2 / 3.0) * l2;
  const double r24 = (-1.0 / 30.0 - phi / 6.0 + phi2 / 6.0) * l2;
  rotary << r11, r12, -r11, r12,  //
      r12, r22, -r12, r24,        //
      -r11, -r12, r11, -r12,      //
      r12, r24, -r12, r22;
  const double scale = 1.0 / ((1.0 + phi) * (1.0 + phi));
  b.mass = scale * (mass_per_length * l * translational + rotary_inertia / l * rotary);
  return b;
}

void local_matrices(const LineProperties& p, int dimension, double length, LineMatrix& stiffness, LineMatrix& mass) {
  const bool is_beam = p.kind == LineProperties::Kind::beam;
  const int width = is_beam ? 3 * (dimension - 1) : dimension;
  stiffness.setZero(2 * width, 2 * width);
  mass.setZero(2 * width, 2 * width);
  const double line_mass = p.density * p.area * length;
  add_rod(p.young * p.area / length, line_mass, p.lumped_mass, 0, width, stiffness, mass);
  if (!is_beam) {
    for (int axis = 1; axis < dimension; ++axis)
      add_rod(0.0, line_mass, p.lumped_mass, axis, width + axis, stiffness, mass);
    return;
  }
  const Bending about_z = bending_about(p.inertia_z, p.shear_area_y, p, length);
  const int rz = dimension == 2 ? 2 : 5;
  const std::array<int, 4> in_xy{1, rz, width + 1, width + rz};
  scatter(about_z.stiffness, in_xy, 1.0, stiffness);
  scatter(about_z.mass, in_xy, 1.0, mass);
  if (dimension == 2) return;
  const Bending about_y = bending_about(p.inertia_y, p.shear_area_z, p, length);
  const std::array<int, 4> in_xz{2, 4, 8, 10};
  scatter(about_y.stiffness, in_xz, -1.0, stiffness);
  scatter(about_y.mass, in_xz, -1.0, mass);
  add_rod(p.shear_modulus * p.torsion / length, p.density * (p.inertia_y + p.inertia_z) * length, p.lumped_mass, 3, 9,
          stiffness, mass);
}

Eigen::Matrix3d local_axes(const Axis& along, const Axis& orientation) {
  Eigen::Matrix3d axes;
  const Axis x = along.normalized();
  const Axis z = x.cross(orientation).normalized();
  axes.row(0) = x;
  axes.row(1) = z.cross(x);
  axes.row(2) = z;
  return axes;
}

bool release(std::uint16_t released, LineMatrix& stiffness, LineMatrix& mass) {
  const int size = static_cast<int>(stiffness.rows());
  std::array<int, 12> gone{}, kept{};
  int r = 0, s = 0;
  for (int i = 0; i < size; ++i) {
    if (released >> i & 1)
      gone[static_cast<std::size_t>(r++)] = i;
    else
      kept[static_cast<std::size_t>(s++)] = i;
  }
  LineMatrix own(r, r), cross(r, s);
  for (int i = 0; i < r; ++i) {
    const int row = gone[static_cast<std::size_t>(i)];
    for (int j = 0; j < r; ++j) own(i, j) = stiffness(row, gone[static_cast<std::size_t>(j)]);
    for (int j = 0; j < s; ++j) cross(i, j) = stiffness(row, kept[static_cast<std::size_t>(j)]);
  }
  // Scaled to a unit diagonal, in which metres and radians compare.
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1> scale = own.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<LineMatrix> factor(LineMatrix(scale.asDiagonal() * own * scale.asDiagonal()));
  constexpr double resists = 1e-10;
  if (!(factor.info() == Eigen::Success && factor.vectorD().minCoeff() > resists)) return false;
  const LineMatrix follows = -(scale.asDiagonal() * factor.solve(LineMatrix(scale.asDiagonal() * cross))).eval();
  LineMatrix shape = LineMatrix::Zero(size, size);
  for (int j = 0; j < s; ++j) {
    const int column = kept[static_cast<std::size_t>(j)];
    shape(column, column) = 1.0;
    for (int i = 0; i < r; ++i) shape(gone[static_cast<std::size_t>(i)], column) = follows(i, j);
  }
  // Where all resistance is released terms cancel, and what they leave is a stiffness of round-off that would hold
  // a mechanism: zero belongs there.
  constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon();
  const LineMatrix terms = shape.cwiseAbs().transpose() * stiffness.cwiseAbs() * shape.cwiseAbs();
  stiffness = (shape.transpose() * stiffness * shape).eval();
  stiffness = (stiffness.array().abs() > round_off * terms.array()).select(stiffness, 0.0).eval();
  mass = (shape.transpose() * mass * shape).eval();
  for (LineMatrix* matrix : {&stiffness, &mass}) {
    *matrix = (0.5 * (*matrix + matrix->transpose())).eval();
    for (int i = 0; i < r; ++i) {
      matrix->row(gone[static_cast<std::size_t>(i)]).setZero();
      matrix->col(gone[static_cast<std::size_t>(i)]).setZero();
    }
  }
  return true;
}

void turn_into_model_axes(const Eigen::Matrix3d& axes, int dimension, bool has_rotations, LineMatrix& matrix) {
  const int blocks = has_rotations && dimension == 3 ? 4 : 2;
  const int width = static_cast<int>(matrix.rows()) / blocks;
  // In the plane the turn of a node is about the third axis, which both frames share.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner(dimension, dimension) = axes.topLeftCorner(dimension, dimension);
  const auto t = turn.topLeftCorner(width, width);
  for (int i = 0; i < blocks; ++i)
    for (int j = 0; j < blocks; ++j) {
      auto block = matrix.block(width * i, width * j, width, width);
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> turned = t.transpose() * block * t;
      block = turned;
    }
}

}  // namespace rubato::model
