#include <rubato/core/stopping.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance_equations.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::steady {
namespace {

// Unknowns from which products beat factorisations: of 760 unknowns one takes 35 ms, a preconditioned product 0.6 ms.
constexpr Index large_size = 100;
constexpr int most_products = 25;
constexpr double farthest_mean = 1e3;      // over the other displacements
constexpr double newton_tolerance = 1e-6;  // of a step: the next one is as small beside it

}  // namespace

void SliderSeries::resize(const Orders& new_orders, bool with_mean, Index sliders) {
  const ComplexMatrix before = std::move(coefficients);
  const Orders old = orders;
  coefficients = ComplexMatrix::Zero(new_orders.count, sliders);
  for (int i = 0; i < new_orders.count; ++i) {
    const int k = new_orders.at(i);
    if (k <= old.highest() && (k - 1) % old.stride == 0 && before.cols() == sliders)
      coefficients.row(i) = before.row((k - 1) / old.stride);
  }
  if (mean.size() != sliders || !with_mean) mean = Vector::Zero(sliders);
  orders = new_orders;
  has_mean = with_mean;
}

void HarmonicBalanceEquations::join(const std::vector<CondensedHarmonic>& harmonics, const Vector& added) {
  harmonics_ = &harmonics;
  added_ = added;
  const Index m = stiffness_.size();
  effective_.resize(m);
  for (Index j = 0; j < m; ++j) effective_[j] = stiffness_[j] / (1.0 + added[j] * stiffness_[j]);
  joined_.resize(harmonics.size());
  for (std::size_t place = 0; place < harmonics.size(); ++place) {
    if (harmonics[place].receptance.rows() < m) continue;  // order zero, where there is no mean
    joined_[place] = harmonics[place].receptance.topLeftCorner(m, m);
    for (Index j = 0; j < m; ++j) joined_[place](j, j) -= added[j] / part(place, j);
  }
}

void HarmonicBalanceEquations::set(const Vector& limits, const Vector& offsets) {
  limits_ = limits;
  offsets_ = offsets;
  active_.clear();
  // A slider without a limit has no force, but where its spring is held in Z its displacement must be known.
  const bool is_held = std::any_of(harmonics_->begin(), harmonics_->end(), [](const auto& h) { return h.held > 0.0; });
  for (Index j = 0; j < limits.size(); ++j)
    if (limits[j] > 0.0 || is_held) active_.push_back(j);
  position_.assign(static_cast<std::size_t>(limits.size()), -1);
  for (std::size_t a = 0; a < active_.size(); ++a)
    position_[static_cast<std::size_t>(active_[a])] = static_cast<Index>(a);
}

SliderSeries HarmonicBalanceEquations::balanced(const SliderSeries& displacement, const SliderSeries& force) const {
  SliderSeries series = displacement;
  series.mean += added_.cwiseProduct(force.mean);
  series.coefficients += force.coefficients * added_.asDiagonal();
  return series;
}

void HarmonicBalanceEquations::displacement_and_force(const SliderSeries& balanced, SliderSeries& displacement,
                                                      SliderSeries& force) const {
  force = balanced;
  force.mean.setZero();
  force.coefficients.setZero();
  for (const Index j : active_) {
    if (balanced.has_mean) force.mean[j] = mean_force_of(j);
    for (int i = 0; i < balanced.orders.count; ++i) force.coefficients(i, j) = force_of(j, balanced.orders.at(i));
  }
  displacement = balanced;
  displacement.mean -= added_.cwiseProduct(force.mean);
  displacement.coefficients -= force.coefficients * added_.asDiagonal();
}

bool HarmonicBalanceEquations::any_slips() const {
  return std::any_of(active_.begin(), active_.end(),
                     [&](Index j) { return j >= sliders_ || loops_[static_cast<std::size_t>(j)].slips(); });
}

