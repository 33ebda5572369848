#include <rubato/model/build_sections.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/by_name.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

namespace rubato::model {
namespace {

using numerics::Parameters;

// Below this share of its length a vector counts as parallel to another: the frame of the beam would be made of
// round-off.
constexpr double parallel = 1e-8;

class StructureBuilder {
 public:
  StructureBuilder(const StructureDescription& description, const Parameters& parameters)
      : description_(description), parameters_(parameters) {}

  BuiltStructure build(Index offset) {
    take_nodes();
    materials_ = build_materials(description_.materials, parameters_);
    sections_ = build_sections(description_.sections, in_plane(), parameters_);
    for (const BeamDescription& beam : description_.beams) take_beam(beam);
    for (const TrussDescription& truss : description_.trusses) take_truss(truss);
    for (const PointMassDescription& mass : description_.masses) take_mass(mass);
    for (const SupportDescription& support : description_.supports) take_support(support);
    number_coordinates(offset);
    return std::move(built_);
  }

 private:
  struct NodeState {
    std::array<bool, 6> exists{}, is_fixed{};
    std::array<double, 6> mass{}, velocity{};
    Location where;
  };

  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }
  double positive(const Quantity& quantity, const std::string& what) const {
    return model::positive(quantity, parameters_, what);
  }
  bool in_plane() const { return built_.structure.dimension == 2; }

  void add_node(const std::string& name, const Location& where, const Axis& position) {
    refuse_unfit_name(name, where);
    nodes_.add(name, where, static_cast<Index>(states_.size()));
    built_.structure.names.push_back(name);
    built_.structure.positions.push_back(position);
    states_.emplace_back();
    states_.back().where = where;
  }

  /// Velocities of a node at the start, by the axes that it has.
  void take_velocity(const NodeDescription& node, NodeState& state) const {
    const auto take = [&](const std::vector<Quantity>& values, const Location& where, const char* key,
                          std::span<const std::size_t> axes) {
      if (values.empty()) return;
      const std::string what = fmt::format("node \"{}\": {}", node.name, key);
      if (values.size() != axes.size())
        throw InvalidInput(
            where, fmt::format("{} takes {} number{} {}, got {}", what,
                               axes.size() == 1   ? "one"
                               : axes.size() == 2 ? "two"
                                                  : "three",
                               axes.size() == 1 ? "" : "s", in_plane() ? "in the plane" : "in space", values.size()));
      for (std::size_t i = 0; i < axes.size(); ++i) state.velocity[axes[i]] = number(values[i], what);
    };
    static constexpr std::array<std::size_t, 6> axes{0, 1, 2, 3, 4, 5};
    const std::size_t translations = in_plane() ? 2 : 3;
    take(node.velocity, node.velocity_where, "velocity", std::span(axes).first(translations));
    take(node.angular_velocity, node.angular_velocity_where, "angular_velocity",
         in_plane() ? std::span(axes).last(1) : std::span(axes).last(3));
  }

  void take_nodes() {
    built_.structure.dimension = description_.nodes.front().position.size() == 3 ? 3 : 2;
    for (const NodeDescription& node : description_.nodes) {
      const std::size_t given = node.position.size();
      if (given != 2 && given != 3)
        throw InvalidInput(node.where, fmt::format("node \"{}\": position takes two numbers in the plane or three in "
                                                   "space, got {}",
                                                   node.name, given));
      if (static_cast<int>(given) != built_.structure.dimension)
        throw InvalidInput(node.where,
                           fmt::format("node \"{}\" has {} numbers for its position, and node \"{}\" has {}: a model "
                                       "lies in the plane or in space",
                                       node.name, given, description_.nodes.front().name, built_.structure.dimension));
      Axis position = Axis::Zero();
      for (std::size_t i = 0; i < given; ++i)
        position[static_cast<Index>(i)] = number(node.position[i], fmt::format("node \"{}\": position", node.name));
      if (node.name == "ground")
        throw InvalidInput(node.where,
                           "a node cannot be called \"ground\", which is the name of what does not move; "
                           "give it another name, and hold it by a [[support]]");
      add_node(node.name, node.where, position);
      take_velocity(node, states_.back());
    }
  }

