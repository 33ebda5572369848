#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/load_fields.hpp>
#include <rubato/model/joints/joint_kinds.hpp>

#include <fmt/format.h>

#include <map>
#include <string_view>

// The keys of bodies and of the joints between them.
namespace rubato::model {

void fields(auto& visit, Like<ShapeDescription> auto& shape) {
  using Kind = ShapeDescription::Kind;
  visit.where(shape.where);
  visit.word("kind", shape.kind, {{"box", Kind::box}, {"cylinder", Kind::cylinder}, {"sphere", Kind::sphere}},
             {.required = true, .says = "a cylinder lies along z of the body"});
  if (visit.applies(shape.kind == Kind::box)) {
    visit.quantities("size", shape.size, {3, 3}, {.unit = "m", .says = "of a box, along x, y and z of the body"});
    visit.check([&](auto& reader) {
      if (shape.size.size() == 3) return;
      reader.refuse_misspelling_of("size");
      throw InvalidInput(reader.where("size"), reader.what() +
                                                   " needs \"size\": three lengths along x, y and z of the "
                                                   "body [m]");
    });
  }
  if (visit.applies(shape.kind != Kind::box))
    visit.quantity("radius", shape.radius, {.required = true, .unit = "m", .says = "of a cylinder or a sphere"});
  if (visit.applies(shape.kind == Kind::cylinder))
    visit.quantity("length", shape.length, {.required = true, .unit = "m", .says = "of a cylinder"});
  visit.quantity("density", shape.density, {.unit = "kg/m3", .says = "or the mass of the body"});
  visit.of_words("kind", {{"box", {"size"}}, {"cylinder", {"radius", "length"}}, {"sphere", {"radius"}}});
}

void fields(auto& visit, Like<BodyDescription> auto& body) {
  visit.name("name", body.name, body.where, {.required = true, .says = "unique among nodes and bodies"});
  visit.title("body", body.name);
  visit.quantity("mass", body.mass,
                 {.unit = "kg", .says = "of a shape it may follow from the density", .range = Range::positive});
  visit.one_or_more(
      "inertia", body.inertia, {1, 6},
      {.unit = "kg m2",
       .says = "about the centre of mass; one number in the plane; in space, in the axes of the body, xx, "
               "yy, zz, or these and the entries xy, xz, yz of the matrix",
       .range = Range::positive});
  visit.where(body.inertia_where, "inertia");
  visit.table("shape", body.shape, {.says = "of one material, instead of the inertia"});
  visit.check([&](auto& reader) {
    if (body.shape) {
      if (!body.inertia.empty())
        throw InvalidInput(body.inertia_where, reader.what() + ": inertia follows from its shape; remove one of them");
      if (body.mass.has_value() == body.shape->density.has_value())
        throw InvalidInput(body.shape->where, reader.what() +
                                                  ": its shape needs \"density\" [kg/m3], or the body "
                                                  "\"mass\" [kg]; one of them");
      return;
    }
    if (!body.mass) reader.refuse_to_lack("mass");
    if (body.inertia.empty())
      reader.refuse_to_lack("inertia", " [kg m2]; a mass that does not turn is a [[node]] with a [[mass]]");
  });
  visit.quantities("position", body.position, {2, 3},
                   {.required = true, .unit = "m", .says = "of the centre of mass at the start"});
  visit.quantity("angle", body.angle, {.unit = "rad", .says = "at the start, in the plane", .unless = "0"});
  visit.quantities(
      "rotation", body.rotation, {3, 3},
      {.unit = "rad", .says = "at the start, in space: a rotation vector, the axis times the angle", .unless = "none"});
  visit.where(body.rotation_where, "rotation");
  visit.check([&](auto& reader) {
    if (body.rotation.size() == 4)
      throw InvalidInput(body.rotation_where,
                         reader.what() +
                             ": rotation is a rotation vector of three numbers, the axis times the angle "
                             "[rad], and no quaternion: of (w, x, y, z) it is 2 acos(w)/sin(acos(w)) times "
                             "[x, y, z]");
  });
  visit.quantities("velocity", body.velocity, {2, 3},
                   {.unit = "m/s", .says = "of the centre of mass at the start", .unless = "at rest"});
  visit.one_or_more(
      "angular_velocity", body.angular_velocity, {1, 3},
      {.unit = "rad/s", .says = "at the start, in space about the axes of the body", .unless = "at rest"});
  visit.rule(R"({"anyOf": [
    {"required": ["mass", "inertia"], "not": {"required": ["shape"]}},
    {"required": ["mass", "shape"], "not": {"required": ["inertia"]},
     "properties": {"shape": {"not": {"required": ["density"]}}}},
    {"required": ["shape"], "not": {"anyOf": [{"required": ["mass"]}, {"required": ["inertia"]}]},
     "properties": {"shape": {"required": ["density"]}}}]})");
}

