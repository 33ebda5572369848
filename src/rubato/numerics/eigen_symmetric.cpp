#include <rubato/numerics/compensated.hpp>
#include <rubato/numerics/eigen_graded.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/numerics/ordered_factor.hpp>
#include <rubato/numerics/scaled_residual.hpp>

#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace rubato::numerics {
namespace {

constexpr double unit = std::numeric_limits<double>::epsilon();
constexpr Index dense_size = 400;  // below, the dense solver takes less than half a second
constexpr double lanczos_tolerance = 1e-12;
constexpr Index most_restarts = 300;
constexpr int most_rounds = 20;        // of searching for what is missing
constexpr Index graded_size = 1000;    // up to it the graded solver takes less than a minute
constexpr double least_pivot = 1e-13;  // relative: K with a smaller one is as good as singular
constexpr double safe_pivot = 1e-13;   // over the largest: the sign of a smaller one is not to be trusted
constexpr double most_growth = 1e6;    // of pivots over the matrix: beyond, elimination without pivoting lost digits
constexpr double distinct = 1e-7;      // relative gap that a count can stand in
constexpr double accurate = 1e-8;      // defect beyond which the dense solver gives way to the graded one
constexpr double acceptable = 1e-4;    // defect of modes that may be returned: 1e-8 of omega^2
constexpr double entry_error = 2.0;    // of K by assembly and by the formulas of elements, in units of round-off
constexpr double worth = 1e-10;        // relative round-off of omega^2 from which products are formed exactly

struct Problem {
  SparseMatrix stiffness, mass;
  double unit_square = 1.0;  // what an eigenvalue of 1 here is outside [rad2/s2]
  double lowest = 1.0;       // of K_ii / M_ii where it is not zero

  SparseMatrix shifted(double s) const { return SparseMatrix(stiffness - s * mass); }
  // What the diagonal of K - s M is made of: the measure of its pivots, light and heavy coordinates alike.
  Vector size(double s) const { return stiffness.diagonal().cwiseAbs() + std::abs(s) * Vector(mass.diagonal()); }
};

// Scaled so that the highest eigenvalue is of the order of one and masses are too: Spectra's floors are absolute.
Problem scaled(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  const double heavy = mass.diagonal().mean();
  double stiff = (stiffness.diagonal().array().abs() / mass.diagonal().array()).maxCoeff();
  if (!(stiff > 0.0)) stiff = 1.0;
  Problem problem{SparseMatrix(stiffness / (stiff * heavy)), SparseMatrix(mass / heavy), stiff, 1.0};
  for (Index i = 0; i < mass.rows(); ++i)
    if (const double own = std::abs(stiffness.coeff(i, i)) / (mass.coeff(i, i) * stiff); own > 0.0)
      problem.lowest = std::min(problem.lowest, own);
  return problem;
}

// Spectra's view of (K - s M)^-1, with the modes already found taken out of every product.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(const Problem& problem, const OrderedFactor& factor, const Matrix& found)
      : factor_(factor), found_(found), weighted_(problem.mass * found), n_(problem.mass.rows()) {}
  Index rows() const { return n_; }
  Index cols() const { return n_; }
  void set_shift(double) {}  // factorised outside
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Vector> result(y, n_);
    right_ = Eigen::Map<const Vector>(x, n_);
    factor_.solve(right_, solution_);
    result = solution_;
    project(result);
  }
  void project(Eigen::Ref<Vector> x) const {
    if (found_.cols() > 0) x -= found_ * (weighted_.transpose() * x);
  }

 private:
  const OrderedFactor& factor_;
  const Matrix& found_;
  Matrix weighted_;
  mutable Vector right_, solution_;
  Index n_;
};

class MassProduct {
 public:
  using Scalar = double;
  explicit MassProduct(const SparseMatrix& mass) : mass_(mass) {}
  Index rows() const { return mass_.rows(); }
  Index cols() const { return mass_.rows(); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Vector>(y, rows()).noalias() = mass_ * Eigen::Map<const Vector>(x, rows());
  }

 private:
  const SparseMatrix& mass_;
};

