#pragma once

#include <rubato/core/types.hpp>

#include <complex>
#include <vector>

namespace rubato::integrate {

/// L D L^T (transposed, not conjugate) of a sparse complex symmetric matrix, without pivoting: up-looking along the
/// elimination tree (Davis 2005, Algorithm 849), after approximate minimum degree. The pattern is analysed once.
class ComplexLdlt {
 public:
  using Complex = std::complex<double>;
  using SparseComplexMatrix = Eigen::SparseMatrix<Complex>;

  void analyse(const SparseComplexMatrix& matrix);    ///< both triangles
  bool factorise(const SparseComplexMatrix& matrix);  ///< false where a pivot vanishes or is not finite
  void solve(const Eigen::MatrixXcd& load, Eigen::MatrixXcd& x) const;  ///< for each column
  Index entries() const { return static_cast<Index>(row_.size()); }

 private:
  Index n_ = 0;
  std::vector<int> order_, position_, parent_, start_, row_, filled_, mark_, path_, pattern_;
  std::vector<int> upper_start_, upper_row_, upper_source_;  ///< upper triangle, permuted, and where its values are
  std::vector<Complex> value_, diagonal_, work_;
};

}  // namespace rubato::integrate
