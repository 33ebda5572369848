#include <rubato/numerics/complex_ldlt.hpp>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <vector>

namespace rubato::numerics {
namespace {

/// K - w^2 M + i w C of a square membrane of side x side masses: symmetric, complex and indefinite.
struct Membrane {
  explicit Membrane(int side, double frequency) {
    const auto at = [side](int row, int column) { return row * side + column; };
    std::vector<Eigen::Triplet<double>> real;
    std::vector<Eigen::Triplet<std::complex<double>>> entries;
    const auto add = [&](int i, int j, std::complex<double> value) {
      real.emplace_back(i, j, 1.0);
      entries.emplace_back(i, j, value);
    };
    const std::complex<double> spring(-1.0, -0.02 * frequency);
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        add(at(r, c), at(r, c), std::complex<double>(4.0 - frequency * frequency, 0.1 * frequency));
        for (const auto& [to_r, to_c] : {std::pair{r + 1, c}, std::pair{r, c + 1}})
          if (to_r < side && to_c < side) {
            add(at(r, c), at(to_r, to_c), spring);
            add(at(to_r, to_c), at(r, c), spring);
          }
      }
    const int n = side * side;
    pattern.resize(n, n);
    matrix.resize(n, n);
    pattern.setFromTriplets(real.begin(), real.end());
    matrix.setFromTriplets(entries.begin(), entries.end());
    scale = Vector::Constant(n, 4.0 + frequency * frequency);
  }
  SparseMatrix pattern;
  SparseComplexMatrix matrix;
  Vector scale;
};

// Condition below 1e3, pivots that grow ten times at most: 1e-11 is a thousand times the round-off of that.
constexpr double round_off = 1e-11;

TEST(ComplexLdlt, SolvesASymmetricComplexMatrix) {
  const Membrane membrane(9, 1.3);
  ComplexLdlt factor;
  factor.analyse(membrane.pattern);
  EXPECT_EQ(factor.factorise(membrane.matrix, membrane.scale), 0);
  const Eigen::MatrixXcd load = Eigen::MatrixXcd::Random(81, 3);
  Eigen::MatrixXcd x = load;
  factor.solve(x);
  EXPECT_LE((membrane.matrix * x - load).cwiseAbs().maxCoeff(), round_off);
}

TEST(ComplexLdlt, CondensesToColumnsAsTheInverseDoes) {
  const Membrane membrane(9, 1.3);
  // Two single rows, a difference, and a load spread over all rows.
  Matrix columns = Matrix::Zero(81, 4);
  columns(40, 0) = columns(7, 1) = columns(62, 2) = 1.0;
  columns(40, 2) = -1.0;
  columns.col(3).setLinSpaced(-1.0, 2.0);
  const Eigen::MatrixXcd inverse = Eigen::MatrixXcd(membrane.matrix).inverse();
  const Eigen::MatrixXcd expected = columns.transpose() * inverse * columns;
  const std::vector<int> touched{7, 40, 62};
  for (const auto& last : {std::vector<int>{}, touched}) {
    ComplexLdlt factor;
    factor.analyse(membrane.pattern, last);
    factor.factorise(membrane.matrix, membrane.scale);
    Eigen::MatrixXcd condensed;
    // Twice: the first must leave nothing behind.
    for (int pass = 0; pass < 2; ++pass) {
      factor.condense(columns.sparseView(), condensed);
      EXPECT_LE((condensed - expected).cwiseAbs().maxCoeff(), round_off * expected.cwiseAbs().maxCoeff());
    }
  }
}

TEST(ComplexLdlt, SaysWhichPivotsItReplaced) {
  const Membrane membrane(2, 2.0);  // w^2 = 4: zeros on the diagonal, but for the damping
  SparseComplexMatrix undamped = membrane.matrix;
  for (Index i = 0; i < undamped.nonZeros(); ++i) undamped.valuePtr()[i].imag(0.0);
  ComplexLdlt factor;
  factor.analyse(membrane.pattern);
  EXPECT_GT(factor.factorise(undamped, membrane.scale), 0);
}

}  // namespace
}  // namespace rubato::numerics
