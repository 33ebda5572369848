#pragma once

#include <rubato/model/laws/jenkins.hpp>

#include "support/laws.hpp"
#include "support/models.hpp"

#include <array>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// Sliders under normal forces that do not stay the same.
namespace rubato::testing {

inline constexpr double rubbed_mu = 0.5;

/// x'' + c x' + k x + T = F cos(w t) with a law that takes a normal force.
inline system::LocallyNonlinear rubbed_mass(const std::string& normal, double stiffness, double damping, double slider,
                                            std::vector<system::LoadTerm> loads, double speed = 0.0) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = sparse(Matrix::Identity(1, 1));
  parts.damping = sparse(damping * Matrix::Identity(1, 1));
  parts.stiffness = sparse(stiffness * Matrix::Identity(1, 1));
  parts.loads = system::Loads(std::move(loads));
  parts.start.q = Vector::Zero(1);
  parts.start.v = Vector::Constant(1, speed);
  parts.coordinates = {"mass"};
  parts.laws = {{"rubs", "slider", 0, ground, model::make_jenkins(slider, rubbed_mu)}};
  parts.laws.front().normal.formula = std::make_shared<const numerics::Formula>(normal, numerics::Parameters{}, true);
  return system::LocallyNonlinear(std::move(parts));
}

/// x'' + .04 x' + x + T = .8 cos(w t), z'' + .06 z' + z + N = 1.5 + .9 cos(w t + pi/3), kT = 1, kn = 2, mu = .4: a
/// slider on x pressed by what stops z, a stop or the same as a law.
inline system::LocallyNonlinear coupled(double w, bool stop_is_law, bool behind_each_other = false) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = sparse(Matrix::Identity(2, 2));
  parts.damping = sparse(Vector(Vector::Map(std::array{0.04, 0.06}.data(), 2)).asDiagonal().toDenseMatrix());
  parts.stiffness = sparse(Matrix::Identity(2, 2));
  parts.loads =
      system::Loads({harmonic(0, 0.8, w), harmonic(1, 1.5, 0.0), harmonic(1, 0.9, w, std::numbers::pi / 3.0)});
  parts.coordinates = {"x", "z"};
  model::LawBetween rubs{"rubs", "slider", 0, ground, model::make_jenkins(1.0, 0.4)};
  model::LawBetween presses{"presses", "stop", 1, ground, model::make_one_sided_spring(2.0, 0.0)};
  if (!stop_is_law) {
    parts.stops = {{"presses", 1, ground, 0.0, 2.0, 0.0}};
    rubs.normal.stop = 0;
    parts.laws = {rubs};
  } else if (behind_each_other) {
    rubs.normal.law = 0;
    parts.laws = {presses, rubs};
  } else {
    rubs.normal.law = 1;
    parts.laws = {rubs, presses};
  }
  return system::LocallyNonlinear(std::move(parts));
}

}  // namespace rubato::testing
