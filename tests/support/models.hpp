#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

// The models of the reference documents, assembled by hand so that a test of a floor needs no floor above it.
namespace rubato::testing {

inline SparseMatrix sparse(const Matrix& dense) { return dense.sparseView(); }

inline system::LoadTerm harmonic(Index row, double amplitude, double angular_frequency, double phase = 0.0) {
  return {{row}, {1.0}, model::HarmonicLaw{amplitude, angular_frequency, phase}};
}

/// m = c = k = f0 = 1, f = cos 2t, from rest (thesis, table 2.1); with `limit` > 0 a slider kT = 1 to the ground
/// (table 3.1: limit 0.15).
inline system::LocallyNonlinear single_mass(double limit = 0.0, double omega = 2.0, double damping = 1.0) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = sparse(Matrix::Identity(1, 1));
  parts.damping = sparse(damping * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  parts.loads = system::Loads({harmonic(0, 1.0, omega)});
  if (limit > 0.0) parts.sliders = {{"contact", 0, ground, 1.0, limit}};
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

/// Two blade sectors and an under-platform damper (thesis, table 3.2): disk 1, blade 1, disk 2, blade 2, damper.
inline system::LocallyNonlinear damper_model(double normal_load = 10.0, double omega = 10.0,
                                             double second_force = -20.0) {
  system::LocallyNonlinear::Parts parts;
  Vector mass(5);
  mass << 10, 1, 10, 1, 1;
  Matrix k = Matrix::Zero(5, 5);
  for (const Index disk : {0, 2}) {
    k(disk, disk) = 150;
    k(disk + 1, disk + 1) = 50;
    k(disk, disk + 1) = k(disk + 1, disk) = -50;
  }
  k(4, 4) = 10;
  // 2 % of the modes without sliders: a K + b M in each sector, and the damper's own entry (reference page, section 4).
  Matrix c = 0.00381868997597177 * k;
  c.diagonal() += 0.0853885037126992 * mass;
  c(4, 4) = 0.126491106406735;
  parts.mass = sparse(mass.asDiagonal().toDenseMatrix());
  parts.damping = sparse(c);
  parts.stiffness = sparse(k);
  parts.sliders = {{"contact1", 1, 4, 10.0, 0.5 * normal_load}, {"contact2", 3, 4, 10.0, 0.5 * normal_load}};
  parts.loads = system::Loads({harmonic(1, 20.0, omega), harmonic(3, second_force, omega)});
  parts.coordinates = {"disk1", "blade1", "disk2", "blade2", "damper"};
  return system::LocallyNonlinear(std::move(parts));
}

/// Unit masses with Rayleigh damping and `sliders` sliders to the ground spread evenly, under two harmonic loads.
inline system::LocallyNonlinear unit_masses(Index n, const std::vector<Eigen::Triplet<double>>& stiffness,
                                            Index sliders, double limit) {
  system::LocallyNonlinear::Parts parts;
  parts.stiffness.resize(n, n);
  parts.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  parts.mass.resize(n, n);
  parts.mass.setIdentity();
  parts.damping = 0.02 * parts.mass + 0.01 * parts.stiffness;
  for (Index i = 0; i < sliders; ++i)
    parts.sliders.push_back({"s" + std::to_string(i + 1), (2 * i + 1) * n / (2 * sliders), ground, 1.0, limit});
  parts.loads = system::Loads({harmonic(n / 3, 5.0, 0.7), harmonic(n / 2, 3.0, 0.7, 0.4)});
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  return system::LocallyNonlinear(std::move(parts));
}

/// A chain of n masses from ground to ground, with `sliders` sliders.
inline system::LocallyNonlinear chain(Index n, Index sliders, double limit = 0.5) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  return unit_masses(n, entries, sliders, limit);
}

/// Masses on a square grid, each joined by springs to all within three rows and columns and to the ground: a pattern
/// with much fill-in.
inline system::LocallyNonlinear plate(int side, Index sliders, double limit = 0.5) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto join = [&](int a, int b, double k) {
    entries.emplace_back(a, a, k);
    entries.emplace_back(b, b, k);
    entries.emplace_back(a, b, -k);
    entries.emplace_back(b, a, -k);
  };
  for (int a = 0; a < side * side; ++a) {
    entries.emplace_back(a, a, 0.1);
    for (int b = 0; b < a; ++b) {
      const int rows = a / side - b / side, columns = a % side - b % side;
      if (rows <= 3 && columns >= -3 && columns <= 3) join(a, b, 1.0 / (rows * rows + columns * columns));
    }
  }
  return unit_masses(side * side, entries, sliders, limit);
}

}  // namespace rubato::testing
