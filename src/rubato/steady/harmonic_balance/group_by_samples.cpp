#include <rubato/steady/harmonic_balance/group_by_samples.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace rubato::steady {

GroupBySamples::GroupBySamples(const LawGroup& law)
    : law_(law),
      d_(law.size()),
      memory_(law.memory_size()),
      derivatives_(law.size(), law.memory_size(), law.depends_on_rate()) {
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
  if (law_.slopes(from, memory, to, slopes_)) {
    law_.advance(from, memory, to, next_.data(), force_now_.data(), nullptr);
    return;
  }
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
  step_slopes_of_period(start);
  return derivatives_.by_start(steps_);
}

/// The slopes of all steps of a period, one below another.
void GroupBySamples::step_slopes_of_period(const Vector& start) {
  const Index rows = derivatives_.step_rows(), count = u_.cols();
  steps_.resize(count * rows, d_ + memory_);
  Vector now = start, after(memory_);
  for (Index i = 1; i <= count; ++i) {
    step_slopes(point(i - 1), now.data(), point(i));
    steps_.middleRows((i - 1) * rows, rows) = slopes_;
    after = next_;
    std::swap(now, after);
  }
}

void GroupBySamples::differentiate() {
  derivatives_.prepare(*angles_, angular_frequency_);
  constexpr double least = Closing::forgets_by_differences;
  step_slopes_of_period(started_.back());
  if (memory_ > 0) {
    const Matrix lost = Matrix::Identity(memory_, memory_) - derivatives_.by_start(steps_);
    if (lost.jacobiSvd().singularValues().minCoeff() <= least) {
      // What is never forgotten has its derivatives from the first periods.
      const Vector nowhere = Vector::Zero(d_), rest = Vector::Zero(memory_);
      step_slopes({nowhere.data(), nowhere.data()}, rest.data(), point(0));
      derivatives_.start_from_rest(slopes_);
      for (std::size_t period = 0; period + 1 < started_.size(); ++period) {
        step_slopes_of_period(started_[period]);
        derivatives_.carry(steps_);
      }
      if (started_.size() > 1) step_slopes_of_period(started_.back());
    }
  }
  derivatives_.close(steps_, least);
}

}  // namespace rubato::steady
