#pragma once

#include <rubato/system/assembled_model.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <span>
#include <vector>

namespace rubato::system {

/// Takes coordinates whose motion is given out of the parts of a system: their rows and columns, and what they pull
/// becomes loads on the others.
/// @param parts      of all coordinates, without loads; contacts do not touch those that are taken out
/// @param motions    in any order
/// @param first_law  the place of the law of the first motion among those of the model; the others follow it
/// @param loads      on all coordinates; returns those on the others, with what is pulled
void eliminate_supports(LocallyNonlinear::Parts& parts, std::span<const model::Prescribed> motions, int first_law,
                        std::vector<ModelLoad>& loads);

/// The damping C_ff of the free coordinates as one of all, for modes that are damped relative to the motion which the
/// supports alone would make: T^T C_ff T with T = [1, K_ff^-1 K_fp]. Throws InvalidInput where K_ff is singular.
/// @param damping    [n x n] of the free coordinates
/// @param stiffness  of all
SparseMatrix relative_damping(const SparseMatrix& damping, const SparseMatrix& stiffness,
                              std::span<const model::Prescribed> motions);

/// The entries of a matrix of all coordinates that join free ones.
SparseMatrix free_part(const SparseMatrix& matrix, std::span<const model::Prescribed> motions);

}  // namespace rubato::system
