#include <rubato/steady/harmonic_balance/law_by_samples.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

using std::numbers::pi;

constexpr double difference = Closing::difference;

}  // namespace

LawBySamples::LawBySamples(const model::Law& law, double normal)
    : law_(law),
      normal_(normal),
      own_slopes_(dynamic_cast<const model::LawSlopes*>(&law)),
      memory_(law.memory_size()),
      least_forgotten_(own_slopes_ ? Closing::forgets : Closing::forgets_by_differences) {
  now_.resize(memory_);
  next_.resize(memory_);
  length_.resize(memory_);
  memory_there_.resize(memory_);
  slopes_.resize(4 + memory_, 1 + memory_);
}

void LawBySamples::pass(SampleAngles& angles, double angular_frequency, double mean, const Orders& orders,
                        const Complex* coefficients) {
  angles_ = &angles;
  orders_ = angles.orders();
  angular_frequency_ = angular_frequency;
  ComplexVector series(orders.count);
  for (int i = 0; i < orders.count; ++i) series[i] = coefficients[i];
  angles.synthesise(orders, series, u_);
  u_scale_ = u_.cwiseAbs().maxCoeff();
  u_.array() += mean;
  for (int i = 0; i < orders.count; ++i) series[i] *= Complex(0.0, angular_frequency * orders.at(i));
  angles.synthesise(orders, series, rate_);
  f_.resize(angles.count());
  by_u_.resize(angles.count());
  by_rate_.resize(angles.count());
  has_closed_ = true;
  if (memory_ == 0) {
    for (int i = 0; i < angles.count(); ++i) {
      const model::LawPoint point{u_[i], rate_[i], 0.0, model::Side::right, normal_};
      const model::LawAnswer answer = law_.at(point, nullptr);
      f_[i] = answer.force;
      by_u_[i] = answer.by_u;
      by_rate_[i] = answer.by_rate;
    }
  } else {
    find_places(orders, coefficients);
    for (Place& p : places_)
      if (p.sample < 0) p.point.u += mean;
    close();
  }
  find_forces();
}

// A turn lies where the rate changes its sign between two samples, found by Newton's method within them.
void LawBySamples::find_places(const Orders& orders, const Complex* coefficients) {
  places_.clear();
  const int count = angles_->count();
  const double width = 2.0 * pi / count;
  for (int i = 0; i <= count; ++i) {
    const int at = i % count;
    if (i > 0 && rate_[i - 1] * rate_[at] < 0.0) {
      double low = width * (i - 1), high = width * i;
      double angle = low + width * rate_[i - 1] / (rate_[i - 1] - rate_[at]);
      Place turn;
      for (int iteration = 0; iteration < 50; ++iteration) {
        turn.unit_vector = unit(angle);
        const SeriesValue value = evaluate(orders, coefficients, turn.unit_vector);
        turn.point.u = value.value;
        ((value.first > 0.0) == (rate_[i - 1] > 0.0) ? low : high) = angle;
        double next = angle - value.first / value.second;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        const double step = std::abs(next - angle);
        angle = next;
        if (step <= 1e-9 * width) break;  // u is flat there: to round-off
      }
      turn.point.t = angle / angular_frequency_;
      turn.point.normal = normal_;
      places_.push_back(turn);
    }
    Place sample;
    sample.point = {u_[at], rate_[at], width * i / angular_frequency_, model::Side::left, normal_};
    sample.unit_vector = angles_->unit_vector(at);
    sample.sample = at;
    places_.push_back(sample);
  }
}

void LawBySamples::march(const Vector& start, Vector& end) {
  now_ = start;
  length_ = start.cwiseAbs();
  for (std::size_t i = 1; i < places_.size(); ++i) {
    model::LawPoint from = places_[i - 1].point;
    from.side = model::Side::right;
    const model::LawAnswer answer = law_.advance(from, now_.data(), places_[i].point, next_.data());
    std::swap(now_, next_);
    length_ = length_.cwiseMax(now_.cwiseAbs());
    const int sample = places_[i].sample;
    if (sample < 0) continue;
    f_[sample] = answer.force;
    by_u_[sample] = answer.by_u;
    by_rate_[sample] = answer.by_rate;
  }
  end = now_;
}

