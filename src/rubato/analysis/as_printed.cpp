#include <rubato/analysis/as_printed.hpp>
#include <rubato/analysis/method_study_plan.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>

#include <array>
#include <cmath>
#include <complex>
#include <functional>

namespace rubato::analysis {
namespace {

constexpr long steps = 30000;

using Oscillator = integrate::HarmonicOscillator;

double load(const Oscillator& o, double t) { return o.amplitude * std::cos(o.angular_frequency * t + o.phase); }

/// The closed-form response from rest.
class Response {
 public:
  explicit Response(const Oscillator& o) : o_(o) {
    const std::complex<double> i(0.0, 1.0);
    steady_ = o.amplitude * std::exp(i * o.phase) /
              (o.stiffness - o.mass * o.angular_frequency * o.angular_frequency + i * o.damping * o.angular_frequency);
    decay_ = 0.5 * o.damping / o.mass;
    turn_ = std::sqrt(o.stiffness / o.mass - decay_ * decay_);
    a_ = -steady_.real();
    b_ = (o.angular_frequency * steady_.imag() + decay_ * a_) / turn_;
  }
  double operator()(double t) const {
    return std::exp(-decay_ * t) * (a_ * std::cos(turn_ * t) + b_ * std::sin(turn_ * t)) +
           steady_.real() * std::cos(o_.angular_frequency * t) - steady_.imag() * std::sin(o_.angular_frequency * t);
  }

 private:
  Oscillator o_;
  std::complex<double> steady_;
  double decay_, turn_, a_, b_;
};

Oscillator oscillator_of(const integrate::SystemKind& kind) {
  const auto o = kind.oscillator();
  if (!o) throw InvalidInput("as_printed is for one coordinate from rest under one harmonic load, without sliders");
  if (!(o->damping * o->damping < 4.0 * o->stiffness * o->mass))
    throw InvalidInput("as_printed is for an underdamped coordinate");
  return *o;
}

/// Collects E_j of one run.
class Errors {
 public:
  Errors(const Response& response, double step) : response_(response), step_(step) {}
  void add(double x) {
    ++j_;
    const double exact = response_(static_cast<double>(j_) * step_), error = std::abs(x - exact) / std::abs(exact);
    if (j_ == 1) first_ = error;
    if (j_ == 2) second_ = error;
    sum_ += error;
    last_ = error;
  }
  double first() const { return first_; }
  double second() const { return second_; }
  double indicator() const { return sum_ / static_cast<double>(steps + 1); }
  double indicator_without_the_last() const { return (sum_ - last_ + 1.0) / static_cast<double>(steps + 1); }