void fields(auto& visit, Like<LockDescription> auto& lock) {
  visit.where(lock.where);
  visit.quantity("at", lock.at, {.required = true, .says = "the angle [rad] or displacement [m] where it locks"});
  visit.word(
      "kind", lock.is_latch, {{"stop", false}, {"latch", true}},
      {.required = true, .says = "a stop holds from one side and lets go; a latch holds for good and ends the drive"});
  using LockSide = LockDescription::Side;
  visit.word("side", lock.side, {{"below", LockSide::below}, {"above", LockSide::above}},
             {.says = "which values are free; needed by a joint that starts at its lock", .unless = "where it starts"});
  visit.quantity("stiffness", lock.stiffness, {.unit = "N m/rad or N/m", .unless = "rigid", .range = Range::positive});
  visit.quantity("damping", lock.damping, {.unit = "N m s/rad or N s/m", .says = "goes with a stiffness"});
  visit.requires_beside("damping", "stiffness");
  visit.check([&](auto& reader) {
    if (lock.damping && !lock.stiffness)
      throw InvalidInput(lock.damping->where,
                         reader.what() + ": damping goes with a stiffness; without one the lock is rigid");
  });
}

void fields(auto& visit, Like<FrictionDescription> auto& friction, JointDescription::Type type) {
  visit.where(friction.where);
  visit.quantity("coefficient", friction.coefficient,
                 {.required = true, .unit = "-", .says = "mu", .range = Range::not_negative});
  visit.quantity("preload", friction.preload, {.unit = "N", .says = "N; or normal_load", .range = Range::not_negative});
  visit.check([&](auto& reader) {
    if (reader.has("normal_load") && reader.plain_text("normal_load") != "reaction")
      throw InvalidInput(reader.where("normal_load"),
                         reader.what() +
                             ": normal_load is \"reaction\", the joint's own; a load that is given [N] is "
                             "\"preload\"");
  });
  bool is_reaction = !friction.preload;
  visit.word("normal_load", is_reaction, {{"reaction", true}},
             {.says = "N is the joint's own reaction at the same instant"});
  visit.check([&](auto& reader) {
    const bool has_load = reader.has("normal_load");
    if (!friction.preload && !has_load) {
      reader.refuse_misspelling_of("normal_load");
      reader.refuse_misspelling_of("preload");
    }
    if (friction.preload.has_value() == has_load)
      throw InvalidInput(reader.where(), reader.what() + " needs either \"preload\" [N] or normal_load = \"reaction\"");
  });
  visit.exactly_one_of({"preload", "normal_load"});
  visit.quantity(
      "radius", friction.radius,
      {.unit = "m",
       .says = "of the pins of a revolute, cylindrical or universal joint: its moment is mu N radius; of the "
               "thread of a screw, in the middle of its flanks"});
  visit.check([&](auto& reader) {
    const bool is_screw = type == JointDescription::Type::screw;
    if (joint_kind(type).has_radius_of_friction && !friction.radius)
      reader.refuse_to_lack("radius", fmt::format(", of the {} [m]: the moment is coefficient * load * radius{}",
                                                  is_screw ? "thread in the middle of its flanks" : "pin",
                                                  is_screw ? " / cos^2 of the lead angle" : ""));
    if (!joint_kind(type).has_radius_of_friction && friction.radius)
      throw InvalidInput(friction.radius->where,
                         reader.what() + ": radius belongs to a revolute, cylindrical, universal or screw joint");
  });
}

/// Which types of joint take a key, of those that not all take.
inline std::vector<std::pair<const char*, std::vector<const char*>>> takers_of_joint_keys() {
  std::map<std::string_view, std::vector<const char*>> takers;
  for (const JointKind& kind : joint_kinds())
    for (const char* key : kind.keys) takers[key].push_back(kind.name);
  std::vector<std::pair<const char*, std::vector<const char*>>> list;
  for (const auto& [key, names] : takers) list.emplace_back(key.data(), names);
  return list;
}