// A start vector without symmetry: the fractional parts of multiples of the golden section, another for each round.
Vector start_vector(Index n, int round) {
  Vector x(n);
  for (Index i = 0; i < n; ++i) {
    const double place = (static_cast<double>(i) + 1.0) * 0.6180339887498949 + 0.1 * round;
    x[i] = place - std::floor(place) - 0.5 + 0.25 * std::sin(static_cast<double>(i) * (1.0 + round));
  }
  return x;
}

/// Modes by Lanczos at a shift, beside those already found. Returns how many came.
struct Search {
  Matrix shapes;
  bool has_converged = false;
};

Search search(const Problem& problem, const OrderedFactor& factor, double shift, const Matrix& found, Index wanted,
              int round) {
  const Index n = problem.mass.rows();
  wanted = std::min(wanted, n - found.cols() - 1);
  Search result;
  if (wanted < 1) return result;
  ShiftInvert inverse(problem, factor, found);
  MassProduct mass(problem.mass);
  const Index subspace = std::min(n - found.cols(), std::max<Index>(2 * wanted + 10, 30));
  Spectra::SymGEigsShiftSolver<ShiftInvert, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(inverse, mass, wanted,
                                                                                                 subspace, shift);
  Vector start = start_vector(n, round);
  inverse.project(start);
  solver.init(start.data());
  solver.compute(Spectra::SortRule::LargestMagn, most_restarts, lanczos_tolerance, Spectra::SortRule::SmallestAlge);
  result.has_converged = solver.info() == Spectra::CompInfo::Successful;
  result.shapes = solver.eigenvectors();
  // Iteration leaves noise that is small beside the mass; one product more makes it small beside the stiffness too.
  for (Index j = 0; j < result.shapes.cols(); ++j) {
    const Vector heavy = problem.mass * result.shapes.col(j);
    inverse.perform_op(heavy.data(), result.shapes.col(j).data());
    result.shapes.col(j) /= std::sqrt(result.shapes.col(j).dot(problem.mass * result.shapes.col(j)));
  }
  return result;
}

// Rayleigh-Ritz in the span of the shapes: orthonormal in M, rising.
void rotate_to_modes(const Problem& problem, Matrix& shapes, Vector& eigenvalues) {
  const Matrix k = shapes.transpose() * (problem.stiffness * shapes);
  const Matrix m = shapes.transpose() * (problem.mass * shapes);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> small(k, m);
  shapes = (shapes * small.eigenvectors()).eval();
  eigenvalues = small.eigenvalues();
}

bool is_safely_definite(const Problem& problem, double shift, const Vector& pivots) {
  return (pivots.array() > least_pivot * problem.size(shift).array()).all() && std::isfinite(pivots.sum());
}

// The number of eigenvalues below s; nothing where round-off could have turned a sign.
std::optional<Index> eigenvalues_below(const Problem& problem, OrderedFactor& factor, double s) {
  if (!factor.factorise(problem.shifted(s), Pivots::nonzero)) return std::nullopt;
  const Vector pivots = factor.pivots();
  const Vector relative = pivots.cwiseAbs().cwiseQuotient(problem.size(s));
  const double most = std::max(1.0, relative.maxCoeff());
  if (!(relative.minCoeff() > safe_pivot * most) || !(most < most_growth)) return std::nullopt;
  return static_cast<Index>((pivots.array() < 0.0).count());
}

// A shift below the spectrum at which K - s M is safely positive definite; its factor is left in `factor`.
double shift_below(const Problem& problem, OrderedFactor& factor, double start) {
  double shift = start;
  for (int i = 0; i < 60; ++i) {
    if (factor.factorise(problem.shifted(shift)) && is_safely_definite(problem, shift, factor.pivots())) return shift;
    shift = shift == 0.0 ? -std::min(1e-6, 1e-3 * problem.lowest) : 10.0 * shift;
  }
  return shift;
}

