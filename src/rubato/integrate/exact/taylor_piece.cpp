#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/integrate/exact/taylor_piece.hpp>

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

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1], by Newton on the Legendre polynomial.
struct Gauss {
  static constexpr int points = 16;
  std::array<double, points> node, weight;

  Gauss() {
    for (int i = 0; i < points; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 0.0;
      for (int k = 0; k < 20; ++k) {
        double p0 = 1.0, p1 = x;
        for (int j = 2; j <= points; ++j) {
          const double p2 = ((2.0 * j - 1.0) * x * p1 - (j - 1.0) * p0) / j;
          p0 = p1;
          p1 = p2;
        }
        slope = points * (x * p1 - p0) / (x * x - 1.0);
        x -= p1 / slope;
      }
      node[static_cast<std::size_t>(i)] = 0.5 * (1.0 + x);
      weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
};

double largest_eigenvalue(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

TaylorPiece::TaylorPiece(const system::LocallyNonlinear& system)
    : system_(system),
      loads_(system.loads()),
      n_(system.size()),
      m_(system.slider_count()),
      terms_(static_cast<Index>(system.loads().terms().size())) {
  const Eigen::LLT<Matrix> mass{Matrix(system.mass())};
  inverse_root_ = mass.matrixL().solve(Matrix::Identity(n_, n_));
  dense_damping_ = Matrix(system.damping());
  damping_ = mass.solve(dense_damping_);
  damping_norm_ = largest_eigenvalue(inverse_root_ * dense_damping_ * inverse_root_.transpose());
  pattern_ = Matrix::Zero(n_, terms_);
  Matrix joins = Matrix::Zero(n_, m_);
  for (Index i = 0; i < terms_; ++i) {
    const auto& term = loads_.terms()[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < term.rows.size(); ++k) pattern_(term.rows[k], i) += term.weights[k];
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law))
      largest_load_frequency_ = std::max(largest_load_frequency_, harmonic->angular_frequency);
  }
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    if (slider.first != ground) joins(slider.first, i) += 1.0;
    if (slider.second != ground) joins(slider.second, i) -= 1.0;
  }
  // Eigen touches the first entry of what it solves for, and a model without loads or sliders has none.
  load_pattern_ = pattern_.cols() > 0 ? Matrix(mass.solve(pattern_)) : pattern_;
  joins_ = joins.cols() > 0 ? Matrix(mass.solve(joins)) : joins;
  forcing_.resize(n_, degree);
  q_.resize(n_, degree + 1);
  v_.resize(n_, degree + 1);
  u_.resize(degree + 1, m_);
  load_.resize(degree + 1, terms_);
  offset_.resize(m_);
  work_q_.resize(n_);
  work_v_.resize(n_);
  work_product_.resize(n_);
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
  const double rho =
      std::max(0.5 * (damping_norm_ + std::sqrt(damping_norm_ * damping_norm_ + 4.0 * k)), largest_load_frequency_);
  Operators operators{inverse_root_.transpose() * (inverse_root_ * stiffness), reach / std::max(rho, 1e-300)};
  return cache_.emplace(std::move(key), std::move(operators)).first->second;
}

void TaylorPiece::start(const system::State& state, const std::vector<SliderState>& states, double table_end) {
  operators_ = &operators_of(states);
  states_ = states;
  q_.col(0) = state.q;
  v_.col(0) = state.v;
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const bool sticks = states[static_cast<std::size_t>(i)] == SliderState::stick;
    offset_[i] = state.slider_force[i] - (sticks ? slider.stiffness * system_.relative_displacement(i, state.q) : 0.0);
  }
  for (Index i = 0; i < terms_; ++i) {
    const auto& law = loads_.terms()[static_cast<std::size_t>(i)].law;
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&law)) {
      const double w = harmonic->angular_frequency, angle = w * state.t + harmonic->phase;
      double cosine = std::cos(angle), sine = std::sin(angle);
      for (int k = 0; k <= degree; ++k) {
        load_(k, i) = cosine;
        const double factor = w * inverse[static_cast<std::size_t>(k)], next = -factor * sine;
        sine = factor * cosine;
        cosine = next;
      }
    } else {
      load_.col(i).setZero();
      load_(0, i) = model::value(law, state.t, model::Side::right);
      if (table_end > state.t)
        load_(1, i) = (model::value(law, table_end, model::Side::left) - load_(0, i)) / (table_end - state.t);
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
    state.slider_force[i] = std::clamp(force, -slider.limit, slider.limit);
  }
}

void TaylorPiece::add_work(double from, double to, double& damper, double& load) const {
  static const Gauss gauss;
  for (int i = 0; i < Gauss::points; ++i) {
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