/// Which keys a type of joint needs, in the words of JSON schema.
inline std::string needed_joint_keys() {
  std::string rules;
  for (const JointKind& kind : joint_kinds())
    if (!kind.needed_keys.empty())
      rules +=
          fmt::format(R"({{"if": {{"properties": {{"type": {{"const": "{}"}}}}}}, "then": {{"required": ["{}"]}}}},)",
                      kind.name, fmt::join(kind.needed_keys, R"(", ")"));
  return rules;
}

/// What rubs in a joint that takes no friction can be built of joints that do.
inline std::string instead_of_joint_key(const std::string& key, const std::string& type) {
  if (key != "friction") return {};
  if (type != "spherical") return "; nothing moves in it that could rub";
  return "; take three revolute joints in a row, with small bodies between them, each with its own friction";
}

inline std::vector<Choice<JointDescription::Type>> joint_types() {
  std::vector<Choice<JointDescription::Type>> types;
  for (const JointKind& kind : joint_kinds()) types.push_back({kind.name, kind.type});
  return types;
}

void fields(auto& visit, Like<JointDescription> auto& joint) {
  using Type = JointDescription::Type;
  visit.numbered_name("joint", joint.name, joint.where, {.says = "of results and messages"});
  visit.word(
      "type", joint.type, joint_types(),
      {.required = true,
       .says = "a distance is a rigid link without mass; a strut holds nothing, and acts along the line between its "
               "ends; cylindrical, spherical, universal, planar and screw in space"});
  visit.belong("type", takers_of_joint_keys(), "joint", instead_of_joint_key);
  visit.between("between", joint.between, joint.between_where,
                {.required = true, .says = "nodes, bodies or \"ground\""});
  visit.quantities(
      "at", joint.at, {2, 3},
      {.unit = "m", .says = "its place on the first, in the configuration given", .unless = "that of its node"});
  visit.where(joint.at_where, "at");
  visit.quantities("to", joint.to, {2, 3},
                   {.unit = "m", .says = "its place on the second", .unless = "the same; of a distance, its node's"});
  visit.where(joint.to_where, "to");
  const bool is_prismatic = joint.type == Type::prismatic;
  visit.quantities("axis", joint.axis, {2, 3},
                   {.required = is_prismatic,
                    .unit = "-",
                    .says = "of a prismatic joint; in space of all but rigid, spherical and distance"});
  visit.where(joint.axis_where, "axis");
  visit.quantities(
      "second_axis", joint.second_axis, {3, 3},
      {.unit = "-",
       .says = "of a universal joint: the axis that belongs to its second part, at a right angle to axis"});
  visit.where(joint.second_axis_where, "second_axis");
  visit.quantity("lead", joint.lead, {.unit = "m", .says = "of a screw, a turn; negative: left-handed"});
  if (visit.applies(is_prismatic))
    visit.quantity("displacement", joint.value,
                   {.unit = "m", .says = "of a prismatic joint in the configuration given", .unless = "0"});
  if (visit.applies(!is_prismatic))
    visit.quantity("angle", joint.value,
                   {.unit = "rad", .says = "of a revolute joint or a screw in the configuration given", .unless = "0"});
  visit.quantity("rate", joint.rate,
                 {.unit = "rad/s or m/s",
                  .says = "of its angle, displacement or length at the start; bodies whose velocities are not given "
                          "follow",
                  .unless = "as its parts move"});
  const bool is_strut = joint.type == Type::strut;
  const bool slides = is_strut || is_prismatic;
  if (visit.applies(slides))
    visit.quantity_or_table(
        "force", joint.drive, joint.drive_table,
        {.units = {"N"},
         .over = is_strut ? "length" : "displacement",
         .over_unit = "m",
         .says = "a CSV file of displacement or length [m] and value, interpolated linearly; relative to the study"},
        {.unit = "N",
         .says = "of a prismatic joint or a strut, + on the second, which lengthens it; may use displacement (of a "
                 "strut length), rate and t; or a table",
         .role = Role::none});
  if (visit.applies(!slides))
    visit.quantity_or_table(
        "moment", joint.drive, joint.drive_table,
        {.units = {"N m"},
         .over = "angle",
         .over_unit = "rad",
         .says = "a CSV file of angle [rad] and value, interpolated linearly; relative to the study"},
        {.unit = "N m",
         .says = "of a revolute joint or a screw, + on the second; may use angle, rate and t; or a table",
         .role = Role::none});
  visit.formula_or_table("drive", joint.motion, {.units = {"rad", "m"}, .may_be_zero_beyond = false},
                         {.unit = "rad or m",
                          .says = "how the angle or displacement moves, whatever it takes: a formula of t, or a table",
                          .role = Role::none});
  visit.quantity("length", joint.length, {.unit = "m", .says = "of a distance", .unless = "as its ends lie"});
  visit.quantity("stiffness", joint.stiffness,
                 {.unit = "N m/rad or N/m", .says = "of a spring on the angle or displacement"});
  visit.quantity("rest", joint.rest,
                 {.unit = "rad or m", .says = "where the spring is at rest", .unless = "in the configuration given"});
  visit.quantity("damping", joint.damping,
                 {.unit = "N m s/rad or N s/m", .says = "of a damper on the angle or displacement"});
  visit.requires_beside("rest", "stiffness");
  visit.check([&](auto& reader) {
    if (joint.rest && !joint.stiffness)
      throw InvalidInput(joint.rest->where, reader.what() + ": rest goes with a stiffness");
  });
  visit.table("friction", joint.friction, {.says = "Coulomb friction on its coordinate"}, joint.type);
  visit.table_or_tables("lock", joint.locks, {.says = "a limit of the angle or displacement, or a list of them"});
  visit.excludes("drive", "friction");
  visit.excludes("drive", "lock");
  visit.excludes("drive", "rate");
  std::vector<const char*> with_radius;
  for (const JointKind& kind : joint_kinds())
    if (kind.has_radius_of_friction) with_radius.push_back(kind.name);
  visit.rule(fmt::format(R"({{"allOf": [{}
    {{"if": {{"required": ["friction"], "properties": {{"type": {{"enum": ["{}"]}}}}}},
     "then": {{"properties": {{"friction": {{"required": ["radius"]}}}}}},
     "else": {{"properties": {{"friction": {{"properties": {{"radius": false}}}}}}}}}}]}})",
                         needed_joint_keys(), fmt::join(with_radius, R"(", ")")));
}

