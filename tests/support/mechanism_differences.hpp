#pragma once

#include <rubato/model/mechanism.hpp>

#include <gtest/gtest.h>

#include <support/joint_pattern.hpp>

#include <cmath>
#include <random>
#include <vector>

// Derivatives of elements and joints against central differences, in the plane, where q is moved by adding.
namespace rubato::testing {

/// A random plane configuration of some nodes after the ground, all of whose axes are free.
struct RandomMotion {
  RandomMotion(int nodes, unsigned seed, double spread = 1.0) : q(3 * (nodes + 1), 0.0), padded(1 + 3 * nodes, 0.0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-spread, spread);
    for (std::size_t i = 3; i < q.size(); ++i) q[i] = draw(random);
    for (std::size_t i = 1; i < padded.size(); ++i) padded[i] = draw(random);
    phase.assign(4, 0);
  }
  model::Motion motion() const {
    return {0.3, model::Side::right, q.data(), padded.data() + 1, phase.data(), nullptr, nullptr, laws};
  }
  std::vector<double> q, padded;
  std::vector<int> phase;
  model::LawHistory laws;
};

inline model::PlaneNode free_plane_node(int i) { return {3 * (i + 1), {3 * i, 3 * i + 1, 3 * i + 2}}; }
inline model::PlaneNode ground_plane_node() { return {0, {ground, ground, ground}}; }

/// Central differences err by step^2 and by round-off/step: about 1e-9 of the values with a step of 1e-5.
constexpr double difference_step = 1e-5;

inline void expect_consistent_tangent(const model::Element& element, RandomMotion at, double size) {
  const auto& places = element.places();
  const std::size_t k = places.size();
  std::vector<double> force(k), other(k), stiffness(k * k), damping(k * k);
  element.tangent(at.motion(), 1.0, 0.0, force.data(), stiffness.data());
  element.tangent(at.motion(), 0.0, 1.0, other.data(), damping.data());
  std::vector<double> alone(k);
  element.force(at.motion(), alone.data());
  for (std::size_t i = 0; i < k; ++i) {
    EXPECT_NEAR(force[i], alone[i], 1e-13 * size);
    EXPECT_NEAR(other[i], alone[i], 1e-13 * size);
  }
  for (std::size_t j = 0; j < k; ++j) {
    if (places[j] == ground) continue;
    for (const bool is_velocity : {false, true}) {
      double& number = is_velocity ? at.padded[std::size_t(places[j]) + 1] : at.q[std::size_t(places[j]) + 3];
      const double kept = number;
      number = kept + difference_step;
      element.force(at.motion(), force.data());
      number = kept - difference_step;
      element.force(at.motion(), other.data());
      number = kept;
      for (std::size_t i = 0; i < k; ++i) {
        const double slope = (force[i] - other[i]) / (2.0 * difference_step);
        EXPECT_NEAR((is_velocity ? damping : stiffness)[i * k + j], slope, 1e-8 * size) << i << " by " << j;
      }
    }
  }
}

/// Forces are the slope of the energy that the element says it stores.
inline void expect_force_of_energy(const model::Element& element, RandomMotion at, double size) {
  std::vector<double> force(element.places().size());
  element.force(at.motion(), force.data());
  for (std::size_t j = 0; j < force.size(); ++j) {
    if (element.places()[j] == ground) continue;
    double& number = at.q[std::size_t(element.places()[j]) + 3];
    const double kept = number;
    number = kept + difference_step;
    const double more = element.stored_energy(at.motion());
    number = kept - difference_step;
    const double less = element.stored_energy(at.motion());
    number = kept;
    EXPECT_NEAR(force[j], (more - less) / (2.0 * difference_step), 1e-8 * size) << j;
  }
}

inline void expect_consistent_joint(const model::Joint& joint, RandomMotion at, double size = 1.0) {
  const auto& places = joint.places();
  const std::size_t k = places.size(), r = std::size_t(joint.rows());
  std::vector<double> g(r), more(r), less(r), jacobian(r * k), after(r * k), before(r * k), multiplier(r);
  for (std::size_t i = 0; i < r; ++i) multiplier[i] = 0.7 - 1.1 * double(i);
  joint.constraint(at.motion(), g.data(), jacobian.data());
  std::vector<double> curvature(k * k), rate(r);
  joint.curvature(at.motion(), multiplier.data(), curvature.data());
  joint.second_rate(at.motion(), rate.data());
  expect_pattern(joint, at.motion(), g, jacobian, multiplier, curvature);
  std::vector<double> second(r, 0.0);
  for (std::size_t j = 0; j < k; ++j) {
    if (places[j] == ground) continue;
    double& number = at.q[std::size_t(places[j]) + 3];
    const double kept = number;
    number = kept + difference_step;
    joint.constraint(at.motion(), more.data(), after.data());
    number = kept - difference_step;
    joint.constraint(at.motion(), less.data(), before.data());
    number = kept;
    for (std::size_t i = 0; i < r; ++i)
      EXPECT_NEAR(jacobian[i * k + j], (more[i] - less[i]) / (2.0 * difference_step), 1e-8 * size) << i << " by " << j;
    for (std::size_t l = 0; l < k; ++l) {
      double slope = 0.0;
      for (std::size_t i = 0; i < r; ++i) {
        const double entry = (after[i * k + l] - before[i * k + l]) / (2.0 * difference_step);
        slope += multiplier[i] * entry;
        if (places[l] != ground)
          second[i] += entry * at.padded[std::size_t(places[l]) + 1] * at.padded[std::size_t(places[j]) + 1];
      }
      if (places[l] != ground) {
        EXPECT_NEAR(curvature[l * k + j], slope, 1e-8 * size) << l << " by " << j;
      }
    }
  }
  for (std::size_t i = 0; i < r; ++i) EXPECT_NEAR(rate[i], second[i], 1e-7 * size) << i;
}

}  // namespace rubato::testing
