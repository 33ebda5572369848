#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/friction_coefficient.hpp>
#include <rubato/model/joints/joint_kinds.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <variant>

namespace rubato::model {
namespace {

constexpr const char *slider_table = "slider", *stop_table = "stop";

const Lock* stop_called(const Mechanism& mechanism, const std::string& name) {
  const auto& locks = mechanism.locks;
  const auto found = std::find_if(locks.begin(), locks.end(),
                                  [&](const Lock& lock) { return lock.is_stop_part && lock.name == name; });
  return found == locks.end() ? nullptr : &*found;
}

/// The coordinate that a joint leaves free, with its zero.
LawCoordinate coordinate_of_joint(const MechanismAssembly& assembly, const LawDescription& law,
                                  const std::string& part) {
  const auto& joints = assembly.description.joints;
  const auto is_called_so = [&](const auto& joint) { return joint.name == law.joint; };
  const auto joint = std::find_if(joints.begin(), joints.end(), is_called_so);
  if (joint == joints.end())
    throw InvalidInput(law.joint_where, fmt::format("{} acts on \"{}\", which is no joint{}", part, law.joint,
                                                    suggestion(law.joint, assembly.joint_names)));
  const int free = joint_kind(joint->type).free_coordinates;
  if (free == 1) {
    // Of a screw its angle, which comes first.
    const Mechanism& mechanism = assembly.mechanism;
    const auto& in_plane = mechanism.joint_coordinates;
    if (const auto s = std::find_if(in_plane.begin(), in_plane.end(), is_called_so); s != in_plane.end()) return s->s;
    const auto& in_space = mechanism.space_coordinates;
    if (const auto s = std::find_if(in_space.begin(), in_space.end(), is_called_so); s != in_space.end()) return s->s;
  }
  const bool leaves_several = free > 1;
  throw InvalidInput(
      law.joint_where,
      fmt::format("{} acts on the joint \"{}\", which leaves {}; {}", part, law.joint,
                  leaves_several ? "more than one coordinate free" : "no coordinate free",
                  leaves_several
                      ? "build it of revolute and prismatic joints with small bodies between them, or take a "
                        "joint of type \"strut\" between two points"
                      : "take a revolute or a prismatic joint, a screw or a strut"));
}

NumberDifference difference_of(const MechanismAssembly& assembly, const LawDescription& law, const std::string& part) {
  const auto end = [&](std::size_t i) -> NodeNumber {
    if (assembly.fixed.count(law.between[i]) > 0) return {};
    return number_of(assembly, law.between[i], law.between_where[i], part,
                     "let the law act on a revolute joint, with joint = \"NAME\"");
  };
  NumberDifference u;
  u.first = end(0);
  u.second = end(1);
  if (law.between[0] == law.between[1])
    throw InvalidInput(law.between_where[1], fmt::format("{} joins \"{}\" with itself", part, law.between[1]));
  if (u.first.place == u.second.place)
    throw InvalidInput(law.between_where[1], fmt::format("{} joins \"{}\" with \"{}\", and neither moves", part,
                                                         law.between[0], law.between[1]));
  const auto turns = [&](const NodeNumber& number) {
    return assembly.mechanism.is_rotation[static_cast<std::size_t>(number.place)] != 0;
  };
  if (u.first.place != ground && u.second.place != ground && turns(u.first) != turns(u.second))
    throw InvalidInput(law.between_where[1], fmt::format("{} joins a displacement [m] and a rotation [rad]", part));
  u.is_rotation = turns(u.first.place != ground ? u.first : u.second);
  u.zero = u.value(assembly.start.data());
  return u;
}

LawCoordinate place_of(const MechanismAssembly& assembly, const LawDescription& law, const std::string& part) {
  if (law.joint.empty()) return difference_of(assembly, law, part);
  return coordinate_of_joint(assembly, law, part);
}

/// Where a slider or a stop acts, as of other laws.
template <class Description>
LawDescription as_law(const Description& part, const char* table) {
  LawDescription law;
  law.kind = table;
  law.name = part.name;
  law.between = part.between;
  law.between_where = part.between_where;
  law.joint = part.joint;
  law.joint_where = part.joint_where;
  law.where = part.where;
  return law;
}

Index law_called(const Mechanism& mechanism, const std::string& name) {
  const auto& laws = mechanism.laws;
  const auto found = std::find_if(laws.begin(), laws.end(), [&](const auto& law) { return law.name == name; });
  return found == laws.end() ? -1 : static_cast<Index>(found - laws.begin());
}

/// The stop whose force presses, of its own name or of that of its joint; -1 where nothing is called so.
Index pressing_stop(const MechanismAssembly& assembly, const SliderDescription& slider, const std::string& part) {
  const std::string& name = slider.normal_law;
  if (const Lock* stop = stop_called(assembly.mechanism, name)) return stop - assembly.mechanism.locks.data();
  const auto& joints = assembly.joint_names;
  if (std::find(joints.begin(), joints.end(), name) == joints.end()) return -1;
  const auto& locks = assembly.mechanism.locks;
  const auto is_of_it = [&](const Lock& lock) { return lock.name == name; };
  const auto found = std::find_if(locks.begin(), locks.end(), is_of_it);
  const auto refuse = [&](const char* what, const char* remedy) {
    throw InvalidInput(slider.normal_law_where,
                       fmt::format("{}: normal_load names the joint \"{}\", {}; {}", part, name, what, remedy));
  };
  if (found == locks.end())
    refuse("which has no lock", "give it lock = { at = ..., kind = \"stop\", stiffness = ... }");
  if (std::count_if(locks.begin(), locks.end(), is_of_it) > 1)
    refuse("which has several locks",
           "give that which presses a name of its own, as a [[stop]] on this joint, with joint = \"NAME\"");
  if (found->is_latch || found->is_rigid())
    refuse(found->is_latch ? "whose lock is a latch" : "whose stop has no stiffness",
           "what presses is the force of a stop with a stiffness, or of a [[nonlinear_spring]]");
  return static_cast<Index>(found - locks.begin());
}

constexpr std::string_view of_reaction = ".reaction";

/// So many rows of a joint, from the first on, are the force that it holds; none of what holds no force by itself.
int force_rows(JointDescription::Type type, bool in_plane) {
  using Type = JointDescription::Type;
  switch (type) {
    case Type::rigid:
    case Type::revolute:
      return in_plane ? 2 : 3;
    case Type::prismatic:
      return in_plane ? 1 : 2;
    case Type::cylindrical:
      return 2;
    case Type::spherical:
    case Type::universal:
      return 3;
    case Type::planar:
    case Type::distance:
      return 1;
    default:
      return 0;
  }
}

/// The joint whose reaction presses: that on which the slider acts, or "JOINT.reaction"; empty: no reaction does.
std::string pressing_joint(const SliderDescription& slider, const std::string& part) {
  const std::string& name = slider.normal_law;
  if (name.size() > of_reaction.size() && name.ends_with(of_reaction))
    return name.substr(0, name.size() - of_reaction.size());
  if (!follows_own_reaction(slider)) return {};
  if (slider.joint.empty())
    throw InvalidInput(slider.normal_load.where,
                       fmt::format("{}: normal_load is a reaction, and the slider acts on no joint; say whose, with {{ "
                                   "law = \"JOINT.reaction\" }}",
                                   part));
  return slider.joint;
}

/// The force of a joint that presses. Throws InvalidInput for one that holds none.
PressingReaction reaction_of(const MechanismAssembly& assembly, const SliderDescription& slider,
                             const std::string& name, const std::string& part) {
  const Location& where = slider.normal_law.empty() ? slider.normal_load.where : slider.normal_law_where;
  const auto& described = assembly.description.joints;
  const auto is_called_so = [&](const JointDescription& joint) { return joint.name == name; };
  const auto joint = std::find_if(described.begin(), described.end(), is_called_so);
  if (joint == described.end())
    throw InvalidInput(where, fmt::format("{}: normal_load is the reaction of \"{}\", which is no joint{}", part, name,
                                          suggestion(name, assembly.joint_names)));
  PressingReaction reaction;
  reaction.rows = force_rows(joint->type, assembly.in_plane());
  if (reaction.rows == 0)
    throw InvalidInput(where, fmt::format("{}: normal_load is the reaction of the joint \"{}\", a {}; {}", part, name,
                                          joint_kind(joint->type).name,
                                          joint->type == JointDescription::Type::strut
                                              ? "it holds no force by itself: let a law on it press"
                                              : "take a revolute or a prismatic joint"));
  const auto& joints = assembly.mechanism.joints;
  for (std::size_t j = 0; reaction.joint < 0; ++j) {  // locks and drives of the same name come behind it
    if (joints[j]->name() == name)
      reaction.joint = static_cast<int>(j);
    else
      reaction.multiplier += joints[j]->rows();
  }
  return reaction;
}

PressingReaction pressing_reaction(const MechanismAssembly& assembly, const SliderDescription& slider,
                                   const std::string& part) {
  const std::string joint = pressing_joint(slider, part);
  return joint.empty() ? PressingReaction{} : reaction_of(assembly, slider, joint, part);
}

NormalForce normal_of(const MechanismAssembly& assembly, const SliderDescription& slider, const std::string& part) {
  NormalForce normal;
  if (!pressing_joint(slider, part).empty()) return normal;
  if (has_constant_load(slider)) {
    normal.value = assembly.at_least_zero(slider.normal_load, part + ": normal_load");
    return normal;
  }
  const std::string& name = slider.normal_law;
  if (name.empty()) return build_normal_formula(slider, assembly.parameters, part);
  const auto& sliders = assembly.description.sliders;
  if (std::any_of(sliders.begin(), sliders.end(), [&](const SliderDescription& other) { return other.name == name; }))
    throw InvalidInput(slider.normal_law_where,
                       fmt::format("{}: the force of the slider \"{}\" rubs, it does not press; name a "
                                   "[[nonlinear_spring]] or a [[stop]] across it, or a joint with a stop",
                                   part, name));
  normal.law = law_called(assembly.mechanism, name);
  if (normal.law < 0) normal.stop = pressing_stop(assembly, slider, part);
  if (normal.depends_on_motion()) return normal;
  std::vector<std::string> known = assembly.joint_names;
  for (const MechanismLaw& law : assembly.mechanism.laws) known.push_back(law.name);
  for (const Lock& lock : assembly.mechanism.locks)
    if (lock.is_stop_part) known.push_back(lock.name);
  throw InvalidInput(slider.normal_law_where,
                     fmt::format("{}: normal_load names \"{}\", which is no stop, no law and no joint with a stop{}",
                                 part, name, suggestion(name, known)));
}

}  // namespace

void refuse_taken_name(const MechanismAssembly& assembly, const LawDescription& law, const std::string& title,
                       const std::string& part) {
  if (law.name.empty()) throw InvalidInput(law.where, fmt::format("{} needs a name", title));
  refuse_unfit_name(law.name, law.where);
  const Mechanism& mechanism = assembly.mechanism;
  const auto is_called_so = [&](const auto& other) { return other.name == law.name; };
  if (std::any_of(mechanism.laws.begin(), mechanism.laws.end(), is_called_so) ||
      std::any_of(mechanism.contacts.begin(), mechanism.contacts.end(), is_called_so) ||
      stop_called(mechanism, law.name))
    throw InvalidInput(law.where, fmt::format("two {} are called \"{}\"",
                                              law.kind == slider_table ? "sliders or laws"
                                              : law.kind == stop_table ? "stops or laws"
                                              : law.kind == "contact"  ? "contacts, sliders or laws"
                                                                       : "laws",
                                              law.name));
  const auto is_among = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), law.name) != names.end();
  };
  if (is_among(assembly.joint_names) || is_among(mechanism.coordinates) || assembly.fixed.count(law.name) > 0)
    throw InvalidInput(law.where,
                       fmt::format("{} has the name of a joint or a coordinate; results would mix them up", part));
}

