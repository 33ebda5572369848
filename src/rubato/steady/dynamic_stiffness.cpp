#include <rubato/steady/dynamic_stiffness.hpp>

#include <rubato/numerics/complex_ldlt.hpp>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <Eigen/SparseLU>

#include <cmath>
#include <limits>
#include <optional>

namespace rubato::steady {
namespace {

using numerics::SparseComplexMatrix;

constexpr double unit = std::numeric_limits<double>::epsilon();
// Dense below this size: the substitutions of a dense factor beat the indirections of a sparse one.
constexpr Index dense_size = 40;
constexpr double dense_share = 0.25;         // of entries that are not zero: modal damping makes C full
constexpr double good_residual = 64 * unit;  // componentwise; LU with pivoting reaches a few units
constexpr int most_refinements = 3;
constexpr Index first_motions = 4;       // sought at once
constexpr int inverse_iterations = 3;    // each leaves 1e-10 or so of what is not free
constexpr double free_residual = 1e-11;  // of a free motion, in the units of the diagonal
constexpr double same_motion = 1e-6;     // part beside those known that makes a motion another one

// Numbers between 1 and 2 without a pattern (multiples of irrational numbers), the same everywhere.
void fill_evenly(ComplexMatrix& block) {
  for (Index c = 0; c < block.cols(); ++c) {
    const double step = std::sqrt(static_cast<double>(2 + 3 * c + c * c));
    for (Index i = 0; i < block.rows(); ++i)
      block(i, c) = 1.0 + std::fmod(0.6180339887498949 * static_cast<double>(i + 1) * (1.0 + step), 1.0);
  }
}

}  // namespace

struct DynamicStiffness::Workspace {
  Workspace(const system::LocallyNonlinear& system, const SparseMatrix& springs, std::span<const int> last)
      : assembled(system, springs) {
    assembled.assemble_sizes(terms);
    const auto n = static_cast<double>(assembled.size());
    is_dense = assembled.size() <= dense_size || static_cast<double>(terms.nonZeros()) > dense_share * n * n;
    if (!is_dense) ldlt.analyse(assembled.pattern(), last);
  }

  void fill(double shift) {
    assembled.assemble(omega, held);
    assembled.assemble_sizes(terms);
    if (shift == 0.0) return;
    for (Index i = 0; i < matrix.rows(); ++i)
      assembled.matrix().coeffRef(i, i) += Complex(0.0, shift * assembled.scale()[i]);
  }

  // False where the factor is that of a singular matrix.
  bool factorise_with_pivoting() {
    if (!is_dense) {
      lu.emplace();
      lu->isSymmetric(true);
      lu->compute(matrix);
      ++pivoted;
      return lu->info() == Eigen::Success;
    }
    dense_lu.compute(Eigen::MatrixXcd(matrix));
    const auto pivots = dense_lu.matrixLU().diagonal().cwiseAbs();
    return pivots.minCoeff() > 0.0 && std::isfinite(pivots.sum());
  }

  void factorise_safely() {
    // A shift of one unit of round-off turns zero pivots into small ones.
    for (double shift = unit; !factorise_with_pivoting() && shift < 1e-12; shift *= 4.0) fill(shift);
  }

  // S with one unit of round-off on its diagonal, for rows in which nothing resists at all.
  void factorise_shifted(const Vector& units) {
    for (Index i = 0; i < matrix.rows(); ++i)
      assembled.matrix().coeffRef(i, i) += Complex(0.0, unit * units[i] * units[i]);
    factorise_with_pivoting();
    fill(0.0);
  }

  void substitute(ComplexVector& x) const {
    if (is_dense)
      x = dense_lu.solve(x);
    else if (lu)
      x = lu->solve(x);
    else
      ldlt.solve(x);
  }

  // One refinement after another while the residual falls; returns the residual reached.
  double solve(const ComplexVector& force, ComplexVector& x) {
    x = force;
    substitute(x);
    double reached = backward_error(force, x);
    for (int i = 0; i < most_refinements && reached > good_residual; ++i) {
      correction = residual;
      substitute(correction);
      trial = x + correction;
      const double next = backward_error(force, trial);
      if (!(next < reached)) break;
      x = trial;
      reached = next;
    }
    return reached;
  }

  double backward_error(const ComplexVector& force, const ComplexVector& x) {
    residual = force - matrix * x;
    size = terms * x.cwiseAbs() + force.cwiseAbs();
    double worst = 0.0;
    for (Index i = 0; i < size.size(); ++i)
      if (const double r = std::abs(residual[i]); r != 0.0) worst = std::max(worst, r / size[i]);
    return x.allFinite() ? worst : std::numeric_limits<double>::infinity();
  }

  // Whether omega x^H C x is more than round-off of its own terms, and than one unit of round-off of all: where stiff
  // parts hide the digits of K - omega^2 M, dampers still bound the motion.
  bool is_damped(const ComplexVector& x) const {
    const SparseMatrix& damping = assembled.damping();
    const Vector moduli = x.cwiseAbs();
    const double least = std::max(round_off_of_terms * omega * moduli.dot(damping.cwiseAbs() * moduli),
                                  unit * moduli.dot(terms * moduli));
    return omega * std::abs(x.dot(damping * x)) > least;
  }

