#include <rubato/steady/harmonic_balance/group_by_samples.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace rubato::steady {

GroupBySamples::GroupBySamples(const LawGroup& law) : law_(law), d_(law.size()), memory_(law.memory_size()) {
  for (Vector* of_memory : {&now_, &next_, &length_, &memory_there_, &next_there_}) of_memory->setZero(memory_);
  for (Vector* of_numbers : {&scale_, &force_now_, &mean_force_, &u_there_, &rate_there_, &force_there_})
    of_numbers->setZero(d_);
  slopes_.resize(4 * d_ + memory_, d_ + memory_);
  other_.setZero(1, d_ + memory_);
}

void GroupBySamples::pass(SampleAngles& angles, double angular_frequency, const Vector& mean, const Orders& orders,
                          const std::vector<const Complex*>& coefficients) {
  angles_ = &angles;
  orders_ = angles.orders();
  angular_frequency_ = angular_frequency;
  const Index count = angles.count();
  u_.resize(d_, count);
  rate_.resize(d_, count);
  f_.resize(count, d_);
  ComplexVector series(orders.count);
  Vector values;
  for (Index i = 0; i < d_; ++i) {
    for (int k = 0; k < orders.count; ++k) series[k] = coefficients[static_cast<std::size_t>(i)][k];
    angles.synthesise(orders, series, values);
    scale_[i] = values.cwiseAbs().maxCoeff();
    u_.row(i) = values.transpose().array() + mean[i];
    for (int k = 0; k < orders.count; ++k) series[k] *= Complex(0.0, angular_frequency * orders.at(k));
    angles.synthesise(orders, series, values);
    rate_.row(i) = values.transpose();
  }
  // A number that does not move is as long as the others.
  const double largest = scale_.maxCoeff() > 0.0 ? scale_.maxCoeff() : law_.length();
  for (Index i = 0; i < d_; ++i)
    if (!(scale_[i] > 1e-6 * largest)) scale_[i] = std::max(largest, std::abs(mean[i]));

  const Vector nowhere = Vector::Zero(d_), rest = Vector::Zero(memory_);
  Vector start(memory_);
  law_.advance({nowhere.data(), nowhere.data()}, rest.data(), point(0), start.data(), force_now_.data(), nullptr);
  has_closed_ = Closing::close(
      std::move(start), length_, Closing::forgets_by_differences,
      [&](const Vector& from, Vector& end) { march(from, end); }, [&](const Vector& from) { return carry(from); },
      started_);

  force_.resize(orders_.count, d_);
  for (Index i = 0; i < d_; ++i) {
    const std::vector<Complex>& spectrum = angles.analyse(f_.col(i).data());
    mean_force_[i] = 0.5 * spectrum[0].real();
    for (int k = 0; k < orders_.count; ++k) force_(k, i) = spectrum[static_cast<std::size_t>(orders_.at(k))];
  }
}

/// One period from a memory; writes forces, and the memory at its end.
void GroupBySamples::march(const Vector& start, Vector& end) {
  now_ = start;
  length_ = start.cwiseAbs();
  for (Index i = 1; i <= u_.cols(); ++i) {
    law_.advance(point(i - 1), now_.data(), point(i), next_.data(), force_now_.data(), nullptr);
    std::swap(now_, next_);
    length_ = length_.cwiseMax(now_.cwiseAbs());
    f_.row(i % u_.cols()) = force_now_.transpose();
  }
  end = now_;
}

double GroupBySamples::asymmetry() const {
  const Index half = f_.rows() / 2;
  return (f_.topRows(half) + f_.bottomRows(half)).cwiseAbs().maxCoeff();
}

void GroupBySamples::add_dissipated(Vector& work) const {
  Vector now = started_.back(), next(memory_), force(d_);
  for (Index i = 1; i <= u_.cols(); ++i) {
    law_.advance(point(i - 1), now.data(), point(i), next.data(), force.data(), nullptr);
    law_.add_dissipated(point(i - 1), now.data(), point(i), next.data(), work);
    std::swap(now, next);
  }
}

