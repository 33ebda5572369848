#include <rubato/steady/harmonic_balance/group_derivatives.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::steady {
namespace {

// Slopes that are differences are alike to half of the digits.
constexpr double alike = 1e-6;

}  // namespace

void GroupDerivatives::prepare(SampleAngles& angles, double angular_frequency) {
  angles_ = &angles;
  angular_frequency_ = angular_frequency;
  shift_.setZero(memory_, d_);
  of_memory_.setZero(memory_, d_ * unknowns() + memory_);
}

// Of what sticks anywhere: by how much its memory follows the displacements.
void GroupDerivatives::find_shift(const Matrix& steps) {
  const Index rows = step_rows(), count = steps.rows() / rows;
  Matrix shift = Matrix::Zero(memory_, d_);
  for (Index r = 0; r < memory_; ++r)
    for (Index i = 0; i < count; ++i) {
      const auto of = steps.col(d_ + r).segment(i * rows, rows);
      const auto own = of.tail(memory_);
      if (std::abs(own[r] - 1.0) > alike || own.cwiseAbs().sum() > 1.0 + 2.0 * alike) continue;
      const auto end = of.head(d_), start = of.segment(2 * d_, d_);
      if ((end + start).cwiseAbs().maxCoeff() > alike * end.cwiseAbs().maxCoeff()) continue;
      shift.row(r) = end.transpose();
      break;
    }
  // The memory so far was told with the shift so far.
  for (Index r = 0; r < memory_; ++r)
    for (Index j = 0; j < d_; ++j)
      if (const double change = shift_(r, j) - shift(r, j); change != 0.0) add_motion(0, j, change, 0.0, r, of_memory_);
  shift_ = shift;
}

GroupDerivatives::Kind GroupDerivatives::kind_of(const Matrix& steps, Index i) const {
  const Index rows = step_rows();
  const auto of = steps.block(i * rows, d_, rows, memory_);
  const auto own = of.bottomRows(memory_);
  if (own.cwiseAbs().maxCoeff() == 0.0) return Kind::forgets;
  if ((own - Matrix::Identity(memory_, memory_)).cwiseAbs().maxCoeff() > alike) return Kind::changes;
  const double size = shift_.size() > 0 ? alike * shift_.cwiseAbs().maxCoeff() : 0.0;
  const bool holds = (of.topRows(d_).transpose() - shift_).cwiseAbs().maxCoeff() <= size &&
                     (of.middleRows(2 * d_, d_).transpose() + shift_).cwiseAbs().maxCoeff() <= size &&
                     (!depends_on_rate_ || (of.middleRows(d_, d_).cwiseAbs().maxCoeff() == 0.0 &&
                                            of.middleRows(3 * d_, d_).cwiseAbs().maxCoeff() == 0.0));
  return holds ? Kind::holds : Kind::changes;
}

/// Adds slopes times how a displacement and its rate at a sample follow from the unknowns of their number.
void GroupDerivatives::add_motion(Index sample, Index number, double by_u, double by_rate, Index row,
                                  Matrix& of_memory) const {
  const Orders& orders = angles_->orders();
  const Index from = number * unknowns();
  of_memory(row, from) += by_u;
  for (int o = 0; o < orders.count; ++o) {
    const Complex z = angles_->unit_vector(static_cast<long>(orders.at(o)) * static_cast<long>(sample));
    const double number_of_waves = angular_frequency_ * orders.at(o);
    of_memory(row, from + 1 + 2 * o) += by_u * z.real() - by_rate * number_of_waves * z.imag();
    of_memory(row, from + 2 + 2 * o) -= by_u * z.imag() + by_rate * number_of_waves * z.real();
  }
}

