#pragma once

#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// make_consistent() where rigid stops only press. Of each rigid stop that is engaged in the state given:
///
///   press = sign impulse >= 0,   sign s' <= 0,   press sign s' = 0
///
/// beside  M (v - v_given) + G^T impulse = 0  and  G v + dg/dt = 0  of joints, drives, latches and what sticks: a
/// linear complementarity problem with one solution v, that of the least kinetic energy of the change (Moreau 1988,
/// Unilateral contact and dry friction in finite freedom dynamics). Stops that the velocities then leave are
/// open in the state that is returned; others stay engaged. Latches and stops with stiffness keep their phases.
/// @return not consistent where the joints and drives leave no velocities, or no set of stops was found that solves it
ConsistentStart make_consistent_pressing(system::MechanismEquations& equations, const system::State& given,
                                         model::Side side);

}  // namespace rubato::integrate
