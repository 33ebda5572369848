#pragma once

#include <rubato/model/beams/geometrically_exact.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/joints/space_joints.hpp>
#include <rubato/model/mechanism.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

// Mechanisms that `mechanisms` measures.
namespace rubato::benchmarks {

/// A point of 1 kg on a rod of 1 m, level and at rest (IFToMM library of computational benchmark problems, "simple
/// pendulum").
inline model::Mechanism planar_pendulum() {
  model::Mechanism m(2);
  const Index mass = m.add_node("mass", {-1.0, 0.0, 0.0}, {true, true, false});
  m.add_mass(mass, 1.0);
  m.joints.push_back(
      model::make_plane_distance("rod", m.plane_point(0, 0.0, 0.0), m.plane_point(mass, -1.0, 0.0), 1.0));
  m.gravity = {0.0, -9.81, 0.0};
  m.reference = std::sqrt(3.0);
  return m;
}

/// Windows of rods of 1 m and 1 kg side by side (IFToMM library, "N-four-bar"): upright at the start, their upper
/// corners moving at 1 m/s.
inline model::Mechanism windows(int count) {
  model::Mechanism m(2);
  std::vector<Index> upright, level;
  for (int i = 0; i <= count; ++i) {
    upright.push_back(m.add_node("upright " + std::to_string(i), {double(i), 0.5, 0.5 * std::numbers::pi}));
    m.add_mass(upright.back(), 1.0, 1.0 / 12.0);
    auto& velocity = m.nodes[std::size_t(upright.back())].velocity;
    velocity[0] = 0.5;
    velocity[5] = -1.0;
  }
  for (int i = 0; i < count; ++i) {
    level.push_back(m.add_node("level " + std::to_string(i), {i + 0.5, 1.0, 0.0}));
    m.add_mass(level.back(), 1.0, 1.0 / 12.0);
    m.nodes[std::size_t(level.back())].velocity[0] = 1.0;
  }
  const auto pin = [&](Index a, Index b, double x, double y) {
    m.joints.push_back(model::make_plane_revolute("pin " + std::to_string(m.joints.size()), m.plane_point(a, x, y),
                                                  m.plane_point(b, x, y)));
  };
  for (int i = 0; i <= count; ++i) pin(0, upright[std::size_t(i)], i, 0.0);
  for (int i = 0; i < count; ++i) {
    pin(upright[std::size_t(i)], level[std::size_t(i)], i, 1.0);
    pin(level[std::size_t(i)], upright[std::size_t(i) + 1], i + 1.0, 1.0);
  }
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

/// The turn of the uprights of the windows, which stay parallel: one pendulum. RK4 with steps of 0.5 ms, cubics between
/// them: errors of 1e-11.
class TurnOfWindows {
 public:
  TurnOfWindows(int count, double end) {
    const double n = count, inertia = (n + 1.0) / 3.0 + n, weight = 9.81 * (0.5 * (n + 1.0) + n);
    const auto slope = [&](double turn) { return weight / inertia * std::sin(turn); };
    double a = 0.0, w = 1.0;
    for (double t = 0.0; t < end + 2.0 * h_; t += h_) {
      turn_.push_back(a);
      rate_.push_back(w);
      const double k1 = slope(a), k2 = slope(a + 0.5 * h_ * w), k3 = slope(a + 0.5 * h_ * (w + 0.5 * h_ * k1));
      const double k4 = slope(a + h_ * (w + 0.5 * h_ * k2));
      a += h_ * (w + h_ / 6.0 * (k1 + k2 + k3));
      w += h_ / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
  }
  double operator()(double t) const {
    const auto i = static_cast<std::size_t>(t / h_);
    const double x = t / h_ - static_cast<double>(i), r = 1.0 - x;
    return r * r * ((1.0 + 2.0 * x) * turn_[i] + x * h_ * rate_[i]) +
           x * x * ((1.0 + 2.0 * r) * turn_[i + 1] - r * h_ * rate_[i + 1]);
  }

 private:
  static constexpr double h_ = 5e-4;
  std::vector<double> turn_, rate_;
};

/// Rods of 1 m and 1 kg, end to end from the ground, level and at rest; revolute joints.
inline model::Mechanism plane_chain(int count) {
  model::Mechanism m(2);
  Index last = 0;
  for (int i = 0; i < count; ++i) {
    const Index rod = m.add_node("rod " + std::to_string(i), {i + 0.5, 0.0, 0.0});
    m.add_mass(rod, 1.0, 1.0 / 12.0);
    m.joints.push_back(model::make_plane_revolute("pin " + std::to_string(i), m.plane_point(last, i, 0.0),
                                                  m.plane_point(rod, i, 0.0)));
    last = rod;
  }
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

/// The same in space: rods 0.1 m thick on spherical joints.
inline model::Mechanism space_chain(int count) {
  model::Mechanism m(3);
  std::vector<Index> rods;
  for (int i = 0; i < count; ++i) {
    rods.push_back(m.add_space_node("rod " + std::to_string(i), {i + 0.5, 0.0, 0.0}, numerics::Rotation::Identity()));
    m.add_space_body(rods.back(), 1.0, numerics::Vector3(1.25e-3, 0.084, 0.084).asDiagonal());
  }
  for (int i = 0; i < count; ++i) {
    const model::SpaceNode first = m.space_node(i > 0 ? rods[std::size_t(i) - 1] : 0);
    const model::SpaceNode second = m.space_node(rods[std::size_t(i)]);
    const numerics::Vector3 back(-0.5, 0.0, 0.0), front(i > 0 ? 0.5 : 0.0, 0.0, 0.0);
    m.joints.push_back(model::make_space_joint(model::SpaceJointKind::spherical, "ball " + std::to_string(i),
                                               {{first, front}, numerics::Matrix3::Identity()},
                                               {{second, back}, numerics::Matrix3::Identity()}));
  }
  m.gravity = {0.0, 0.0, -9.81};
  return m;
}

/// Bricard's mechanism (IFToMM library, A04): five rods of 1 m and 1 kg, 0.1 m thick, along the edges of a cube, and
/// six hinges, of whose conditions one repeats the others; at rest.
inline model::Mechanism bricard() {
  using numerics::Vector3;
  model::Mechanism m(3);
  const Vector3 corner[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const Vector3 axis[] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  for (std::size_t i = 0; i < 5; ++i) {
    const Vector3 rod = corner[i + 1] - corner[i];
    const double across = (1.0 + 0.01) / 12.0, along = 0.02 / 12.0;
    const Index node =
        m.add_space_node("rod " + std::to_string(i + 1), corner[i] + 0.5 * rod, numerics::Rotation::Identity());
    m.add_space_body(node, 1.0, (Vector3::Constant(across) + (along - across) * rod.cwiseAbs()).asDiagonal());
  }
  const std::vector<double> q = m.numbers();
  for (Index i = 0; i < 6; ++i)
    m.joints.push_back(
        model::make_space_joint(model::SpaceJointKind::revolute, "hinge " + std::to_string(i + 1),
                                model::frame_at(m.space_node(i), q.data(), corner[i], axis[i]),
                                model::frame_at(m.space_node((i + 1) % 6), q.data(), corner[i], axis[i])));
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

/// A flexible pendulum: a steel strip of 10 m in `count` geometrically exact beams, pinned, level and at rest, with a
/// rigid body of 20 kg pinned to its end.
inline model::Mechanism flexible_pendulum(int count) {
  constexpr double area = 1e-3, inertia = 1e-7, density = 7800.0, young = 2.1e11, length = 10.0;
  const model::PlaneSection section{young * area, 5.0 / 6.0 * young / 2.6 * area, young * inertia};
  model::Mechanism m(2);
  Index last = m.add_node("0", {0.0, 0.0, 0.0}, {false, false, true});
  const double part = length / count;
  for (int i = 1; i <= count; ++i) {
    const Index next = m.add_node(std::to_string(i), {part * i, 0.0, 0.0});
    m.elements.push_back(model::make_plane_beam("beam", m.plane_node(last), m.plane_node(next),
                                                {part * (i - 1), 0.0, 0.0}, {part * i, 0.0, 0.0}, section));
    for (const std::size_t axis : {0u, 1u, 5u}) {
      const double mass = density * (axis == 5 ? inertia : area) * part / 6.0;
      m.masses.push_back({last, last, axis, axis, 2.0 * mass});
      m.masses.push_back({next, next, axis, axis, 2.0 * mass});
      m.masses.push_back({last, next, axis, axis, mass});
    }
    last = next;
  }
  const Index body = m.add_node("body", {length, -0.5, 0.0});
  m.add_mass(body, 20.0, 2.0);
  m.joints.push_back(
      model::make_plane_revolute("pin", m.plane_point(last, length, 0.0), m.plane_point(body, length, 0.0)));
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

}  // namespace rubato::benchmarks
