#include <rubato/integrate/stability.hpp>

#include <rubato/integrate/stepper.hpp>
#include <rubato/numerics/eigen_quadratic.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double growth =
    1e-9;  // round-off of a double eigenvalue at 1 is its square root, 1e-8: stay below limits by less

system::LocallyNonlinear one_coordinate(double stiffness, double damping) {
  const auto entry = [](double value) {
    SparseMatrix matrix(1, 1);
    matrix.insert(0, 0) = value;
    return matrix;
  };
  system::LocallyNonlinear::Parts parts;
  parts.mass = entry(1.0);
  parts.damping = entry(damping);
  parts.stiffness = entry(stiffness);
  parts.coordinates = {"q"};
  return system::LocallyNonlinear(std::move(parts));
}

// Eigenvalues of the step of length h on m = 1, c, k; scaled states (q, h v, h^2 a).
Eigen::VectorXcd step_eigenvalues(const Method& method, double stiffness, double damping, double h) {
  const system::LocallyNonlinear system = one_coordinate(stiffness, damping);
  const auto stepper = make_stepper(method, system);
  const bool carries_acceleration =
      std::holds_alternative<GeneralizedAlpha>(method.formula) || std::holds_alternative<WilsonTheta>(method.formula);
  const Index size = carries_acceleration ? 3 : 2;
  Matrix step(size, size);
  for (Index column = 0; column < size; ++column) {
    system::State from = system.start(), to = from;
    from.q[0] = column == 0 ? 1.0 : 0.0;
    from.v[0] = column == 1 ? 1.0 / h : 0.0;
    from.auxiliary_acceleration[0] = column == 2 ? 1.0 / (h * h) : 0.0;
    const StepReport report = stepper->attempt(from, h, h, to);
    if (report.outcome != StepOutcome::accepted) return Eigen::VectorXcd::Constant(size, infinity);
    step(0, column) = to.q[0];
    step(1, column) = h * to.v[0];
    if (size == 3) step(2, column) = h * h * to.auxiliary_acceleration[0];
  }
  return Eigen::EigenSolver<Matrix>(step, false).eigenvalues();
}

double spectral_radius(const Method& method, double stiffness, double damping, double h) {
  return step_eigenvalues(method, stiffness, damping, h).cwiseAbs().maxCoeff();
}

// The smallest h on a fine ladder at which the mode grows, refined by bisection; infinity if there is none.
double first_growth(const Method& method, double stiffness, double damping) {
  const double scale = 1.0 / std::max(std::sqrt(std::max(stiffness, 0.0)), damping);
  const auto grows = [&](double h) { return spectral_radius(method, stiffness, damping, h) > 1.0 + growth; };
  double stable = 0.0;
  for (double x = 0.02; x < 2000.0; x += std::max(0.02, 0.02 * x)) {
    const double h = x * scale;
    if (!grows(h)) {
      stable = h;
      continue;
    }
    double low = stable, high = h;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (grows(middle) ? high : low) = middle;
    }
    return low;
  }
  return infinity;
}

// |R(i y)|^2 - 1 as a polynomial in y^2; its first coefficient that is not zero decides near the origin.
double imaginary_limit(const numerics::ButcherTableau& tableau) {
  // R(z) = sum_k r_k z^k with r_0 = 1, r_k = b^T A^(k-1) 1.
  const auto stages = static_cast<std::size_t>(tableau.stages);
  std::vector<double> power(stages, 1.0), r{1.0};
  for (std::size_t k = 0; k < stages; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < stages; ++i) sum += tableau.b[i] * power[i];
    r.push_back(sum);
    std::vector<double> next(stages, 0.0);
    for (std::size_t i = 0; i < stages; ++i)
      for (std::size_t j = 0; j < i; ++j) next[i] += tableau.a[i][j] * power[j];
    power = next;
  }
  const auto excess = [&](double y) {
    std::complex<double> value = 0.0;
    for (std::size_t k = r.size(); k-- > 0;) value = value * std::complex<double>(0.0, y) + r[k];
    return std::norm(value) - 1.0;
  };
  std::vector<double> even(r.size(), 0.0);  // coefficient of y^(2k)
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = 0; j < r.size(); ++j) {
      if ((i + j) % 2 != 0) continue;
      const std::size_t k = (i + j) / 2;
      const int sign = ((i + 3 * j) / 2) % 2 == 0 ? 1 : -1;  // i^i * conj(i)^j
      if (k < even.size()) even[k] += sign * r[i] * r[j];
    }
  even[0] -= 1.0;
  const auto lead = std::find_if(even.begin(), even.end(), [](double c) { return std::abs(c) > 1e-13; });
  if (lead == even.end()) return infinity;
  if (*lead > 0.0) return 0.0;
  double low = 1e-2, high = low;
  while (excess(high) <= 0.0 && high < 100.0) high += 0.01;
  low = high - 0.01;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? high : low) = middle;
  }
  return low;
}

