#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/integrate/exact/taylor_piece.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace rubato::integrate {
namespace {

// Calls a member template with the size where it is known at compile time: three times as fast for five coordinates.
template <class Call>
void with_size(Index n, Call&& call) {
  switch (n) {
    case 1:
      return call(std::integral_constant<int, 1>());
    case 2:
      return call(std::integral_constant<int, 2>());
    case 3:
      return call(std::integral_constant<int, 3>());
    case 4:
      return call(std::integral_constant<int, 4>());
    case 5:
      return call(std::integral_constant<int, 5>());
    case 6:
      return call(std::integral_constant<int, 6>());
    case 7:
      return call(std::integral_constant<int, 7>());
    case 8:
      return call(std::integral_constant<int, 8>());
    default:
      return call(std::integral_constant<int, Eigen::Dynamic>());
  }
}

// 1/(k + 1): divisions would take a third of the making of a piece.
constexpr std::array<double, TaylorPiece::degree + 1> inverse = [] {
  std::array<double, TaylorPiece::degree + 1> table{};
  for (std::size_t k = 0; k < table.size(); ++k) table[k] = 1.0 / static_cast<double>(k + 1);
  return table;
}();

double largest_eigenvalue(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

TaylorPiece::TaylorPiece(const system::LocallyNonlinear& system)
    : system_(system), n_(system.size()), m_(system.slider_count()) {
  const Eigen::LLT<Matrix> mass{Matrix(system.mass())};
  inverse_root_ = mass.matrixL().solve(Matrix::Identity(n_, n_));
  inverse_mass_ = inverse_root_.transpose() * inverse_root_;
  dense_damping_ = Matrix(system.damping());
  damping_ = mass.solve(dense_damping_);
  damping_norm_ = largest_eigenvalue(inverse_root_ * dense_damping_ * inverse_root_.transpose());
  Matrix joins = Matrix::Zero(n_, m_);
  limits_.resize(m_);
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    if (slider.first != ground) joins(slider.first, i) += 1.0;
    if (slider.second != ground) joins(slider.second, i) -= 1.0;
    limits_[i] = slider.limit;
  }
  // Eigen touches the first entry of what it solves for, and a model without sliders has none.
  joins_ = m_ > 0 ? Matrix(mass.solve(joins)) : joins;

  const auto& terms = system.loads().terms();
  pattern_ = Matrix::Zero(n_, static_cast<Index>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Load load;
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&terms[i].law))
      load = {harmonic->angular_frequency, harmonic->phase, nullptr};
    else
      load.table = std::get_if<model::TableLaw>(&terms[i].law);
    loads_.push_back(load);
    for (std::size_t k = 0; k < terms[i].rows.size(); ++k)
      pattern_(terms[i].rows[k], static_cast<Index>(i)) += terms[i].weights[k];
  }
  set_pattern();

  forcing_.resize(n_, degree);
  q_.resize(n_, degree + 1);
  v_.resize(n_, degree + 1);
  u_.resize(degree + 1, m_);
  offset_.resize(m_);
  work_q_.resize(n_);
  work_v_.resize(n_);
  work_product_.resize(n_);
}

void TaylorPiece::set_pattern() {
  terms_ = static_cast<Index>(loads_.size());
  largest_load_frequency_ = 0.0;
  for (const Load& load : loads_)
    largest_load_frequency_ = std::max(largest_load_frequency_, std::abs(load.angular_frequency));
  load_pattern_.resize(n_, terms_);
  load_pattern_.noalias() = inverse_mass_.lazyProduct(pattern_);
  load_.resize(degree + 1, terms_);
}

// A complex amplitude a is a_r cos(k w t) + a_i cos(k w t + pi/2).
void TaylorPiece::set_excitation(const Excitation& excitation) {
  limits_ = excitation.limits;
  loads_.clear();
  const bool is_static = excitation.constant.size() > 0 && excitation.constant.cwiseAbs().maxCoeff() > 0.0;
  if (is_static) loads_.push_back({});
  for (const LoadHarmonic& harmonic : excitation.harmonics) {
    const double frequency = harmonic.order * excitation.angular_frequency;
    loads_.push_back({frequency, 0.0, nullptr});
    if (harmonic.amplitude.imag().cwiseAbs().maxCoeff() > 0.0)
      loads_.push_back({frequency, 0.5 * std::numbers::pi, nullptr});
  }
  pattern_.resize(n_, static_cast<Index>(loads_.size()));
  Index column = 0;
  if (is_static) pattern_.col(column++) = excitation.constant;
  for (const LoadHarmonic& harmonic : excitation.harmonics) {
    pattern_.col(column++) = harmonic.amplitude.real();
    if (harmonic.amplitude.imag().cwiseAbs().maxCoeff() > 0.0) pattern_.col(column++) = harmonic.amplitude.imag();
  }
  set_pattern();
}

const TaylorPiece::Operators& TaylorPiece::operators_of(const std::vector<SliderState>& states) {
  std::vector<SliderState> key = states;  // which way a slider slips changes no coefficient
  for (SliderState& state : key)
    if (state != SliderState::stick) state = SliderState::slip_positive;
  const auto known = cache_.find(key);
  if (known != cache_.end()) return known->second;
  Matrix stiffness(system_.stiffness());
  for (Index i = 0; i < m_; ++i) {
    if (key[static_cast<std::size_t>(i)] != SliderState::stick) continue;
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    Vector join = Vector::Zero(n_);
    if (slider.first != ground) join[slider.first] += 1.0;
    if (slider.second != ground) join[slider.second] -= 1.0;
    stiffness += slider.stiffness * join * join.transpose();
  }
  // |eigenvalue| <= the positive root of x^2 = c x + k with the norms of C and K in the metric of M.
  const double k = largest_eigenvalue(inverse_root_ * stiffness * inverse_root_.transpose());
  Operators operators{inverse_root_.transpose() * (inverse_root_ * stiffness),
                      0.5 * (damping_norm_ + std::sqrt(damping_norm_ * damping_norm_ + 4.0 * k))};
  return cache_.emplace(std::move(key), std::move(operators)).first->second;
}

