#include <rubato/integrate/steady/assembled_stiffness.hpp>
#include <rubato/integrate/steady/condensed_structure_routes.hpp>
#include <rubato/numerics/complex_ldlt.hpp>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

using Outcome = CondensedStructure::Outcome;
using Columns = CondensedStructure::Columns;
// What of a singular direction a column must see to be moved by it.
constexpr double seen = 1e-9;

class DenseFactorisation final : public CondensedStructure::Route {
 public:
  explicit DenseFactorisation(const Columns& columns)
      : columns_(columns),
        mass_(columns.system.mass()),
        damping_(columns.system.damping()),
        stiffness_(columns.system.stiffness()) {}

  void set_loads() override {}

  Outcome condense(double w, double held, ComplexMatrix& g) override {
    const Index n = mass_.rows(), m = columns_.sliders.cols(), e = columns_.loads.cols();
    factorise(w, held);
    Matrix driven(n, m + e);
    driven << columns_.sliders, columns_.loads;
    if (is_singular_) {
      for (const Index direction : singular_directions()) {
        if (sees(columns_.sliders, direction)) return Outcome::sliders_needed;
        if (sees(columns_.loads, direction)) return Outcome::resonance;
      }
    }
    ComplexMatrix position;
    solve(driven.cast<Complex>(), position);
    g = columns_.project(position);
    return !is_singular_ && condition_ < nearly_singular ? Outcome::near_resonance : Outcome::regular;
  }

  void expand(double w, double held, const ComplexVector& forces, ComplexVector& position) override {
    factorise(w, held);
    ComplexMatrix out;
    solve(columns_.sliders.cast<Complex>() * forces.head(columns_.sliders.cols()) +
              columns_.loads.cast<Complex>() * forces.tail(columns_.loads.cols()),
          out);
    position = out;
  }

  std::vector<CondensedStructure::Resonance> resonances(double w) override {
    std::vector<CondensedStructure::Resonance> found;
    factorise(w, 0.0);
    if (!is_singular_) return found;
    for (const Index direction : singular_directions()) {
      ComplexVector phi = svd_.matrixV().col(direction).cwiseProduct(scale_);
      Index largest;
      phi.cwiseAbs().maxCoeff(&largest);
      phi /= phi[largest];
      const Vector real = phi.real();
      found.push_back({columns_.sliders.transpose() * real, columns_.loads.transpose() * real});
    }
    return found;
  }

 private:
  // S Z S with S = 1/sqrt(|K_ii| + held + w^2 M_ii), so that metres and radians weigh the same.
  void factorise(double w, double held) {
    ComplexMatrix z = assembled_stiffness(stiffness_, mass_, damping_, w);
    if (held > 0.0)
      z += (columns_.sliders * (held * columns_.slider_stiffness).asDiagonal() * columns_.sliders.transpose())
               .cast<Complex>();
    scale_ = (z.diagonal().cwiseAbs() + (w * w) * mass_.diagonal()).cwiseSqrt();
    for (double& s : scale_) s = s > 0.0 ? 1.0 / s : 1.0;
    z = scale_.asDiagonal() * z * scale_.asDiagonal();
    factor_.compute(z);
    condition_ = factor_.rcond();
    is_singular_ = !(condition_ > singular);
    if (is_singular_) svd_.compute(z, Eigen::ComputeFullU | Eigen::ComputeFullV);
  }

  std::vector<Index> singular_directions() const {
    std::vector<Index> directions;
    const Vector& values = svd_.singularValues();
    for (Index i = 0; i < values.size(); ++i)
      if (!(values[i] > 10.0 * singular * values[0])) directions.push_back(i);
    return directions;
  }

  bool sees(const Matrix& columns, Index direction) const {
    const ComplexVector phi = svd_.matrixV().col(direction).cwiseProduct(scale_);
    for (Index j = 0; j < columns.cols(); ++j)
      if (std::abs((columns.col(j).cast<Complex>().transpose() * phi)(0)) > seen * columns.col(j).norm() * phi.norm())
        return true;
    return false;
  }

  void solve(const ComplexMatrix& forces, ComplexMatrix& position) const {
    const ComplexMatrix scaled = scale_.asDiagonal() * forces;
    if (!is_singular_) {
      position = scale_.asDiagonal() * ComplexMatrix(factor_.solve(scaled));
      return;
    }
    ComplexMatrix shares = svd_.matrixU().adjoint() * scaled;
    const Vector& values = svd_.singularValues();
    for (Index i = 0; i < values.size(); ++i)
      shares.row(i) *= values[i] > 10.0 * singular * values[0] ? 1.0 / values[i] : 0.0;
    position = scale_.asDiagonal() * ComplexMatrix(svd_.matrixV() * shares);
  }

  const Columns& columns_;
  Matrix mass_, damping_, stiffness_;
  Vector scale_;
  Eigen::PartialPivLU<ComplexMatrix> factor_;
  Eigen::JacobiSVD<ComplexMatrix> svd_;
  double condition_ = 0.0;
  bool is_singular_ = false;
};

/// L D L^T of the sparse complex symmetric Z without pivoting, the rows of the columns last, judged by the residual of
/// one combination of the columns; where that is too large, LU with pivoting.
class SparseFactorisation final : public CondensedStructure::Route {
 public:
  explicit SparseFactorisation(const Columns& columns)
      : columns_(columns),
        stiffness_(columns.system, StuckSliders(static_cast<std::size_t>(columns.system.slider_count()), true)) {
    set_loads();
  }