  static std::string part_of(const LineDescription& line, const char* kind) {
    return line.name.empty() ? fmt::format("the {} from \"{}\" to \"{}\"", kind, line.nodes[0], line.nodes[1])
                             : fmt::format("{} \"{}\"", kind, line.name);
  }

  void add_name(const LineDescription& line, std::size_t count) {
    if (line.name.empty()) return;
    lines_.add(line.name, line.where, 0);
    built_.lines.push_back({line.name, built_.structure.elements.size(), count});
  }

  /// Two lines of a kind between the same nodes double their stiffness: who means it names one.
  void refuse_twin(const LineDescription& line, const char* kind, const std::array<Index, 2>& ends) {
    if (!line.name.empty()) return;
    const auto [low, high] = std::minmax(ends[0], ends[1]);
    const auto [twin, is_new] = unnamed_[kind].emplace(std::pair{low, high}, &line.where);
    if (is_new) return;
    const Location& first = *twin->second;
    const std::string place = first.line <= 0                 ? ""
                              : first.file == line.where.file ? fmt::format(" (line {})", first.line)
                                                              : fmt::format(" ({}:{})", first.file, first.line);
    throw InvalidInput(line.where, fmt::format("{0} is there already{1}, and a second one would double its stiffness; "
                                               "remove one, or if two {2}s are meant give one of them a name",
                                               part_of(line, kind), place, kind));
  }

  /// The ends of a line, which must be two nodes apart.
  std::array<Index, 2> ends_of(const LineDescription& line, const std::string& part) const {
    std::array<Index, 2> ends{};
    for (std::size_t i = 0; i < 2; ++i)
      ends[i] = static_cast<Index>(nodes_.place(line.nodes[i], line.nodes_where[i], part + " joins"));
    if (ends[0] == ends[1])
      throw InvalidInput(line.nodes_where[1], fmt::format("{} joins node \"{}\" with itself", part, line.nodes[1]));
    const Axis &a = built_.structure.positions[static_cast<std::size_t>(ends[0])],
               &b = built_.structure.positions[static_cast<std::size_t>(ends[1])];
    // Shorter than round-off of the positions: the direction would be made of it.
    if (!((b - a).norm() > 1e-12 * std::max(a.norm(), b.norm())))
      throw InvalidInput(line.where, fmt::format("{} has no length: nodes \"{}\" and \"{}\" lie in the same place",
                                                 part, line.nodes[0], line.nodes[1]));
    return ends;
  }

  int add_properties(const LineProperties& properties) {
    auto& all = built_.structure.properties;
    // Neighbours in the file mostly share theirs.
    const auto found = std::find(all.rbegin(), all.rend(), properties);
    if (found != all.rend()) return static_cast<int>(all.rend() - found) - 1;
    all.push_back(properties);
    return static_cast<int>(all.size()) - 1;
  }

  LineProperties properties_of(const LineDescription& line, const std::string& part, Section& section) {
    const std::size_t at_section = sections_.place(line.section, line.section_where, part + " has the section");
    const std::size_t at_material = materials_.place(line.material, line.material_where, part + " has the material");
    section = sections_.at(at_section);
    const Material& material = materials_.at(at_material);
    LineProperties p;
    p.lumped_mass = line.lumped_mass;
    p.young = material.young;
    p.density = material.density;
    p.shear_modulus = material.shear_modulus;
    p.area = section.area;
    return p;
  }

