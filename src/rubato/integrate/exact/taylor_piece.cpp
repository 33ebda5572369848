#include <rubato/integrate/exact/series_length.hpp>
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

// x^k/k! that is neglected: reach^25/25!, beyond round-off.
const SeriesLength& series() {
  static const SeriesLength length([] {
    double term = 1.0;
    for (int k = 1; k <= TaylorPiece::degree + 1; ++k) term *= TaylorPiece::reach / k;
    return term * (1.0 + 1e-12);
  }());
  return length;
}

constexpr Index fewest_terms = 8;  // the decisions of sliders at their limits look at the first seven

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
  work_q_.resize(n_);
  set_pattern();

  q_.resize(n_, degree + 1);
  v_.resize(n_, degree + 1);
  u_.resize(degree + 1, m_);
  offset_.resize(m_);
  work_v_.resize(n_);
  work_product_.resize(n_);
}

// cos(w (t + s) + phase) = sum over k of w^k s^k/k! times cos, -sin, -cos, sin of the angle at t.
void TaylorPiece::set_pattern() {
  const auto count = static_cast<Index>(loads_.size());
  largest_load_frequency_ = 0.0;
  for (const Load& load : loads_)
    largest_load_frequency_ = std::max(largest_load_frequency_, std::abs(load.angular_frequency));
  load_length_ = reach / std::max(largest_load_frequency_, 1e-300);
  growth_.setZero(n_ * degree, count);
  load_start_.resize(2 * count);
  for (Index i = 0; i < count; ++i) {
    const Load& load = loads_[static_cast<std::size_t>(i)];
    work_q_.noalias() = inverse_mass_.lazyProduct(pattern_.col(i));
    double factor = 1.0;
    for (Index k = 0; k < (load.table ? 2 : degree); ++k) {
      const bool negative = !load.table && (k % 4 == 1 || k % 4 == 2);
      double* growth = growth_.col(i).data() + k * n_;
      for (Index j = 0; j < n_; ++j) growth[j] = (negative ? -factor : factor) * work_q_[j];
      if (!load.table) factor *= load.angular_frequency * inverse[static_cast<std::size_t>(k)];
    }
  }
}

// A complex amplitude a is a_r cos(k w t) + a_i cos(k w t + pi/2).
void TaylorPiece::set_excitation(const system::Excitation& excitation) {
  limits_ = excitation.limits;
  loads_.clear();
  const bool is_static = excitation.constant.size() > 0 && excitation.constant.cwiseAbs().maxCoeff() > 0.0;
  if (is_static) loads_.push_back({});
  for (const system::LoadHarmonic& harmonic : excitation.harmonics) {
    const double frequency = harmonic.order * excitation.angular_frequency;
    loads_.push_back({frequency, 0.0, nullptr});
    if (harmonic.amplitude.imag().cwiseAbs().maxCoeff() > 0.0)
      loads_.push_back({frequency, 0.5 * std::numbers::pi, nullptr});
  }
  pattern_.resize(n_, static_cast<Index>(loads_.size()));
  Index column = 0;
  if (is_static) pattern_.col(column++) = excitation.constant;
  for (const system::LoadHarmonic& harmonic : excitation.harmonics) {
    pattern_.col(column++) = harmonic.amplitude.real();
    if (harmonic.amplitude.imag().cwiseAbs().maxCoeff() > 0.0) pattern_.col(column++) = harmonic.amplitude.imag();
  }
  set_pattern();
}

const TaylorPiece::Operators& TaylorPiece::operators_of(const std::vector<SliderState>& states) {
  // Which way a slider slips changes no coefficient.
  const auto same = [](SliderState a, SliderState b) { return (a == SliderState::stick) == (b == SliderState::stick); };
  if (operators_ && std::equal(states.begin(), states.end(), key_.begin(), same)) return *operators_;
  key_ = states;
  for (SliderState& state : key_)
    if (state != SliderState::stick) state = SliderState::slip_positive;
  const auto known = cache_.find(key_);
  if (known != cache_.end()) return known->second;
  Matrix stiffness(system_.stiffness());
  for (Index i = 0; i < m_; ++i) {
    if (key_[static_cast<std::size_t>(i)] != SliderState::stick) continue;
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    Vector join = Vector::Zero(n_);
    if (slider.first != ground) join[slider.first] += 1.0;
    if (slider.second != ground) join[slider.second] -= 1.0;
    stiffness += slider.stiffness * join * join.transpose();
  }
  // |eigenvalue| <= the positive root of x^2 = c x + k with the norms of C and K in the metric of M.
  const double k = largest_eigenvalue(inverse_root_ * stiffness * inverse_root_.transpose());
  const double rate = 0.5 * (damping_norm_ + std::sqrt(damping_norm_ * damping_norm_ + 4.0 * k));
  Operators operators{inverse_root_.transpose() * (inverse_root_ * stiffness), rate, reach / std::max(rate, 1e-300)};
  return cache_.emplace(key_, std::move(operators)).first->second;
}

