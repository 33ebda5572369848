#include <rubato/core/complex.hpp>
#include <rubato/numerics/complex_ldlt.hpp>
#include <rubato/numerics/eigen_damped.hpp>
#include <rubato/numerics/eigen_quadratic.hpp>
#include <rubato/numerics/scaled_residual.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rubato::numerics {
namespace {

constexpr double unit = std::numeric_limits<double>::epsilon();
constexpr Index largest_full = 400;  // coupled modes solved together: seconds
constexpr double equal = 1e-9;       // relative distance of eigenvalues that count as equal
constexpr double visible = 1e-9;     // change of a shape by coupling that is worth a complex mode
constexpr double noise = 1e-13;      // of phi_i^T C phi_j, relative to the sizes of its terms
constexpr int most_iterations = 12;
constexpr double settled = 1e-13;    // relative change of s
constexpr double same = 1e-8;        // relative distance of eigenvalues that may be one
constexpr double accurate = 1e-8;    // defect beyond which a mode is iterated on the full matrices
constexpr double acceptable = 1e-4;  // defect of a mode that may be returned

struct Structure {
  const SparseMatrix &stiffness, &damping, &mass;

  // s^2 M + s C + K on x
  ScaledResidual residual(Complex s, const ComplexVector& x) const {
    const ComplexVector left = stiffness * x + s * (damping * x) + s * s * (mass * x);
    const Vector size =
        stiffness.diagonal().cwiseAbs() + std::abs(s) * damping.diagonal().cwiseAbs() + std::norm(s) * mass.diagonal();
    return {size, left, x};
  }
  // What the terms of x^H (s^2 M + s C + K) x are made of.
  double energy(Complex s, const ComplexVector& x) const {
    const ComplexVector k = stiffness * x, c = damping * x, m = mass * x;
    return std::abs(x.dot(k)) + std::abs(s) * std::abs(x.dot(c)) + std::norm(s) * std::abs(x.dot(m));
  }
  double defect(const DampedMode& mode) const {
    return residual(mode.eigenvalue, mode.shape).of_energy(energy(mode.eigenvalue, mode.shape));
  }
};

void normalise(const SparseMatrix& mass, ComplexVector& x) {
  const double most = x.cwiseAbs().maxCoeff();
  Index largest = 0;
  while (largest + 1 < x.size() && !(std::abs(x[largest]) >= most * (1.0 - 1e-6))) ++largest;
  const ComplexVector heavy = mass * x;
  x *= std::conj(x[largest]) / std::abs(x[largest]) / std::sqrt(x.dot(heavy).real());
  x[largest] = std::abs(x[largest]);
}

// Turns modes of equal frequency so that C does not couple them.
void separate_equal_modes(const Structure& structure, SymmetricModes& undamped, Matrix& damping) {
  const Index k = undamped.eigenvalues.size();
  for (Index from = 0, to; from < k; from = to) {
    const double value = undamped.eigenvalues[from];
    for (to = from + 1; to < k && undamped.eigenvalues[to] - value <= equal * std::abs(value);) ++to;
    const Index size = to - from;
    if (size == 1) continue;
    const Matrix block = damping.block(from, from, size, size);
    const double coupling = (block - Matrix(block.diagonal().asDiagonal())).cwiseAbs().maxCoeff();
    if (coupling <= noise * block.cwiseAbs().maxCoeff()) continue;  // as they are
    const Eigen::SelfAdjointEigenSolver<Matrix> turn(0.5 * (block + block.transpose()));
    undamped.shapes.middleCols(from, size) = (undamped.shapes.middleCols(from, size) * turn.eigenvectors()).eval();
  }
  damping = undamped.shapes.transpose() * (structure.damping * undamped.shapes);
}

// Groups of modes that C couples, each sorted.
std::vector<std::vector<Index>> coupled_groups(const Structure& structure, const SymmetricModes& undamped,
                                               const Matrix& damping) {
  const Index k = undamped.eigenvalues.size();
  const Matrix magnitude = undamped.shapes.cwiseAbs();
  const Vector size = (magnitude.transpose() * (structure.damping.cwiseAbs() * magnitude)).diagonal();
  std::vector<Index> group(static_cast<std::size_t>(k));
  std::iota(group.begin(), group.end(), Index{0});
  const auto root = [&](Index i) {
    while (group[static_cast<std::size_t>(i)] != i) i = group[static_cast<std::size_t>(i)];
    return i;
  };
  for (Index i = 0; i < k; ++i)
    for (Index j = i + 1; j < k; ++j) {
      const double coupling = std::abs(damping(i, j));
      const double highest = std::sqrt(std::max(std::abs(undamped.eigenvalues[i]), std::abs(undamped.eigenvalues[j])));
      if (coupling <= noise * std::sqrt(size[i] * size[j])) continue;
      if (coupling * highest <= visible * std::abs(undamped.eigenvalues[i] - undamped.eigenvalues[j])) continue;
      const Index low = std::min(root(i), root(j)), high = std::max(root(i), root(j));
      group[static_cast<std::size_t>(high)] = low;
    }
  std::vector<std::vector<Index>> members(static_cast<std::size_t>(k));
  for (Index i = 0; i < k; ++i) members[static_cast<std::size_t>(root(i))].push_back(i);
  std::erase_if(members, [](const auto& list) { return list.empty(); });
  return members;
}

DampedMode real_mode(double square, double damping, const Vector& shape) {
  DampedMode mode;
  const double omega = std::sqrt(std::abs(square));
  mode.angular_frequency = omega;
  mode.shape = shape.cast<Complex>();
  const double half = 0.5 * damping, inside = half * half - square;
  if (inside < 0.0) {
    mode.eigenvalue = Complex(-half, std::sqrt(-inside));
  } else {
    // Two real roots, without cancellation: the slower, or the one that grows.
    const double sum = half + std::copysign(std::sqrt(inside), half);
    const double far = -sum, near = sum != 0.0 ? -square / sum : 0.0;
    mode.eigenvalue = square > 0.0 ? near : std::max(far, near);
  }
  if (square > 0.0)
    mode.damping_ratio = half / omega;
  else if (square < 0.0)
    mode.damping_ratio = -1.0;
  return mode;
}

DampedMode complex_mode(Complex s, ComplexVector shape, const SparseMatrix& mass) {
  DampedMode mode;
  mode.eigenvalue = s;
  mode.angular_frequency = std::abs(s);
  mode.damping_ratio = s == 0.0 ? 0.0 : -s.real() / std::abs(s);
  normalise(mass, shape);
  mode.shape = std::move(shape);
  mode.is_complex = true;
  return mode;
}

// The root of x^T (s^2 M + s C + K) x = 0 next to s.
Complex quotient(const Structure& structure, const ComplexVector& x, Complex s) {
  const ComplexVector mx = structure.mass * x, cx = structure.damping * x, kx = structure.stiffness * x;
  const Complex m = x.transpose() * mx, c = x.transpose() * cx, k = x.transpose() * kx;
  const Complex root = std::sqrt(c * c - 4.0 * m * k);
  const Complex sum = std::abs(c + root) >= std::abs(c - root) ? c + root : c - root;
  const Complex large = -sum / (2.0 * m), small = sum == 0.0 ? Complex(0.0) : -2.0 * k / sum;
  return std::abs(large - s) < std::abs(small - s) ? large : small;
}

// The round-off of that root.
double quotient_error(const Structure& structure, const ComplexVector& x, Complex s) {
  const Vector size = x.cwiseAbs();
  const double terms = size.dot(structure.stiffness.cwiseAbs() * size) +
                       std::abs(s) * size.dot(structure.damping.cwiseAbs() * size) +
                       std::norm(s) * size.dot(structure.mass.cwiseAbs() * size);
  const ComplexVector slope = 2.0 * s * (structure.mass * x) + structure.damping * x;
  const Complex derivative = x.transpose() * slope;
  return 16.0 * unit * terms / std::abs(derivative);
}

/// A rigid motion that dampers brake has the root 0 beside -c/m: what is found of it is round-off, and set to 0.
void take_root_at_zero(const Structure& structure, DampedMode& mode) {
  if (!(std::abs(mode.eigenvalue) <= quotient_error(structure, mode.shape, mode.eigenvalue))) return;
  mode.eigenvalue = 0.0;
  mode.angular_frequency = mode.damping_ratio = 0.0;
}

/// Inverse iteration on the full matrices, whose pattern is analysed once.
class Refinement {
 public:
  explicit Refinement(const Structure& structure) : structure_(structure) {
    factor_.analyse(
        SparseMatrix(structure.stiffness.cwiseAbs() + structure.damping.cwiseAbs() + structure.mass.cwiseAbs()));
  }

