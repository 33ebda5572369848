#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/marching/lane_map_parts.hpp>
#include <rubato/steady/marching/stepper_map.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

// The modal coordinates, and the step of a method in them, read off its own steps.
namespace rubato::steady {
namespace {

constexpr double couples = 1e-11;          // damping between modes, relative to the largest entry, that counts
constexpr double slowest_sweep = 0.3;      // contraction of a sweep of the slider forces beyond which it is not used
constexpr double nearly_singular = 1e-12;  // reciprocal condition of a resonance without damping

}  // namespace

LaneMap::LaneMap(const integrate::Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request)
    : method_(method),
      n_(system.size()),
      m_(system.slider_count()),
      width_(std::holds_alternative<integrate::Exponential>(method.formula) ? 2 : 3),
      system_(system) {
  const Matrix mass(system.mass());
  unit_mass_ = mass.trace() / static_cast<double>(n_);
  const numerics::SymmetricModes found = numerics::all_modes(system.stiffness(), system.mass());
  modes_ = std::sqrt(unit_mass_) * found.shapes;
  to_modes_ = modes_.transpose() * mass / unit_mass_;
  stiffness_ = found.eigenvalues.asDiagonal();
  damping_ = modes_.transpose() * Matrix(system.damping()) * modes_ / unit_mass_;
  Matrix between = damping_;
  between.diagonal().setZero();
  is_coupled_ = between.cwiseAbs().maxCoeff() > couples * damping_.cwiseAbs().maxCoeff();
  if (!is_coupled_) damping_ = Vector(damping_.diagonal()).asDiagonal();
  relative_.setZero(m_, n_);
  slider_stiffness_.resize(m_);
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    if (slider.first != ground) relative_.row(i) += modes_.row(slider.first);
    if (slider.second != ground) relative_.row(i) -= modes_.row(slider.second);
    slider_stiffness_[i] = slider.stiffness;
  }
  push_ = relative_.transpose() / unit_mass_;

  observation_.observed = static_cast<int>(request.observed.size());
  observation_.work_unit = unit_mass_;
  for (const auto& observed : request.observed)
    for (Index k = 0; k < n_; ++k) observation_.combination.push_back(observed.of(modes_.col(k)));
  for (Index k = 0; k < n_; ++k) {
    for (Index l = 0; l < n_; ++l) {
      observation_.stiffness.push_back(stiffness_(k, l));
      observation_.damping.push_back(damping_(k, l));
    }
    for (Index i = 0; i < m_; ++i) observation_.slider_push.push_back(push_(k, i));
  }
}

system::LocallyNonlinear LaneMap::coordinates_with(std::vector<system::LoadTerm> terms) const {
  system::LocallyNonlinear::Parts parts;
  parts.mass.resize(n_, n_);
  parts.mass.setIdentity();
  parts.damping = damping_.sparseView(0.0, 0.0);
  parts.stiffness = stiffness_.sparseView(0.0, 0.0);
  parts.loads = system::Loads(std::move(terms));
  return system::LocallyNonlinear(std::move(parts));
}

Vector LaneMap::scaled(const system::State& state) const {
  Vector y(n_ * width_);
  for (Index k = 0; k < n_; ++k) {
    y[k * width_] = state.q[k];
    y[k * width_ + 1] = state.v[k] / omega_;
    if (width_ == 3) y[k * width_ + 2] = state.auxiliary_acceleration[k] / (omega_ * omega_);
  }
  return y;
}

