#include <rubato/integrate/exact/flow_derivative.hpp>

#include <Eigen/Cholesky>

#include <utility>

namespace rubato::integrate {

FlowDerivative::FlowDerivative(const system::LocallyNonlinear& system)
    : system_(system), n_(system.size()), m_(system.slider_count()), size_(2 * n_ + m_), length_powers_(degree + 1) {
  const Eigen::LLT<Matrix> mass{Matrix(system.mass())};
  flow_ = Matrix::Zero(size_, size_);
  flow_.block(0, n_, n_, n_).setIdentity();
  flow_.block(n_, 0, n_, n_) = -mass.solve(Matrix(system.stiffness()));
  flow_.block(n_, n_, n_, n_) = -mass.solve(Matrix(system.damping()));
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    Vector join = Vector::Zero(n_);
    if (slider.first != ground) join[slider.first] += 1.0;
    if (slider.second != ground) join[slider.second] -= 1.0;
    flow_.block(n_, 2 * n_ + i, n_, 1) = -mass.solve(join);
    flow_.block(2 * n_ + i, n_, 1, n_) = slider.stiffness * join.transpose();
  }
  derivative_.resize(size_, size_);
  propagator_.resize(size_, size_);
  product_.resize(size_, size_);
}

void FlowDerivative::set_identity() { derivative_.setIdentity(); }

const Matrix& FlowDerivative::powers_of(const std::vector<SliderState>& states) {
  const auto known = cache_.find(states);
  if (known != cache_.end()) return known->second;
  Matrix flow = flow_;
  for (Index i = 0; i < m_; ++i) {
    if (states[static_cast<std::size_t>(i)] == SliderState::stick) continue;
    flow.col(2 * n_ + i).setZero();
    flow.row(2 * n_ + i).setZero();
  }
  Matrix powers(size_ * size_, degree + 1), power = Matrix::Identity(size_, size_);
  for (int k = 0; k <= degree; ++k) {
    powers.col(k) = power.reshaped();
    power = (flow * power / (k + 1)).eval();
  }
  return cache_.emplace(states, std::move(powers)).first->second;
}

void FlowDerivative::pass(double length, const std::vector<SliderState>& states) {
  for (Index i = 0; i < m_; ++i)
    if (states[static_cast<std::size_t>(i)] != SliderState::stick) derivative_.row(2 * n_ + i).setZero();
  const Matrix& powers = powers_of(states);
  double power = 1.0;
  for (int k = 0; k <= degree; ++k, power *= length) length_powers_[k] = power;
  propagator_.reshaped().noalias() = powers * length_powers_;
  switch (size_) {
    case 2:
      return multiply<2>();
    case 3:
      return multiply<3>();
    case 4:
      return multiply<4>();
    case 5:
      return multiply<5>();
    case 6:
      return multiply<6>();
    case 8:
      return multiply<8>();
    case 10:
      return multiply<10>();
    case 12:
      return multiply<12>();
    default:
      return multiply<Eigen::Dynamic>();
  }
}

template <int N>
void FlowDerivative::multiply() {
  using Square = Eigen::Matrix<double, N, N>;
  const Eigen::Map<const Square> propagator(propagator_.data(), size_, size_), now(derivative_.data(), size_, size_);
  Eigen::Map<Square> next(product_.data(), size_, size_);
  next.noalias() = propagator * now;
  derivative_.swap(product_);
}

}  // namespace rubato::integrate
