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
    const bool at_an_end = t == times.front() || t == times.back();
    if (table.beyond == TableLaw::Beyond::zero && !at_an_end) return 0.0;
    return before ? table.values.front() : table.values.back();
  }
  // The row that ends the interval to which t belongs, seen from the given side.
  const auto end = side == Side::right ? std::upper_bound(times.begin(), times.end(), t)
                                       : std::lower_bound(times.begin(), times.end(), t);
  const auto i = static_cast<std::size_t>(end - times.begin());
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return table.values[i - 1] + share * (table.values[i] - table.values[i - 1]);
}

double value(const TimeLaw& law, double t, Side side) {
  struct Visitor {
    double t;
    Side side;
    double operator()(const HarmonicLaw& harmonic) const {
      return harmonic.amplitude * std::cos(harmonic.angular_frequency * t + harmonic.phase);
    }
    double operator()(const FormulaLaw& formula) const { return formula.formula(t); }
    double operator()(const TableLaw& table) const { return value(table, t, side); }
  };
  return std::visit(Visitor{t, side}, law);
}

}  // namespace rubato::model
