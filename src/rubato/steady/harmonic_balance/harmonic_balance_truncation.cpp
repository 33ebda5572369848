#include <rubato/core/stopping.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance_equations.hpp>

// What the orders left out would do.
namespace rubato::steady {
namespace {

constexpr double estimate_tolerance = 1e-3;  // of the linear system: an estimate needs no more

}  // namespace

void HarmonicBalanceEquations::sampling(const SliderSeries& series, std::size_t end, ComplexMatrix& force_change) {
  force_change.setZero(series.orders.count, stiffness_.size());
  if (!has_laws()) return;
  // The derivatives, of the orders left out too, by the samples at hand; then the forces by finer ones.
  const Orders all{series.orders.stride, static_cast<int>(end) - 1};
  is_extended_ = true;
  int samples = samples_;
  while (samples < 4 * (all.highest() + 1)) samples *= 2;
  coarse_angles_.prepare(samples, all);
  evaluate(series);
  differentiate(series);
  if (!is_large(series)) factorise(series);
  sampled_change_ = -force_;
  fine_angles_.prepare(finer * samples, all);
  is_fine_ = true;
  evaluate(series);
  is_fine_ = is_extended_ = false;
  sampled_change_ += force_;
  for (Index j = 0; j < sliders_; ++j) sampled_change_.col(j).setZero();
  Vector change = -residual_;
  solve_linear(series, estimate_tolerance, change);
  force_change = sampled_change_;
  add_force_change(series, change, force_change);
}

void HarmonicBalanceEquations::truncation(const SliderSeries& series, std::size_t first, std::size_t end,
                                          ComplexMatrix& left_out, ComplexMatrix& forces_left_out,
                                          ComplexMatrix& force_change) {
  const auto m = static_cast<Index>(active_.size());
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  const int count = series.orders.count;
  left_out.setZero(static_cast<Index>(end - first), stiffness_.size());
  forces_left_out.setZero(static_cast<Index>(end - first), stiffness_.size());
  force_change.setZero(count, stiffness_.size());
  if (!any_slips()) return;
  if (has_laws()) force_change = sampled_change_;
  for (const Index j : active_)
    if (j < sliders_) loops_[static_cast<std::size_t>(j)].extend(series.orders.at(static_cast<int>(end) - 2));

  // Each order alone, with its own part in the force: U + R (F + dF U) = 0.
  Vector right(2 * m);
  ComplexMatrix by_real(most_partners_, m), by_imaginary(most_partners_, m);  // of the forces of its partners
  for (std::size_t p = first; p < end; ++p) {
    stop_if_asked();
    const int k = series.orders.at(static_cast<int>(p) - 1);
    const auto place = static_cast<Index>(p - first);
    Matrix& own = own_factor_.matrix(2 * m);
    own.setZero();
    right.setZero();
    for (Index b = 0; b < m; ++b) {
      const Index j = active_[static_cast<std::size_t>(b)];
      const Complex force = part(p, j) * force_of(j, k);
      forces_left_out(place, j) = force;
      own(2 * b, 2 * b) += 1.0 / part(p, j);
      own(2 * b + 1, 2 * b + 1) += 1.0 / part(p, j);
      const std::span<const Index> others = partners(j);
      for (std::size_t q = 0; q < others.size(); ++q) {
        const Index o = others[q];
        Complex &real = by_real(static_cast<Index>(q), b), &imaginary = by_imaginary(static_cast<Index>(q), b);
        derivative_of(o, j, k, k, real, imaginary);
        real = part(p, o) * real - (o == j ? held(p, j) : 0.0);
        imaginary = part(p, o) * imaginary - Complex(0.0, o == j ? held(p, j) : 0.0);
        for (Index a = 0; a < m; ++a) {
          const Complex r = joined_[p](active_[static_cast<std::size_t>(a)], o);
          const Complex x = product(r, real), y = product(r, imaginary);
          own(2 * a, 2 * b) += x.real();
          own(2 * a + 1, 2 * b) += x.imag();
          own(2 * a, 2 * b + 1) += y.real();
          own(2 * a + 1, 2 * b + 1) += y.imag();
        }
      }
      for (Index a = 0; a < m; ++a) {
        const Complex f = product(joined_[p](active_[static_cast<std::size_t>(a)], j), force);
        right[2 * a] -= f.real();
        right[2 * a + 1] -= f.imag();
      }
    }
    own_factor_.factorise();
    own_factor_.solve(right);
    for (Index b = 0; b < m; ++b) {
      const Index j = active_[static_cast<std::size_t>(b)];
      left_out(place, j) = Complex(right[2 * b], right[2 * b + 1]);
      const std::span<const Index> others = partners(j);
      for (std::size_t q = 0; q < others.size(); ++q) {
        const auto of = static_cast<Index>(q);
        forces_left_out(place, others[q]) += right[2 * b] * by_real(of, b) + right[2 * b + 1] * by_imaginary(of, b);
      }
    }
  }

  // What that does to the orders kept.
  const bool is_new = factor_.size() != rows * m;
  if ((is_new || is_large(series)) && !has_laws()) differentiate(series);
  if (is_new && !is_large(series)) factorise(series);
  Vector mean_change = Vector::Zero(stiffness_.size());
  for (const Index j : active_) {
    for (std::size_t p = first; p < end; ++p) {
      const int l = series.orders.at(static_cast<int>(p) - 1);
      const Complex u = left_out(static_cast<Index>(p - first), j);
      for (const Index o : partners(j)) {
        for (int i = 0; i < count; ++i) {
          Complex real, imaginary;
          derivative_of(o, j, series.orders.at(i), l, real, imaginary);
          force_change(i, o) += part(static_cast<std::size_t>(i) + 1, o) * (u.real() * real + u.imag() * imaginary);
        }
        if (!series.has_mean) continue;
        double real, imaginary;
        mean_derivative_of(o, j, l, real, imaginary);
        mean_change[o] += part(0, o) * (u.real() * real + u.imag() * imaginary);
      }
    }
  }
  Vector change = -residual_;
  for (Index a = 0; a < m; ++a) {
    const Index row = active_[static_cast<std::size_t>(a)];
    if (series.has_mean) {
      for (const Index j : active_) change[a * rows] -= joined_[0](row, j).real() * mean_change[j];
    }
    for (int i = 0; i < count; ++i) {
      Complex sum = 0.0;
      for (const Index j : active_)
        sum -= product(joined_[static_cast<std::size_t>(i) + 1](row, j), force_change(i, j));
      change[a * rows + shift + 2 * i] += sum.real();
      change[a * rows + shift + 2 * i + 1] += sum.imag();
    }
  }
  solve_linear(series, estimate_tolerance, change);
  add_force_change(series, change, force_change);
}

void HarmonicBalanceEquations::add_force_change(const SliderSeries& series, const Vector& change,
                                                ComplexMatrix& force_change) const {
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  const int count = series.orders.count;
  for (Index b = 0; b < static_cast<Index>(active_.size()); ++b) {
    const Index j = active_[static_cast<std::size_t>(b)];
    if (j >= sliders_ && series.has_mean)
      for (const Index o : partners(j))
        for (int i = 0; i < count; ++i)
          force_change(i, o) += change[b * rows] * derivative_by_mean_of(o, j, series.orders.at(i));
    for (int l = 0; l < count; ++l) {
      const double re = change[b * rows + shift + 2 * l], im = change[b * rows + shift + 2 * l + 1];
      force_change(l, j) -= held(static_cast<std::size_t>(l) + 1, j) * Complex(re, im);
      for (const Index o : partners(j))
        for (int i = 0; i < count; ++i) {
          Complex real, imaginary;
          derivative_of(o, j, series.orders.at(i), series.orders.at(l), real, imaginary);
          force_change(i, o) += part(static_cast<std::size_t>(i) + 1, o) * (re * real + im * imaginary);
        }
    }
  }
}

}  // namespace rubato::steady
