#pragma once

#include <rubato/core/types.hpp>

#include <complex>

namespace rubato {

using Complex = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;
using ComplexMatrix = Eigen::MatrixXcd;

}  // namespace rubato
