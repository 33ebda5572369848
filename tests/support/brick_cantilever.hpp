#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include "support/models.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace rubato::testing {

/// A steel cantilever of 8-node bricks, clamped at z = 0, thin across y, with Rayleigh damping. Its coordinates are x,
/// y, z of the free nodes, those of a section z = constant together.
struct BrickCantilever {
  int across = 2, thick = 1, along = 20;                 ///< elements
  double width = 0.04, thickness = 0.002, length = 1.0;  ///< [m]
  double by_mass = 10.0, by_stiffness = 1e-6;            ///< of the damping [1/s], [s]
  double youngs_modulus = 206e9, poissons_ratio = 0.3, density = 7800.0;

  Index rows() const { return static_cast<Index>(3 * (across + 1) * (thick + 1) * along); }
  /// Displacement along y of the first node of a section, 1 to `along`.
  Index deflection(int section) const { return static_cast<Index>(3 * (across + 1) * (thick + 1) * (section - 1) + 1); }

  system::LocallyNonlinear::Parts parts() const {
    const std::array<double, 3> size = {width / across, thickness / thick, length / along};
    const double shear = youngs_modulus / (2.0 * (1.0 + poissons_ratio)),
                 lame = youngs_modulus * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
    Eigen::Matrix<double, 6, 6> elasticity = Eigen::Matrix<double, 6, 6>::Zero();
    elasticity.topLeftCorner<3, 3>().setConstant(lame);
    for (int i = 0; i < 3; ++i) {
      elasticity(i, i) += 2.0 * shear;
      elasticity(i + 3, i + 3) = shear;
    }
    const auto corner = [](int node, int axis) { return (node >> axis) % 2 == 0 ? -1.0 : 1.0; };
    const double volume = size[0] * size[1] * size[2] / 8.0, place = 1.0 / std::sqrt(3.0);
    Matrix stiffness = Matrix::Zero(24, 24), mass = Matrix::Zero(24, 24);
    for (int point = 0; point < 8; ++point) {
      Eigen::Matrix<double, 6, 24> strain = Eigen::Matrix<double, 6, 24>::Zero();
      Vector shape(8);
      for (int node = 0; node < 8; ++node) {
        std::array<double, 3> factor{}, slope{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double side = corner(node, static_cast<int>(axis)), at = place * corner(point, static_cast<int>(axis));
          factor[axis] = 0.5 * (1.0 + side * at);
          slope[axis] = side / size[axis];
        }
        shape[node] = factor[0] * factor[1] * factor[2];
        const double dx = slope[0] * factor[1] * factor[2], dy = factor[0] * slope[1] * factor[2],
                     dz = factor[0] * factor[1] * slope[2];
        strain.middleCols<3>(3 * node) << dx, 0, 0, 0, dy, 0, 0, 0, dz, dy, dx, 0, 0, dz, dy, dz, 0, dx;
      }
      stiffness += volume * (strain.transpose() * elasticity * strain);
      for (int a = 0; a < 8; ++a)
        for (int b = 0; b < 8; ++b)
          for (int axis = 0; axis < 3; ++axis)
            mass(3 * a + axis, 3 * b + axis) += volume * density * shape[a] * shape[b];
    }
    std::vector<Eigen::Triplet<double>> k, m;
    const auto row = [&](int element, int node, int axis) {
      const int x = element % across + node % 2, y = element / across % thick + node / 2 % 2,
                z = element / (across * thick) + node / 4;
      return 3 * (((z - 1) * (thick + 1) + y) * (across + 1) + x) + axis;
    };
    for (int element = 0; element < across * thick * along; ++element)
      for (int a = 0; a < 24; ++a)
        for (int b = 0; b < 24; ++b) {
          const int i = row(element, a / 3, a % 3), j = row(element, b / 3, b % 3);
          if (i < 0 || j < 0) continue;
          k.emplace_back(i, j, 0.5 * (stiffness(a, b) + stiffness(b, a)));
          m.emplace_back(i, j, 0.5 * (mass(a, b) + mass(b, a)));
        }
    system::LocallyNonlinear::Parts result;
    result.stiffness.resize(rows(), rows());
    result.stiffness.setFromTriplets(k.begin(), k.end());
    result.mass.resize(rows(), rows());
    result.mass.setFromTriplets(m.begin(), m.end());
    result.damping = by_mass * result.mass + by_stiffness * result.stiffness;
    for (Index i = 0; i < rows(); ++i) result.coordinates.push_back("x" + std::to_string(i + 1));
    return result;
  }
};

}  // namespace rubato::testing