struct Mode {
  double stiffness, damping;  // per unit of modal mass
  Vector shape;
  double least_damping = 0.0;  // what lies below is round-off
};

// The eigenvalues of the structure of first order, each as the mode of one coordinate that has it: of a complex pair s
// both, of a real one s and 0. Nothing where damping couples no modes, or too many of them to solve for all.
std::vector<Mode> coupled_modes(const std::vector<Mode>& modes, const SparseMatrix& damping) {
  constexpr std::size_t most = 200;  // half a second
  if (modes.size() < 2 || modes.size() > most) return {};
  const auto n = static_cast<Index>(modes.size());
  Vector squares(n);
  Matrix shapes(modes[0].shape.size(), n);
  for (Index i = 0; i < n; ++i) {
    const Mode& mode = modes[static_cast<std::size_t>(i)];
    squares[i] = mode.stiffness;
    shapes.col(i) = mode.shape;
  }
  const Matrix coupling = shapes.transpose() * (damping * shapes);
  const Vector own = coupling.diagonal();
  if ((coupling - Matrix(own.asDiagonal())).cwiseAbs().maxCoeff() <= 1e-9 * own.cwiseAbs().maxCoeff()) return {};
  std::vector<Mode> found;
  const double fastest = std::sqrt(squares.cwiseAbs().maxCoeff()) + own.cwiseAbs().maxCoeff();
  for (const numerics::QuadraticMode& mode : numerics::quadratic_modes(squares, coupling)) {
    const std::complex<double> s = mode.eigenvalue;
    const bool is_real = s.imag() == 0.0;
    found.push_back({is_real ? 0.0 : std::norm(s), (is_real ? -1.0 : -2.0) * s.real(), (shapes * mode.shape).cwiseAbs(),
                     1e-14 * fastest});
  }
  return found;
}

std::vector<Mode> modes_of(const system::LocallyNonlinear& system) {
  const SparseMatrix stuck = system.closed_stiffness(), damping = system.closed_damping();
  std::vector<Mode> modes;
  const auto add = [&](const Vector& shape) {  // phi^T M phi = 1
    modes.push_back({shape.dot(stuck * shape), shape.dot(damping * shape), shape});
  };
  constexpr Index all_modes = 1000;
  if (system.size() <= all_modes) {
    const numerics::SymmetricModes found = numerics::all_modes(stuck, system.mass());
    for (Index i = 0; i < found.shapes.cols(); ++i) add(found.shapes.col(i));
    if (found.shapes.cols() == system.size()) return modes;
    modes.clear();
  }
  // The highest mode by power iteration on M^-1 K from a vector that no symmetry leaves out; its Rayleigh quotient
  // comes from below, so one percent is added to the frequency.
  const Eigen::SimplicialLDLT<SparseMatrix> mass(system.mass());
  Vector x(system.size());
  for (Index i = 0; i < x.size(); ++i)
    x[i] = std::sin(1.0 + 1.7 * static_cast<double>(i) * static_cast<double>(i % 97));
  for (int i = 0; i < 300; ++i) {
    x = mass.solve(stuck * x);
    x /= std::sqrt(x.dot(system.mass() * x));
  }
  add(x);
  modes.back().stiffness *= 1.02;
  return modes;
}

}  // namespace

