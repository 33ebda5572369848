#include <rubato/model/build_parts.hpp>

#include <fmt/format.h>

namespace rubato::model {

void refuse_parts_without_nodes(const ModelDescription& description) {
  const StructureDescription& parts = description.structure;
  if (!parts.nodes.empty() || description.finite_elements) return;
  const auto refuse = [&](const Location& where, const std::string& part, const std::string& of_bodies) {
    throw InvalidInput(where, fmt::format("{} acts on nodes, and the study has none; add [[node]] or [nodes]{}", part,
                                          description.bodies.empty() ? "" : "; " + of_bodies));
  };
  if (!parts.beams.empty())
    refuse(parts.beams.front().where, "a [[beam]]", "nodes and bodies are joined by joints of type \"rigid\"");
  if (!parts.trusses.empty())
    refuse(parts.trusses.front().where, "a [[truss]]", "between bodies take a joint of type \"strut\"");
  if (!parts.masses.empty())
    refuse(parts.masses.front().where, "a [[mass]]", "a body has its own mass: add to that, and to its inertia");
  if (!parts.supports.empty())
    refuse(parts.supports.front().where, "a [[support]]",
           "hold a body by a joint to \"ground\", of type \"rigid\" if it is fixed");
}

}  // namespace rubato::model
