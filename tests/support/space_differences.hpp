#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/space_point.hpp>

#include <gtest/gtest.h>

#include <support/joint_pattern.hpp>

#include <random>
#include <vector>

// Derivatives of elements and joints in space against central differences by increments of positions and, in body axes,
// of rotations.
namespace rubato::testing {

/// A random configuration of some free nodes in space after the ground.
struct SpaceMotion {
  SpaceMotion(int nodes, unsigned seed, double spread = 1.0) : padded(1 + 6 * std::size_t(nodes), 0.0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-spread, spread);
    q = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
    for (int node = 0; node < nodes; ++node) {
      for (int i = 0; i < 3; ++i) q.push_back(draw(random));
      const auto turn = numerics::rotation_of({draw(random), draw(random), draw(random)});
      q.insert(q.end(), {turn.w(), turn.x(), turn.y(), turn.z()});
    }
    for (std::size_t i = 1; i < padded.size(); ++i) padded[i] = draw(random);
  }
  model::Motion motion() const {
    return {0.3, model::Side::right, q.data(), padded.data() + 1, phase.data(), rubbing.data(), stuck_at.data()};
  }

  /// Moves a tangent coordinate.
  void move(Index place, double by) {
    const auto node = std::size_t(place / 6) + 1;
    const auto axis = place % 6;
    double* numbers = q.data() + 7 * node;
    if (axis < 3) {
      numbers[axis] += by;
      return;
    }
    const numerics::Rotation now(numbers[3], numbers[4], numbers[5], numbers[6]);
    const numerics::Rotation next = now * numerics::rotation_of(by * numerics::Vector3::Unit(axis - 3));
    numbers[3] = next.w();
    numbers[4] = next.x();
    numbers[5] = next.y();
    numbers[6] = next.z();
  }
  /// Turns and shifts the whole configuration.
  void move_all(const numerics::Rotation& turn, const numerics::Vector3& shift) {
    for (std::size_t i = 7; i < q.size(); i += 7) {
      const numerics::Vector3 moved = turn * numerics::Vector3(q[i], q[i + 1], q[i + 2]) + shift;
      const numerics::Rotation turned = turn * numerics::Rotation(q[i + 3], q[i + 4], q[i + 5], q[i + 6]);
      const double numbers[7] = {moved[0], moved[1], moved[2], turned.w(), turned.x(), turned.y(), turned.z()};
      std::copy(numbers, numbers + 7, q.begin() + std::ptrdiff_t(i));
    }
  }
  std::vector<double> q, padded;
  std::vector<int> phase{1}, rubbing{1};  // a lock that is engaged, a friction that sticks
  std::vector<double> stuck_at{0.2};
};

inline model::SpaceNode free_space_node(int i) {
  model::SpaceNode node;
  node.q = 7 * (i + 1);
  for (int axis = 0; axis < 6; ++axis) node.place[std::size_t(axis)] = 6 * i + axis;
  return node;
}
inline model::SpaceNode ground_space_node() {
  model::SpaceNode node;
  node.place.fill(ground);
  return node;
}

/// Central differences err by step^2 and by round-off/step: about 1e-9 of the values with a step of 1e-5.
constexpr double space_step = 1e-5;

/// Calls with what a function of the motion changes by, per unit of each free place.
template <class Evaluate, class Use>
void for_each_slope(const std::vector<Index>& places, const SpaceMotion& at, std::size_t size, Evaluate evaluate,
                    Use use) {
  std::vector<double> more(size), less(size);
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (places[j] == ground) continue;
    SpaceMotion moved = at;
    moved.move(places[j], space_step);
    evaluate(moved.motion(), more.data());
    moved = at;
    moved.move(places[j], -space_step);
    evaluate(moved.motion(), less.data());
    for (std::size_t i = 0; i < size; ++i) use(i, j, (more[i] - less[i]) / (2.0 * space_step));
  }
}