void TaylorPiece::start(const system::State& state, const std::vector<SliderState>& states, double end) {
  operators_ = &operators_of(states);
  start_ = state.t;
  rate_ = std::max(operators_->rate, largest_load_frequency_);
  length_ = std::min(operators_->length, load_length_);
  terms_ = std::max(fewest_terms, terms_of(rate_ * (end - state.t)));
  states_ = states;
  q_.col(0) = state.q;
  v_.col(0) = state.v;
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const bool sticks = states[static_cast<std::size_t>(i)] == SliderState::stick;
    offset_[i] = state.slider_force[i] - (sticks ? slider.stiffness * system_.relative_displacement(i, state.q) : 0.0);
  }
  set_loads(state.t, end);
  with_size(n_, [&](auto size) { fill_coefficients<decltype(size)::value>(); });
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    double* u = u_.col(i).data();
    const double *first = slider.first == ground ? nullptr : q_.data() + slider.first,
                 *second = slider.second == ground ? nullptr : q_.data() + slider.second;
    for (Index k = 0; k < terms_; ++k) u[k] = (first ? first[k * n_] : 0.0) - (second ? second[k * n_] : 0.0);
  }
}

void TaylorPiece::set_loads(double t, double end) {
  for (Index i = 0; i < static_cast<Index>(loads_.size()); ++i) {
    const Load& load = loads_[static_cast<std::size_t>(i)];
    double &first = load_start_[2 * i], &second = load_start_[2 * i + 1];
    if (!load.table) {
      const double angle = load.angular_frequency * t + load.phase;
      first = std::cos(angle);
      second = std::sin(angle);
    } else {
      first = model::value(*load.table, t, model::Side::right);
      second = end > t ? (model::value(*load.table, end, model::Side::left) - first) / (end - t) : 0.0;
    }
  }
}

double TaylorPiece::load_value(Index i, double s) const {
  const Load& load = loads_[static_cast<std::size_t>(i)];
  return load.table ? load_start_[2 * i] + s * load_start_[2 * i + 1]
                    : std::cos(load.angular_frequency * (start_ + s) + load.phase);
}

template <int N>
void TaylorPiece::fill_coefficients() {
  using Column = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  const Eigen::Map<const Square> stiffness(operators_->stiffness.data(), n_, n_), damping(damping_.data(), n_, n_);
  const Index loads = growth_.cols(), stride = growth_.rows();
  Column forcing = Column::Zero(n_);  // M^-1 (P l_k - B c)
  for (Index k = 0; k + 1 < terms_; ++k) {
    const Eigen::Map<const Column> q(q_.data() + k * n_, n_), v(v_.data() + k * n_, n_);
    Eigen::Map<Column> next_q(q_.data() + (k + 1) * n_, n_), next_v(v_.data() + (k + 1) * n_, n_);
    const double factor = inverse[static_cast<std::size_t>(k)];
    forcing.setZero();
    for (Index i = 0; i < loads; ++i)
      forcing += load_start_[2 * i + k % 2] * Eigen::Map<const Column>(growth_.data() + i * stride + k * n_, n_);
    if (k == 0) forcing.noalias() -= joins_.lazyProduct(offset_);
    if constexpr (N == Eigen::Dynamic) {
      next_v = forcing;
      next_v.noalias() -= damping * v;
      next_v.noalias() -= stiffness * q;
      next_v *= factor;
    } else if constexpr (N <= 3) {  // nothing but two operations from one velocity to the next
      const Square scaled_stiffness = factor * stiffness, scaled_damping = factor * damping;
      const Column elastic = factor * forcing - scaled_stiffness.lazyProduct(q);
      next_v = elastic - scaled_damping.lazyProduct(v);
    } else {
      const Column elastic = stiffness.lazyProduct(q), viscous = damping.lazyProduct(v);
      next_v = factor * ((forcing - elastic) - viscous);
    }
    next_q = factor * v;
  }
}

// Even and odd terms apart: their recurrences do not wait for each other.
template <int N>
void TaylorPiece::horner(double s, double* q_out, double* v_out) const {
  using Column = Eigen::Matrix<double, N, 1>;
  Eigen::Map<Column> q(q_out, n_), v(v_out, n_);
  const auto column = [this](const Matrix& c, Index k) { return Eigen::Map<const Column>(c.data() + k * n_, n_); };
  if constexpr (N != Eigen::Dynamic) {
    const double square = s * s;
    Index k = terms_ - 1;
    Column q_odd = Column::Zero(n_), v_odd = q_odd, q_even = q_odd, v_even = q_odd;
    if (k % 2 == 0) {
      q_even = column(q_, k);
      v_even = column(v_, k);
      --k;
    }
    for (; k > 0; k -= 2) {
      q_odd = square * q_odd + column(q_, k);
      v_odd = square * v_odd + column(v_, k);
      q_even = square * q_even + column(q_, k - 1);
      v_even = square * v_even + column(v_, k - 1);
    }
    q = q_even + s * q_odd;
    v = v_even + s * v_odd;
  } else {
    q = column(q_, terms_ - 1);
    v = column(v_, terms_ - 1);
    for (Index k = terms_ - 1; k-- > 0;) {
      q = s * q + column(q_, k);
      v = s * v + column(v_, k);
    }
  }
}

Index TaylorPiece::terms_of(double turn) { return series().terms(turn, degree + 1); }

double TaylorPiece::displacement_scale(Index slider) const {
  const auto& element = system_.sliders()[static_cast<std::size_t>(slider)];
  double scale = 0.0, power = 1.0;
  for (Index k = 0; k < terms_; ++k, power *= length_)
    for (const Index row : {element.first, element.second})
      if (row != ground) scale = std::max(scale, std::abs(q_(row, k)) * power);
  return scale;
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
    for (Index j = 0; j < pattern_.cols(); ++j) load += weight * load_value(j, s) * pattern_.col(j).dot(work_v_);
  }
}

}  // namespace rubato::integrate