// E by unit states, in all modes at once where they do not know of each other.
void LaneMap::read_propagator(integrate::Stepper& stepper, double h, double quiet, PreparedLanes& result) const {
  const Index size = n_ * width_;
  const double units[] = {1.0, omega_, omega_ * omega_};
  system::State from, to;
  const auto step_from = [&](Index first, Index last, Index number) {
    from.t = quiet;
    from.q = from.v = from.auxiliary_acceleration = Vector::Zero(n_);
    Vector& part = number == 0 ? from.q : number == 1 ? from.v : from.auxiliary_acceleration;
    part.segment(first, last - first).setConstant(units[number]);
    from.slider_force.resize(0);
    to = from;
    result.is_sound =
        result.is_sound && stepper.attempt(from, h, quiet + h, to).outcome == integrate::StepOutcome::accepted;
    return scaled(to);
  };
  result.propagator.setZero(size, size);
  for (Index c = 0; c < width_; ++c) {
    if (is_coupled_) {
      for (Index k = 0; k < n_; ++k) result.propagator.col(k * width_ + c) = step_from(k, k + 1, c);
      continue;
    }
    const Vector y = step_from(0, n_, c);
    for (Index k = 0; k < n_; ++k)
      result.propagator.block(k * width_, k * width_ + c, width_, 1) = y.segment(k * width_, width_);
  }
}

// The periodic response of the method to cos(order omega t) on each coordinate: (exp(i order omega h) - E) Y = L, where
// Re(F exp(i phi) L) is what a load Re(F exp(i (phi + order omega s))) adds in a step.
bool LaneMap::read_response(int order, double h, const PreparedLanes& prepared, ComplexMatrix& response) const {
  const double frequency = order * omega_;
  const Index size = n_ * width_;
  ComplexMatrix added = ComplexMatrix::Zero(size, n_);
  for (Index k = 0; k < (is_coupled_ ? n_ : 1); ++k) {
    system::LoadTerm term;
    for (Index l = is_coupled_ ? k : 0; l < (is_coupled_ ? k + 1 : n_); ++l) {
      term.rows.push_back(l);
      term.weights.push_back(1.0);
    }
    term.law = model::HarmonicLaw{1.0, frequency, 0.0};
    const system::LocallyNonlinear loaded = coordinates_with({term});
    const auto stepper = integrate::make_stepper(method_, loaded);
    system::State from = loaded.start(), to = from;
    Vector parts[2] = {Vector::Zero(size), Vector::Zero(size)};
    for (int quadrature = 0; quadrature < (order == 0 ? 1 : 2); ++quadrature) {
      from.t = quadrature == 0 ? 0.0 : -0.5 * std::numbers::pi / frequency;
      if (stepper->attempt(from, h, from.t + h, to).outcome != integrate::StepOutcome::accepted) return false;
      parts[quadrature] = scaled(to);
    }
    for (Index row = 0; row < size; ++row) added(row, is_coupled_ ? k : row / width_) = {parts[0][row], parts[1][row]};
  }
  const std::complex<double> turn = std::polar(1.0, frequency * h);
  response.setZero(size, n_);
  const Index block = is_coupled_ ? size : width_;
  for (Index b = 0; b < size / block; ++b) {
    ComplexMatrix difference =
        -prepared.propagator.block(b * block, b * block, block, block).cast<std::complex<double>>();
    difference.diagonal().array() += turn;
    const Eigen::PartialPivLU<ComplexMatrix> factor(difference);
    if (!(factor.rcond() > nearly_singular)) return false;
    const Index first = is_coupled_ ? 0 : b, columns = is_coupled_ ? n_ : 1;
    response.block(b * block, first, block, columns) = factor.solve(added.block(b * block, first, block, columns));
  }
  return response.allFinite();
}