  /// Returns whether the eigenvalue has come to stand.
  bool operator()(DampedMode& mode) {
    const SparseMatrix &k = structure_.stiffness, &c = structure_.damping, &m = structure_.mass;
    Complex s = mode.eigenvalue;
    ComplexVector x = mode.shape;
    bool stands = false;
    for (int i = 0; i < most_iterations && !stands; ++i) {
      const SparseComplexMatrix matrix = k.cast<Complex>() + s * c.cast<Complex>() + s * s * m.cast<Complex>();
      const Vector scale =
          k.diagonal().cwiseAbs() + std::abs(s) * c.diagonal().cwiseAbs() + std::norm(s) * m.diagonal().cwiseAbs();
      factor_.factorise(matrix, scale);
      ComplexVector y = 2.0 * s * (m * x) + c * x;
      factor_.solve(y);
      if (!y.allFinite()) return false;
      x = y / y.cwiseAbs().maxCoeff();
      const Complex next = quotient(structure_, x, s);
      stands = std::abs(next - s) <= std::max(settled * std::abs(s), quotient_error(structure_, x, next));
      s = next;
    }
    if (!std::isfinite(std::abs(s))) return false;
    mode = complex_mode(s, std::move(x), m);
    return stands;
  }

 private:
  const Structure& structure_;
  ComplexLdlt factor_;
};

// Whether C leads out of the span of the shapes, by more than round-off: each against its own stiffness, so that a soft
// dashpot counts beside one of a stiff part.
bool leads_out(const Structure& structure, const SymmetricModes& undamped, const Matrix& damping) {
  const Matrix force = structure.damping * undamped.shapes;
  const Matrix outside = force - structure.mass * (undamped.shapes * damping);
  const Matrix terms = structure.damping.cwiseAbs() * undamped.shapes.cwiseAbs();
  const Vector stiff = structure.stiffness.diagonal().cwiseAbs(), heavy = structure.mass.diagonal();
  for (Index j = 0; j < outside.cols(); ++j) {
    const Vector weight =
        (stiff + std::max(std::abs(undamped.eigenvalues[j]), undamped.round_off[j]) * heavy).cwiseInverse();
    const double left = weight.dot(outside.col(j).cwiseAbs2()), all = weight.dot(terms.col(j).cwiseAbs2());
    // Shapes of an iteration are known to about the root of its tolerance in the worst gaps.
    if (std::sqrt(left) > 1e-8 * std::sqrt(all)) return true;
  }
  return false;
}

void sort_and_cut(std::vector<DampedMode>& modes, Index count) {
  std::stable_sort(modes.begin(), modes.end(),
                   [](const DampedMode& a, const DampedMode& b) { return a.angular_frequency < b.angular_frequency; });
  if (static_cast<Index>(modes.size()) > count) modes.resize(static_cast<std::size_t>(count));
}

}  // namespace