double HarmonicBalanceEquations::evaluate(const SliderSeries& series) {
  const int count = series.orders.count;
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  const auto& harmonics = *harmonics_;
  force_.resize(count, stiffness_.size());
  mean_force_.resize(stiffness_.size());
  displacement_ = linear_ = 0.0;
  double mean = 0.0;
  if (has_laws() && !is_extended_) coarse_angles_.prepare(samples_, series.orders);
  for (const Index j : active_) {
    const Complex* const u = series.coefficients.data() + j * count;
    pass(j, series);
    if (j >= sliders_ && !std::isfinite(mean_force_of(j))) return HUGE_VAL;
    for (int i = 0; i < count; ++i) {
      const auto place = static_cast<std::size_t>(i) + 1;
      const Complex force = shared(j, force_of(j, series.orders.at(i)), stiffness_[j] * u[i]);
      force_(i, j) = part(place, j) * force - held(place, j) * u[i];
      displacement_ = std::max(displacement_, std::abs(u[i].real()) + std::abs(u[i].imag()));
    }
    if (series.has_mean) {
      const double force = shared(j, mean_force_of(j), stiffness_[j] * series.mean[j]);
      mean_force_[j] = part(0, j) * force - held(0, j) * series.mean[j];
      mean = std::max(mean, std::abs(series.mean[j]));
    }
  }
  residual_.resize(rows * static_cast<Index>(active_.size()));
  for (std::size_t a = 0; a < active_.size(); ++a) {
    const Index row = active_[a], base = static_cast<Index>(a) * rows;
    if (series.has_mean) {
      const double linear = load_factor_ * harmonics[0].linear[row].real();
      double sum = series.mean[row] / part(0, row) - linear;
      linear_ = std::max(linear_, std::abs(linear));
      for (const Index j : active_) sum += joined_[0](row, j).real() * mean_force_[j];
      residual_[base] = sum;
    }
    for (int i = 0; i < count; ++i) {
      const auto place = static_cast<std::size_t>(i) + 1;
      const Complex linear = load_factor_ * harmonics[place].linear[row];
      linear_ = std::max(linear_, std::abs(linear.real()) + std::abs(linear.imag()));
      Complex sum = series.coefficients(i, row) / part(place, row) - linear;
      for (const Index j : active_) sum += product(joined_[place](row, j), force_(i, j));
      residual_[base + shift + 2 * i] = sum.real();
      residual_[base + shift + 2 * i + 1] = sum.imag();
    }
  }
  // A mean that runs away, where friction cannot hold a constant load, is no measure of what is left of it.
  displacement_ = std::max(displacement_, std::min(mean, farthest_mean * std::max(displacement_, linear_)));
  if (left_part_ > 0.0) residual_ -= left_part_ * left_;
  return residual_.size() == 0 ? 0.0 : residual_.cwiseAbs().maxCoeff();
}

void HarmonicBalanceEquations::keep_residual(const SliderSeries& series) {
  left_part_ = 0.0;
  evaluate(series);
  left_ = residual_;
}

void HarmonicBalanceEquations::fill_diagonal(const SliderSeries& series, Vector& diagonal) const {
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  diagonal.resize(rows * static_cast<Index>(active_.size()));
  for (std::size_t a = 0; a < active_.size(); ++a) {
    const Index j = active_[a], base = static_cast<Index>(a) * rows;
    if (series.has_mean) diagonal[base] = 1.0 / part(0, j);
    for (int i = 0; i < series.orders.count; ++i)
      diagonal.segment(base + shift + 2 * i, 2).setConstant(1.0 / part(static_cast<std::size_t>(i) + 1, j));
  }
}