ModeResponse mode_response(const Method& method, double omega_h, double zeta) {
  const auto eigenvalues = step_eigenvalues(method, omega_h * omega_h, 2.0 * zeta * omega_h, 1.0);
  ModeResponse response;
  response.spectral_radius = eigenvalues.cwiseAbs().maxCoeff();
  // The physical pair is the complex one nearest to the exact eigenvalue.
  const std::complex<double> exact =
      std::exp(omega_h * std::complex<double>(-zeta, std::sqrt(std::max(0.0, 1.0 - zeta * zeta))));
  const std::complex<double>* nearest = nullptr;
  for (const auto& value : eigenvalues)
    if (value.imag() > 1e-12 && (!nearest || std::abs(value - exact) < std::abs(*nearest - exact))) nearest = &value;
  if (!nearest || zeta >= 1.0) return response;
  const double decay = -std::log(std::abs(*nearest)), turn = std::arg(*nearest);
  response.period_elongation = omega_h * std::sqrt(1.0 - zeta * zeta) / turn - 1.0;
  response.numerical_damping = decay / std::hypot(decay, turn) - zeta;
  return response;
}

double stability_limit(const Method& method) {
  if (std::holds_alternative<Exact>(method.formula) || std::holds_alternative<Exponential>(method.formula))
    return infinity;
  if (const auto* tableau = std::get_if<RungeKutta>(&method.formula)) return imaginary_limit(tableau->tableau);
  const auto* alpha = std::get_if<GeneralizedAlpha>(&method.formula);
  if (alpha && alpha->alpha_m == 0.0 && alpha->alpha_f == 0.0) {
    if (alpha->gamma < 0.5) return 0.0;
    if (2.0 * alpha->beta >= alpha->gamma) return infinity;
    return 1.0 / std::sqrt(0.5 * alpha->gamma - alpha->beta);
  }
  return first_growth(method, 1.0, 0.0);
}

double spectral_radius_at_infinity(const Method& method) {
  if (std::holds_alternative<Exact>(method.formula) || std::holds_alternative<Exponential>(method.formula)) return 1.0;
  if (!std::isinf(stability_limit(method))) return infinity;
  return spectral_radius(method, 1e16, 0.0, 1.0);
}

ModelStability stability_of(const Method& method, const system::LocallyNonlinear& system) {
  ModelStability found;
  found.step = infinity;
  if (std::isinf(stability_limit(method))) return found;
  std::vector<Mode> modes = modes_of(system);
  // Damping does not change the limit of Newmark's methods, and a step of Runge and Kutta treats each eigenvalue alone.
  if (std::holds_alternative<RungeKutta>(method.formula))
    if (auto coupled = coupled_modes(modes, system.closed_damping()); !coupled.empty()) modes = std::move(coupled);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Mode& mode = modes[i];
    const double omega = std::sqrt(std::max(mode.stiffness, 0.0));
    const double damping = mode.damping > std::max(1e-12 * omega, mode.least_damping) ? mode.damping : 0.0;
    double step = infinity;
    if (damping > 0.0)
      step = first_growth(method, std::max(mode.stiffness, 0.0), damping);
    else if (omega > 0.0)
      step = stability_limit(method) / omega;
    if (!(step < found.step)) continue;
    Index largest = 0;
    mode.shape.cwiseAbs().maxCoeff(&largest);
    const bool is_real = mode.stiffness == 0.0 && mode.least_damping > 0.0;
    found = {step, is_real ? damping : omega,
             is_real       ? 1.0
             : omega > 0.0 ? 0.5 * damping / omega
                           : 0.0,
             modes.size() == 1 ? system.size() : static_cast<Index>(i) + 1,
             system.coordinates().empty() ? std::to_string(largest + 1)
                                          : system.coordinates()[static_cast<std::size_t>(largest)]};
  }
  return found;
}

}  // namespace rubato::integrate
