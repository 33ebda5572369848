#include <rubato/steady/dynamic_stiffness.hpp>
#include <rubato/steady/harmonic_balance/condensed_structure_routes.hpp>

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rubato::steady {
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

 private:
  // S Z S with S = 1/sqrt(|K_ii| + held + w^2 M_ii), so that metres and radians weigh the same.
  void factorise(double w, double held) {
    ComplexMatrix z = assembled_stiffness(stiffness_, mass_, damping_, w);
    if (held > 0.0)
      z += (columns_.sliders * (held * columns_.holding_stiffness).asDiagonal() * columns_.sliders.transpose())
               .cast<Complex>();
    sizes_ = stiffness_.cwiseAbs() + (w * w) * mass_.cwiseAbs();
    scale_ = (z.diagonal().cwiseAbs() + (w * w) * mass_.diagonal()).cwiseSqrt();
    for (double& s : scale_) s = s > 0.0 ? 1.0 / s : 1.0;
    z = scale_.asDiagonal() * z * scale_.asDiagonal();
    factor_.compute(z);
    // The estimate of the condition overlooks a pivot that is zero to the last digit.
    const auto& factors = factor_.matrixLU();
    const bool has_pivots = factors.allFinite() && (factors.diagonal().array() != 0.0).all();
    condition_ = has_pivots ? factor_.rcond() : 0.0;
    is_singular_ = !(condition_ > singular);
    if (!is_singular_) return;
    dynamic_ = z;
    frequency_ = w;
    svd_.compute(z, Eigen::ComputeFullU | Eigen::ComputeFullV);
    is_singular_ = !singular_directions().empty();
  }

  // Whether nothing but round-off of its terms resists a direction: K - w^2 M and C each by itself, since stiff parts
  // hide the digits of soft ones and not those of their dampers.
  bool is_free(Index direction) const {
    const ComplexVector phi = svd_.matrixV().col(direction);
    const ComplexVector x = phi.cwiseProduct(scale_);
    const Vector moduli = x.cwiseAbs();
    const double size = moduli.dot(sizes_ * moduli), dampers = moduli.dot(damping_.cwiseAbs() * moduli);
    const double resisted = frequency_ * std::abs(x.dot(damping_ * x));
    return std::abs(phi.dot(dynamic_ * phi).real()) <= round_off_of_terms * size &&
           resisted <= std::max(round_off_of_terms * frequency_ * dampers, 1e-3 * round_off_of_terms * size);
  }

  std::vector<Index> singular_directions() const {
    std::vector<Index> directions;
    const Vector& values = svd_.singularValues();
    for (Index i = 0; i < values.size(); ++i)
      if (!(values[i] > 10.0 * singular * values[0]) && is_free(i)) directions.push_back(i);
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
    for (Index i = 0; i < values.size(); ++i) shares.row(i) *= values[i] > 0.0 ? 1.0 / values[i] : 0.0;
    for (const Index direction : singular_directions()) shares.row(direction).setZero();
    position = scale_.asDiagonal() * ComplexMatrix(svd_.matrixV() * shares);
  }

  const Columns& columns_;
  Matrix mass_, damping_, stiffness_, sizes_;
  Vector scale_;
  ComplexMatrix dynamic_;  // scaled, where it may be singular
  double frequency_ = 0.0;
  Eigen::PartialPivLU<ComplexMatrix> factor_;
  Eigen::JacobiSVD<ComplexMatrix> svd_;
  double condition_ = 0.0;
  bool is_singular_ = false;
};

/// DynamicStiffness, the rows of the columns last: its factor condenses all columns at once without substituting
/// backwards. One combination of them is solved with refinement and says how far Z determines the answer; where the
/// condensed columns do not agree with it, each is solved by itself.
class SparseFactorisation final : public CondensedStructure::Route {
 public:
  explicit SparseFactorisation(const Columns& columns) : columns_(columns) { set_loads(); }