 private:
  const Response& response_;
  double step_, first_ = 0.0, second_ = 0.0, sum_ = 0.0, last_ = 0.0;
  long j_ = 0;
};

using Pair = std::array<double, 2>;

Pair slope(const Oscillator& o, double force, const Pair& y) {
  return {y[1], (force - o.damping * y[1] - o.stiffness * y[0]) / o.mass};
}
Pair along(const Pair& y, double h, const Pair& k) { return {y[0] + h * k[0], y[1] + h * k[1]}; }

Errors march(const Response& response, double h, const std::function<Pair(long, const Pair&)>& step) {
  Errors errors(response, h);
  Pair y{0.0, 0.0};
  for (long j = 0; j < steps; ++j) {
    y = step(j, y);
    errors.add(y[0]);
  }
  return errors;
}

// The load half a step before t_j where half a step after it was meant.
double half_step_load(const Oscillator& o, long j, double h) {
  return load(o, j == 0 ? 0.0 : (static_cast<double>(j) - 0.5) * h);
}

PrintedRow euler(const Oscillator& o, const Response& response, double h) {
  const Errors errors = march(response, h, [&](long j, const Pair& y) {
    return along(y, h, slope(o, load(o, static_cast<double>(j) * h), y));
  });
  return {"Explicit Euler",
          "explicit_euler",
          "first step: the second; last sample missing",
          false,
          errors.second(),
          errors.indicator_without_the_last(),
          0.0,
          0.0};
}

PrintedRow runge_kutta_3(const Oscillator& o, const Response& response, double h) {
  const Errors errors = march(response, h, [&](long j, const Pair& y) {
    const Pair k1 = slope(o, load(o, static_cast<double>(j) * h), y);
    const Pair k2 = slope(o, half_step_load(o, j, h), along(y, 0.5 * h, k1));
    const Pair k3 = slope(o, load(o, static_cast<double>(j + 1) * h), along(along(y, -h, k1), 2.0 * h, k2));
    return along(along(along(y, h / 6.0, k1), 2.0 * h / 3.0, k2), h / 6.0, k3);
  });
  return {
      "Runge-Kutta 3", "rk3", "load of the half step at t - h/2", false, errors.first(), errors.indicator(), 0.0, 0.0};
}

PrintedRow runge_kutta_4(const Oscillator& o, const Response& response, double h) {
  const Errors errors = march(response, h, [&](long j, const Pair& y) {
    const double middle = half_step_load(o, j, h);
    const Pair k1 = slope(o, load(o, static_cast<double>(j) * h), y);
    const Pair k2 = slope(o, middle, along(y, 0.5 * h, k1));
    const Pair k3 = slope(o, middle, along(y, 0.5 * h, k2));
    const Pair k4 = slope(o, load(o, static_cast<double>(j + 1) * h), along(y, h, k3));
    return along(along(along(along(y, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
  });
  return {
      "Runge-Kutta 4", "rk4", "load of the half step at t - h/2", false, errors.first(), errors.indicator(), 0.0, 0.0};
}

class ErrorObserver final : public integrate::Observer {
 public:
  explicit ErrorObserver(Errors& errors) : errors_(errors) {}
  bool accepted(const system::State&, const system::State& after) override {
    errors_.add(after.q[0]);
    return true;
  }

 private:
  Errors& errors_;
};

Errors errors_of(const integrate::SystemKind& kind, const Response& response, double h,
                 const integrate::Method& method) {
  Errors errors(response, h);
  ErrorObserver observer(errors);
  const double end = static_cast<double>(steps) * h;
  const integrate::MarchPlan plan = march_plan_of(method, kind, h, end);
  (void)kind.marches().march(plan)->go_to(end, &observer, nullptr);
  return errors;
}

PrintedRow implicit_row(const integrate::SystemKind& kind, const Response& response, double h, PrintedRow row,
                        const integrate::Method& method) {
  const Errors errors = errors_of(kind, response, h, method);
  row.in_percent = true;
  row.first_step_error = 100.0 * errors.first();
  row.indicator = 100.0 * errors.indicator();
  return row;
}

}  // namespace

std::vector<PrintedRow> tables_as_printed(const integrate::SystemKind& kind, double step) {
  const Oscillator o = oscillator_of(kind);
  const Response response(o);
  std::vector<PrintedRow> rows{euler(o, response, step), runge_kutta_3(o, response, step),
                               runge_kutta_4(o, response, step)};
  struct Newmark {
    const char *title, *method, *convention;
    double beta, gamma;
  };
  const Newmark table[] = {
      {"Central difference", "central_difference", "", 0.0, 0.5},
      {"Fox-Goodwin", "fox_goodwin", "", 1.0 / 12.0, 0.5},
      {"Linear acceleration", "linear_acceleration", "", 1.0 / 6.0, 0.5},
      {"Trapezoid", "average_acceleration", "", 0.25, 0.5},
      {"Linear acceleration II", "linear_acceleration", "beta = 1/3, the 2 beta of the method; 1/4 is printed",
       1.0 / 3.0, 0.5},
      {"Constant mean acceleration", "average_acceleration", "beta = 1/2, the 2 beta of the method", 0.5, 0.5},
      {"Galerkin", "galerkin", "beta = 8/5, the 2 beta of the method", 1.6, 1.5},
      {"Backward difference", "backward_difference", "beta = 2, the 2 beta of the method", 2.0, 1.5},
      {"Damped Newmark", "damped_newmark", "", 0.3025, 0.6}};
  for (const Newmark& n : table)
    rows.push_back(implicit_row(kind, response, step, {n.title, n.method, n.convention, true},
                                {n.title, integrate::GeneralizedAlpha{0.0, 0.0, n.beta, n.gamma}}));
  rows.push_back(implicit_row(kind, response, step, {"Wilson-theta", "wilson_theta", "", true},
                              {"Wilson-theta", integrate::WilsonTheta{1.4}}));
  for (PrintedRow& row : rows) {
    const Errors errors = errors_of(kind, response, step, integrate::make_method(row.method));
    const double unit = row.in_percent ? 100.0 : 1.0;
    row.correct_first_step_error = unit * errors.first();
    row.correct_indicator = unit * errors.indicator();
  }
  return rows;
}

void require_model_as_printed(const integrate::SystemKind& kind) { (void)oscillator_of(kind); }

}  // namespace rubato::analysis
