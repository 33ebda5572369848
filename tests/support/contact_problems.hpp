#pragma once

#include <rubato/model/laws/elastic_contact.hpp>
#include <rubato/model/laws/jenkins.hpp>

#include "support/models.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// Structures on elastic Coulomb contacts that open and close: problems C, W and S of the friction family.
namespace rubato::testing {

using Columns = std::array<std::vector<model::Share>, model::largest_block>;

inline model::BlockBetween contact(std::string name, const model::ContactValues& values, Columns columns) {
  return {std::move(name), "contact", model::make_elastic_contact(values), std::move(columns)};
}

inline system::LocallyNonlinear::Parts masses(const Vector& mass, const Vector& damping, const Vector& stiffness) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = sparse(mass.asDiagonal().toDenseMatrix());
  parts.damping = sparse(damping.asDiagonal().toDenseMatrix());
  parts.stiffness = sparse(stiffness.asDiagonal().toDenseMatrix());
  for (Index i = 0; i < mass.size(); ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  return parts;
}

/// x'' + .04 x' + x + T = .8 cos(w t), z'' + .06 z' + z + N = 1.5 + .9 cos(w t + pi/3), kT = 1, kn = 2, mu = .4.
inline system::LocallyNonlinear coupled(double w, bool by_contact) {
  auto parts = masses(Vector::Ones(2), Eigen::Vector2d(0.04, 0.06), Vector::Ones(2));
  parts.loads =
      system::Loads({harmonic(0, 0.8, w), harmonic(1, 1.5, 0.0), harmonic(1, 0.9, w, std::numbers::pi / 3.0)});
  if (by_contact) {
    parts.blocks = {contact("contact", {1, 1.0, 2.0, 0.4, 0.0}, {{{{0, 1.0}}, {{1, 1.0}}}})};
  } else {
    model::LawBetween rubs{"rubs", "slider", 0, ground, model::make_jenkins(1.0, 0.4)};
    rubs.normal.stop = 0;
    parts.stops = {{"presses", 1, ground, 0.0, 2.0, 0.0}};
    parts.laws = {rubs};
  }
  return system::LocallyNonlinear(std::move(parts));
}

/// Two blades and a wedge damper: x1, x2, xd, yd; contact planes inclined by 35 degrees, pressed by a load of 6.
inline system::LocallyNonlinear wedge(double friction, double amplitude = 0.0, double w = 7.6) {
  const double b = 35.0 * std::numbers::pi / 180.0, c = std::cos(b), s = std::sin(b);
  auto parts =
      masses(Eigen::Vector4d(1, 1, 0.05, 0.05), Eigen::Vector4d(0.08, 0.08, 0.05, 0.05), Eigen::Vector4d(60, 66, 0, 0));
  std::vector<system::LoadTerm> loads{harmonic(3, 6.0, 0.0)};
  if (amplitude > 0.0) {
    loads.push_back(harmonic(0, amplitude, w));
    loads.push_back(harmonic(1, amplitude, w, -std::numbers::pi / 3.0));
  }
  parts.loads = system::Loads(std::move(loads));
  const model::ContactValues values{1, 30.0, 45.0, friction, 0.0};
  parts.blocks = {contact("left", values, {{{{2, c}, {0, -c}, {3, s}}, {{2, -s}, {0, s}, {3, c}}}}),
                  contact("right", values, {{{{2, c}, {1, -c}, {3, -s}}, {{2, s}, {1, -s}, {3, c}}}})};
  return system::LocallyNonlinear(std::move(parts));
}

/// x'' + .04 x' + x + Tx = .8 cos(w t), y'' + .05 y' + 1.3 y + Ty = .5 cos(w t - pi/2),
/// z'' + .06 z' + z + N = 1.5 + .6 cos(w t + pi/3), kT = 1, kn = 2, mu = .4.
/// @param turn  the two directions of the contact, against x and y
inline system::LocallyNonlinear in_space(double turn = 0.0, double w = 1.6) {
  const double c = std::cos(turn), s = std::sin(turn);
  auto parts = masses(Vector::Ones(3), Eigen::Vector3d(0.04, 0.05, 0.06), Eigen::Vector3d(1.0, 1.3, 1.0));
  parts.loads = system::Loads({harmonic(0, 0.8, w), harmonic(1, 0.5, w, -0.5 * std::numbers::pi), harmonic(2, 1.5, 0.0),
                               harmonic(2, 0.6, w, std::numbers::pi / 3.0)});
  Columns columns{{{{0, c}, {1, s}}, {{0, -s}, {1, c}}, {{2, 1.0}}}};
  if (turn == 0.0) columns = {{{{0, 1.0}}, {{1, 1.0}}, {{2, 1.0}}}};
  parts.blocks = {contact("contact", {2, 1.0, 2.0, 0.4, 0.0}, columns)};
  return system::LocallyNonlinear(std::move(parts));
}

}  // namespace rubato::testing
