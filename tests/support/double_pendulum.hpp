#pragma once

#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/mechanism.hpp>
#include <rubato/system/state.hpp>

#include <array>
#include <cmath>

namespace rubato::testing {

/// Point masses of 5 and 2 kg on rigid massless links of 1 m, hanging at rest; a horizontal force on the second rises
/// from 0 to 40 N at 0.5 s and falls to 0 at 1 s (Cardona and Cassano 1991, completed).
/// @param knows_kinks  of the force: as a table, which says where they are, or as a formula
inline model::Mechanism double_pendulum(bool knows_kinks = true) {
  model::Mechanism m(2);
  const Index first = m.add_node("1", {0.0, -1.0, 0.0}, {true, true, false});
  const Index second = m.add_node("2", {0.0, -2.0, 0.0}, {true, true, false});
  m.add_mass(first, 5.0);
  m.add_mass(second, 2.0);
  m.joints.push_back(
      model::make_plane_distance("upper", m.plane_point(0, 0.0, 0.0), m.plane_point(first, 0.0, -1.0), 1.0));
  m.joints.push_back(
      model::make_plane_distance("lower", m.plane_point(first, 0.0, -1.0), m.plane_point(second, 0.0, -2.0), 1.0));
  m.gravity = {0.0, -9.81, 0.0};
  if (knows_kinks)
    m.forces.push_back({2, model::TableLaw{{0.0, 0.5, 1.0}, {0.0, 40.0, 0.0}, model::TableLaw::Beyond::zero, ""}});
  else
    m.forces.push_back(
        {2, model::FormulaLaw{numerics::Formula("t < 0.5 ? 80*t : (t < 1 ? 80*(1 - t) : 0)", {}, true)}});
  m.reference = std::sqrt(42.0);  // 3 (m1 + m2) (diagonal 2 m)^2 / 2 links
  return m;
}

inline double double_pendulum_position(const system::State& state, int i) {
  constexpr int numbers[] = {3, 4, 6, 7};
  return state.q[numbers[i]];
}

/// x1, y1, x2, y2 by a Taylor integration in angles with 30 digits.
inline std::array<double, 4> double_pendulum_at(double t) {
  if (t == 1.0) return {0.736085495014059, -0.676888575786228, 1.734171706039201, -0.738726390766016};
  if (t == 2.0) return {-0.516205710603337, -0.856464631108900, -1.098065171416270, -1.669753981747701};
  return {-0.614816419077215, -0.788670254816974, -1.596975128649444, -0.600616355066359};  // t = 5
}

}  // namespace rubato::testing