  // Real free motions that span the directions given (in units of the diagonal), each judged by itself.
  Matrix real_motions(const ComplexMatrix& directions, const Vector& units) const {
    Matrix motions(directions.rows(), 0);
    const Vector errors = shape_error * units.cwiseInverse();
    const double of_errors = errors.dot(terms * errors);
    for (Index c = 0; c < 2 * directions.cols(); ++c) {
      Vector motion = c % 2 == 0 ? Vector(directions.col(c / 2).real()) : Vector(directions.col(c / 2).imag());
      for (int pass = 0; pass < 2; ++pass) motion -= motions * (motions.transpose() * motion);
      if (!(motion.norm() > same_motion)) continue;
      motion.normalize();
      const ComplexVector x = motion.cwiseQuotient(units).cast<Complex>();
      const double sum = std::abs(x.dot(matrix * x).real()), sizes = x.cwiseAbs().dot(terms * x.cwiseAbs());
      if (!(sum <= round_off_of_terms * sizes + of_errors) || is_damped(x)) continue;
      motions.conservativeResize(Eigen::NoChange, motions.cols() + 1);
      motions.col(motions.cols() - 1) = motion;
    }
    return units.cwiseInverse().asDiagonal() * motions;
  }

  AssembledStiffness assembled;
  const SparseComplexMatrix& matrix = assembled.matrix();
  SparseMatrix terms;
  double omega = 0.0, held = 1.0;
  bool is_dense = true;
  long pivoted = 0;
  Eigen::PartialPivLU<Eigen::MatrixXcd> dense_lu;
  numerics::ComplexLdlt ldlt;
  std::optional<Eigen::SparseLU<SparseComplexMatrix>> lu;
  Vector size;
  ComplexVector residual, correction, trial;
};

DynamicStiffness::DynamicStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck)
    : DynamicStiffness(system, springs_of(system, stuck)) {}
DynamicStiffness::DynamicStiffness(const system::LocallyNonlinear& system, const SparseMatrix& springs,
                                   std::span<const int> last)
    : work_(std::make_unique<Workspace>(system, springs, last)) {}
DynamicStiffness::~DynamicStiffness() = default;
DynamicStiffness::DynamicStiffness(DynamicStiffness&&) noexcept = default;
DynamicStiffness& DynamicStiffness::operator=(DynamicStiffness&&) noexcept = default;

Index DynamicStiffness::size() const { return work_->matrix.rows(); }
double DynamicStiffness::fill() const {
  if (work_->is_dense) return static_cast<double>(size());
  return static_cast<double>(work_->ldlt.factor_entries()) / static_cast<double>(size());
}
long DynamicStiffness::pivoted() const { return work_->pivoted; }

void DynamicStiffness::factorise(double angular_frequency, double held) {
  Workspace& w = *work_;
  w.omega = angular_frequency;
  w.held = held;
  w.fill(0.0);
  w.lu.reset();
  if (w.is_dense)
    w.factorise_safely();
  else
    w.ldlt.factorise(w.matrix, w.assembled.scale());
}

StiffnessSolution DynamicStiffness::solve(const ComplexVector& force, ComplexVector& x) {
  Workspace& w = *work_;
  StiffnessSolution solution;
  solution.residual = w.solve(force, x);
  if (!w.is_dense && !w.lu && !(solution.residual <= good_residual)) {
    w.factorise_safely();
    solution.residual = w.solve(force, x);
  }
  // Round-off with the signs of x: what a mode that x is made of answers to most.
  w.size = w.terms * x.cwiseAbs();
  solution.uncertainty.resize(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const double modulus = std::abs(x[i]);
    solution.uncertainty[i] = modulus > 0.0 ? unit * w.size[i] * x[i] / modulus : Complex(unit * w.size[i]);
  }
  w.substitute(solution.uncertainty);
  solution.is_damped = w.is_damped(x);
  return solution;
}

bool DynamicStiffness::condense(const SparseMatrix& columns, ComplexMatrix& out) {
  Workspace& w = *work_;
  if (w.is_dense || w.lu) return false;
  w.ldlt.condense(columns, out);
  return true;
}

Matrix DynamicStiffness::free_motions() {
  Workspace& w = *work_;
  const Index n = size();
  const Vector units = w.assembled.scale().unaryExpr([](double s) { return s > 0.0 ? std::sqrt(s) : 1.0; });
  const auto largest = [&](const ComplexVector& x) { return units.cwiseProduct(x.cwiseAbs()).maxCoeff(); };
  // A load with a part in every motion: where its answer is determined, none is free.
  ComplexMatrix block(n, std::min(first_motions, n));
  fill_evenly(block);
  ComplexVector answer;
  const StiffnessSolution solution = solve(units.asDiagonal() * block.col(0), answer);
  if (largest(solution.uncertainty) <= undetermined * largest(answer)) return Matrix(n, 0);
  if (!answer.allFinite()) w.factorise_shifted(units);

  for (;;) {
    for (int i = 0; i < inverse_iterations; ++i) {
      for (Index c = 0; c < block.cols(); ++c) {
        ComplexVector x = units.asDiagonal() * block.col(c);
        w.substitute(x);
        block.col(c) = units.asDiagonal() * x;
      }
      if (!block.allFinite()) return Matrix(n, 0);
      const Eigen::HouseholderQR<ComplexMatrix> basis(block);
      block = basis.householderQ() * ComplexMatrix::Identity(n, block.cols());
    }
    const ComplexMatrix left =
        units.cwiseInverse().asDiagonal() * (w.matrix * ComplexMatrix(units.cwiseInverse().asDiagonal() * block));
    const Eigen::JacobiSVD<ComplexMatrix> parts(left, Eigen::ComputeThinU | Eigen::ComputeFullV);
    const Index count = (parts.singularValues().array() <= free_residual).count();
    if (count == block.cols() && count < n) {
      block.resize(n, std::min(2 * count, n));
      fill_evenly(block);
      continue;
    }
    return w.real_motions(block * parts.matrixV().rightCols(count), units);
  }
}

}  // namespace rubato::steady