inline void expect_consistent_tangent(const model::Element& element, const SpaceMotion& at, double size) {
  const std::size_t k = element.places().size();
  std::vector<double> force(k), alone(k), tangent(k * k);
  element.tangent(at.motion(), 1.0, 0.0, force.data(), tangent.data());
  element.force(at.motion(), alone.data());
  for (std::size_t i = 0; i < k; ++i) EXPECT_NEAR(force[i], alone[i], 1e-13 * size);
  for_each_slope(
      element.places(), at, k, [&](const model::Motion& motion, double* out) { element.force(motion, out); },
      [&](std::size_t i, std::size_t j, double slope) {
        EXPECT_NEAR(tangent[i * k + j], slope, 1e-8 * size) << i << " by " << j;
      });
}

inline void expect_consistent_damping(const model::Element& element, SpaceMotion at, double size) {
  const auto& places = element.places();
  const std::size_t k = places.size();
  std::vector<double> force(k), more(k), less(k), tangent(k * k);
  element.tangent(at.motion(), 0.0, 1.0, force.data(), tangent.data());
  for (std::size_t j = 0; j < k; ++j) {
    double& speed = at.padded[std::size_t(places[j]) + 1];
    const double kept = speed;
    speed = kept + space_step;
    element.force(at.motion(), more.data());
    speed = kept - space_step;
    element.force(at.motion(), less.data());
    speed = kept;
    for (std::size_t i = 0; i < k; ++i)
      EXPECT_NEAR(tangent[i * k + j], (more[i] - less[i]) / (2.0 * space_step), 1e-8 * size) << i << " by " << j;
  }
}

/// Forces are the slope of the energy that the element says it stores.
inline void expect_force_of_energy(const model::Element& element, const SpaceMotion& at, double size) {
  std::vector<double> force(element.places().size());
  element.force(at.motion(), force.data());
  for_each_slope(
      element.places(), at, 1, [&](const model::Motion& motion, double* out) { *out = element.stored_energy(motion); },
      [&](std::size_t, std::size_t j, double slope) { EXPECT_NEAR(force[j], slope, 1e-8 * size) << j; });
}

inline void expect_consistent_joint(const model::Joint& joint, const SpaceMotion& at, double size = 1.0) {
  const auto& places = joint.places();
  const std::size_t k = places.size(), r = std::size_t(joint.rows());
  std::vector<double> g(r), jacobian(r * k), multiplier(r), curvature(k * k), second(r), summed(r, 0.0);
  for (std::size_t i = 0; i < r; ++i) multiplier[i] = 0.7 - 1.1 * double(i);
  joint.constraint(at.motion(), g.data(), jacobian.data());
  joint.curvature(at.motion(), multiplier.data(), curvature.data());
  joint.second_rate(at.motion(), second.data());
  expect_pattern(joint, at.motion(), g, jacobian, multiplier, curvature);
  std::vector<double> unused(r * k), slopes(k * k, 0.0);
  for_each_slope(
      places, at, r, [&](const model::Motion& motion, double* out) { joint.constraint(motion, out, unused.data()); },
      [&](std::size_t i, std::size_t j, double slope) {
        EXPECT_NEAR(jacobian[i * k + j], slope, 1e-8 * size) << "row " << i << " by " << j;
      });
  for_each_slope(
      places, at, r * k,
      [&](const model::Motion& motion, double* out) {
        std::vector<double> value(r);
        joint.constraint(motion, value.data(), out);
      },
      [&](std::size_t entry, std::size_t j, double slope) {
        const std::size_t row = entry / k, i = entry % k;
        slopes[i * k + j] += multiplier[row] * slope;
        if (places[i] != ground)
          summed[row] += at.padded[std::size_t(places[i]) + 1] * slope * at.padded[std::size_t(places[j]) + 1];
      });
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j < k; ++j)
      if (places[i] != ground && places[j] != ground) {
        EXPECT_NEAR(curvature[i * k + j], slopes[i * k + j], 1e-8 * size) << i << " by " << j;
      }
  for (std::size_t i = 0; i < r; ++i) EXPECT_NEAR(second[i], summed[i], 1e-7 * size) << i;
}

}  // namespace rubato::testing
