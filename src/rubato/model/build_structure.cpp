#include <rubato/model/build_sections.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/build_structure_nodes.hpp>
#include <rubato/model/by_name.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
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
      : description_(description), parameters_(parameters), nodes_(description, parameters, built_.structure) {}

  BuiltStructure build(Index offset) {
    nodes_.take_given();
    materials_ = build_materials(description_.materials, parameters_);
    sections_ = build_sections(description_.sections, in_plane(), parameters_);
    for (const BeamDescription& beam : description_.beams) take_beam(beam);
    for (const TrussDescription& truss : description_.trusses) take_truss(truss);
    nodes_.take_masses_and_supports();
    nodes_.number(offset, built_);
    return std::move(built_);
  }

 private:
  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }
  bool in_plane() const { return built_.structure.dimension == 2; }

  static std::string part_of(const LineDescription& line, const char* kind) {
    return line.name.empty() ? fmt::format("the {} from \"{}\" to \"{}\"", kind, line.nodes[0], line.nodes[1])
                             : fmt::format("{} \"{}\"", kind, line.name);
  }

  void add_name(const LineDescription& line, std::size_t count) {
    if (!line.name.empty()) lines_.add(line.name, line.where, 0);
    const std::string name = line.name.empty() ? line.nodes[0] + "-" + line.nodes[1] : line.name;
    built_.lines.push_back({name, built_.structure.elements.size(), count, !line.name.empty()});
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
    p.retardation_time = material.retardation_time;
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
    built_.beams.push_back({name, built_.structure.elements.size(), static_cast<std::size_t>(beam.elements)});
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
      element.second = nodes_.add_between(between, beam.where, first, last, share);
      element.properties = properties_at(i == 1, false);
      add_element(element, true, beam.release_where);
      element.first = element.second;
    }
    element.second = last;
    element.properties = properties_at(beam.elements == 1, true);
    add_element(element, true, beam.release_where);
  }

  void add_element(const LineElement& element, bool is_beam, const Location& where) {
    built_.structure.elements.push_back(element);
    const std::uint16_t released = built_.structure.properties[static_cast<std::size_t>(element.properties)].released;
    if (released != 0) return take_kept_axes(element, released, where);
    for (const Index node : {element.first, element.second}) nodes_.give_axes(node, is_beam);
  }

  /// An element has inertia in every motion of the axes that it does not release, and in no other: a degree of freedom
  /// that all elements of a node release does not exist.
  void take_kept_axes(const LineElement& element, std::uint16_t released, const Location& where) {
    const Eigen::Matrix3d axes = axes_of(built_.structure, element, true);
    const int width = in_plane() ? 3 : 6;
    static constexpr std::array<std::size_t, 3> of_plane{0, 1, 5};
    for (const bool is_second : {false, true}) {
      std::array<bool, 6> is_kept{};
      for (int i = 0; i < width; ++i) {
        const auto place = static_cast<std::size_t>(i);
        is_kept[in_plane() ? of_plane[place] : place] = (released >> (is_second ? width + i : i) & 1) == 0;
      }
      nodes_.give_kept_axes(is_second ? element.second : element.first, is_kept, axes, where);
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
    add_element({ends[0], ends[1], add_properties(p), Axis::Zero()}, false, truss.where);
  }

  const StructureDescription& description_;
  const Parameters& parameters_;
  BuiltStructure built_;
  StructureNodes nodes_;
  ByName<Material> materials_{"material"};
  ByName<Section> sections_{"section"};
  ByName<int> lines_{"element"};  // beams and trusses that have a name
  // Where the others of each kind were given, by the nodes that they join.
  std::map<std::string, std::map<std::pair<Index, Index>, const Location*>> unnamed_;
};

}  // namespace

BuiltStructure build_structure(const StructureDescription& description, const Parameters& parameters, Index offset) {
  return StructureBuilder(description, parameters).build(offset);
}

}  // namespace rubato::model
