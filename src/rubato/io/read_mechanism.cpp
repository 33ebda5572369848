#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace rubato::io {
namespace {

using namespace model;

/// A point or vector of the model; empty where the key is missing.
std::vector<Quantity> optional_point(TomlReader& reader, const std::string& key) {
  return reader.optional_quantities(key).value_or(std::vector<Quantity>{});
}

/// One number in the plane, a list in space.
std::vector<Quantity> optional_one_or_more(TomlReader& reader, const std::string& key) {
  const toml::node* found = reader.node(key);
  if (!found) return {};
  if (found->is_array()) return *reader.optional_quantities(key);
  return {*reader.optional_quantity(key)};
}

ShapeDescription read_shape(TomlReader& reader) {
  const std::vector<std::string> kinds{"box", "cylinder", "sphere"};
  ShapeDescription shape;
  shape.where = reader.where();
  const auto kind = reader.optional_word("kind", kinds);
  if (!kind) {
    reader.refuse_misspelling_of("kind");
    throw InvalidInput(reader.where(),
                       fmt::format("{} lacks the key \"kind\": \"box\", \"cylinder\" or \"sphere\"", reader.what()));
  }
  shape.kind = static_cast<ShapeDescription::Kind>(std::find(kinds.begin(), kinds.end(), *kind) - kinds.begin());
  if (shape.kind == ShapeDescription::Kind::box) {
    shape.size = optional_point(reader, "size");
    if (shape.size.size() != 3) {
      reader.refuse_misspelling_of("size");
      throw InvalidInput(
          reader.where("size"),
          fmt::format("{} needs \"size\": three lengths along x, y and z of the body [m]", reader.what()));
    }
  } else {
    shape.radius = reader.quantity("radius");
    if (shape.kind == ShapeDescription::Kind::cylinder) shape.length = reader.quantity("length");
  }
  shape.density = reader.optional_quantity("density");
  reader.finish();
  return shape;
}

/// A body has a mass and an inertia, or a shape and a mass, or a shape and a density.
void read_inertia(TomlReader& reader, BodyDescription& body) {
  body.mass = reader.optional_quantity("mass");
  body.inertia = optional_one_or_more(reader, "inertia");
  body.inertia_where = reader.where("inertia");
  if (auto shape = reader.optional_table("shape", fmt::format("{}: shape", reader.what()))) {
    body.shape = read_shape(*shape);
    if (!body.inertia.empty())
      throw InvalidInput(body.inertia_where,
                         fmt::format("{}: inertia follows from its shape; remove one of them", reader.what()));
    if (body.mass.has_value() == body.shape->density.has_value())
      throw InvalidInput(body.shape->where, fmt::format("{}: its shape needs \"density\" [kg/m3], or the body \"mass\" "
                                                        "[kg]; one of them",
                                                        reader.what()));
    return;
  }
  if (!body.mass) {
    reader.refuse_misspelling_of("mass");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"mass\"", reader.what()));
  }
  if (body.inertia.empty()) {
    reader.refuse_misspelling_of("inertia");
    throw InvalidInput(reader.where(),
                       fmt::format("{} lacks the key \"inertia\" [kg m2]; a mass that does not turn is a [[node]] with "
                                   "a [[mass]]",
                                   reader.what()));
  }
}

BodyDescription read_body(TomlReader& reader) {
  BodyDescription body;
  body.name = reader.name("name", &body.where);
  reader.rename(fmt::format("body \"{}\"", body.name));
  read_inertia(reader, body);
  body.position = optional_point(reader, "position");
  if (body.position.empty()) {
    reader.refuse_misspelling_of("position");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"position\"", reader.what()));
  }
  body.angle = reader.optional_quantity("angle");
  body.rotation = optional_point(reader, "rotation");
  body.rotation_where = reader.where("rotation");
  if (body.rotation.size() == 4)
    throw InvalidInput(
        body.rotation_where,
        fmt::format("{}: rotation is a rotation vector of three numbers, the axis times the angle [rad], "
                    "and no quaternion: of (w, x, y, z) it is 2 acos(w)/sin(acos(w)) times [x, y, z]",
                    reader.what()));
  body.velocity = optional_point(reader, "velocity");
  body.angular_velocity = optional_one_or_more(reader, "angular_velocity");
  reader.finish();
  return body;
}

LockDescription read_lock(TomlReader& reader) {
  LockDescription lock;
  lock.where = reader.where();
  lock.at = reader.quantity("at");
  const auto kind = reader.optional_word("kind", {"stop", "latch"});
  if (!kind) {
    reader.refuse_misspelling_of("kind");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"kind\": \"stop\" or \"latch\"", reader.what()));
  }
  lock.is_latch = *kind == "latch";
  lock.stiffness = reader.optional_quantity("stiffness");
  lock.damping = reader.optional_quantity("damping");
  if (lock.damping && !lock.stiffness)
    throw InvalidInput(lock.damping->where,
                       fmt::format("{}: damping goes with a stiffness; without one the lock is rigid", reader.what()));
  reader.finish();
  return lock;
}

