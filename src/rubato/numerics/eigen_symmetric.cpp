#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/numerics/ordered_factor.hpp>

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
constexpr double least_pivot = 1e-11;  // relative: K with a smaller one is as good as singular
constexpr double safe_pivot = 1e-10;   // relative: the sign of a smaller one is not to be trusted
constexpr double most_growth = 1e6;    // of pivots over the matrix: beyond, elimination without pivoting lost digits
constexpr double distinct = 1e-7;      // relative gap that a count can stand in

struct Problem {
  SparseMatrix stiffness, mass;
  Vector size;               // |K_ii| + M_ii: what a diagonal entry of K - s M is made of
  double unit_square = 1.0;  // what an eigenvalue of 1 here is outside [rad2/s2]

  SparseMatrix shifted(double s) const { return SparseMatrix(stiffness - s * mass); }
};

// Scaled so that the highest eigenvalue is of the order of one and masses are too: Spectra's floors are absolute.
Problem scaled(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  const double heavy = mass.diagonal().mean();
  double stiff = (stiffness.diagonal().array().abs() / mass.diagonal().array()).maxCoeff();
  if (!(stiff > 0.0)) stiff = 1.0;
  Problem problem{SparseMatrix(stiffness / (stiff * heavy)), SparseMatrix(mass / heavy), {}, stiff};
  problem.size = problem.stiffness.diagonal().cwiseAbs() + problem.mass.diagonal();
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

bool is_safely_definite(const Problem& problem, const Vector& pivots) {
  return (pivots.array() > least_pivot * problem.size.array()).all() && std::isfinite(pivots.sum());
}

// The number of eigenvalues below s; nothing where round-off could have turned a sign.
std::optional<Index> eigenvalues_below(const Problem& problem, OrderedFactor& factor, double s) {
  if (!factor.factorise(problem.shifted(s), Pivots::nonzero)) return std::nullopt;
  const Vector pivots = factor.pivots();
  const auto relative = pivots.array().abs() / problem.size.array();
  if (!(relative.minCoeff() > safe_pivot) || !(relative.maxCoeff() < most_growth)) return std::nullopt;
  return static_cast<Index>((pivots.array() < 0.0).count());
}

// A shift below the spectrum at which K - s M is safely positive definite; its factor is left in `factor`.
double shift_below(const Problem& problem, OrderedFactor& factor, double start) {
  double shift = start;
  for (int i = 0; i < 40; ++i) {
    if (factor.factorise(problem.shifted(shift)) && is_safely_definite(problem, factor.pivots())) return shift;
    shift = shift == 0.0 ? -1e-6 : 10.0 * shift;
  }
  return shift;
}

// How many modes are missing below the last one wanted: in the gap below it and those equal to it, all eigenvalues are
// counted. Copies of the last one itself do not matter.
std::optional<Index> missing_below(const Problem& problem, OrderedFactor& factor, const Vector& eigenvalues,
                                   Index wanted) {
  const Index held = eigenvalues.size();
  const double scale = std::max(std::abs(eigenvalues[held - 1]), least_pivot);
  const double margin = distinct * scale;
  Index found = std::min(wanted, held) - 1;
  while (found > 0 && !(eigenvalues[found] - eigenvalues[found - 1] > margin)) --found;
  const double to = eigenvalues[found], from = found > 0 ? eigenvalues[found - 1] : to - 20.0 * margin;
  for (const double part : {0.5, 0.375, 0.7, 0.25, 0.85})
    if (const auto all = eigenvalues_below(problem, factor, from + part * (to - from))) return *all - found;
  return std::nullopt;
}

void finish(const SparseMatrix& stiffness, const SparseMatrix& mass, SymmetricModes& modes) {
  const Index k = modes.shapes.cols();
  const double floor = (16.0 + std::sqrt(static_cast<double>(mass.rows()))) * unit;
  const SparseMatrix size = stiffness.cwiseAbs(), weight = mass.cwiseAbs();
  modes.eigenvalues.resize(k);
  for (Index j = 0; j < k; ++j) {
    Vector shape = modes.shapes.col(j);
    Index largest = 0;
    const double most = shape.cwiseAbs().maxCoeff();
    // The first of those that share the largest value: round-off must not choose between them.
    while (largest + 1 < shape.size() && !(std::abs(shape[largest]) >= most * (1.0 - 1e-6))) ++largest;
    shape *= std::copysign(1.0, shape[largest]) / std::sqrt(shape.dot(mass * shape));
    const Vector stiff = stiffness * shape, heavy = mass * shape, magnitude = shape.cwiseAbs();
    const double energy = shape.dot(stiff);
    modes.eigenvalues[j] = std::abs(energy) <= floor * magnitude.dot(size * magnitude) ? 0.0 : energy;
    const Vector terms = size * magnitude + std::abs(energy) * (weight * magnitude);
    const double scale = terms.maxCoeff();
    if (scale > 0.0)
      modes.residual = std::max(modes.residual, (stiff - modes.eigenvalues[j] * heavy).cwiseAbs().maxCoeff() / scale);
    modes.shapes.col(j) = shape;
  }
  // Quotients of nearly equal modes may come out of order.
  std::vector<Index> order(static_cast<std::size_t>(k));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return modes.eigenvalues[a] < modes.eigenvalues[b]; });
  const Vector eigenvalues = modes.eigenvalues;
  const Matrix shapes = modes.shapes;
  for (Index j = 0; j < k; ++j) {
    modes.eigenvalues[j] = eigenvalues[order[static_cast<std::size_t>(j)]];
    modes.shapes.col(j) = shapes.col(order[static_cast<std::size_t>(j)]);
  }
}

SymmetricModes by_shift_invert(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count) {
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
  finish(stiffness, mass, modes);
  const Index kept = std::min(count, modes.shapes.cols());
  modes.shapes.conservativeResize(n, kept);
  modes.eigenvalues.conservativeResize(kept);
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

SymmetricModes all_modes(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver{Matrix(stiffness), Matrix(mass)};
  SymmetricModes modes;
  if (solver.info() != Eigen::Success) {
    modes.has_converged = false;
    modes.eigenvalues = Vector(0);
    modes.shapes = Matrix(mass.rows(), 0);
    return modes;
  }
  modes.shapes = solver.eigenvectors();
  finish(stiffness, mass, modes);
  return modes;
}

SymmetricModes lowest_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count) {
  if (!is_dense_eigenproblem(mass.rows(), count)) return by_shift_invert(stiffness, mass, count);
  SymmetricModes modes = all_modes(stiffness, mass);
  const Index kept = std::min(count, modes.shapes.cols());
  modes.eigenvalues.conservativeResize(kept);
  modes.shapes.conservativeResize(mass.rows(), kept);
  return modes;
}

}  // namespace rubato::numerics
