#include <rubato/integrate/steady/dynamic_stiffness.hpp>

#include <rubato/numerics/complex_ldlt.hpp>

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include <cmath>
#include <limits>
#include <optional>

namespace rubato::integrate {
namespace {

using numerics::SparseComplexMatrix;

constexpr double unit = std::numeric_limits<double>::epsilon();
// Dense below this size: the substitutions of a dense factor beat the indirections of a sparse one.
constexpr Index dense_size = 40;
constexpr double dense_share = 0.25;         // of entries that are not zero: modal damping makes C full
constexpr double good_residual = 64 * unit;  // componentwise; LU with pivoting reaches a few units
constexpr int most_refinements = 3;

}  // namespace

struct DynamicStiffness::Workspace {
  Workspace(const system::LocallyNonlinear& system, const StuckSliders& stuck) : assembled(system, stuck) {
    assembled.assemble_sizes(terms);
    const auto n = static_cast<double>(assembled.size());
    is_dense = assembled.size() <= dense_size || static_cast<double>(terms.nonZeros()) > dense_share * n * n;
    if (!is_dense) ldlt.analyse(assembled.pattern());
  }

  void fill(double shift) {
    assembled.assemble(omega, 1.0);
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

  AssembledStiffness assembled;
  const SparseComplexMatrix& matrix = assembled.matrix();
  SparseMatrix terms;
  double omega = 0.0;
  bool is_dense = true;
  long pivoted = 0;
  Eigen::PartialPivLU<Eigen::MatrixXcd> dense_lu;
  numerics::ComplexLdlt ldlt;
  std::optional<Eigen::SparseLU<SparseComplexMatrix>> lu;
  Vector size;
  ComplexVector residual, correction, trial;
};

DynamicStiffness::DynamicStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck)
    : work_(std::make_unique<Workspace>(system, stuck)) {}
DynamicStiffness::~DynamicStiffness() = default;
DynamicStiffness::DynamicStiffness(DynamicStiffness&&) noexcept = default;
DynamicStiffness& DynamicStiffness::operator=(DynamicStiffness&&) noexcept = default;

Index DynamicStiffness::size() const { return work_->matrix.rows(); }
double DynamicStiffness::fill() const {
  if (work_->is_dense) return static_cast<double>(size());
  return static_cast<double>(work_->ldlt.factor_entries()) / static_cast<double>(size());
}
long DynamicStiffness::pivoted() const { return work_->pivoted; }

void DynamicStiffness::factorise(double angular_frequency) {
  Workspace& w = *work_;
  w.omega = angular_frequency;
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
  return solution;
}

}  // namespace rubato::integrate
