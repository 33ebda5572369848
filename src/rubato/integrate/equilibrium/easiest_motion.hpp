#pragma once

#include <rubato/numerics/ordered_factor.hpp>

#include <vector>

namespace rubato::integrate {

/// Factorises a stiffness and tells whether it resists every motion. A matrix of a structure that floats is singular,
/// but its last pivot is round-off of either sign and may look like a stiffness.
/// @param matrix          [n x n], n above 0
/// @param factor          analysed for the matrix; where true, it holds the factor
/// @param factorisations  counts them
/// @param moving          where false, the rows of the motion of least resistance; else as it was
bool factorise_resisting(const SparseMatrix& matrix, numerics::Pivots pivots, numerics::OrderedFactor& factor,
                         int& factorisations, std::vector<Index>& moving);

}  // namespace rubato::integrate
