#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// The coordinates of a motion that the stiffness does not resist and laws at rest do; empty where there is none.
std::vector<Index> held_by_laws_alone(const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
