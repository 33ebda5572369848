#pragma once

#include <rubato/model/mechanism_assembly.hpp>

#include <rubato/numerics/formula_swings.hpp>

#include <fmt/format.h>

#include <algorithm>

// Private to the model floor: what a joint does to the coordinate that it leaves free, in the plane and in space alike.
namespace rubato::model {

/// The angle or displacement that a joint has in the configuration given.
inline double start_value(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                          bool is_angle) {
  if (!joint.value) return 0.0;
  return is_angle ? assembly.angle(*joint.value, part + ": angle")
                  : assembly.number(*joint.value, part + ": displacement");
}

/// Throws InvalidInput for a joint without an axis that needs one.
inline void require_axis(const JointDescription& joint, const std::string& part) {
  if (joint.axis.empty()) throw InvalidInput(joint.where, fmt::format("{} lacks the key \"axis\"", part));
}

/// Whether anything acts on the coordinate that a joint leaves free.
inline bool has_law(const MechanismAssembly& assembly, const JointDescription& joint) {
  const ModelDescription& all = assembly.description;
  const auto any_acts_on_it = [&](const auto& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return part.joint == joint.name; });
  };
  return joint.motion || joint.rate || joint.drive || joint.drive_table || joint.stiffness || joint.damping ||
         !joint.locks.empty() || joint.friction || any_acts_on_it(all.laws) || any_acts_on_it(all.sliders) ||
         any_acts_on_it(all.stops);
}

/// Throws InvalidInput for a strut on which nothing acts: its length alone changes no motion.
inline void require_law(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part) {
  if (has_law(assembly, joint)) return;
  throw InvalidInput(joint.where,
                     fmt::format("{} is a strut that does nothing; give it \"force\", \"stiffness\", \"damping\", "
                                 "\"drive\", \"lock\", \"rate\" or \"friction\"; force = 0 only measures its length",
                                 part));
}

/// The law of a drive, checked.
/// @param value  of the coordinate in the configuration given
MotionLaw drive_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                   bool is_angle, double value);

/// The friction of the joint that was added last on the coordinate that it leaves free.
/// @param pressing  which rows of the joint are the force that presses
/// @param arm       the limit is mu times this; of an angle [m]
struct PressingRows {
  int first = 0, count = 0;
};
/// @return its index
int take_friction(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                  const FreeCoordinate& s, PressingRows pressing, double arm);

/// Of the pin or the thread that rubs [m]; 1 for what slides.
double rubbing_radius(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part);

/// The locks of a joint on the coordinate that it leaves free.
/// @param value  of s in the configuration given
/// @return the phase in which the laws are at work that a latch ends
AtLock take_locks(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                  const FreeCoordinate& s, double value);

/// The table of a joint's moment or force over its coordinate.
/// @param value  of the coordinate in the configuration given
CoordinateTable table_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                         double value);

/// The rate that a joint has at the start.
void take_start_rate(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                     const FreeCoordinate& s);

/// The drive, the law of a moment or force, the spring and the damper.
/// @param s      with its zero
/// @param value  of s in the configuration given
/// @param when   the phase of a lock in which the law is at work
template <class Coordinate>
void take_laws(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part, const Coordinate& s,
               double value, const AtLock& when = {}) {
  auto& elements = assembly.mechanism.elements;
  if (joint.rate) take_start_rate(assembly, joint, part, s);
  if (joint.motion) assembly.mechanism.add_drive(joint.name, s, drive_of(assembly, joint, part, s.is_angle(), value));
  if (joint.drive) {
    const std::string text =
        joint.drive->expression.empty() ? fmt::format("{}", joint.drive->value) : joint.drive->expression;
    try {
      elements.push_back(make_joint_drive(joint.name, s, text, assembly.parameters, when));
      assembly.mechanism.joint_formulas.emplace_back(text, assembly.parameters, true,
                                                     std::vector<std::string>{s.name(), "rate"});
    } catch (const InvalidInput& fault) {
      throw InvalidInput(joint.drive->where,
                         fmt::format("{}: {}: {}", part, s.is_angle() ? "moment" : "force", fault.message()));
    }
  }
  if (joint.drive_table)
    elements.push_back(make_joint_table(joint.name, s, table_of(assembly, joint, part, value), when));
  if (joint.stiffness) {
    const bool is_length = joint.type == JointDescription::Type::strut;
    const double rest = !joint.rest    ? value
                        : is_length    ? assembly.at_least_zero(*joint.rest, part + ": rest")
                        : s.is_angle() ? assembly.angle(*joint.rest, part + ": rest")
                                       : assembly.number(*joint.rest, part + ": rest");
    elements.push_back(
        make_joint_spring(joint.name, s, assembly.at_least_zero(*joint.stiffness, part + ": stiffness"), rest));
  }
  if (joint.damping)
    elements.push_back(make_joint_damper(joint.name, s, assembly.at_least_zero(*joint.damping, part + ": damping")));
}

}  // namespace rubato::model