PreparedLanes LaneMap::prepare_step(int steps, const std::vector<int>& orders) const {
  PreparedLanes result;
  const double h = 2.0 * std::numbers::pi / (omega_ * steps);
  const Index size = n_ * width_;
  // A hat over two steps for each slider, one after the other; then quiet.
  std::vector<system::LoadTerm> terms;
  for (Index i = 0; i < m_; ++i) {
    system::LoadTerm term;
    const double start = static_cast<double>(2 * i) * h;
    term.law = model::TableLaw{{start, start + h, start + 2.0 * h}, {0.0, 1.0, 0.0}, model::TableLaw::Beyond::zero, ""};
    for (Index k = 0; k < n_; ++k) {
      term.rows.push_back(k);
      term.weights.push_back(-push_(k, i));
    }
    terms.push_back(std::move(term));
  }
  const system::LocallyNonlinear coordinates = coordinates_with(std::move(terms));
  const auto stepper = integrate::make_stepper(method_, coordinates);
  result.is_sound = true;
  read_propagator(*stepper, h, static_cast<double>(2 * m_ + 2) * h, result);
  Matrix start_force(size, m_);
  result.end_force.resize(size, m_);
  system::State from = coordinates.start(), to = from;
  for (Index i = 0; i < m_; ++i) {
    const double start = static_cast<double>(2 * i) * h;
    from.t = start;
    result.is_sound =
        result.is_sound && stepper->attempt(from, h, start + h, to).outcome == integrate::StepOutcome::accepted;
    result.end_force.col(i) = scaled(to);
    from.t = start + h;
    result.is_sound =
        result.is_sound && stepper->attempt(from, h, start + 2.0 * h, to).outcome == integrate::StepOutcome::accepted;
    start_force.col(i) = scaled(to);
  }

  LaneStep& step = result.step;
  step.coordinates = static_cast<int>(n_);
  step.sliders = static_cast<int>(m_);
  step.width = static_cast<int>(width_);
  step.blocks = is_coupled_ ? 1 : static_cast<int>(n_);
  step.block = static_cast<int>(is_coupled_ ? size : width_);
  step.steps = steps;
  for (Index b = 0; b < step.blocks; ++b)
    for (Index r = 0; r < step.block; ++r)
      for (Index c = 0; c < step.block; ++c)
        step.propagator.push_back(result.propagator(b * step.block + r, b * step.block + c));
  const Matrix from_force = result.propagator * result.end_force + start_force;
  Matrix compliance = Matrix::Zero(m_, m_);
  for (Index k = 0; k < n_; ++k) compliance -= relative_.col(k) * result.end_force.row(k * width_);
  const auto append = [](const Matrix& matrix, std::vector<double>& out) {
    for (Index r = 0; r < matrix.rows(); ++r)
      for (Index c = 0; c < matrix.cols(); ++c) out.push_back(matrix(r, c));
  };
  append(from_force, step.from_force);
  append(result.end_force, step.end_force);
  append(relative_, step.relative);
  append(compliance, step.coupling);
  double contraction = 0.0;
  for (Index i = 0; i < m_; ++i) {
    const double stiffness = slider_stiffness_[i], own = 1.0 + stiffness * compliance(i, i);
    step.stiffness.push_back(stiffness);
    step.flexibility.push_back(1.0 / stiffness);
    step.share.push_back(1.0 / own);
    contraction =
        std::max(contraction, stiffness * (compliance.row(i).cwiseAbs().sum() - std::abs(compliance(i, i))) / own);
    result.is_sound = result.is_sound && own > 0.0;
  }
  result.is_sound = result.is_sound && contraction < slowest_sweep;
  constexpr double round_off = 1e-15;
  step.sweeps =
      contraction > round_off ? 1 + static_cast<int>(std::ceil(std::log(round_off) / std::log(contraction))) : 2;
  if (m_ < 2) step.sweeps = 1;

  result.orders = orders;
  for (const int order : orders) {
    result.responses.emplace_back();
    result.is_sound = result.is_sound && read_response(order, h, result, result.responses.back());
  }
  step.harmonics = static_cast<int>(std::count_if(orders.begin(), orders.end(), [](int order) { return order > 0; }));
  for (int j = 0; j <= steps; ++j)
    for (const int order : orders) {
      if (order == 0) continue;
      const double angle = 2.0 * std::numbers::pi * static_cast<double>((static_cast<long>(order) * j) % steps) / steps;
      step.turn.push_back(std::cos(angle));
      step.turn.push_back(std::sin(angle));
    }
  return result;
}

}  // namespace rubato::steady