void HarmonicBalanceEquations::fill_jacobian(const SliderSeries& series, Matrix& jacobian) const {
  const int count = series.orders.count;
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  const Index size = rows * static_cast<Index>(active_.size());
  jacobian.setZero(size, size);
  jacobian.diagonal() = diagonal_;
  for (std::size_t b = 0; b < active_.size(); ++b) {
    const Index from = static_cast<Index>(b) * rows;
    const std::span<const Index> others = partners(active_[b]);
    for (std::size_t a = 0; a < active_.size(); ++a) {
      const Index row = active_[a], base = static_cast<Index>(a) * rows;
      for (Index c = from; c < from + rows; ++c) {
        double* const out = jacobian.data() + c * size + base;
        for (std::size_t p = 0; p < others.size(); ++p) {
          const Index o = others[p], first = static_cast<Index>(p) * count;
          if (series.has_mean) out[0] += joined_[0](row, o).real() * by_mean_(c, static_cast<Index>(p));
          for (int i = 0; i < count; ++i) {
            const Complex change = product(joined_[static_cast<std::size_t>(i) + 1](row, o), columns_(first + i, c));
            out[shift + 2 * i] += change.real();
            out[shift + 2 * i + 1] += change.imag();
          }
        }
      }
    }
  }
}

// y <- J x, first the forces of each slider, then what they move at each order.
void HarmonicBalanceEquations::multiply_by_jacobian(const SliderSeries& series, const Vector& x, Vector& y) {
  const int count = series.orders.count;
  const Index rows = rows_per_slider(series), shift = series.has_mean ? 1 : 0;
  const auto m = static_cast<Index>(active_.size());
  changed_force_.setZero(m, count);
  y = diagonal_.cwiseProduct(x);
  for (Index b = 0; b < m; ++b) {
    const auto own = x.segment(b * rows, rows);
    const std::span<const Index> others = partners(active_[static_cast<std::size_t>(b)]);
    for (std::size_t p = 0; p < others.size(); ++p) {
      const auto place = static_cast<Index>(p);
      changed_force_.row(position_[static_cast<std::size_t>(others[p])]).noalias() +=
          (columns_.block(place * count, b * rows, count, rows) * own).transpose();
      if (!series.has_mean) continue;
      const double mean_force = by_mean_.col(place).segment(b * rows, rows).dot(own);
      for (Index a = 0; a < m; ++a)
        y[a * rows] += joined_[0](active_[static_cast<std::size_t>(a)], others[p]).real() * mean_force;
    }
  }
  for (int i = 0; i < count; ++i) {
    const ComplexMatrix& receptance = joined_[static_cast<std::size_t>(i) + 1];
    for (Index a = 0; a < m; ++a) {
      Complex sum = 0.0;
      for (Index b = 0; b < m; ++b)
        sum += product(receptance(active_[static_cast<std::size_t>(a)], active_[static_cast<std::size_t>(b)]),
                       changed_force_(b, i));
      y[a * rows + shift + 2 * i] += sum.real();
      y[a * rows + shift + 2 * i + 1] += sum.imag();
    }
  }
}

bool HarmonicBalanceEquations::is_large(const SliderSeries& series) const {
  return rows_per_slider(series) * static_cast<Index>(active_.size()) >= large_size;
}

void HarmonicBalanceEquations::factorise(const SliderSeries& series) {
  fill_jacobian(series, factor_.matrix(rows_per_slider(series) * static_cast<Index>(active_.size())));
  is_regular_ = factor_.factorise() > 1e-13;
  has_factor_ = is_regular_;
  factor_active_ = active_;
  factor_orders_ = series.orders;
}

// x <- J^-1 x
void HarmonicBalanceEquations::solve_linear(const SliderSeries& series, double tolerance, Vector& x) {
  if (is_large(series)) {
    const bool fits = has_factor_ && factor_.size() == x.size() && factor_active_ == active_ &&
                      factor_orders_.count == series.orders.count && factor_orders_.stride == series.orders.stride;
    const auto multiply = [&](const Vector& direction, Vector& result) {
      preconditioned_ = direction;
      factor_.solve(preconditioned_);
      multiply_by_jacobian(series, preconditioned_, result);
    };
    if (fits && gmres_.solve(x, tolerance, most_products, multiply, product_) >= 0) {
      x = product_;
      factor_.solve(x);
      return;
    }
    factorise(series);
  }
  if (is_regular_) {
    factor_.solve(x);
    return;
  }
  // A mean position that nothing determines: the least change.
  Matrix jacobian(x.size(), x.size());
  fill_jacobian(series, jacobian);
  solve_by_least_change(jacobian, x);
}

