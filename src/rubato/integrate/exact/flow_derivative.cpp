#include <rubato/integrate/exact/flow_derivative.hpp>
#include <rubato/integrate/exact/processor_clones.hpp>
#include <rubato/integrate/exact/series_length.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <utility>

namespace rubato::integrate {
namespace {

constexpr Index width = 4;
constexpr Index largest_by_kernels = 16;  // rows; beyond, the blocks of a general product pay
// Terms that are neglected: few save a step of Newton where it would be the last, and cost most where matrices are
// large. 2^21/21! = 4e-14, 2^15/15! = 3e-8.
constexpr double neglected_of_small = 1e-13, neglected_of_large = 1e-7;
constexpr int degree_of_small = 20, degree_of_large = 14;

typedef double Lanes __attribute__((vector_size(width * sizeof(double)), aligned(alignof(double)), may_alias));

// sum over k of s^k p_k, of `entries` at a time: a multiple of `width`.
RUBATO_CLONES void combine(const double* p, Index entries, Index terms, double s, double* result) {
  for (Index i = 0; i < entries; i += width) {
    Lanes sum = *reinterpret_cast<const Lanes*>(p + (terms - 1) * entries + i);
    for (Index k = terms - 1; k-- > 0;) sum = sum * s + *reinterpret_cast<const Lanes*>(p + k * entries + i);
    *reinterpret_cast<Lanes*>(result + i) = sum;
  }
}

// c = a b, of `size` columns; the rows are a multiple of `width`.
RUBATO_CLONES void multiply(const double* a, const double* b, Index rows, Index size, double* c) {
  for (Index j = 0; j < size; ++j)
    for (Index i = 0; i < rows; i += width) {
      Lanes even{}, odd{};  // sums that do not wait for each other
      Index k = 0;
      for (; k + 1 < size; k += 2) {
        even += *reinterpret_cast<const Lanes*>(a + k * rows + i) * b[j * rows + k];
        odd += *reinterpret_cast<const Lanes*>(a + (k + 1) * rows + i) * b[j * rows + k + 1];
      }
      if (k < size) even += *reinterpret_cast<const Lanes*>(a + k * rows + i) * b[j * rows + k];
      *reinterpret_cast<Lanes*>(c + j * rows + i) = even + odd;
    }
}

const SeriesLength& series(bool small) {
  static const SeriesLength of_small(neglected_of_small), of_large(neglected_of_large);
  return small ? of_small : of_large;
}

}  // namespace

FlowDerivative::FlowDerivative(const system::LocallyNonlinear& system)
    : system_(system),
      n_(system.size()),
      m_(system.slider_count()),
      size_(2 * n_ + m_),
      rows_((size_ + width - 1) / width * width),
      degree_(rows_ <= largest_by_kernels ? degree_of_small : degree_of_large),
      length_powers_(degree_ + 1) {
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
  derivative_.resize(rows_, size_);
  propagator_.resize(rows_, size_);
  product_.resize(rows_, size_);
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
  Matrix powers(rows_ * size_, degree_ + 1), power = Matrix::Zero(rows_, size_);
  power.topRows(size_).setIdentity();
  for (int k = 0; k <= degree_; ++k) {
    powers.col(k) = power.reshaped();
    power.topRows(size_) = (flow * power.topRows(size_) / (k + 1)).eval();
  }
  return cache_.emplace(states, std::move(powers)).first->second;
}

void FlowDerivative::pass(double length, double turn, const std::vector<SliderState>& states) {
  for (Index i = 0; i < m_; ++i)
    if (states[static_cast<std::size_t>(i)] != SliderState::stick) derivative_.row(2 * n_ + i).setZero();
  const Matrix& powers = powers_of(states);
  const bool small = rows_ <= largest_by_kernels;
  const Index terms = series(small).terms(turn, degree_ + 1);
  if (small) {
    combine(powers.data(), rows_ * size_, terms, length, propagator_.data());
    multiply(propagator_.data(), derivative_.data(), rows_, size_, product_.data());
  } else {
    double power = 1.0;
    for (Index k = 0; k < terms; ++k, power *= length) length_powers_[k] = power;
    propagator_.reshaped().noalias() = powers.leftCols(terms) * length_powers_.head(terms);
    product_.noalias() = propagator_ * derivative_.topRows(size_);
  }
  derivative_.swap(product_);
}

}  // namespace rubato::integrate