void fields(auto& visit, Like<GearDescription> auto& gear) {
  visit.numbered_name("gear", gear.name, gear.where, {.says = "of results and messages"});
  visit.between(
      "joints", gear.joints, gear.joints_where,
      {.required = true, .says = "which leave one coordinate free each: the first moves ratio times the second"});
  visit.quantity(
      "ratio", gear.ratio,
      {.required = true, .unit = "-, m or 1/m", .says = "negative: against it; of a rack, in m, the radius"});
}

void fields(auto& visit, Like<BushingDescription> auto& bushing) {
  visit.numbered_name("bushing", bushing.name, bushing.where, {.says = "of results and messages"});
  visit.between("between", bushing.between, bushing.between_where,
                {.required = true, .says = "nodes, bodies or \"ground\"; its axes turn with the first"});
  visit.quantities("at", bushing.at, {2, 3},
                   {.unit = "m", .says = "its place, in the configuration given", .unless = "that of its node"});
  visit.where(bushing.at_where, "at");
  visit.quantities("axis", bushing.axis, {2, 2},
                   {.unit = "-", .says = "in the plane: its x", .unless = "x of the world"});
  visit.where(bushing.axis_where, "axis");
  visit.quantities("rotation", bushing.rotation, {3, 3},
                   {.unit = "rad",
                    .says = "in space: a rotation vector, which turns the axes of the world into its own",
                    .unless = "none"});
  visit.where(bushing.rotation_where, "rotation");
  visit.quantities("stiffness", bushing.stiffness, {3, 6},
                   {.required = true,
                    .unit = "N/m and N m/rad",
                    .says = "along x and y and about z; in space along x, y and z, and about them",
                    .range = Range::not_negative});
  visit.where(bushing.stiffness_where, "stiffness");
  visit.quantities("damping", bushing.damping, {3, 6},
                   {.unit = "N s/m and N m s/rad", .says = "likewise", .unless = "0", .range = Range::not_negative});
  visit.where(bushing.damping_where, "damping");
}

}  // namespace rubato::model