/// The balance as Newton's method sees it: the iterate is a series, and what is tried stands in trial_. Its size is the
/// largest residual.
struct HarmonicBalanceEquations::Iterates : numerics::NewtonProblem {
  Iterates(HarmonicBalanceEquations& of, SliderSeries& series_, double tolerance_)
      : eq(of), series(series_), tolerance(tolerance_) {}

  double evaluate(bool /*with_tangent*/) { return eq.evaluate(is_tried ? eq.trial_ : series); }

  bool is_solved(double residual) {
    // Round-off of the linear part bounds what can be reached.
    reachable = std::max(tolerance * eq.displacement_, 8e-15 * eq.linear_);
    relative = eq.displacement_ > 0.0 ? residual / eq.displacement_ : residual;
    if (!is_tried) {
      best = residual;
      eq.trial_ = eq.best_ = series;
    }
    return residual <= reachable;
  }

  bool factorise() {
    stop_if_asked();
    eq.differentiate(series);
    if (!eq.is_large(series)) eq.factorise(series);
    return true;
  }

  double correct() {
    eq.step_ = eq.residual_;
    eq.solve_linear(series, newton_tolerance, eq.step_);
    return eq.step_.allFinite() ? eq.step_.cwiseAbs().maxCoeff() : HUGE_VAL;
  }

  // Over the kinks of contacts the residual must be allowed to rise: a search for less of it loses solutions.
  bool is_lower(double residual, double before, double part) {
    constexpr double most_growth = 10.0;
    return eq.groups_.empty() ? NewtonProblem::is_lower(residual, before, part) : residual < most_growth * before;
  }

  void move(double part) {
    is_tried = true;
    const int count = series.orders.count;
    const Index rows = eq.rows_per_slider(series), shift = series.has_mean ? 1 : 0;
    const Vector& step = eq.step_;
    for (std::size_t a = 0; a < eq.active_.size(); ++a) {
      const Index j = eq.active_[a], base = static_cast<Index>(a) * rows;
      if (series.has_mean) eq.trial_.mean[j] = series.mean[j] - part * step[base];
      for (int i = 0; i < count; ++i)
        eq.trial_.coefficients(i, j) =
            series.coefficients(i, j) - part * Complex(step[base + shift + 2 * i], step[base + shift + 2 * i + 1]);
    }
  }

  void accept(double residual) {
    std::swap(series.mean, eq.trial_.mean);
    std::swap(series.coefficients, eq.trial_.coefficients);
    if (residual >= best) return;
    best = residual;
    eq.best_ = series;
  }

  HarmonicBalanceEquations& eq;
  SliderSeries& series;
  double tolerance;
  double best = 0.0, reachable = 0.0;
  double relative = 0.0;  // residual of the series over the displacements
  bool is_tried = false;
};

HarmonicBalanceEquations::Outcome HarmonicBalanceEquations::solve(SliderSeries& series, double tolerance,
                                                                  int most_iterations) {
  numerics::NewtonRules rules;
  rules.most_iterations = most_iterations;
  rules.most_halvings = 7;
  // Where a slider begins to slip twice, or a loop splits, the residual has a kink: Newton must be allowed to pass it
  // upwards.
  rules.memory = 4;
  Iterates iterates(*this, series, tolerance);
  const numerics::NewtonReport report = numerics::newton(iterates, rules);
  Outcome outcome{report.has_converged(), iterates.relative, report.iterations};
  if (report.outcome != numerics::NewtonOutcome::diverged) return outcome;
  // At the floor of round-off nothing gets better; the loops belong to the series again.
  if (iterates.best < report.residual) std::swap(series, best_);
  const double size = evaluate(series);
  outcome.residual = displacement_ > 0.0 ? size / displacement_ : size;
  outcome.has_converged = size <= 100.0 * iterates.reachable;
  return outcome;
}

}  // namespace rubato::steady