// Away from where the step goes: a change of u must not carry it over the limit that it has just reached.
void GroupBySamples::step_slopes(const GroupPoint& from, const double* memory, const GroupPoint& to) {
  slopes_.setZero();
  law_.advance(from, memory, to, next_.data(), force_now_.data(), &tangent_);
  const auto differ = [&](const GroupPoint& begin, const double* past, const GroupPoint& end, double by, auto row) {
    law_.advance(begin, past, end, next_there_.data(), force_there_.data(), nullptr);
    row.head(d_) = (force_there_ - force_now_).transpose() / by;
    row.tail(memory_) = (next_there_ - next_).transpose() / by;
  };
  const auto differ_by = [&](auto row, const double* values, Vector& moved, double change, Index i, bool at_end,
                             bool is_rate) {
    if (!(std::abs(change) > 0.0)) return;
    moved = Eigen::Map<const Vector>(values, d_);
    moved[i] += change;
    GroupPoint there = at_end ? to : from;
    (is_rate ? there.rate : there.u) = moved.data();
    differ(at_end ? from : there, memory, at_end ? there : to, moved[i] - values[i], row);
  };
  for (Index i = 0; i < d_; ++i) {
    const double far = Closing::difference * std::max(scale_[i], std::abs(to.u[i]));
    const double travel = to.u[i] - from.u[i], forwards = travel < 0.0 ? -1.0 : 1.0;
    const double way = std::abs(travel) > 2.0 * far ? -forwards : forwards;
    differ_by(slopes_.row(i), to.u, u_there_, way * far, i, true, false);
    // What slips stands at a limit that follows the displacements at the start. Its memory says so already: to that
    // side which lowers the limit the change would count twice.
    differ_by(slopes_.row(2 * d_ + i), from.u, u_there_, far, i, false, false);
    differ_by(other_.row(0), from.u, u_there_, -far, i, false, false);
    if (other_.squaredNorm() < slopes_.row(2 * d_ + i).squaredNorm()) slopes_.row(2 * d_ + i) = other_;
    if (!law_.depends_on_rate()) continue;
    differ_by(slopes_.row(d_ + i), to.rate, rate_there_, angular_frequency_ * far, i, true, true);
    differ_by(slopes_.row(3 * d_ + i), from.rate, rate_there_, angular_frequency_ * far, i, false, true);
  }
  memory_there_ = Eigen::Map<const Vector>(memory, memory_);
  const double whole = length_.size() > 0 ? length_.maxCoeff() : 0.0;
  for (Index i = 0; i < memory_; ++i) {
    const double before = memory_there_[i];
    const double size = length_[i] > 1e-6 * whole ? length_[i] : std::max(whole, scale_.maxCoeff());
    memory_there_[i] -= std::copysign(Closing::difference * std::max(size, 1e-300), before);
    differ(from, memory_there_.data(), to, memory_there_[i] - before, slopes_.row(4 * d_ + i));
    memory_there_[i] = before;
  }
  slopes_.block(0, 0, 2 * d_, d_) = tangent_.transpose();  // to all digits
}

Matrix GroupBySamples::carry(const Vector& start) {
  Matrix by_start = Matrix::Identity(memory_, memory_);
  Vector now = start, after(memory_);
  for (Index i = 1; i <= u_.cols(); ++i) {
    step_slopes(point(i - 1), now.data(), point(i));
    by_start = (slopes_.bottomRightCorner(memory_, memory_).transpose() * by_start).eval();
    after = next_;
    std::swap(now, after);
  }
  return by_start;
}

/// How a displacement and its rate at a sample follow from the unknowns of its number.
void GroupBySamples::set_motion(Index sample, Vector& of_u, Vector& of_rate) const {
  of_u[0] = 1.0;
  of_rate[0] = 0.0;
  for (int o = 0; o < orders_.count; ++o) {
    const Complex z = angles_->unit_vector(static_cast<long>(orders_.at(o)) * static_cast<long>(sample));
    const double number = angular_frequency_ * orders_.at(o);
    of_u[1 + 2 * o] = z.real();
    of_u[2 + 2 * o] = -z.imag();
    of_rate[1 + 2 * o] = -number * z.imag();
    of_rate[2 + 2 * o] = -number * z.real();
  }
}