DampedModes lowest_damped_modes(const SparseMatrix& stiffness, const SparseMatrix& damping, const SparseMatrix& mass,
                                Index count, const SparseMatrix* terms) {
  const Structure structure{stiffness, damping, mass};
  const Index n = mass.rows();
  DampedModes result;
  // Damped modes come in another order than undamped ones: some more of them take part.
  const bool is_full = n <= largest_full;
  const Index basis = is_full ? n : std::min(n, 2 * count + 10);
  SymmetricModes undamped = is_full || is_dense_eigenproblem(n, basis) ? all_modes(stiffness, mass, terms)
                                                                       : lowest_modes(stiffness, mass, basis, terms);
  if (!is_full && undamped.eigenvalues.size() > std::max(basis, largest_full)) {
    undamped.eigenvalues.conservativeResize(std::max(basis, largest_full));
    undamped.round_off.conservativeResize(undamped.eigenvalues.size());
    undamped.shapes.conservativeResize(n, undamped.eigenvalues.size());
  }
  result.missing = undamped.missing;
  result.has_converged = undamped.has_converged;
  result.defect = undamped.defect;
  if (undamped.eigenvalues.size() == 0 || !std::isfinite(undamped.defect)) {
    result.residual = result.defect = std::numeric_limits<double>::infinity();
    result.has_converged = false;
    return result;
  }

  Matrix modal = undamped.shapes.transpose() * (damping * undamped.shapes);
  separate_equal_modes(structure, undamped, modal);
  for (const auto& group : coupled_groups(structure, undamped, modal)) {
    if (group.size() == 1) {
      const Index i = group[0];
      DampedMode mode = real_mode(undamped.eigenvalues[i], modal(i, i), undamped.shapes.col(i));
      mode.round_off = undamped.round_off[i];
      normalise(mass, mode.shape);
      result.modes.push_back(std::move(mode));
      continue;
    }
    const auto r = static_cast<Index>(group.size());
    Vector squares(r);
    Matrix coupling(r, r), shapes(n, r);
    for (Index a = 0; a < r; ++a) {
      const Index i = group[static_cast<std::size_t>(a)];
      squares[a] = undamped.eigenvalues[i];
      shapes.col(a) = undamped.shapes.col(i);
      for (Index b = 0; b < r; ++b) coupling(a, b) = modal(i, group[static_cast<std::size_t>(b)]);
    }
    const std::vector<QuadraticMode> coupled = quadratic_modes(squares, coupling);
    result.has_converged = result.has_converged && !coupled.empty();
    for (const QuadraticMode& mode : coupled) {
      result.modes.push_back(complex_mode(mode.eigenvalue, shapes * mode.shape, mass));
      take_root_at_zero(structure, result.modes.back());
    }
  }
  sort_and_cut(result.modes, count);
  const bool is_complete = undamped.eigenvalues.size() == n;
  const bool leaves = !is_complete && leads_out(structure, undamped, modal);
  const auto is_poor = [&](const DampedMode& mode) {
    return mode.is_complex && mode.eigenvalue != 0.0 && !(structure.defect(mode) <= accurate);
  };
  if (leaves || std::any_of(result.modes.begin(), result.modes.end(), is_poor)) {
    result.is_refined = true;
    Refinement refine(structure);
    for (DampedMode& mode : result.modes)
      if (leaves || is_poor(mode)) result.has_converged = refine(mode) && result.has_converged;
    sort_and_cut(result.modes, count);
    for (std::size_t i = 0; i + 1 < result.modes.size(); ++i) {
      const DampedMode &a = result.modes[i], &b = result.modes[i + 1];
      if (std::abs(a.eigenvalue - b.eigenvalue) > same * std::abs(a.eigenvalue)) continue;
      // Two that came to one motion: the other one was lost.
      const ComplexVector heavy = mass * b.shape;
      if (std::abs(a.shape.dot(heavy)) > 1.0 - 1e-6) result.has_converged = false;
    }
  }
  for (DampedMode& mode : result.modes) {
    if (!mode.is_complex && !is_complete) continue;
    result.residual = std::max(result.residual, structure.residual(mode.eigenvalue, mode.shape).backward());
    if (!mode.is_complex) continue;
    const Vector size = mode.shape.cwiseAbs();
    const double all = terms ? size.dot(*terms * size) : size.dot(stiffness.cwiseAbs() * size);
    const double energy = structure.energy(mode.eigenvalue, mode.shape);
    const bool is_at_zero = mode.eigenvalue == 0.0;
    mode.round_off =
        energy > 0.0 && !is_at_zero ? 2.0 * unit * all / energy * std::norm(mode.eigenvalue) : 2.0 * unit * all;
    if (is_at_zero) continue;
    const double defect = structure.defect(mode);
    result.defect = std::max(result.defect, defect);
    if (!(defect <= acceptable)) result.has_converged = false;
  }
  result.residual = std::max(result.residual, undamped.residual);
  return result;
}

}  // namespace rubato::numerics