/// From sample i to the next.
void GroupDerivatives::step(const Matrix& steps, Index i, Matrix& of_memory) {
  const Index rows = step_rows();
  const auto of = steps.block(i * rows, d_, rows, memory_);
  const Matrix own = of.bottomRows(memory_).transpose();
  now_.resize(memory_);
  for (Index c = 0; c < of_memory.cols(); ++c) {
    now_ = of_memory.col(c);
    for (Index r = 0; r < memory_; ++r) {
      double sum = 0.0;
      for (Index p = 0; p < memory_; ++p) sum += own(r, p) * now_[p];
      of_memory(r, c) = sum;
    }
  }
  const Matrix start = of.middleRows(2 * d_, d_).transpose() + own * shift_;
  for (Index r = 0; r < memory_; ++r)
    for (Index j = 0; j < d_; ++j) {
      const double end = of(j, r) - shift_(r, j);
      const double rate = depends_on_rate_ ? of(d_ + j, r) : 0.0,
                   start_rate = depends_on_rate_ ? of(3 * d_ + j, r) : 0.0;
      if (end != 0.0 || rate != 0.0) add_motion(i + 1, j, end, rate, r, of_memory);
      if (start(r, j) != 0.0 || start_rate != 0.0) add_motion(i, j, start(r, j), start_rate, r, of_memory);
    }
}

void GroupDerivatives::start_from_rest(const Matrix& step) {
  for (Index r = 0; r < memory_; ++r)
    for (Index j = 0; j < d_; ++j) add_motion(0, j, step(j, d_ + r), step(d_ + j, d_ + r), r, of_memory_);
}

void GroupDerivatives::carry(const Matrix& steps) {
  find_shift(steps);
  for (Index i = 0; i < steps.rows() / step_rows(); ++i)
    if (kind_of(steps, i) != Kind::holds) step(steps, i, of_memory_);
}

Matrix GroupDerivatives::by_start(const Matrix& steps) const {
  const Index rows = step_rows();
  Matrix product = Matrix::Identity(memory_, memory_);
  for (Index i = 0; i < steps.rows() / rows; ++i)
    product = (steps.block(i * rows + 4 * d_, d_, memory_, memory_).transpose() * product).eval();
  return product;
}

void GroupDerivatives::close(const Matrix& steps, double least) {
  const Orders& orders = angles_->orders();
  const Index size = d_ * unknowns();
  by_.resize(static_cast<std::size_t>(d_));
  for (ComplexMatrix& by : by_) by.setZero(orders.count, size);
  mean_by_.setZero(size, d_);
  if (memory_ > 0) {
    find_shift(steps);
    // From a start that changes by itself, behind what is known of it.
    Matrix start = Matrix::Zero(memory_, size + memory_);
    start.rightCols(memory_).setIdentity();
    // So many different S: more cost more than analysing the forces sample by sample.
    const Index count = steps.rows() / step_rows();
    Index changes = 0;
    for (Index i = 0; i < count; ++i) changes += kind_of(steps, i) == Kind::changes ? 1 : 0;
    const double wide = static_cast<double>(orders.count) * static_cast<double>(memory_ * changes);
    const bool by_pieces = wide < 4.0 * static_cast<double>(count);
    are_samples_ = !by_pieces;
    const Matrix end = by_pieces ? take_pieces(steps, std::move(start)) : take_samples(steps, std::move(start));
    const Matrix own = end.rightCols(memory_), before = of_memory_.leftCols(size);
    const Matrix after = end.leftCols(size) + own * before;
    of_memory_.leftCols(size) = before + Closing::solve(own, after - before, least);
    add_memory();
  }
  add_direct_slopes(steps);
}