void LawBySamples::close() {
  Vector start = Vector::Zero(memory_);
  const Vector rest = start;
  model::LawPoint origin;
  origin.t = places_.front().point.t;
  origin.normal = normal_;
  law_.advance(origin, rest.data(), places_.front().point, start.data());
  has_closed_ = Closing::close(
      std::move(start), length_, least_forgotten_, [&](const Vector& from, Vector& end) { march(from, end); },
      [&](const Vector& from) { return carry(from); }, started_);
}

void LawBySamples::find_forces() {
  largest_force_ = f_.cwiseAbs().maxCoeff();
  const std::vector<Complex>& series = angles_->analyse(f_.data());
  mean_force_ = 0.5 * series[0].real();
  force_.resize(orders_.count);
  for (int i = 0; i < orders_.count; ++i) force_[i] = series[static_cast<std::size_t>(orders_.at(i))];
}

double LawBySamples::asymmetry() const {
  const Index half = f_.size() / 2;
  return (f_.head(half) + f_.tail(half)).cwiseAbs().maxCoeff();
}

double LawBySamples::force_at(double angle) const {
  const double turns = angle / (2.0 * pi), at = (turns - std::floor(turns)) * angles_->count();
  const int i = std::min(static_cast<int>(at), angles_->count() - 1), j = (i + 1) % angles_->count();
  const double share = at - i;
  return (1.0 - share) * f_[i] + share * f_[j];
}

double LawBySamples::dissipated() const {
  Vector now, next(memory_);
  double sum = 0.0;
  if (memory_ > 0) {
    now = started_.back();
    for (std::size_t i = 1; i < places_.size(); ++i) {
      law_.advance(places_[i - 1].point, now.data(), places_[i].point, next.data());
      sum += law_.dissipated(places_[i - 1].point, now.data(), places_[i].point, next.data());
      std::swap(now, next);
    }
    return sum;
  }
  const double width = 2.0 * pi / (angles_->count() * angular_frequency_);
  const auto point = [&](int i) {
    return model::LawPoint{u_[i % angles_->count()], rate_[i % angles_->count()], width * i, model::Side::left,
                           normal_};
  };
  for (int i = 0; i < angles_->count(); ++i) sum += law_.dissipated(point(i), nullptr, point(i + 1), nullptr);
  return sum;
}

// In slopes_, a column a quantity. A change of u makes no turn: it shortens the step, or lengthens one that is too
// short. At the end of a step that just reaches a limit of the law the shorter one is that before the limit.
void LawBySamples::step_slopes(const model::LawPoint& from, const double* memory, const model::LawPoint& to) {
  slopes_.setZero();
  if (own_slopes_) {
    own_slopes_->slopes(from, memory, to, slopes_.data());
    return;
  }
  const model::LawAnswer base = law_.advance(from, memory, to, next_.data());
  const double travel = to.u - from.u, far = difference * std::max(u_scale_, std::abs(to.u));
  const double forwards = travel < 0.0 || (travel == 0.0 && to.rate < 0.0) ? -1.0 : 1.0;
  const double way = std::abs(travel) > 2.0 * far ? -forwards : forwards;
  const auto differ = [&](Index row, const model::LawPoint& begin, const double* past, const model::LawPoint& end,
                          double by) {
    const model::LawAnswer there = law_.advance(begin, past, end, memory_there_.data());
    slopes_(row, 0) = (there.force - base.force) / by;
    for (Index i = 0; i < memory_; ++i) slopes_(row, 1 + i) = (memory_there_[i] - next_[i]) / by;
  };
  if (far > 0.0) {
    model::LawPoint moved = to;
    moved.u += way * far;
    differ(0, from, memory, moved, moved.u - to.u);
    moved = from;
    moved.u -= way * far;
    differ(2, moved, memory, to, moved.u - from.u);
    if (law_.depends_on_rate()) {
      const double faster = angular_frequency_ * far;
      moved = to;
      moved.rate += faster;
      differ(1, from, memory, moved, moved.rate - to.rate);
      moved = from;
      moved.rate += faster;
      differ(3, moved, memory, to, moved.rate - from.rate);
    }
  }
  slopes_(0, 0) = base.by_u;
  slopes_(1, 0) = base.by_rate;
  perturbed_ = Eigen::Map<const Vector>(memory, memory_);
  for (Index i = 0; i < memory_; ++i) {
    const double before = perturbed_[i];
    perturbed_[i] += difference * (length_[i] > 0.0 ? length_[i] : std::max(u_scale_, 1e-300));
    differ(4 + i, from, perturbed_.data(), to, perturbed_[i] - before);
    perturbed_[i] = before;
  }
}