  void take_beam(const BeamDescription& beam) {
    add_name(beam, static_cast<std::size_t>(std::max(beam.elements, 1)));
    const std::string part = part_of(beam, "beam");
    const std::array<Index, 2> ends = ends_of(beam, part);
    refuse_twin(beam, "beam", ends);
    Section section{};
    LineProperties p = properties_of(beam, part, section);
    if (section.inertia_z == 0.0)
      throw InvalidInput(beam.section_where,
                         fmt::format("{} has the section \"{}\", which has no inertia; give the section one [m4], or "
                                     "take a [[truss]]",
                                     part, beam.section));
    p.inertia_z = section.inertia_z;
    if (!in_plane()) {
      p.inertia_y = section.inertia_y;
      p.torsion = section.torsion;
      if (p.torsion == 0.0)
        throw InvalidInput(beam.section_where,
                           fmt::format("{} has the section \"{}\", which has no torsion constant; give the section "
                                       "\"torsion\" [m4]",
                                       part, beam.section));
    }
    const bool has_shear = beam.formulation != BeamDescription::Formulation::euler_bernoulli;
    const bool is_exact = beam.formulation == BeamDescription::Formulation::geometrically_exact;
    if (has_shear && section.shear_factor_y == 0.0)
      throw InvalidInput(beam.section_where,
                         fmt::format("{} is a {} beam, and its section \"{}\" has no shear_factor (5/6 for a "
                                     "rectangle); give it one{}",
                                     part, is_exact ? "geometrically exact" : "Timoshenko", beam.section,
                                     is_exact ? "" : ", or take formulation = \"euler_bernoulli\""));
    if (p.shear_modulus == 0.0 && (has_shear || !in_plane()))
      throw InvalidInput(beam.material_where,
                         fmt::format("{} needs the shear modulus of the material \"{}\"; give the material \"poisson\" "
                                     "or \"shear_modulus\"",
                                     part, beam.material));
    if (has_shear) {
      p.shear_area_y = section.shear_factor_y * section.area;
      p.shear_area_z = in_plane() ? 0.0 : section.shear_factor_z * section.area;
    }
    const LineElement element{ends[0], ends[1], 0, orientation_of(beam, part, ends, p)};
    const std::array<std::uint16_t, 2> released{released_at(beam, part, 0), released_at(beam, part, 1)};
    divide(beam, part, element, p, released);
  }

  /// What an end of a beam does not share with its node, as bits over the degrees of freedom of one end.
  std::uint16_t released_at(const BeamDescription& beam, const std::string& part, std::size_t end) const {
    static constexpr std::array<std::size_t, 3> of_plane{0, 1, 5};
    std::uint16_t released = 0;
    for (const std::string& axis : beam.release[end]) {
      std::size_t place = 0;
      const std::size_t count = in_plane() ? 3 : 6;
      while (place < count && axis != axis_names[in_plane() ? of_plane[place] : place]) ++place;
      if (place == count)
        throw InvalidInput(beam.release_where,
                           fmt::format("{} releases \"{}\"; an end of a beam has {}", part, axis,
                                       in_plane() ? "x, y, rz in the plane" : "x, y, z, rx, ry, rz in space"));
      released = static_cast<std::uint16_t>(released | (1u << place));
    }
    return released;
  }

  /// Properties with released ends, which must leave the element stiff by itself.
  int add_released(LineProperties p, std::uint16_t released, double length, const std::string& part,
                   const Location& where) {
    p.released = released;
    if (released != 0) {
      LineMatrix stiffness, mass;
      local_matrices(p, built_.structure.dimension, length, stiffness, mass);
      if (!release(released, stiffness, mass))
        throw InvalidInput(where, fmt::format("{} releases so much that it moves by itself without resistance: a "
                                              "mechanism; keep one of the ends of each motion",
                                              part));
    }
    return add_properties(p);
  }

