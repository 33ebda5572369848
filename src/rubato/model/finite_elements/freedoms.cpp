#include <rubato/model/finite_elements/freedoms.hpp>
#include <rubato/model/structure.hpp>

#include <algorithm>
#include <string_view>

namespace rubato::model {
namespace {

using Directions = std::array<bool, 6>;

bool begins_with_any(std::string_view type, std::initializer_list<std::string_view> starts) {
  return std::any_of(starts.begin(), starts.end(), [&](std::string_view start) { return type.starts_with(start); });
}

/// Elements in the x-y plane of CalculiX and Abaqus.
bool is_plane(std::string_view type) {
  return begins_with_any(type, {"CPE", "CPS", "CAX", "CGAX", "T2D", "B21", "B22", "B23", "R2D", "SAX", "CONN2D",
                                "FRAME2D", "PIPE21", "PIPE22"});
}

/// Beams, shells and their like, whose nodes turn; solids, trusses and membranes have nodes that do not.
bool turns(std::string_view type) {
  return !begins_with_any(type, {"C3D", "CPE", "CPS", "CAX", "CGAX", "T2D", "T3D", "M3D", "DC", "SPRING", "DASHPOT"});
}

/// Directions that the elements of each node know [p].
std::vector<Directions> known_to_elements(const FiniteElements& model) {
  const Mesh& mesh = *model.mesh;
  std::vector<std::size_t> place(mesh.nodes.size(), model.nodes.size());
  for (std::size_t node = 0; node < model.nodes.size(); ++node) place[*mesh.place_of(model.nodes[node])] = node;
  std::vector<Directions> known(model.nodes.size(), Directions{});
  for (const MeshElement& element : mesh.elements) {
    Directions moves{true, true, !is_plane(element.type), false, false, false};
    const auto for_each_node = [&](const auto& visit) {
      for (std::size_t i = element.first; i < element.first + element.count; ++i)
        if (const std::size_t node = place[mesh.element_nodes[i]]; node < model.nodes.size()) visit(node);
    };
    if (turns(element.type))
      for_each_node([&](std::size_t node) {
        for (std::size_t axis = 3; axis < 6; ++axis) moves[axis] |= model.places[node][axis] != ground;
      });
    for_each_node([&](std::size_t node) {
      for (std::size_t axis = 0; axis < 6; ++axis) known[node][axis] |= moves[axis];
    });
  }
  return known;
}

std::vector<Directions> known_to_rows(const FiniteElements& model) {
  Directions moves{};
  for (const auto& places : model.places)
    for (std::size_t axis = 0; axis < 3; ++axis) moves[axis] |= places[axis] != ground;
  return std::vector<Directions>(model.nodes.size(), moves);
}

}  // namespace

std::vector<std::array<Freedom, 6>> freedoms_of(const FiniteElements& model,
                                                const std::vector<RowLabel>& held_in_files) {
  const std::vector<Directions> known =
      model.mesh && !model.mesh->elements.empty() ? known_to_elements(model) : known_to_rows(model);
  std::vector<std::array<Freedom, 6>> freedoms(model.nodes.size());
  for (std::size_t node = 0; node < model.nodes.size(); ++node)
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const RowLabel row{model.nodes[node], static_cast<int>(axis) + 1};
      freedoms[node][axis] = model.places[node][axis] != ground ? Freedom::free
                             : std::binary_search(held_in_files.begin(), held_in_files.end(), row)
                                 ? Freedom::held_in_files
                             : known[node][axis] ? Freedom::held
                                                 : Freedom::absent;
    }
  return freedoms;
}

bool is_partly_held(const FiniteElements& model, std::size_t node) {
  const auto& freedoms = model.freedoms[node];
  return model.is_held[node] == 0 && std::any_of(freedoms.begin(), freedoms.end(), is_held);
}

}  // namespace rubato::model
