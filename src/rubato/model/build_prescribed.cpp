#include <rubato/model/build_parts.hpp>
#include <rubato/model/load_laws.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

struct Building {
  const numerics::Parameters& parameters;
  const std::string& part;
  const Location& where;
  Index coordinate;

  Prescribed operator()(const HarmonicDescription& harmonic) const {
    const auto law = std::get<HarmonicLaw>(build_time_law(harmonic, parameters, part));
    return {coordinate, law, derivative(law, 1), derivative(law, 2)};
  }

  Prescribed operator()(const TimeFormulaDescription& formula) const {
    const numerics::Formula motion = build_motion(formula, parameters, part);
    return {coordinate, FormulaDerivative{motion, 0}, FormulaDerivative{motion, 1}, FormulaDerivative{motion, 2}};
  }

  Prescribed operator()(const TableDescription& description) const {
    const TableLaw table = build_motion(description, parameters, part, where);
    if (table.times.size() < 2)
      throw InvalidInput(
          where, fmt::format("{}: the table \"{}\" has one row; a motion takes at least two", part, table.source));
    SplineLaw displacement = spline_through(table), velocity = displacement, acceleration = displacement;
    velocity.order = 1;
    acceleration.order = 2;
    return {coordinate, std::move(displacement), std::move(velocity), std::move(acceleration)};
  }
};

}  // namespace

numerics::Formula build_motion(const TimeFormulaDescription& description, const numerics::Parameters& parameters,
                               const std::string& part) {
  try {
    numerics::Formula motion(description.formula.expression, parameters, true);
    const numerics::TimeDerivatives start = motion.derivatives(0.0);
    if (!std::isfinite(start.value) || !std::isfinite(start.rate) || !std::isfinite(start.second_rate))
      throw InvalidInput(fmt::format("\"{}\" has no finite value, rate and second rate at t = 0 ({}, {}, {})",
                                     motion.text(), start.value, start.rate, start.second_rate));
    return motion;
  } catch (const InvalidInput& fault) {
    throw InvalidInput(description.formula.where, part + ": " + fault.message());
  }
}

TableLaw build_motion(const TableDescription& description, const numerics::Parameters& parameters,
                      const std::string& part, const Location& where) {
  auto table = std::get<TableLaw>(build_time_law(description, parameters, part));
  if (table.beyond == TableLaw::Beyond::zero)
    throw InvalidInput(where, fmt::format("{}: beyond = \"zero\" would make it jump; take \"hold\", or extend the "
                                          "table \"{}\"",
                                          part, table.source));
  for (std::size_t i = 1; i < table.times.size(); ++i)
    if (!(table.times[i] > table.times[i - 1]))
      throw InvalidInput(where, fmt::format("{}: the table \"{}\" jumps at t = {} s, and nothing moves from one place "
                                            "to another at once; give its rows a time between",
                                            part, table.source, table.times[i]));
  return table;
}

Prescribed build_prescribed(const PrescribedDescription& description, Index coordinate,
                            const numerics::Parameters& parameters) {
  const std::string part = fmt::format("the displacement of \"{}\"", description.on);
  return std::visit(Building{parameters, part, description.where, coordinate}, description.law);
}

std::string contact_at(const Model& model, Index coordinate) {
  const auto joins = [&](const auto& contact) { return contact.first == coordinate || contact.second == coordinate; };
  for (const Slider& slider : model.sliders)
    if (joins(slider)) return slider.name;
  for (const Stop& stop : model.stops)
    if (joins(stop)) return stop.name;
  for (const LawBetween& law : model.laws)
    if (joins(law) || std::any_of(law.shares.begin(), law.shares.end(),
                                  [&](const Share& share) { return share.coordinate == coordinate; }))
      return law.name;
  for (const BlockBetween& block : model.blocks)
    for (const std::vector<Share>& column : block.columns)
      if (std::any_of(column.begin(), column.end(), [&](const Share& share) { return share.coordinate == coordinate; }))
        return block.name;
  return {};
}

}  // namespace rubato::model