/// What the memory does in the forces, by the S that there are.
Matrix GroupDerivatives::take_pieces(const Matrix& steps, Matrix of_memory) {
  const Orders& orders = angles_->orders();
  const Index rows = step_rows(), count = steps.rows() / rows;
  const double share = 2.0 / static_cast<double>(count);
  Index used = 0, forgotten = -1;  // pieces; the step whose S is not yet formed
  bool is_new = true;
  weights_.resize(static_cast<std::size_t>(d_));
  const auto make = [&] {
    if (forgotten < 0) return;
    of_memory.setZero();
    step(steps, forgotten, of_memory);
    forgotten = -1;
  };
  for (Index i = 0; i < count; ++i) {
    const auto in_force = steps.block(i * rows + 4 * d_, 0, memory_, d_);
    if ((in_force.array() != 0.0).any()) {
      if (is_new) {
        make();
        const Index room = (used + 1) * memory_;
        if (pieces_.rows() < room || pieces_.cols() != of_memory.cols())
          pieces_.conservativeResize(std::max(2 * room, pieces_.rows()), of_memory.cols());
        pieces_.middleRows(used * memory_, memory_) = of_memory;
        for (ComplexMatrix& weights : weights_) {
          if (weights.cols() < room || weights.rows() != 1 + orders.count)
            weights.conservativeResize(1 + orders.count, std::max(2 * room, weights.cols()));
          weights.middleCols(used * memory_, memory_).setZero();
        }
        ++used;
        is_new = false;
      }
      const long sample = static_cast<long>((i + 1) % count);
      for (Index q = 0; q < d_; ++q)
        for (Index r = 0; r < memory_; ++r) {
          const double slope = share * in_force(r, q);
          if (slope == 0.0) continue;
          auto weight = weights_[static_cast<std::size_t>(q)].col((used - 1) * memory_ + r);
          weight[0] += 0.5 * slope;
          for (int k = 0; k < orders.count; ++k)
            weight[1 + k] += slope * std::conj(angles_->unit_vector(orders.at(k) * sample));
        }
    }
    switch (kind_of(steps, i)) {
      case Kind::holds:
        break;
      case Kind::forgets:
        forgotten = i;
        is_new = true;
        break;
      case Kind::changes:
        make();
        step(steps, i, of_memory);
        is_new = true;
        break;
    }
  }
  make();
  pieces_.conservativeResize(used * memory_, of_memory.cols());
  for (ComplexMatrix& weights : weights_) weights.conservativeResize(1 + orders.count, used * memory_);
  return of_memory;
}

/// As take_pieces(), where S is another at every sample: its share in the forces is analysed, and told as the weights
/// of unit vectors.
Matrix GroupDerivatives::take_samples(const Matrix& steps, Matrix of_memory) {
  const Orders& orders = angles_->orders();
  const Index rows = step_rows(), count = steps.rows() / rows, columns = of_memory.cols();
  std::vector<Matrix> of_forces(static_cast<std::size_t>(d_), Matrix(count, columns));
  // A few samples at a time: a column of so many is far away in memory from the next.
  constexpr Index most = 16;
  std::vector<Matrix> several(static_cast<std::size_t>(d_), Matrix(columns, most));
  for (Index from = 0; from < count; from += most) {
    const Index taken = std::min(most, count - from);
    for (Index i = from; i < from + taken; ++i) {
      for (Index q = 0; q < d_; ++q) {
        const auto in_force = steps.col(q).segment(i * rows + 4 * d_, memory_);
        auto here = several[static_cast<std::size_t>(q)].col(i - from);
        for (Index c = 0; c < columns; ++c) {
          double sum = 0.0;
          for (Index r = 0; r < memory_; ++r) sum += in_force[r] * of_memory(r, c);
          here[c] = sum;
        }
      }
      if (kind_of(steps, i) != Kind::holds) step(steps, i, of_memory);
    }
    for (Index q = 0; q < d_; ++q)
      of_forces[static_cast<std::size_t>(q)].middleRows(from, taken) =
          several[static_cast<std::size_t>(q)].leftCols(taken).transpose();
  }
  // The force of a step is that at the sample behind it.
  for (Matrix& of_force : of_forces)
    for (Index c = 0; c < columns; ++c) {
      auto column = of_force.col(c);
      std::rotate(column.data(), column.data() + count - 1, column.data() + count);
    }
  weights_.assign(static_cast<std::size_t>(d_), ComplexMatrix(1 + orders.count, columns));
  for (Index q = 0; q < d_; ++q)
    for (Index c = 0; c < columns; ++c) {
      const std::vector<Complex>& spectrum = angles_->analyse(of_forces[static_cast<std::size_t>(q)].col(c).data());
      auto weight = weights_[static_cast<std::size_t>(q)].col(c);
      weight[0] = 0.5 * spectrum[0].real();
      for (int k = 0; k < orders.count; ++k) weight[1 + k] = spectrum[static_cast<std::size_t>(orders.at(k))];
    }
  return of_memory;
}

