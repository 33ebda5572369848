#include <rubato/steady/harmonic_balance/sample_angles.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::steady {

using std::numbers::pi;

void SampleAngles::prepare(int count, const Orders& orders) {
  orders_ = orders;
  if (this->count() == count) return;
  circle_.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) circle_[static_cast<std::size_t>(i)] = unit(2.0 * pi * i / count);
}

void SampleAngles::synthesise(const Orders& orders, const ComplexVector& coefficients, Vector& values) {
  const auto n = static_cast<std::size_t>(count());
  spectrum_.assign(n, 0.0);
  const double half = 0.5 * count();
  for (int i = 0; i < orders.count; ++i) {
    const auto k = static_cast<std::size_t>(orders.at(i));
    spectrum_[k] = half * coefficients[i];
    spectrum_[n - k] = std::conj(spectrum_[k]);
  }
  transform_.inv(values_, spectrum_);
  values.resize(count());
  for (std::size_t i = 0; i < n; ++i) values[static_cast<Index>(i)] = values_[i].real();
}

const std::vector<Complex>& SampleAngles::analyse(const double* values) {
  samples_.assign(values, values + count());
  transform_.fwd(spectrum_, samples_);
  spectrum_.resize(circle_.size() / 2 + 1);
  for (Complex& c : spectrum_) c *= 2.0 / count();
  return spectrum_;
}

Matrix Closing::solve(const Matrix& by_start, const Matrix& x, double least) {
  const Matrix lost = Matrix::Identity(by_start.rows(), by_start.cols()) - by_start;
  Eigen::CompleteOrthogonalDecomposition<Matrix> factor(lost.rows(), lost.cols());
  factor.setThreshold(least / std::max(1.0, lost.cwiseAbs().maxCoeff()));
  factor.compute(lost);
  if (lost.cwiseAbs().maxCoeff() < least) return Matrix::Zero(x.rows(), x.cols());
  return factor.solve(x);
}

}  // namespace rubato::steady
