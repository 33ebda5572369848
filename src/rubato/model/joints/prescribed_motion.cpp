#include <rubato/model/joints/prescribed_motion.hpp>

#include <algorithm>

namespace rubato::model {
namespace {

/// The slope of the piece to which t belongs, seen from the given side; zero beyond the table.
double slope(const TableLaw& table, double t, Side side) {
  const auto& times = table.times;
  const auto end = side == Side::right ? std::upper_bound(times.begin(), times.end(), t)
                                       : std::lower_bound(times.begin(), times.end(), t);
  if (end == times.begin() || end == times.end()) return 0.0;
  const auto i = static_cast<std::size_t>(end - times.begin());
  return (table.values[i] - table.values[i - 1]) / (times[i] - times[i - 1]);
}

}  // namespace

numerics::TimeDerivatives derivatives(const MotionLaw& law, double t, Side side) {
  if (const auto* formula = std::get_if<numerics::Formula>(&law))
    return side == Side::left ? formula->derivatives_from_left(t) : formula->derivatives_from_right(t);
  const auto& table = std::get<TableLaw>(law);
  return {value(table, t, side), slope(table, t, side), 0.0};
}

}  // namespace rubato::model