/// A joint that turns takes the radius at which it rubs.
FrictionDescription read_friction(TomlReader& reader, JointDescription::Type type) {
  const bool is_screw = type == JointDescription::Type::screw;
  const bool turns = is_screw || type == JointDescription::Type::revolute ||
                     type == JointDescription::Type::cylindrical || type == JointDescription::Type::universal;
  FrictionDescription friction;
  friction.where = reader.where();
  friction.coefficient = reader.quantity("coefficient");
  friction.preload = reader.optional_quantity("preload");
  if (const toml::node* load = reader.node("normal_load"); load && load->value_or<std::string>("") != "reaction")
    throw InvalidInput(reader.where("normal_load"),
                       fmt::format("{}: normal_load is \"reaction\", the joint's own; a load that is given [N] is "
                                   "\"preload\"",
                                   reader.what()));
  const auto load = reader.optional_word("normal_load", {"reaction"});
  if (!friction.preload && !load) {
    reader.refuse_misspelling_of("normal_load");
    reader.refuse_misspelling_of("preload");
  }
  if (friction.preload.has_value() == load.has_value())
    throw InvalidInput(reader.where(),
                       fmt::format("{} needs either \"preload\" [N] or normal_load = \"reaction\"", reader.what()));
  friction.radius = reader.optional_quantity("radius");
  if (turns && !friction.radius) {
    reader.refuse_misspelling_of("radius");
    throw InvalidInput(reader.where(),
                       fmt::format("{} lacks the key \"radius\", of the {} [m]: the moment is coefficient * load * "
                                   "radius{}",
                                   reader.what(), is_screw ? "thread in the middle of its flanks" : "pin",
                                   is_screw ? " / cos^2 of the lead angle" : ""));
  }
  if (!turns && friction.radius)
    throw InvalidInput(
        friction.radius->where,
        fmt::format("{}: radius belongs to a revolute, cylindrical, universal or screw joint", reader.what()));
  reader.finish();
  return friction;
}

/// What rubs in a joint that takes no friction can be built of joints that do.
std::string instead_of(const std::string& key, const std::string& type) {
  if (key != "friction") return {};
  if (type != "spherical") return "; nothing moves in it that could rub";
  return "; take three revolute joints in a row, with small bodies between them, each with its own friction";
}

/// The keys that belong to one type of joint each; others are refused with the types that take them.
void refuse_foreign_keys(TomlReader& reader, const std::string& type) {
  const std::vector<std::string> of_one_coordinate{"revolute", "prismatic", "screw", "strut"};
  const std::map<std::string, std::vector<std::string>> takers{
      {"angle", {"revolute", "screw"}},
      {"moment", {"revolute", "screw"}},
      {"displacement", {"prismatic"}},
      {"force", {"prismatic", "strut"}},
      {"axis", {"revolute", "prismatic", "cylindrical", "universal", "planar", "screw"}},
      {"second_axis", {"universal"}},
      {"lead", {"screw"}},
      {"length", {"distance"}},
      {"drive", of_one_coordinate},
      {"stiffness", of_one_coordinate},
      {"damping", of_one_coordinate},
      {"rest", of_one_coordinate},
      {"friction", {"revolute", "prismatic", "cylindrical", "universal", "planar", "screw", "strut"}},
      {"lock", of_one_coordinate}};
  for (const auto& [key, types] : takers) {
    if (!reader.has(key) || std::find(types.begin(), types.end(), type) != types.end()) continue;
    const std::string last = types.size() > 1 ? " or " + types.back() : "";
    throw InvalidInput(reader.where(key),
                       fmt::format("{}: \"{}\" belongs to a {}{} joint, and this one is {}{}", reader.what(), key,
                                   fmt::join(types.begin(), types.end() - (types.size() > 1 ? 1 : 0), ", "), last, type,
                                   instead_of(key, type)));
  }
}

const std::vector<std::string> joint_types{"rigid",     "revolute",  "prismatic", "distance", "cylindrical",
                                           "spherical", "universal", "planar",    "screw",    "strut"};

/// A formula of t, or { table = "file.csv" }.
DriveDescription read_drive(TomlReader& reader, const StudyFolder& folder) {
  DriveDescription drive;
  drive.where = reader.where("drive");
  if (!reader.node("drive")->is_table()) {
    TimeFormulaDescription formula{reader.quantity("drive")};
    if (formula.formula.expression.empty()) formula.formula.expression = fmt::format("{}", formula.formula.value);
    drive.law = formula;
    return drive;
  }
  auto inner = reader.optional_table("drive", fmt::format("{}: drive", reader.what()));
  TableDescription table = read_table(inner->text("table"), folder, inner->where("table"), {"rad", "m"});
  if (inner->optional_word("beyond", {"error", "hold"}) == "hold") table.beyond = TableDescription::Beyond::hold;
  inner->finish();
  drive.law = table;
  return drive;
}

