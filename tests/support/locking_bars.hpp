#pragma once

#include <rubato/model/beams/geometrically_exact.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/mechanism.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace rubato::testing {

enum class LockingLaw {
  none,
  stop,
  latch,
  rigid_latch,
  formula,  ///< the stop as a formula of the angle, whose kink nobody knows
};

/// Two bars of 4 m that a moment of 2000 N m at their hinge opens from 60 to 180 degrees, where the hinge locks
/// (Cardona and Cassano 1991, completed). Geometrically exact beams, `elements` a bar.
struct LockingBars {
  model::Mechanism mechanism{2};
  model::PlaneCoordinate angle;  ///< of the hinge
  std::vector<Index> first, second;
};

inline LockingBars locking_bars(LockingLaw law, int elements = 4) {
  constexpr double area = 4.8e-3, inertia = 4.5e-5, density = 7800.0, young = 2.101e11, length = 4.0;
  constexpr double start = std::numbers::pi / 3.0;
  const model::PlaneSection section{young * area, 5.0 / 6.0 * young / 2.6 * area, young * inertia};
  LockingBars bars;
  model::Mechanism& m = bars.mechanism;
  const std::array<double, 2> a{0.0, 0.0}, b{length * std::sin(0.5 * start), length * std::cos(0.5 * start)},
      c{2.0 * b[0], 0.0};
  const auto add_bar = [&](const std::string& name, const std::array<double, 2>& from, const std::array<double, 2>& to,
                           const std::array<bool, 3>& first_free, const std::array<bool, 3>& last_free) {
    std::vector<Index> nodes;
    for (int i = 0; i <= elements; ++i) {
      const double share = double(i) / elements;
      const std::array<double, 3> at{from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]), 0.0};
      std::array<bool, 3> is_free{true, true, true};
      if (i == 0) is_free = first_free;
      if (i == elements) is_free = last_free;
      nodes.push_back(m.add_node(name + std::to_string(i), at, is_free));
    }
    const double part = length / elements;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      const auto at = [&](std::size_t k) {
        const auto& n = m.nodes[std::size_t(nodes[k])].numbers;
        return std::array<double, 3>{n[0], n[1], n[2]};
      };
      m.elements.push_back(
          model::make_plane_beam(name, m.plane_node(nodes[i]), m.plane_node(nodes[i + 1]), at(i), at(i + 1), section));
      for (const std::size_t axis : {0u, 1u, 5u}) {
        const double mass = density * (axis == 5 ? inertia : area) * part / 6.0;
        m.masses.push_back({nodes[i], nodes[i], axis, axis, 2.0 * mass});
        m.masses.push_back({nodes[i + 1], nodes[i + 1], axis, axis, 2.0 * mass});
        m.masses.push_back({nodes[i], nodes[i + 1], axis, axis, mass});
      }
    }
    return nodes;
  };
  bars.first = add_bar("AB", a, b, {false, false, true}, {true, true, true});
  bars.second = add_bar("BC", b, c, {true, true, true}, {true, false, true});
  const Index left = bars.first.back(), right = bars.second.front();
  m.joints.push_back(
      model::make_plane_revolute("B", m.plane_point(left, b[0], b[1]), m.plane_point(right, b[0], b[1])));
  bars.angle.along = {m.plane_point(left, b[0], b[1]), m.plane_point(right, b[0], b[1]), {1.0, 0.0}};
  bars.angle.zero = -start;
  m.joint_coordinates.push_back({"B", bars.angle});
  model::AtLock drive;
  if (law != LockingLaw::none && law != LockingLaw::formula) {
    model::Lock lock;
    lock.name = "B";
    lock.s = bars.angle;
    lock.is_latch = law != LockingLaw::stop;
    lock.at = std::numbers::pi;
    lock.stiffness = law == LockingLaw::rigid_latch ? 0.0 : 1e7;
    const int index = m.add_lock(lock);
    if (lock.is_latch) drive = {index, 1, false};
  }
  m.elements.push_back(model::make_joint_drive(
      "B", bars.angle, law == LockingLaw::formula ? "2000 - 1e7*max(0, angle - pi)" : "2000", {}, drive));
  m.reference = 56.07994293863002;  // sqrt(3 rho A 2 L (diagonal)^2 / 8 elements)
  return bars;
}

}  // namespace rubato::testing
