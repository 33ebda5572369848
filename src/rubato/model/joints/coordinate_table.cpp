#include <rubato/model/joints/coordinate_table.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace rubato::model {

CoordinateTable::Value CoordinateTable::operator()(double s) const {
  if (!(s >= at.front() && s <= at.back())) {
    const bool is_before = s < at.front();
    const Beyond beyond = is_before ? before : after;
    if (beyond == Beyond::error) {
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      return {unknown, unknown, unknown};
    }
    const double end = is_before ? at.front() : at.back(), stored = is_before ? potential.front() : potential.back();
    if (beyond == Beyond::zero) return {0.0, 0.0, stored};
    const double held = is_before ? force.front() : force.back();
    return {held, 0.0, stored - held * (s - end)};
  }
  const auto next = std::upper_bound(at.begin() + 1, at.end() - 1, s) - at.begin();
  const auto i = static_cast<std::size_t>(next) - 1;
  const double slope = (force[i + 1] - force[i]) / (at[i + 1] - at[i]), way = s - at[i];
  return {force[i] + slope * way, slope, potential[i] - (force[i] + 0.5 * slope * way) * way};
}

CoordinateTable make_table(std::vector<double> at, std::vector<double> force, CoordinateTable::Beyond beyond) {
  CoordinateTable table{std::move(at), std::move(force), {0.0}, beyond, beyond};
  double lowest = 0.0;
  for (std::size_t i = 1; i < table.at.size(); ++i) {
    const double way = table.at[i] - table.at[i - 1], before = table.force[i - 1], after = table.force[i];
    // Where the force changes its sign from + to - within a piece the potential is lowest.
    if (before > 0.0 && after < 0.0)
      lowest = std::min(lowest, table.potential.back() - 0.5 * before * way * before / (before - after));
    table.potential.push_back(table.potential.back() - 0.5 * (before + after) * way);
    lowest = std::min(lowest, table.potential.back());
  }
  for (double& stored : table.potential) stored -= lowest;
  return table;
}

}  // namespace rubato::model