/// The law of the moment or force: a formula, or { table = "file.csv" } over the coordinate.
void read_law(TomlReader& reader, const StudyFolder& folder, JointDescription& joint) {
  const bool is_strut = joint.type == JointDescription::Type::strut;
  const bool slides = is_strut || joint.type == JointDescription::Type::prismatic;
  const std::string key = slides ? "force" : "moment";
  const toml::node* node = slides ? reader.node("force") : reader.node("moment");
  if (!node || !node->is_table()) {
    joint.drive = slides ? reader.optional_quantity("force") : reader.optional_quantity("moment");
    return;
  }
  auto inner = reader.optional_table(key, fmt::format("{}: {}", reader.what(), key));
  const TableOver over = slides ? TableOver{is_strut ? "length" : "displacement", "m"} : TableOver{"angle", "rad"};
  joint.drive_table = read_table(inner->text("table"), folder, inner->where("table"), {slides ? "N" : "N m"}, over);
  const auto beyond = inner->optional_word("beyond", {"error", "zero", "hold"});
  if (beyond == "zero") joint.drive_table->beyond = TableDescription::Beyond::zero;
  if (beyond == "hold") joint.drive_table->beyond = TableDescription::Beyond::hold;
  inner->finish();
}

JointDescription read_joint(TomlReader& reader, std::size_t number, const StudyFolder& folder) {
  JointDescription joint;
  joint.name = reader.optional_text("name").value_or(fmt::format("joint{}", number));
  joint.where = reader.where("name");
  reader.rename(fmt::format("joint \"{}\"", joint.name));
  const auto type = reader.optional_word("type", joint_types);
  if (!type) {
    reader.refuse_misspelling_of("type");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"type\": \"{}\"", reader.what(),
                                                   fmt::join(joint_types, "\", \"")));
  }
  joint.type = static_cast<JointDescription::Type>(std::find(joint_types.begin(), joint_types.end(), *type) -
                                                   joint_types.begin());
  refuse_foreign_keys(reader, *type);
  joint.between = reader.between("between", joint.between_where);
  joint.at = optional_point(reader, "at");
  joint.at_where = reader.where("at");
  joint.to = optional_point(reader, "to");
  joint.to_where = reader.where("to");
  joint.axis = optional_point(reader, "axis");
  joint.axis_where = reader.where("axis");
  joint.second_axis = optional_point(reader, "second_axis");
  joint.second_axis_where = reader.where("second_axis");
  joint.lead = reader.optional_quantity("lead");
  const bool is_prismatic = joint.type == JointDescription::Type::prismatic;
  if (is_prismatic && joint.axis.empty()) {
    reader.refuse_misspelling_of("axis");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"axis\"", reader.what()));
  }
  joint.value = is_prismatic ? reader.optional_quantity("displacement") : reader.optional_quantity("angle");
  read_law(reader, folder, joint);
  if (reader.has("drive")) joint.motion = read_drive(reader, folder);
  joint.length = reader.optional_quantity("length");
  joint.stiffness = reader.optional_quantity("stiffness");
  joint.rest = reader.optional_quantity("rest");
  joint.damping = reader.optional_quantity("damping");
  if (joint.rest && !joint.stiffness)
    throw InvalidInput(joint.rest->where, fmt::format("{}: rest goes with a stiffness", reader.what()));
  if (auto friction = reader.optional_table("friction", fmt::format("{}: friction", reader.what())))
    joint.friction = read_friction(*friction, joint.type);
  if (const toml::node* lock = reader.node("lock"); lock && lock->is_array())
    throw InvalidInput(reader.where("lock"),
                       fmt::format("{}: lock must be one table {{ ... }}: a joint has one lock; give another to a "
                                   "[[joint]] of type = \"strut\" between points of the same parts",
                                   reader.what()));
  if (auto lock = reader.optional_table("lock", fmt::format("{}: lock", reader.what()))) joint.lock = read_lock(*lock);
  reader.finish();
  return joint;
}

}  // namespace

void read_mechanism(TomlReader& root, const StudyFolder& folder, ModelDescription& model) {
  for (const std::string& type : joint_types)
    root.note_elsewhere(type, fmt::format("write [[joint]] with type = \"{}\"", type));
  root.note_elsewhere("hinge", "write [[joint]] with type = \"revolute\"");
  for (TomlReader& reader : root.tables("body")) model.bodies.push_back(read_body(reader));
  for (TomlReader& reader : root.tables("joint"))
    model.joints.push_back(read_joint(reader, model.joints.size() + 1, folder));
}

}  // namespace rubato::io
