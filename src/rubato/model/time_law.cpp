#include <rubato/model/time_law.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rubato::model {

double value(const TableLaw& table, double t, Side side) {
  const auto& times = table.times;
  const bool before = side == Side::right ? t < times.front() : t <= times.front();
  const bool after = side == Side::right ? t >= times.back() : t > times.back();
  if (before || after) {
    // No time precedes the study: what the first row says at t = 0 held before.
    const bool starts_the_study = t == 0.0 && times.front() == 0.0;
    if (table.beyond == TableLaw::Beyond::zero && !starts_the_study) return 0.0;
    return before ? table.values.front() : table.values.back();
  }
  // The row that ends the interval to which t belongs, seen from the given side.
  const auto end = side == Side::right ? std::upper_bound(times.begin(), times.end(), t)
                                       : std::lower_bound(times.begin(), times.end(), t);
  const auto i = static_cast<std::size_t>(end - times.begin());
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return table.values[i - 1] + share * (table.values[i] - table.values[i - 1]);
}

SplineLaw spline_through(const TableLaw& table) {
  SplineLaw spline{table.times, table.values, {}, 0, table.beyond == TableLaw::Beyond::hold, table.source};
  const std::vector<double>&x = spline.times, &y = spline.values;
  const std::size_t n = x.size();
  spline.curvatures.assign(n, 0.0);
  std::vector<double> above(n, 0.0);  // of the eliminated tridiagonal rows
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    const double pivot = 2.0 * (before + after) - before * above[i - 1];
    above[i] = after / pivot;
    const double bend = 6.0 * ((y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before);
    spline.curvatures[i] = (bend - before * spline.curvatures[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) spline.curvatures[i] -= above[i] * spline.curvatures[i + 1];
  return spline;
}

namespace {

double value_of(const SplineLaw& spline, double t, Side side) {
  const auto& x = spline.times;
  const bool before = side == Side::right ? t < x.front() : t <= x.front();
  // Where nothing is known beyond the rows the analysis ends with them, and the last row is still of the spline.
  const bool after = spline.holds_beyond && (side == Side::right ? t >= x.back() : t > x.back());
  if (before || after) return spline.order > 0 ? 0.0 : before ? spline.values.front() : spline.values.back();
  const auto end =
      side == Side::right ? std::upper_bound(x.begin(), x.end(), t) : std::lower_bound(x.begin(), x.end(), t);
  const auto i = std::min(static_cast<std::size_t>(end - x.begin()), x.size() - 1) - 1;
  const double h = x[i + 1] - x[i], s = t - x[i], r = x[i + 1] - t;
  const double m0 = spline.curvatures[i], m1 = spline.curvatures[i + 1], y0 = spline.values[i],
               y1 = spline.values[i + 1];
  if (spline.order == 2) return (r * m0 + s * m1) / h;
  if (spline.order == 1) return (s * s * m1 - r * r * m0) / (2.0 * h) + (y1 - y0) / h - h * (m1 - m0) / 6.0;
  return (r * r * r * m0 + s * s * s * m1) / (6.0 * h) + (y0 / h - h * m0 / 6.0) * r + (y1 / h - h * m1 / 6.0) * s;
}

}  // namespace

double value(const TimeLaw& law, double t, Side side) {
  struct Visitor {
    double t;
    Side side;
    double operator()(const HarmonicLaw& harmonic) const {
      return harmonic.amplitude * std::cos(harmonic.angular_frequency * t + harmonic.phase);
    }
    /// No time precedes the study: what a formula says at t = 0 held before.
    bool has_no_left() const { return t == 0.0 && side == Side::left; }
    double operator()(const FormulaLaw& formula) const {
      if (has_no_left()) return formula.formula(t);
      return side == Side::left ? formula.formula.from_left(t) : formula.formula.from_right(t);
    }
    double operator()(const TableLaw& table) const { return value(table, t, side); }
    double operator()(const FormulaDerivative& derivative) const {
      const numerics::Formula& formula = derivative.formula;
      const numerics::TimeDerivatives all = has_no_left()        ? formula.derivatives(t)
                                            : side == Side::left ? formula.derivatives_from_left(t)
                                                                 : formula.derivatives_from_right(t);
      return derivative.order == 0 ? all.value : derivative.order == 1 ? all.rate : all.second_rate;
    }
    double operator()(const SplineLaw& spline) const { return value_of(spline, t, side); }
  };
  return std::visit(Visitor{t, side}, law);
}

}  // namespace rubato::model