  Axis orientation_of(const BeamDescription& beam, const std::string& part, const std::array<Index, 2>& ends,
                      const LineProperties& p) const {
    if (in_plane()) {
      if (!beam.orientation.empty())
        throw InvalidInput(beam.orientation_where, part + ": orientation is for models in space; remove the key");
      return Axis::Zero();
    }
    const Axis along = (built_.structure.positions[static_cast<std::size_t>(ends[1])] -
                        built_.structure.positions[static_cast<std::size_t>(ends[0])])
                           .normalized();
    if (beam.orientation.empty()) {
      if (along.cross(Axis::UnitZ()).norm() > parallel) return Axis::UnitZ();
      if (p.inertia_y == p.inertia_z && p.shear_area_y == p.shear_area_z) return Axis::UnitX();
      throw InvalidInput(beam.where,
                         fmt::format("{} is vertical, and its section is not the same about both axes; give "
                                     "\"orientation\", a vector in its local x-y plane",
                                     part));
    }
    if (beam.orientation.size() != 3)
      throw InvalidInput(beam.orientation_where,
                         fmt::format("{}: orientation takes three numbers, got {}", part, beam.orientation.size()));
    Axis orientation;
    for (Index i = 0; i < 3; ++i)
      orientation[i] = number(beam.orientation[static_cast<std::size_t>(i)], part + ": orientation");
    if (!(along.cross(orientation).norm() > parallel * orientation.norm()))
      throw InvalidInput(beam.orientation_where,
                         fmt::format("{}: the orientation [{}] lies along the beam; give a vector across it, in its "
                                     "local x-y plane",
                                     part, fmt::join(orientation.data(), orientation.data() + 3, ", ")));
    return orientation;
  }

  /// Adds the elements of a beam and the nodes between them, which are called BEAM:1, BEAM:2, ...
  /// @param p         of an element without releases
  /// @param released  at the ends of the beam
  void divide(const BeamDescription& beam, const std::string& part, LineElement element, const LineProperties& p,
              const std::array<std::uint16_t, 2>& released) {
    if (beam.elements < 1)
      throw InvalidInput(beam.where, fmt::format("{}: elements must be at least 1, got {}", part, beam.elements));
    const Index first = element.first, last = element.second;
    const Axis from = built_.structure.positions[static_cast<std::size_t>(element.first)];
    const Axis to = built_.structure.positions[static_cast<std::size_t>(last)];
    const std::string name = beam.name.empty() ? beam.nodes[0] + "-" + beam.nodes[1] : beam.name;
    const double length = (to - from).norm() / beam.elements;
    const int width = 3 * (built_.structure.dimension - 1);
    const auto properties_at = [&](bool is_first, bool is_last) {
      const auto both = static_cast<std::uint16_t>((is_first ? released[0] : 0) | (is_last ? released[1] << width : 0));
      return both == 0 ? add_properties(p) : add_released(p, both, length, part, beam.release_where);
    };
    for (int i = 1; i < beam.elements; ++i) {
      const double share = static_cast<double>(i) / beam.elements;
      const std::string between = fmt::format("{}:{}", name, i);
      if (nodes_.has(between))
        throw InvalidInput(beam.where, fmt::format("{} makes a node \"{}\" within it, which there is already; give the "
                                                   "beam another name",
                                                   part, between));
      add_node(between, beam.where, (1.0 - share) * from + share * to);
      element.second = static_cast<Index>(states_.size()) - 1;
      for (std::size_t axis = 0; axis < 6; ++axis)
        states_.back().velocity[axis] = (1.0 - share) * states_[static_cast<std::size_t>(first)].velocity[axis] +
                                        share * states_[static_cast<std::size_t>(last)].velocity[axis];
      element.properties = properties_at(i == 1, false);
      add_element(element, true);
      element.first = element.second;
    }
    element.second = last;
    element.properties = properties_at(beam.elements == 1, true);
    add_element(element, true);
  }