Matrix LawBySamples::carry(const Vector& start) {
  Matrix by_start = Matrix::Identity(memory_, memory_);
  Vector now = start, next(memory_);
  for (std::size_t i = 1; i < places_.size(); ++i) {
    const model::LawPoint &from = places_[i - 1].point, &to = places_[i].point;
    step_slopes(from, now.data(), to);
    by_start = (slopes_.bottomRightCorner(memory_, memory_).transpose() * by_start).eval();
    law_.advance(from, now.data(), to, next.data());
    std::swap(now, next);
  }
  return by_start;
}

void LawBySamples::set_motion(const Place& place, Vector& of_u, Vector& of_rate) const {
  of_u[0] = 1.0;
  of_rate[0] = 0.0;
  const bool is_turn = place.sample < 0;
  const Complex factor = orders_.stride == 1 ? place.unit_vector : product(place.unit_vector, place.unit_vector);
  Complex z = place.unit_vector;
  for (int o = 0; o < orders_.count; ++o) {
    if (!is_turn) z = angles_->unit_vector(static_cast<long>(orders_.at(o)) * place.sample);
    const double cosine = z.real(), sine = z.imag();
    const double number = is_turn ? 0.0 : angular_frequency_ * orders_.at(o);  // a turn has no rate
    of_u[1 + 2 * o] = cosine;
    of_u[2 + 2 * o] = -sine;
    of_rate[1 + 2 * o] = -number * sine;
    of_rate[2 + 2 * o] = -number * cosine;
    if (is_turn) z = product(z, factor);
  }
}

void LawBySamples::carry(const Vector& start, Matrix& of_memory, bool forces) {
  const Index unknowns = 1 + 2 * orders_.count;
  Vector u0(unknowns), rate0(unknowns), u1(unknowns), rate1(unknowns), now = start, next(memory_);
  set_motion(places_.front(), u0, rate0);
  const bool has_rates = law_.depends_on_rate();
  Matrix moved(unknowns, memory_);
  for (std::size_t i = 1; i < places_.size(); ++i) {
    const model::LawPoint &from = places_[i - 1].point, &to = places_[i].point;
    set_motion(places_[i], u1, rate1);
    step_slopes(from, now.data(), to);
    for (Index row = forces && places_[i].sample >= 0 ? -1 : 0; row < memory_; ++row) {
      const auto s = slopes_.col(row + 1);
      Vector sum = s[0] * u1 + s[2] * u0 + of_memory * s.tail(memory_);
      if (has_rates) sum += s[1] * rate1 + s[3] * rate0;
      if (row < 0)
        of_forces_.row(places_[i].sample) = sum.transpose();
      else
        moved.col(row) = sum;
    }
    std::swap(of_memory, moved);
    law_.advance(from, now.data(), to, next.data());
    std::swap(now, next);
    std::swap(u0, u1);
    std::swap(rate0, rate1);
  }
}

