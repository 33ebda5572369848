#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::model {

DistributedForce build_distributed_force(const DistributedForceDescription& description,
                                         const std::vector<NamedLine>& lines, int dimension,
                                         const numerics::Parameters& parameters) {
  const std::string part = fmt::format("the distributed force on \"{}\"", description.on);
  const auto is_meant = [&](const NamedLine& line) { return line.name == description.on; };
  auto found = std::find_if(lines.begin(), lines.end(),
                            [&](const NamedLine& line) { return is_meant(line) && line.has_own_name; });
  if (found == lines.end()) {
    found = std::find_if(lines.begin(), lines.end(), is_meant);
    if (found != lines.end() && std::find_if(std::next(found), lines.end(), is_meant) != lines.end())
      throw InvalidInput(description.where, fmt::format("a distributed force is on \"{}\", which a beam and a truss "
                                                        "are; give the one that is meant a name",
                                                        description.on));
  }
  if (found == lines.end()) {
    std::vector<std::string> names;
    for (const NamedLine& line : lines) names.push_back(line.name);
    throw InvalidInput(description.where,
                       fmt::format("a distributed force is on \"{}\", which is the name of no beam or truss{}",
                                   description.on, suggestion(description.on, names)));
  }
  const auto wanted = static_cast<std::size_t>(dimension);
  if (description.direction.size() != wanted)
    throw InvalidInput(description.where, fmt::format("{}: direction takes {} numbers, as the positions of nodes do, "
                                                      "got {}",
                                                      part, wanted, description.direction.size()));
  DistributedForce force{found->first, found->count, Axis::Zero(), build_time_law(description.law, parameters, part)};
  for (std::size_t i = 0; i < wanted; ++i)
    force.direction[static_cast<Index>(i)] = evaluate(description.direction[i], parameters, part + ": direction");
  const bool is_written = std::all_of(description.direction.begin(), description.direction.end(),
                                      [](const Quantity& quantity) { return quantity.expression.empty(); });
  // Parameters may turn a force off.
  if (is_written && force.direction.isZero(0.0))
    throw InvalidInput(description.where,
                       fmt::format("{}: its direction has no length, and it would do nothing; give the direction in "
                                   "which it pushes, such as {}",
                                   part, wanted == 2 ? "[0, -1]" : "[0, 0, -1]"));
  return force;
}

}  // namespace rubato::model