  void add_element(const LineElement& element, bool is_beam) {
    built_.structure.elements.push_back(element);
    if (built_.structure.properties[static_cast<std::size_t>(element.properties)].released != 0)
      return take_inertias_of(element);
    for (const Index node : {element.first, element.second}) {
      auto& exists = states_[static_cast<std::size_t>(node)].exists;
      exists[0] = exists[1] = true;
      exists[2] = exists[2] || !in_plane();
      if (!is_beam) continue;
      exists[5] = true;
      exists[3] = exists[4] = !in_plane();
    }
  }

  /// A degree of freedom that all elements of a node release has no inertia, and does not exist.
  void take_inertias_of(const LineElement& element) {
    Structure alone;
    alone.dimension = built_.structure.dimension;
    for (const Index node : {element.first, element.second})
      alone.positions.push_back(built_.structure.positions[static_cast<std::size_t>(node)]);
    alone.places.resize(2);
    alone.properties = {built_.structure.properties[static_cast<std::size_t>(element.properties)]};
    ElementEquations equations;
    equations_of(alone, {0, 1, 0, element.orientation}, equations);
    constexpr double none = 1e-12;  // of the largest of its kind: round-off of turning the axes
    std::array<double, 2> largest{};
    for (int i = 0; i < equations.size; ++i) {
      double& kind = largest[is_rotation(equations.axis[static_cast<std::size_t>(i)])];
      kind = std::max(kind, equations.mass(i, i));
    }
    for (int i = 0; i < equations.size; ++i) {
      const std::size_t axis = equations.axis[static_cast<std::size_t>(i)];
      const Index node = i < equations.size / 2 ? element.first : element.second;
      if (equations.mass(i, i) > none * largest[is_rotation(axis)])
        states_[static_cast<std::size_t>(node)].exists[axis] = true;
    }
  }

  void take_truss(const TrussDescription& truss) {
    add_name(truss, 1);
    const std::string part = part_of(truss, "truss");
    const std::array<Index, 2> ends = ends_of(truss, part);
    refuse_twin(truss, "truss", ends);
    Section unused{};
    LineProperties p = properties_of(truss, part, unused);
    p.kind = LineProperties::Kind::truss;
    p.shear_modulus = 0.0;
    add_element({ends[0], ends[1], add_properties(p), Axis::Zero()}, false);
  }

  void take_mass(const PointMassDescription& mass) {
    const std::string part = fmt::format("the mass on node \"{}\"", mass.node);
    const std::size_t node = nodes_.place(mass.node, mass.node_where, "a mass is on");
    NodeState& state = states_[node];
    if (!mass.mass && mass.inertia.empty())
      throw InvalidInput(mass.where, part + " needs \"mass\" [kg], \"inertia\" [kg m2] or both");
    if (mass.mass) {
      const double value = positive(*mass.mass, part + ": mass");
      for (std::size_t axis = 0; axis < static_cast<std::size_t>(built_.structure.dimension); ++axis) {
        state.mass[axis] += value;
        state.exists[axis] = true;
      }
    }
    if (mass.inertia.empty()) return;
    const std::size_t wanted = in_plane() ? 1 : 3;
    if (mass.inertia.size() != wanted)
      throw InvalidInput(mass.where, fmt::format("{}: inertia takes {}, got {}", part,
                                                 in_plane() ? "one number in the plane, about z"
                                                            : "three numbers in space, about x, y and z",
                                                 mass.inertia.size()));
    for (std::size_t i = 0; i < wanted; ++i) {
      const std::size_t axis = in_plane() ? 5 : 3 + i;
      state.mass[axis] += positive(mass.inertia[i], part + ": inertia");
      state.exists[axis] = true;
    }
  }