  void set_loads() override {
    const Index n = columns_.system.size(), driven = columns_.driven();
    Matrix all = Matrix::Zero(n, columns_.count());
    all.leftCols(driven) << columns_.sliders, columns_.loads;
    for (std::size_t i = 0; i < columns_.observed.size(); ++i)
      columns_.observed[i].for_each(
          [&](Index coordinate, double weight) { all(coordinate, driven + static_cast<Index>(i)) += weight; });
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
    combined_ = (all.leftCols(driven) * combination_).cast<Complex>();
    stiffness_.emplace(columns_.system, columns_.holding_springs(), last);
  }

  Outcome condense(double w, double held, ComplexMatrix& g) override {
    stiffness_->factorise(w, held);
    ComplexVector position;
    const StiffnessSolution solution = stiffness_->solve(combined_, position);
    const double size = largest(position), doubt = largest(solution.uncertainty);
    const double uncertainty = size > 0.0 ? doubt / size : 0.0;
    const bool is_singular = !(uncertainty <= undetermined);
    if (is_singular && !solution.is_damped)
      return held == 0.0 && columns_.sliders.cols() > 0 ? Outcome::sliders_needed : Outcome::resonance;
    if (stiffness_->condense(sparse_, condensed_)) {
      g = condensed_.leftCols(columns_.driven());
      if (!agrees(g, position, std::max(solved * size, doubt))) solve_each(g);
    } else {
      solve_each(g);
    }
    return is_singular || uncertainty > held_is_better ? Outcome::near_resonance : Outcome::regular;
  }

  void expand(double w, double held, const ComplexVector& forces, ComplexVector& position) override {
    stiffness_->factorise(w, held);
    stiffness_->solve(columns_.sliders.cast<Complex>() * forces.head(columns_.sliders.cols()) +
                          columns_.loads.cast<Complex>() * forces.tail(columns_.loads.cols()),
                      position);
  }

  double fill() const override { return stiffness_->fill(); }

 private:
  static double largest(const ComplexVector& x) {
    return x.size() > 0 ? std::sqrt(x.cwiseAbs2().maxCoeff()) : 0.0;  // squares: moduli cost more than the solution
  }

  void solve_each(ComplexMatrix& g) {
    const Index driven = columns_.driven();
    ComplexMatrix positions(columns_.sliders.rows(), driven);
    ComplexVector position;
    for (Index c = 0; c < driven; ++c) {
      const Index m = columns_.sliders.cols();
      const ComplexVector force = (c < m ? columns_.sliders.col(c) : columns_.loads.col(c - m)).cast<Complex>();
      stiffness_->solve(force, position);
      positions.col(c) = position;
    }
    g = columns_.project(positions);
  }

  // The condensed columns answer to the combination as the solution does.
  bool agrees(const ComplexMatrix& g, const ComplexVector& position, double allowed) const {
    const ComplexVector seen_of_it = columns_.project(position), summed = g * combination_.cast<Complex>();
    return largest(seen_of_it - summed) <= allowed;
  }

  static constexpr double solved = 1e-9;
  // Uncertainty from which springs put into Z may give better digits: static answers of fine meshes have 1e-9 or so.
  static constexpr double held_is_better = 1e-6;
  static constexpr int most_own_rows = 8;  // of a column, to be eliminated last

  const Columns& columns_;
  std::optional<DynamicStiffness> stiffness_;
  SparseMatrix sparse_;     ///< P [n x p]
  Vector combination_;      ///< of the driven columns
  ComplexVector combined_;  ///< [n]
  ComplexMatrix condensed_;
};

}  // namespace

std::unique_ptr<CondensedStructure::Route> dense_factorisation(const Columns& columns) {
  return std::make_unique<DenseFactorisation>(columns);
}

std::unique_ptr<CondensedStructure::Route> sparse_factorisation(const Columns& columns) {
  return std::make_unique<SparseFactorisation>(columns);
}

}  // namespace rubato::steady