/// The derivatives of a quantity at the end of a step, by the slopes of the step.
void GroupBySamples::take_step(const Vector& u0, const Vector& rate0, const Vector& u1, const Vector& rate1,
                               const Matrix& of_memory, Index quantity, Vector& sum) const {
  const auto s = slopes_.col(quantity);
  sum.noalias() = of_memory * s.tail(memory_);
  const Index size = unknowns();
  for (Index j = 0; j < d_; ++j) {
    auto own = sum.segment(column(j), size);
    own += s[j] * u1 + s[2 * d_ + j] * u0;
    if (law_.depends_on_rate()) own += s[d_ + j] * rate1 + s[3 * d_ + j] * rate0;
  }
}

/// Carries the derivatives by all unknowns along a period. With `forces` those of the forces are written too.
void GroupBySamples::carry(const Vector& start, Matrix& of_memory, bool forces) {
  const Index size = unknowns();
  Vector u0(size), rate0(size), u1(size), rate1(size), now = start, after(memory_), sum(d_ * size);
  set_motion(0, u0, rate0);
  Matrix moved(d_ * size, memory_);
  for (Index i = 1; i <= u_.cols(); ++i) {
    set_motion(i, u1, rate1);
    step_slopes(point(i - 1), now.data(), point(i));
    for (Index q = forces ? 0 : d_; q < d_ + memory_; ++q) {
      take_step(u0, rate0, u1, rate1, of_memory, q, sum);
      if (q < d_)
        of_forces_[static_cast<std::size_t>(q)].row(i % u_.cols()) = sum.transpose();
      else
        moved.col(q - d_) = sum;
    }
    std::swap(of_memory, moved);
    after = next_;
    std::swap(now, after);
    std::swap(u0, u1);
    std::swap(rate0, rate1);
  }
}

void GroupBySamples::differentiate() {
  const Index size = unknowns();
  of_forces_.resize(static_cast<std::size_t>(d_));
  for (Matrix& of_force : of_forces_) of_force.resize(u_.cols(), d_ * size);
  Matrix of_memory = Matrix::Zero(d_ * size, memory_);
  if (memory_ > 0) {
    const Matrix by_start = carry(started_.back());
    const double slowest = (Matrix::Identity(memory_, memory_) - by_start).jacobiSvd().singularValues().minCoeff();
    constexpr double least = Closing::forgets_by_differences;
    if (slowest <= least) {
      // What is never forgotten has its derivatives from the first periods.
      Vector of_u(size), of_rate(size), sum(d_ * size);
      const Vector none = Vector::Zero(size);
      set_motion(0, of_u, of_rate);
      const Vector nowhere = Vector::Zero(d_), rest = Vector::Zero(memory_);
      step_slopes({nowhere.data(), nowhere.data()}, rest.data(), point(0));
      const Matrix from_rest = Matrix::Zero(d_ * size, memory_);
      for (Index q = 0; q < memory_; ++q) {
        take_step(none, none, of_u, of_rate, from_rest, d_ + q, sum);
        of_memory.col(q) = sum;
      }
      for (std::size_t period = 0; period + 1 < started_.size(); ++period) carry(started_[period], of_memory, false);
    }
    Matrix after = of_memory;
    carry(started_.back(), after, false);
    of_memory += Closing::solve(by_start, (after - of_memory).transpose(), least).transpose();
  }
  carry(started_.back(), of_memory, true);
  by_.resize(static_cast<std::size_t>(d_));
  mean_by_.resize(d_ * size, d_);
  for (Index i = 0; i < d_; ++i) {
    const Matrix& of_force = of_forces_[static_cast<std::size_t>(i)];
    ComplexMatrix& by = by_[static_cast<std::size_t>(i)];
    by.resize(orders_.count, d_ * size);
    for (Index c = 0; c < d_ * size; ++c) {
      const std::vector<Complex>& spectrum = angles_->analyse(of_force.col(c).data());
      mean_by_(c, i) = 0.5 * spectrum[0].real();
      for (int k = 0; k < orders_.count; ++k) by(k, c) = spectrum[static_cast<std::size_t>(orders_.at(k))];
    }
  }
}

}  // namespace rubato::steady