void take_stops(MechanismAssembly& assembly) {
  for (const StopDescription& given : assembly.description.stops) {
    const LawDescription place = as_law(given, stop_table);
    const std::string part = fmt::format("stop \"{}\"", given.name);
    refuse_taken_name(assembly, place, "a stop", part);
    Lock stop;
    stop.name = given.name;
    stop.is_stop_part = true;
    stop.on_joint = given.joint;
    stop.s = std::visit([](const auto& u) { return FreeCoordinate(u); }, place_of(assembly, place, part));
    stop.at = assembly.number(given.gap, part + ": gap");
    stop.stiffness = assembly.positive(given.stiffness, part + ": stiffness");
    stop.damping = assembly.at_least_zero(given.damping, part + ": damping");
    constexpr double round_off = 1e-11;
    stop.is_met_at_start = stop.s.value(assembly.start.data()) - stop.at > -round_off * (1.0 + std::abs(stop.at));
    assembly.mechanism.add_lock(std::move(stop));
  }
}

void take_sliders(MechanismAssembly& assembly) {
  for (const SliderDescription& slider : assembly.description.sliders) {
    const LawDescription place = as_law(slider, slider_table);
    const std::string part = fmt::format("slider \"{}\"", slider.name);
    refuse_taken_name(assembly, place, "a slider", part);
    if (slider.normal_law.empty() && slider.normal_law_where.line > 0)
      throw InvalidInput(
          slider.normal_law_where,
          fmt::format("{}: normal_load names no law; give the name of a stop, of a law or of a joint with a stop, "
                      "or a number",
                      part));
    const double stiffness = assembly.positive(slider.stiffness, part + ": stiffness");
    if (depends_on_rate(slider.friction_coefficient) && !pressing_joint(slider, part).empty())
      throw InvalidInput(
          slider.friction_coefficient.where,
          fmt::format("{}: friction_coefficient depends on the rate, and normal_load is a reaction: the two "
                      "do not go together; give a number, a formula of t, or the force of a stop or law",
                      part));
    assembly.mechanism.add_law(slider.name, slider_table, place_of(assembly, place, part),
                               build_slider_law(slider, stiffness, assembly.parameters, part),
                               normal_of(assembly, slider, part), pressing_reaction(assembly, slider, part));
  }
}

void take_local_laws(MechanismAssembly& assembly) {
  for (const LawDescription& description : assembly.description.laws) {
    const LawKind& kind = law_kind(description.kind);
    const std::string part = fmt::format("{} \"{}\"", description.kind, description.name);
    refuse_taken_name(assembly, description, kind.title, part);
    if (!description.shares.empty())
      throw InvalidInput(description.shares_where,
                         fmt::format("{}: shares are of the coordinates of structures, and this model has joints or "
                                     "bodies; take `between` or `joint`",
                                     part));
    assembly.mechanism.add_law(description.name, description.kind, place_of(assembly, description, part),
                               kind.make(description, assembly.parameters, part));
  }
}

}  // namespace rubato::model