/// Once the S at the start of the period is known.
void GroupDerivatives::add_memory() {
  const Index size = d_ * unknowns();
  const auto known = of_memory_.leftCols(size);
  Matrix pieces;
  if (!are_samples_) pieces = pieces_.leftCols(size) + pieces_.rightCols(memory_) * known;
  for (Index q = 0; q < d_; ++q) {
    const ComplexMatrix& weights = weights_[static_cast<std::size_t>(q)];
    const ComplexMatrix all = are_samples_ ? ComplexMatrix(weights.leftCols(size) + weights.rightCols(memory_) * known)
                                           : ComplexMatrix(weights * pieces);
    by_[static_cast<std::size_t>(q)] += all.bottomRows(all.rows() - 1);
    mean_by_.col(q) += all.row(0).real().transpose();
  }
}

void GroupDerivatives::add_direct_slopes(const Matrix& steps) {
  for (Index i = 0; i < d_; ++i)
    for (Index j = 0; j < d_; ++j) add_direct_slopes(steps, i, j);
}

/// Of force i by the displacement and the rate of number j, at the sample itself and at the one before.
void GroupDerivatives::add_direct_slopes(const Matrix& steps, Index i, Index j) {
  const Orders& orders = angles_->orders();
  const Index rows = step_rows(), count = steps.rows() / rows, from = j * unknowns();
  const int quantities = depends_on_rate_ ? 2 : 1;
  std::vector<Complex> end[2], start[2];
  bool are_any = false;
  samples_.resize(static_cast<std::size_t>(count));
  const auto analyse = [&](auto&& slope, std::vector<Complex>& spectrum) {
    bool is_zero = true;
    for (Index s = 0; s < count; ++s) {
      const double value = slope(s);
      samples_[static_cast<std::size_t>((s + 1) % count)] = value;
      is_zero = is_zero && value == 0.0;
    }
    spectrum.clear();
    if (!is_zero) spectrum = angles_->analyse(samples_.data());
    are_any = are_any || !is_zero;
  };
  for (int of = 0; of < quantities; ++of) {
    analyse([&](Index s) { return steps(s * rows + of * d_ + j, i); }, end[of]);
    analyse(
        [&](Index s) {
          double slope = steps(s * rows + (2 + of) * d_ + j, i);
          if (of == 0)
            for (Index r = 0; r < memory_; ++r) slope += steps(s * rows + 4 * d_ + r, i) * shift_(r, j);
          return slope;
        },
        start[of]);
  }
  if (!are_any) return;
  const auto at = [count](const std::vector<Complex>& spectrum, long k) -> Complex {
    if (spectrum.empty()) return 0.0;
    k %= static_cast<long>(count);
    if (k < 0) k += static_cast<long>(count);
    return 2 * k <= static_cast<long>(count) ? spectrum[static_cast<std::size_t>(k)]
                                             : std::conj(spectrum[static_cast<std::size_t>(count - k)]);
  };
  ComplexMatrix& by = by_[static_cast<std::size_t>(i)];
  for (int a = -1; a < orders.count; ++a) {  // -1: the mean of the force
    const long k = a < 0 ? 0 : orders.at(a);
    const auto put = [&](Index column, Complex value) {
      if (a < 0)
        mean_by_(column, i) += 0.5 * value.real();
      else
        by(a, column) += value;
    };
    put(from, at(end[0], k) + at(start[0], k));
    for (int o = 0; o < orders.count; ++o) {
      const long l = orders.at(o);
      const Complex turned = angles_->unit_vector(l);  // from the sample before
      const auto less = [&](int of) { return at(end[of], k - l) + product(std::conj(turned), at(start[of], k - l)); };
      const auto more = [&](int of) { return at(end[of], k + l) + product(turned, at(start[of], k + l)); };
      const Complex minus = less(0), plus = more(0);
      Complex by_real = 0.5 * (minus + plus), by_imaginary = product(Complex(0.0, 0.5), minus - plus);
      if (depends_on_rate_) {
        const double waves = angular_frequency_ * static_cast<double>(l);
        const Complex rate_minus = less(1), rate_plus = more(1);
        by_real += product(Complex(0.0, 0.5 * waves), rate_minus - rate_plus);
        by_imaginary -= 0.5 * waves * (rate_minus + rate_plus);
      }
      put(from + 1 + 2 * o, by_real);
      put(from + 2 + 2 * o, by_imaginary);
    }
  }
}

}  // namespace rubato::steady
