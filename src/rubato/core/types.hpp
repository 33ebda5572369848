#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace rubato {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;  ///< by columns, int indices

/// The index that stands for the ground wherever an element joins two coordinates.
inline constexpr Index ground = -1;

}  // namespace rubato