  void set_loads() override {
    const Index n = stiffness_.size(), driven = columns_.driven();
    Matrix all = Matrix::Zero(n, columns_.count());
    all.leftCols(driven) << columns_.sliders, columns_.loads;
    for (std::size_t i = 0; i < columns_.observed.size(); ++i) {
      const auto& [first, second] = columns_.observed[i];
      if (first != ground) all(first, driven + static_cast<Index>(i)) += 1.0;
      if (second != ground) all(second, driven + static_cast<Index>(i)) -= 1.0;
    }
    sparse_ = all.sparseView();
    // The rows of a load that is spread over the structure stay where they are.
    const int spread = std::max(most_own_rows, static_cast<int>(n) / 100);
    std::vector<bool> is_last(static_cast<std::size_t>(n), false);
    for (Index column = 0; column < sparse_.cols(); ++column) {
      if (sparse_.outerIndexPtr()[column + 1] - sparse_.outerIndexPtr()[column] > spread) continue;
      for (SparseMatrix::InnerIterator entry(sparse_, column); entry; ++entry)
        is_last[static_cast<std::size_t>(entry.row())] = true;
    }
    std::vector<int> last;
    for (int row = 0; row < n; ++row)
      if (is_last[static_cast<std::size_t>(row)]) last.push_back(row);
    combination_ = Vector::LinSpaced(driven, 1.0, 2.0);
    combined_ = all.leftCols(driven) * combination_;
    factor_.analyse(stiffness_.pattern(), last);
  }

  Outcome condense(double w, double held, ComplexMatrix& g) override {
    stiffness_.assemble(w, held);
    factor_.factorise(stiffness_.matrix(), stiffness_.scale());
    ComplexMatrix position = combined_.cast<Complex>();
    factor_.solve(position);
    if (is_solved(combined_.cast<Complex>(), position)) {
      factor_.condense(sparse_, condensed_);
      g = condensed_.leftCols(columns_.driven());
      if (agrees(g, position)) return Outcome::regular;
    }
    Matrix driven(columns_.sliders.rows(), columns_.driven());
    driven << columns_.sliders, columns_.loads;
    if (!solve_with_pivoting(driven.cast<Complex>(), position))
      return held == 0.0 && columns_.sliders.cols() > 0 ? Outcome::sliders_needed : Outcome::resonance;
    g = columns_.project(position);
    return Outcome::regular;
  }

  void expand(double w, double held, const ComplexVector& forces, ComplexVector& position) override {
    const ComplexMatrix load = columns_.sliders.cast<Complex>() * forces.head(columns_.sliders.cols()) +
                               columns_.loads.cast<Complex>() * forces.tail(columns_.loads.cols());
    stiffness_.assemble(w, held);
    factor_.factorise(stiffness_.matrix(), stiffness_.scale());
    ComplexMatrix out = load;
    factor_.solve(out);
    if (is_solved(load, out) || solve_with_pivoting(load, out))
      position = out;
    else
      position.setConstant(load.rows(), Complex(std::numeric_limits<double>::infinity(), 0.0));
  }

 private:
  bool solve_with_pivoting(const ComplexMatrix& load, ComplexMatrix& position) const {
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> pivoting;
    pivoting.compute(stiffness_.matrix());
    if (pivoting.info() != Eigen::Success) return false;
    position = pivoting.solve(load);
    return is_solved(load, position);
  }

  // A small residual against a bounded answer: a singular matrix leaves one of the two unfulfilled.
  bool is_solved(const ComplexMatrix& load, const ComplexMatrix& position) const {
    // Squares: the moduli of a million entries cost more than the solution.
    const auto largest = [](const auto& values) { return std::sqrt(values.cwiseAbs2().maxCoeff()); };
    const double given = largest(load), residual = largest(load - stiffness_.matrix() * position);
    const double size = largest(stiffness_.matrix().coeffs()) * largest(position);
    return residual <= solved * given && singular * size <= given;
  }

  // The condensed columns answer to the combination as the solution does.
  bool agrees(const ComplexMatrix& g, const ComplexMatrix& position) const {
    const ComplexVector seen_of_it = columns_.project(position), summed = g * combination_.cast<Complex>();
    return (seen_of_it - summed).cwiseAbs().maxCoeff() <= solved * position.cwiseAbs().maxCoeff();
  }

  static constexpr double solved = 1e-9;
  static constexpr int most_own_rows = 8;  // of a column, to be eliminated last

  const Columns& columns_;
  AssembledStiffness stiffness_;
  SparseMatrix sparse_;  ///< P [n x p]
  Vector combination_;   ///< of the driven columns
  Vector combined_;      ///< [n]
  ComplexMatrix condensed_;
  numerics::ComplexLdlt factor_;
};

}  // namespace

std::unique_ptr<CondensedStructure::Route> dense_factorisation(const Columns& columns) {
  return std::make_unique<DenseFactorisation>(columns);
}

std::unique_ptr<CondensedStructure::Route> sparse_factorisation(const Columns& columns) {
  return std::make_unique<SparseFactorisation>(columns);
}

}  // namespace rubato::integrate
