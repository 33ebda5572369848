#include <rubato/analysis/sweep.hpp>
#include <rubato/analysis/sweep_samples.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

constexpr double most_lines = 1e12;   // beyond it nobody waits
constexpr double most_values = 1e7;   // of a range
constexpr double most_samples = 1e8;  // of numbers kept in memory

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

double whole_number(const model::Quantity& quantity, const numerics::Parameters& parameters, const std::string& what,
                    const Location& otherwise) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value >= 1.0) || value != std::floor(value))
    throw InvalidInput(place(quantity.where, otherwise),
                       fmt::format("{} must be a whole number of at least 1, got {}", what, value));
  return value;
}

}  // namespace

std::vector<double> values_of(const model::ValuesDescription& description, const numerics::Parameters& parameters,
                              const std::string& what, const Location& otherwise) {
  const Location where = place(description.where, otherwise);
  std::vector<double> values;
  if (!description.list.empty()) {
    for (const auto& quantity : description.list) values.push_back(model::evaluate(quantity, parameters, what));
    return values;
  }
  const double from = model::evaluate(description.from, parameters, what + ": from");
  const double to = model::evaluate(description.to, parameters, what + ": to");
  const double points = whole_number(description.points, parameters, what + ": points", where);
  if (points > most_values)
    throw InvalidInput(where,
                       fmt::format("{}: {:.3g} points are more than can be kept ({:.0g})", what, points, most_values));
  if (!(from <= to))
    throw InvalidInput(where, fmt::format("{}: the range from {} to {} is reversed; write from = {}, to = {}", what,
                                          from, to, to, from));
  if (points > 1.0 && from == to)
    throw InvalidInput(where, fmt::format("{}: the range from {} to {} is empty; give an end above its begin, or "
                                          "points = 1",
                                          what, from, to));
  if (points == 1.0 && from != to)
    throw InvalidInput(where, fmt::format("{}: one point cannot be both {} and {}; give two or more, or a list of one",
                                          what, from, to));
  if (description.logarithmic && !(from > 0.0))
    throw InvalidInput(where, fmt::format("{}: spacing = \"log\" needs a positive begin, got {}", what, from));
  const auto count = static_cast<std::size_t>(points);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = count == 1 ? 0.0 : static_cast<double>(i) / (points - 1.0);
    values.push_back(description.logarithmic ? from * std::pow(to / from, share) : from + share * (to - from));
  }
  values.back() = to;
  return values;
}

Sweep::Sweep(const model::SweepDescription& description, const Location& where, const StudyInput& input,
             const std::string& title) {
  if (const auto* grid = std::get_if<model::GridSweepDescription>(&description))
    take(*grid, input, title, where);
  else if (const auto* cases = std::get_if<model::CaseSweepDescription>(&description))
    take(*cases, input, title);
  else if (const auto* random = std::get_if<model::RandomSweepDescription>(&description))
    take(*random, input, title);
}

void Sweep::add_parameter(const std::string& name, const Location& where, const StudyInput& input,
                          const std::string& title) {
  std::vector<std::string> known;
  for (const auto& parameter : input.parameters) known.push_back(parameter.first);
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw InvalidInput(where, fmt::format("{}sweep names \"{}\", which is no parameter{}", title, name,
                                          known.empty() ? "; the study has no [parameters]" : suggestion(name, known)));
  if (std::find(names_.begin(), names_.end(), name) != names_.end())
    throw InvalidInput(where, fmt::format("{}sweep names \"{}\" twice", title, name));
  names_.push_back(name);
  places_.push_back(static_cast<std::size_t>(found - known.begin()));
  where_.push_back(where);
}

void Sweep::take(const model::GridSweepDescription& grid, const StudyInput& input, const std::string& title,
                 const Location& where) {
  kind_ = Kind::grid;
  double lines = 1.0;
  for (const auto& [name, values] : grid.parameters) {
    add_parameter(name, place(values.where, where), input, title);
    grid_.push_back(values_of(values, input.parameters, title + "sweep of " + name, where));
    lines *= static_cast<double>(grid_.back().size());
  }
  if (lines > most_lines)
    throw InvalidInput(where, fmt::format("{}the sweep has {:.3g} combinations, more than can be run ({:.0g})", title,
                                          lines, most_lines));
  lines_ = static_cast<long>(lines);
}