// How many modes are missing below the last one wanted: in the gap below it and those equal to it, all eigenvalues are
// counted. Copies of the last one itself do not matter.
std::optional<Index> missing_below(const Problem& problem, OrderedFactor& factor, const Vector& eigenvalues,
                                   Index wanted) {
  const Index held = eigenvalues.size();
  const double scale = std::max(std::abs(eigenvalues[held - 1]), unit * problem.lowest);
  const double margin = distinct * scale;
  Index found = std::min(wanted, held) - 1;
  while (found > 0 && !(eigenvalues[found] - eigenvalues[found - 1] > margin)) --found;
  const double to = eigenvalues[found], from = found > 0 ? eigenvalues[found - 1] : to - 20.0 * margin;
  for (const double part : {0.5, 0.375, 0.7, 0.25, 0.85})
    if (const auto all = eigenvalues_below(problem, factor, from + part * (to - from))) return *all - found;
  return std::nullopt;
}

// phi^T K phi and K phi as if with twice the digits.
double exact_energy(const SparseMatrix& stiffness, const Vector& shape, Vector& force) {
  std::vector<Compensated> rows(static_cast<std::size_t>(shape.size()));
  for (Index column = 0; column < stiffness.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(stiffness, column); entry; ++entry)
      rows[static_cast<std::size_t>(entry.row())].add_product(entry.value(), shape[column]);
  Compensated energy;
  for (Index i = 0; i < shape.size(); ++i) {
    const Compensated& row = rows[static_cast<std::size_t>(i)];
    force[i] = row.value();
    energy.add_product(shape[i], row.sum());
    energy.add_product(shape[i], row.lost());
  }
  return energy.value();
}

void finish(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseMatrix* terms, SymmetricModes& modes) {
  const Index k = modes.shapes.cols();
  const SparseMatrix moduli = stiffness.cwiseAbs();
  const SparseMatrix& size = terms ? *terms : moduli;
  const double plain = (16.0 + std::sqrt(static_cast<double>(mass.rows()))) * unit;  // round-off of a sum as it comes
  const Vector stiff = stiffness.diagonal().cwiseAbs(), heavy = mass.diagonal();
  modes.eigenvalues.resize(k);
  modes.round_off.resize(k);
  for (Index j = 0; j < k; ++j) {
    Vector shape = modes.shapes.col(j);
    Index largest = 0;
    const double most = shape.cwiseAbs().maxCoeff();
    // The first of those that share the largest value: round-off must not choose between them.
    while (largest + 1 < shape.size() && !(std::abs(shape[largest]) >= most * (1.0 - 1e-6))) ++largest;
    shape *= std::copysign(1.0, shape[largest]) / std::sqrt(shape.dot(mass * shape));
    const Vector magnitude = shape.cwiseAbs();
    const double all = magnitude.dot(size * magnitude);
    modes.round_off[j] = entry_error * unit * all;
    Vector force = stiffness * shape;
    double energy = shape.dot(force);
    if (plain * all > worth * std::abs(energy)) energy = exact_energy(stiffness, shape, force);
    modes.eigenvalues[j] = std::abs(energy) <= modes.round_off[j] ? 0.0 : energy;
    const Vector residual = force - modes.eigenvalues[j] * (mass * shape);
    const ScaledResidual scaled(stiff + std::abs(energy) * heavy, residual, shape);
    modes.residual = std::max(modes.residual, scaled.backward());
    modes.defect = std::max(modes.defect, scaled.of_energy(std::abs(modes.eigenvalues[j])));
    // A motion without mass, or numbers beyond the largest: what the round-off hides would count as a rigid motion.
    if (!std::isfinite(all)) modes.residual = modes.defect = std::numeric_limits<double>::infinity();
    modes.shapes.col(j) = shape;
  }
  modes.has_converged = modes.has_converged && modes.defect <= acceptable;
  // Quotients of nearly equal modes may come out of order.
  std::vector<Index> order(static_cast<std::size_t>(k));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return modes.eigenvalues[a] < modes.eigenvalues[b]; });
  const Vector eigenvalues = modes.eigenvalues, round_off = modes.round_off;
  const Matrix shapes = modes.shapes;
  for (Index j = 0; j < k; ++j) {
    const Index from = order[static_cast<std::size_t>(j)];
    modes.eigenvalues[j] = eigenvalues[from];
    modes.round_off[j] = round_off[from];
    modes.shapes.col(j) = shapes.col(from);
  }
}

