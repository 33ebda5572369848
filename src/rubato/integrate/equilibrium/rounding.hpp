#pragma once

#include <rubato/numerics/ordered_factor.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// What the rounding of the entries of K may do to displacements that were solved for with it, over the largest of
/// them (of displacements and of rotations the larger): |K^-1 (eps |K| |q| s)| for shares s in
/// [-1, 1] that follow no pattern, a sample of the condition number of Bauer and Skeel (Higham 2002, section 7.2).
/// Meshes whose elements are ever shorter beside the whole lose their displacements by it, the residual being as small
/// as ever.
/// @param free    coordinates of the factors, in their order
/// @param factor  of K on these, with what contacts add
double rounding_of_stiffness(const system::LocallyNonlinear& system, const std::vector<Index>& free,
                             const numerics::OrderedFactor& factor, const Vector& q);

}  // namespace rubato::integrate