void LawBySamples::differentiate() {
  if (memory_ == 0) {
    differentiate_without_memory();
    return;
  }
  const Index unknowns = 1 + 2 * orders_.count;
  of_forces_.resize(angles_->count(), unknowns);
  const Matrix by_start = carry(started_.back());
  Matrix of_memory = Matrix::Zero(unknowns, memory_);
  const double slowest = (Matrix::Identity(memory_, memory_) - by_start).jacobiSvd().singularValues().minCoeff();
  if (slowest <= least_forgotten_) {
    // What is never forgotten has its derivatives from the first periods.
    Vector of_u(unknowns), of_rate(unknowns);
    set_motion(places_.front(), of_u, of_rate);
    const Vector rest = Vector::Zero(memory_);
    model::LawPoint origin;
    origin.normal = normal_;
    step_slopes(origin, rest.data(), places_.front().point);
    for (Index row = 0; row < memory_; ++row)
      of_memory.col(row) = slopes_(0, row + 1) * of_u + slopes_(1, row + 1) * of_rate;
    for (std::size_t period = 0; period + 1 < started_.size(); ++period) carry(started_[period], of_memory, false);
  }
  Matrix after = of_memory;
  carry(started_.back(), after, false);
  of_memory += Closing::solve(by_start, (after - of_memory).transpose(), least_forgotten_).transpose();
  carry(started_.back(), of_memory, true);
  find_derivatives_of_forces();
}

void LawBySamples::find_derivatives_of_forces() {
  mean_by_.resize(of_forces_.cols());
  by_.resize(orders_.count, of_forces_.cols());
  for (Index c = 0; c < of_forces_.cols(); ++c) {
    const std::vector<Complex>& series = angles_->analyse(of_forces_.col(c).data());
    mean_by_[c] = 0.5 * series[0].real();
    for (int i = 0; i < orders_.count; ++i) by_(i, c) = series[static_cast<std::size_t>(orders_.at(i))];
  }
}

// Of a force that follows from u and its rate at once: with the Fourier coefficients S of its slope,
//   dF_k = (S_(k-l) + S_(k+l))/2 by the real and i (S_(k-l) - S_(k+l))/2 by the imaginary part of U_l.
void LawBySamples::differentiate_without_memory() {
  const bool has_rates = law_.depends_on_rate();
  const std::vector<Complex> s = angles_->analyse(by_u_.data());
  std::vector<Complex> r;
  if (has_rates) r = angles_->analyse(by_rate_.data());
  const auto at = [](const std::vector<Complex>& x, int p) {
    const Complex value = x[static_cast<std::size_t>(std::abs(p))];
    return p < 0 ? std::conj(value) : value;
  };
  by_.resize(orders_.count, 1 + 2 * orders_.count);
  mean_by_.resize(by_.cols());
  mean_by_[0] = 0.5 * s.front().real();
  for (int i = 0; i < orders_.count; ++i) {
    const int k = orders_.at(i);
    by_(i, 0) = at(s, k);
    mean_by_[1 + 2 * i] = 0.5 * at(s, k).real();
    mean_by_[2 + 2 * i] = 0.5 * at(s, k).imag();
    if (has_rates) {
      mean_by_[1 + 2 * i] += 0.5 * k * angular_frequency_ * at(r, k).imag();
      mean_by_[2 + 2 * i] -= 0.5 * k * angular_frequency_ * at(r, k).real();
    }
    for (int j = 0; j < orders_.count; ++j) {
      const int l = orders_.at(j);
      const Complex down = at(s, k - l), up = at(s, k + l), turned = 0.5 * (down - up);
      by_(i, 1 + 2 * j) = 0.5 * (down + up);
      by_(i, 2 + 2 * j) = Complex(-turned.imag(), turned.real());
      if (!has_rates) continue;
      const Complex slower = at(r, k - l), faster = at(r, k + l), half = 0.5 * (slower - faster);
      const double number = l * angular_frequency_;
      by_(i, 1 + 2 * j) += number * Complex(-half.imag(), half.real());
      by_(i, 2 + 2 * j) -= number * 0.5 * (slower + faster);
    }
  }
}

}  // namespace rubato::steady