SymmetricModes by_shift_invert(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                               const SparseMatrix* terms) {
  const Index n = mass.rows();
  const Problem problem = scaled(stiffness, mass);
  OrderedFactor factor;
  factor.analyse(problem.shifted(-1.0));
  const Index wanted = std::min(n - 1, count + std::max<Index>(4, count / 8));
  SymmetricModes modes;
  Vector eigenvalues;
  double shift = shift_below(problem, factor, 0.0);
  Search first = search(problem, factor, shift, Matrix(n, 0), wanted, 0);
  // A shift much larger or smaller than the eigenvalues wanted costs iterations, or digits.
  for (int i = 0; i < 4 && shift != 0.0 && first.shapes.cols() > 0; ++i) {
    rotate_to_modes(problem, first.shapes, eigenvalues);
    const double size = eigenvalues[eigenvalues.size() - 1];
    if (!(size > 0.0) || (-shift <= size && -shift >= 1e-3 * size)) break;
    const double better = shift_below(problem, factor, -0.1 * size);
    if (better == shift) break;
    shift = better;
    first = search(problem, factor, shift, Matrix(n, 0), wanted, 0);
  }
  modes.shapes = std::move(first.shapes);
  modes.has_converged = first.has_converged;
  modes.missing = -1;
  OrderedFactor inertia;
  inertia.analyse(problem.shifted(-1.0));
  for (int round = 1; round <= most_rounds && modes.shapes.cols() > 0; ++round) {
    rotate_to_modes(problem, modes.shapes, eigenvalues);
    modes.missing = missing_below(problem, inertia, eigenvalues, count).value_or(-1);
    if (modes.missing <= 0) break;
    const Search more = search(problem, factor, shift, modes.shapes, modes.missing + 2, round);
    if (more.shapes.cols() == 0) break;
    Matrix all(n, modes.shapes.cols() + more.shapes.cols());
    all << modes.shapes, more.shapes;
    modes.shapes = std::move(all);
  }
  if (modes.missing < -1) modes.missing = -1;
  modes.has_converged = modes.has_converged && modes.shapes.cols() >= count;
  modes.shapes.conservativeResize(n, std::min(count, modes.shapes.cols()));
  finish(stiffness, mass, terms, modes);
  return modes;
}

}  // namespace

std::optional<Index> modes_below(const SparseMatrix& stiffness, const SparseMatrix& mass, double value) {
  const Problem problem = scaled(stiffness, mass);
  OrderedFactor factor;
  factor.analyse(problem.shifted(-1.0));
  return eigenvalues_below(problem, factor, value / problem.unit_square);
}

bool is_dense_eigenproblem(Index size, Index count) { return size <= dense_size || 3 * count > size; }

SymmetricModes all_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseMatrix* terms) {
  const Matrix k(stiffness), m(mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(k, m);
  SymmetricModes modes;
  modes.shapes = Matrix(mass.rows(), 0);
  if (solver.info() == Eigen::Success && solver.eigenvectors().allFinite()) modes.shapes = solver.eigenvectors();
  finish(stiffness, mass, terms, modes);
  if (modes.shapes.cols() == mass.rows() && modes.defect <= accurate) return modes;
  modes.has_converged = modes.has_converged && modes.shapes.cols() == mass.rows();
  if (mass.rows() > graded_size) return modes;
  const std::optional<Matrix> shapes = graded_shapes(k, m);
  if (!shapes) return modes;
  SymmetricModes graded;
  graded.shapes = *shapes;
  finish(stiffness, mass, terms, graded);
  return modes.shapes.cols() < mass.rows() || graded.defect < modes.defect ? graded : modes;
}

SymmetricModes lowest_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                            const SparseMatrix* terms) {
  const Index n = mass.rows();
  if (!is_dense_eigenproblem(n, count)) return by_shift_invert(stiffness, mass, count, terms);
  SymmetricModes modes = all_modes(stiffness, mass, terms);
  const Index kept = std::min(count, modes.shapes.cols());
  modes.eigenvalues.conservativeResize(kept);
  modes.round_off.conservativeResize(kept);
  modes.shapes.conservativeResize(n, kept);
  return modes;
}

}  // namespace rubato::numerics