void TaylorPiece::start(const system::State& state, const std::vector<SliderState>& states, double table_end) {
  operators_ = &operators_of(states);
  length_ = reach / std::max({operators_->rate, largest_load_frequency_, 1e-300});
  states_ = states;
  q_.col(0) = state.q;
  v_.col(0) = state.v;
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const bool sticks = states[static_cast<std::size_t>(i)] == SliderState::stick;
    offset_[i] = state.slider_force[i] - (sticks ? slider.stiffness * system_.relative_displacement(i, state.q) : 0.0);
  }
  for (Index i = 0; i < terms_; ++i) {
    const Load& law = loads_[static_cast<std::size_t>(i)];
    if (!law.table) {
      const double w = law.angular_frequency, angle = w * state.t + law.phase;
      double cosine = std::cos(angle), sine = std::sin(angle);
      for (int k = 0; k <= degree; ++k) {
        load_(k, i) = cosine;
        const double factor = w * inverse[static_cast<std::size_t>(k)], next = -factor * sine;
        sine = factor * cosine;
        cosine = next;
      }
    } else {
      load_.col(i).setZero();
      load_(0, i) = model::value(*law.table, state.t, model::Side::right);
      if (table_end > state.t)
        load_(1, i) = (model::value(*law.table, table_end, model::Side::left) - load_(0, i)) / (table_end - state.t);
    }
  }
  if (terms_ == 0) forcing_.setZero();
  for (Index i = 0; i < terms_; ++i) {
    const auto law = load_.col(i).head(degree).transpose();
    if (i == 0)
      forcing_.noalias() = load_pattern_.col(i) * law;
    else
      forcing_.noalias() += load_pattern_.col(i) * law;
  }
  forcing_.col(0).noalias() -= joins_.lazyProduct(offset_);
  with_size(n_, [&](auto size) { fill_coefficients<decltype(size)::value>(); });
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    u_.col(i).setZero();
    if (slider.first != ground) u_.col(i) += q_.row(slider.first).transpose();
    if (slider.second != ground) u_.col(i) -= q_.row(slider.second).transpose();
  }
}

template <int N>
void TaylorPiece::fill_coefficients() {
  using Column = Eigen::Matrix<double, N, 1>;
  const Eigen::Map<const Eigen::Matrix<double, N, N>> stiffness(operators_->stiffness.data(), n_, n_),
      damping(damping_.data(), n_, n_);
  for (int k = 0; k < degree; ++k) {
    const Eigen::Map<const Column> q(q_.col(k).data(), n_), v(v_.col(k).data(), n_),
        forcing(forcing_.col(k).data(), n_);
    Eigen::Map<Column> next_q(q_.col(k + 1).data(), n_), next_v(v_.col(k + 1).data(), n_);
    const double factor = inverse[static_cast<std::size_t>(k)];
    next_v = forcing;
    next_v.noalias() -= damping * v;
    next_v.noalias() -= stiffness * q;
    next_v *= factor;
    next_q = factor * v;
  }
}

template <int N>
void TaylorPiece::horner(double s, double* q_out, double* v_out) const {
  using Column = Eigen::Matrix<double, N, 1>;
  Eigen::Map<Column> q(q_out, n_), v(v_out, n_);
  q = Eigen::Map<const Column>(q_.col(degree).data(), n_);
  v = Eigen::Map<const Column>(v_.col(degree).data(), n_);
  for (int k = degree - 1; k >= 0; --k) {
    q = s * q + Eigen::Map<const Column>(q_.col(k).data(), n_);
    v = s * v + Eigen::Map<const Column>(v_.col(k).data(), n_);
  }
}

void TaylorPiece::evaluate(double s, Vector& q, Vector& v) const {
  with_size(n_, [&](auto size) { horner<decltype(size)::value>(s, q.data(), v.data()); });
}

void TaylorPiece::evaluate(double s, system::State& state) const {
  evaluate(s, state.q, state.v);
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const bool sticks = states_[static_cast<std::size_t>(i)] == SliderState::stick;
    const double force = offset_[i] + (sticks ? slider.stiffness * system_.relative_displacement(i, state.q) : 0.0);
    state.slider_force[i] = std::clamp(force, -limits_[i], limits_[i]);
  }
}

void TaylorPiece::add_work(double from, double to, double& damper, double& load) const {
  static const numerics::GaussLegendre<16> gauss;
  for (int i = 0; i < 16; ++i) {
    const double s = from + (to - from) * gauss.node[static_cast<std::size_t>(i)];
    const double weight = (to - from) * gauss.weight[static_cast<std::size_t>(i)];
    evaluate(s, work_q_, work_v_);
    work_product_.noalias() = dense_damping_ * work_v_;
    damper += weight * work_v_.dot(work_product_);
    for (Index j = 0; j < terms_; ++j)
      load += weight * polynomial({load_.col(j).data(), degree + 1}, s) * pattern_.col(j).dot(work_v_);
  }
}

}  // namespace rubato::integrate
