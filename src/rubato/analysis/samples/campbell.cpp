#include <rubato/analysis/samples/campbell.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

std::size_t speed_of(const model::SweptDescription& swept, const Sweep& sweep, const std::string& title,
                     const Location& where) {
  const auto& names = sweep.names();
  if (swept.speed.empty()) {
    if (names.size() == 1) return 0;
    throw InvalidInput(place(swept.engine_orders_where, where),
                       fmt::format("{}several parameters are swept; say which one is the speed: speed = \"{}\"", title,
                                   names.front()));
  }
  const auto found = std::find(names.begin(), names.end(), swept.speed);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  throw InvalidInput(place(swept.speed_where, where), fmt::format("{}speed names \"{}\", which is not swept{}", title,
                                                                  swept.speed, suggestion(swept.speed, names)));
}

}  // namespace

CampbellPlan plan_campbell(const model::SweptDescription& swept, const Sweep& sweep,
                           const numerics::Parameters& parameters, const std::string& title, const Location& where) {
  using Unit = model::SweptDescription::SpeedUnit;
  if (sweep.kind() == Sweep::Kind::random)
    throw InvalidInput(
        place(swept.engine_orders_where, where),
        title +
            "engine_orders are lines over a speed, and random samples have no order; sweep the speed over a "
            "range, { from = 0, to = ..., points = ... }, or over cases");
  CampbellPlan plan;
  plan.speed = speed_of(swept, sweep, title, where);
  for (const auto& quantity : swept.engine_orders) {
    const double order = model::evaluate(quantity, parameters, title + "engine_orders");
    if (!(order > 0.0))
      throw InvalidInput(place(quantity.where, where),
                         fmt::format("{}an engine order is a positive multiple of the speed, got {}", title, order));
    if (std::find(plan.orders.begin(), plan.orders.end(), order) == plan.orders.end()) plan.orders.push_back(order);
  }
  plan.unit = swept.speed_unit == Unit::rad_per_second ? "rad/s" : swept.speed_unit == Unit::hertz ? "Hz" : "rpm";
  plan.factor = swept.speed_unit == Unit::rad_per_second ? 1.0 : swept.speed_unit == Unit::hertz ? turn : turn / 60.0;
  std::vector<double> values(sweep.names().size());
  for (long number = 0; number < sweep.lines(); ++number) {
    sweep.values(number, values);
    if (!(values[plan.speed] >= 0.0))
      throw InvalidInput(sweep.where()[plan.speed],
                         fmt::format("{}the speed \"{}\" of a diagram with engine_orders cannot be negative, got {}",
                                     title, sweep.names()[plan.speed], values[plan.speed]));
  }
  return plan;
}

void Campbell::take(long number, std::span<const double> frequencies, std::span<const double> damping_ratios) {
  std::vector<double> key(sweep_.names().size());
  sweep_.values(number, key);
  const double speed = key[plan_.speed];
  key[plan_.speed] = 0.0;
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  const auto line = static_cast<std::size_t>(found - keys_.begin());
  if (found == keys_.end()) {
    keys_.push_back(key);
    lines_.emplace_back();
  }
  lines_[line].push_back(
      {speed, {frequencies.begin(), frequencies.end()}, {damping_ratios.begin(), damping_ratios.end()}});
}

/// A crossing at a point belongs to one of its two pairs: to that in which the order goes from below the mode, or from
/// the mode itself, to above or the other way round.
void Campbell::add_between(const Point& low, const Point& high, const std::vector<double>& parameters, double order,
                           std::size_t mode, bool is_last, std::vector<Crossing>& crossings) const {
  const double first = turn * low.frequencies[mode], second = turn * high.frequencies[mode];
  if (!std::isfinite(first) || !std::isfinite(second)) return;
  const double from = plan_.factor * low.speed, to = plan_.factor * high.speed;
  const double before = first * first - order * order * from * from, after = second * second - order * order * to * to;
  const bool is_end = is_last && after == 0.0 && before > 0.0;
  if (!is_end && (before < 0.0) == (after < 0.0)) return;
  // At rest a rigid motion and all orders are at zero, which excites nothing.
  if (before == 0.0 && from == 0.0) return;
  const double share = is_end ? 1.0 : before / (before - after);
  const double speed = std::sqrt(from * from + share * (to * to - from * from));
  Crossing crossing{parameters, order, mode, order * speed / turn,
                    low.damping_ratios[mode] + share * (high.damping_ratios[mode] - low.damping_ratios[mode])};
  crossing.parameters[plan_.speed] = speed / plan_.factor;
  crossings.push_back(crossing);
}

std::vector<Crossing> Campbell::crossings() const {
  std::vector<Crossing> all;
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    std::vector<Point> points = lines_[line];
    std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.speed < b.speed; });
    const std::size_t modes = points.front().frequencies.size();
    for (const double order : plan_.orders)
      for (std::size_t mode = 0; mode < modes; ++mode)
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
          add_between(points[i], points[i + 1], keys_[line], order, mode, i + 2 == points.size(), all);
  }
  return all;
}

void Campbell::write(const std::string& name, const std::vector<std::string>& modes, results::Sink& sink) const {
  results::TableLayout layout{name, "crossings", "crossing", {}, {{"type", "crossings"}}};
  const auto add = [&](const std::string& variable, const std::string& unit, const std::string& description) {
    layout.blocks.push_back({variable, unit, description, "", {}});
  };
  for (std::size_t i = 0; i < sweep_.names().size(); ++i)
    add(sweep_.names()[i], i == plan_.speed ? plan_.unit : "",
        i == plan_.speed ? "at the crossing" : "swept parameter");
  add("engine_order", "1", "multiple of the speed");
  layout.blocks.push_back({"mode", "1", "whose natural frequency is met", "", {}, modes});
  add("frequency", "Hz", "of both");
  add("angular_frequency", "rad/s", "of both");
  add("damping_ratio", "1", "of the mode, between its neighbours");
  const auto rows = sink.open(layout);
  for (const Crossing& crossing : crossings()) {
    std::vector<double> row = crossing.parameters;
    row.insert(row.end(), {crossing.order, static_cast<double>(crossing.mode), crossing.frequency,
                           turn * crossing.frequency, crossing.damping_ratio});
    rows->append(row);
  }
}

std::vector<std::string> Campbell::findings(const std::vector<std::string>& modes) const {
  constexpr std::size_t most_told = 12;
  std::vector<std::string> lines;
  const auto all = crossings();
  for (const Crossing& crossing : all) {
    if (lines.size() == most_told) {
      lines.push_back(
          fmt::format("of {} crossings these are the first; all are in the table \"crossings\"", all.size()));
      break;
    }
    std::string others;
    for (std::size_t i = 0; i < crossing.parameters.size(); ++i)
      if (i != plan_.speed) others += fmt::format(", {} = {:.6g}", sweep_.names()[i], crossing.parameters[i]);
    lines.push_back(fmt::format("engine order {:.6g} meets {} at {} = {:.6g} {} ({:.6g} Hz){}", crossing.order,
                                modes[crossing.mode], sweep_.names()[plan_.speed], crossing.parameters[plan_.speed],
                                plan_.unit, crossing.frequency, others));
  }
  if (all.empty()) lines.emplace_back("no engine order meets a natural frequency within the speeds of the sweep");
  return lines;
}

}  // namespace rubato::analysis