  void take_support(const SupportDescription& support) {
    const std::size_t node = nodes_.place(support.node, support.node_where, "a support is at");
    if (support.fix.empty())
      throw InvalidInput(support.where, fmt::format("the support at node \"{}\" fixes nothing", support.node));
    for (std::size_t i = 0; i < support.fix.size(); ++i) {
      const auto axis = static_cast<std::size_t>(std::find(axis_names.begin(), axis_names.end(), support.fix[i]) -
                                                 axis_names.begin());
      const Location& where = i < support.fix_where.size() ? support.fix_where[i] : support.where;
      if (axis == axis_names.size() || (in_plane() && axis >= 2 && axis != 5))
        throw InvalidInput(
            where, fmt::format("the support at node \"{}\" fixes \"{}\"; a node {}", support.node, support.fix[i],
                               in_plane() ? "in the plane has x, y, rz" : "in space has x, y, z, rx, ry, rz"));
      if (states_[node].is_fixed[axis])
        throw InvalidInput(where, fmt::format("node \"{}\" is fixed in {} twice", support.node, support.fix[i]));
      states_[node].is_fixed[axis] = true;
    }
  }

  /// A velocity along what a support holds, or of a rotation that nothing gives an inertia.
  void refuse_lost_velocity(std::size_t node) const {
    if (node >= description_.nodes.size()) return;  // within a beam
    const NodeState& state = states_[node];
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (state.velocity[axis] == 0.0 || (state.exists[axis] && !state.is_fixed[axis])) continue;
      const NodeDescription& given = description_.nodes[node];
      throw InvalidInput(
          is_rotation(axis) ? given.angular_velocity_where : given.velocity_where,
          fmt::format("node \"{}\" starts with a velocity in {}, {}", given.name, axis_names[axis],
                      state.is_fixed[axis] ? "which a support holds; leave it out"
                                           : "where nothing gives it an inertia; leave it out, or add a [[mass]]"));
    }
  }

  void number_coordinates(Index offset) {
    for (std::size_t node = 0; node < states_.size(); ++node) {
      const NodeState& state = states_[node];
      if (std::none_of(state.exists.begin(), state.exists.end(), [](bool e) { return e; }))
        throw InvalidInput(state.where, fmt::format("node \"{}\" is joined by nothing: no beam, truss or mass names it",
                                                    built_.structure.names[node]));
      refuse_lost_velocity(node);
      std::array<Index, 6> places{};
      places.fill(ground);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (!state.exists[axis] && !state.is_fixed[axis]) continue;
        std::string name = built_.structure.names[node] + "." + axis_names[axis];
        if (state.is_fixed[axis]) {
          built_.fixed.insert(std::move(name));
          continue;
        }
        places[axis] = offset + static_cast<Index>(built_.coordinates.size());
        built_.coordinates.push_back({std::move(name), is_rotation(axis), state.mass[axis], state.velocity[axis]});
      }
      built_.structure.places.push_back(places);
    }
  }

  const StructureDescription& description_;
  const Parameters& parameters_;
  BuiltStructure built_;
  ByName<Index> nodes_{"node"};
  ByName<Material> materials_{"material"};
  ByName<Section> sections_{"section"};
  ByName<int> lines_{"element"};  // beams and trusses that have a name
  // Where the others of each kind were given, by the nodes that they join.
  std::map<std::string, std::map<std::pair<Index, Index>, const Location*>> unnamed_;
  std::vector<NodeState> states_;
};

}  // namespace

void refuse_unfit_name(const std::string& name, const Location& where) {
  const auto is_unfit = [](unsigned char c) {
    return c < 0x20 || c == 0x7f || c == ',' || c == ';' || c == '"' || c == '/';
  };
  if (name.empty() || (name.front() != ' ' && name.back() != ' ' && name.find(" - ") == std::string::npos &&
                       std::none_of(name.begin(), name.end(), is_unfit)))
    return;
  std::string shown = name;
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  throw InvalidInput(where,
                     fmt::format("the name \"{}\" cannot head a column of results: no comma, semicolon, quote, slash, "
                                 "control character, \" - \", or space at its ends",
                                 shown));
}

BuiltStructure build_structure(const StructureDescription& description, const Parameters& parameters, Index offset) {
  return StructureBuilder(description, parameters).build(offset);
}

}  // namespace rubato::model
