#include <rubato/model/build_contact_values.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace rubato::model {
namespace {

class ContactOfParts {
 public:
  ContactOfParts(const MechanismAssembly& assembly, const ContactDescription& description)
      : assembly_(assembly),
        d_(description),
        read_(description, assembly.parameters, assembly.mechanism.dimension),
        part_(read_.part()) {}

  MechanismContact build() const {
    refuse_what_structures_take();
    const std::array<Index, 2> node{node_of(0), node_of(1)};
    if (node[0] == node[1])
      throw InvalidInput(d_.between_where[1], fmt::format("{} joins \"{}\" with itself", part_, d_.between[1]));
    const Axis at = point_of_first(node[0]), n = read_.normal();
    const double radius = d_.radius ? read_.positive(*d_.radius, "radius") : 0.0;
    const std::vector<Axis> plane = read_.along(n);
    const Index directions = d_.friction_coefficient ? static_cast<Index>(plane.size()) : 0;
    refuse_rolling_spheres(directions);
    ContactValues values = read_.values(directions);
    Axis to = at - (radius + values.gap) * n;
    if (!d_.to.empty()) {
      to = assembly_.point(d_.to, d_.to_where, part_ + ": to");
      values.gap = n.dot(at - to) - radius;
    }
    MechanismContact contact;
    contact.name = d_.name;
    for (Index i = 0; i < directions; ++i)
      contact.numbers.push_back(number_along(node, at, to, plane[static_cast<std::size_t>(i)], 1.0, radius));
    contact.numbers.push_back(number_along(node, at, to, n, -1.0, 0.0));
    contact.law = make_elastic_contact(values);
    return contact;
  }

 private:
  void refuse_what_structures_take() const {
    if (!d_.normal.empty())
      throw InvalidInput(d_.normal_where,
                         fmt::format("{}: shares are of the coordinates of structures, and this model has joints or "
                                     "bodies; take between, a normal_direction and `at`, the point of the first part",
                                     part_));
    if (d_.sliding_velocity)
      throw InvalidInput(d_.sliding_velocity->where,
                         fmt::format("{}: sliding_velocity is of structures; in a mechanism let the plane belong to a "
                                     "body that a joint with a drive moves",
                                     part_));
  }

  /// What slips under a sphere in space is no function of where it is.
  void refuse_rolling_spheres(Index directions) const {
    if (d_.radius && directions > 0 && !assembly_.in_plane())
      throw InvalidInput(d_.radius->where,
                         fmt::format("{}: a sphere in space touches without friction; leave out friction_coefficient "
                                     "and tangential_stiffness, or the radius, for a point of the body",
                                     part_));
  }

  Index node_of(std::size_t end) const {
    const std::string& name = d_.between[end];
    if (name == "ground") return 0;
    const auto found = assembly_.nodes.find(name);
    if (found != assembly_.nodes.end()) return found->second;
    std::vector<std::string> known;
    for (const MechanismNode& node : assembly_.mechanism.nodes) known.push_back(node.name);
    throw InvalidInput(d_.between_where[end], fmt::format("{} joins \"{}\", which is no node and no body{}", part_,
                                                          name, suggestion(name, known)));
  }

  Axis point_of_first(Index node) const {
    if (d_.at.empty()) {
      if (node == 0)
        throw InvalidInput(d_.where, fmt::format("{} needs \"at\", the point of the ground that touches [m]", part_));
      return assembly_.position(node);
    }
    const Axis at = assembly_.point(d_.at, d_.at_where, part_ + ": at");
    if (at != assembly_.position(node) && !assembly_.has_axes(node))
      throw InvalidInput(d_.at_where,
                         fmt::format("{}: at is not where \"{}\" is, which has no axes that could carry a point; "
                                     "leave it out, or give the node an inertia or supports that hold its rotations",
                                     part_, d_.between[0]));
    return at;
  }

  /// Along an axis of the second part, from a point of its plane to one of the first part.
  ContactNumber number_along(const std::array<Index, 2>& node, const Axis& at, const Axis& to, const Axis& axis,
                             double sign, double radius) const {
    const Mechanism& mechanism = assembly_.mechanism;
    ContactNumber number;
    number.sign = sign;
    number.radius = radius;
    if (assembly_.in_plane()) {
      PlaneCoordinate s;
      s.kind = PlaneCoordinate::Kind::displacement;
      s.along.first = mechanism.plane_point(node[1], to[0], to[1]);
      s.along.second = mechanism.plane_point(node[0], at[0], at[1]);
      const double angle = mechanism.nodes[static_cast<std::size_t>(node[1])].numbers[2];
      const double c = std::cos(angle), sine = std::sin(angle);
      s.along.direction = {c * axis[0] + sine * axis[1], -sine * axis[0] + c * axis[1]};
      const double turned = mechanism.nodes[static_cast<std::size_t>(node[0])].numbers[2] - angle;
      s.zero = s.value(assembly_.start.data()) - radius * turned;
      number.s = s;
    } else {
      SpaceCoordinate s;
      s.kind = SpaceCoordinate::Kind::displacement;
      s.first = mechanism.space_point(node[1], to);
      s.second = mechanism.space_point(node[0], at);
      s.row = BodyGap{s.first.node.rotation(assembly_.start.data()).conjugate() * axis};
      s.zero = s.value(assembly_.start.data());
      number.s = s;
    }
    return number;
  }

  const MechanismAssembly& assembly_;
  const ContactDescription& d_;
  ContactReading read_;
  std::string part_;
};

}  // namespace

void take_contacts(MechanismAssembly& assembly) {
  for (const ContactDescription& contact : assembly.description.contacts) {
    LawDescription named;
    named.kind = "contact";
    named.name = contact.name;
    named.where = contact.where;
    refuse_taken_name(assembly, named, "a contact", fmt::format("contact \"{}\"", contact.name));
    assembly.mechanism.add_contact(ContactOfParts(assembly, contact).build());
  }
}

}  // namespace rubato::model