void Sweep::take(const model::CaseSweepDescription& cases, const StudyInput& input, const std::string& title) {
  kind_ = Kind::cases;
  for (const std::string& name : cases.names) add_parameter(name, cases.where, input, title);
  const auto width = static_cast<Index>(names_.size());
  lines_ = static_cast<long>(cases.values.size()) / static_cast<long>(names_.size());
  table_ = Eigen::Map<const Matrix>(cases.values.data(), width, lines_);
}

void Sweep::take(const model::RandomSweepDescription& random, const StudyInput& input, const std::string& title) {
  kind_ = Kind::random;
  const std::string prefix = title + "sweep: ";
  const double samples = whole_number(random.samples, input.parameters, prefix + "samples", random.where);
  std::vector<Distribution> distributions;
  for (const auto& description : random.parameters) {
    add_parameter(description.parameter, description.where, input, title);
    const std::string what = prefix + description.parameter;
    using Shape = model::DistributionDescription::Kind;
    const Distribution distribution{description.kind, model::evaluate(description.first, input.parameters, what),
                                    model::evaluate(description.second, input.parameters, what)};
    if (description.kind == Shape::uniform && !(distribution.first < distribution.second))
      throw InvalidInput(place(description.first.where, description.where),
                         fmt::format("{}: the uniform distribution from {} to {} is empty; from must lie below to",
                                     what, distribution.first, distribution.second));
    if (description.kind != Shape::uniform && !(distribution.second > 0.0))
      throw InvalidInput(place(description.second.where, description.where),
                         fmt::format("{}: deviation must be positive, got {}", what, distribution.second));
    if (description.kind == Shape::lognormal && !(distribution.first > 0.0))
      throw InvalidInput(
          place(description.first.where, description.where),
          fmt::format("{}: the median of a lognormal distribution must be positive, got {}", what, distribution.first));
    distributions.push_back(distribution);
  }
  const auto width = static_cast<Index>(names_.size());
  if (random.sampling == model::RandomSweepDescription::Sampling::sobol && width > most_sobol_dimensions)
    throw InvalidInput(random.where, fmt::format("{}sampling = \"sobol\" takes up to {} parameters, got {}; take "
                                                 "\"latin_hypercube\"",
                                                 prefix, most_sobol_dimensions, width));
  if (samples * static_cast<double>(width) > most_samples)
    throw InvalidInput(place(random.samples.where, random.where),
                       fmt::format("{}{:.3g} samples of {} parameters are more than can be kept ({:.0g} numbers)",
                                   prefix, samples, width, most_samples));
  lines_ = static_cast<long>(samples);
  table_ = unit_samples(random.sampling, width, lines_, random.seed);
  for (Index line = 0; line < table_.cols(); ++line)
    for (Index i = 0; i < width; ++i)
      table_(i, line) = distributions[static_cast<std::size_t>(i)].quantile(table_(i, line));
}

void Sweep::values(long line, std::span<double> out) const {
  if (kind_ != Kind::grid) {
    for (std::size_t i = 0; i < names_.size(); ++i) out[i] = table_(static_cast<Index>(i), line);
    return;
  }
  for (std::size_t i = names_.size(); i-- > 0;) {
    const auto count = static_cast<long>(grid_[i].size());
    out[i] = grid_[i][static_cast<std::size_t>(line % count)];
    line /= count;
  }
}

bool Sweep::is_first_but_for(long line, const std::vector<bool>& marked) const {
  if (std::all_of(marked.begin(), marked.end(), [](bool m) { return m; })) return line == 0;
  if (kind_ != Kind::grid) return true;
  for (std::size_t i = names_.size(); i-- > 0;) {
    const auto count = static_cast<long>(grid_[i].size());
    if (marked[i] && line % count != 0) return false;
    line /= count;
  }
  return true;
}

}  // namespace rubato::analysis
