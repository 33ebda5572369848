#include <rubato/model/mechanism_joint_laws.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

// The limits of the coordinate that a joint leaves free.
namespace rubato::model {
namespace {

using Side = LockDescription::Side;

/// "lock", or "lock(2)" of several.
std::string called(const JointDescription& joint, const LockDescription& given, const std::string& part) {
  if (joint.locks.size() == 1) return part + ": lock";
  return fmt::format("{}: lock({})", part, 1 + (&given - joint.locks.data()));
}

/// Which way leads to a lock: +1 from below. Throws InvalidInput where the start does not tell, or lies beyond.
double sign_of(const JointDescription& joint, const LockDescription& given, const std::string& what, const Lock& lock,
               double value) {
  const bool is_length = joint.type == JointDescription::Type::strut;
  const char* const unit = is_length ? "length" : lock.s.is_angle() ? "angle" : "displacement";
  if (!given.side && lock.is_met_at_start)
    throw InvalidInput(given.where,
                       fmt::format("{}: the joint starts at its lock, {}; say which values are free, side = \"below\" "
                                   "or \"above\", or let it start at another {}",
                                   what, lock.at, unit));
  const double from_start = lock.at > value ? 1.0 : -1.0;
  if (!given.side) return from_start;
  const double sign = *given.side == Side::below ? 1.0 : -1.0;
  if (!lock.is_met_at_start && sign != from_start)
    throw InvalidInput(given.where,
                       fmt::format("{}: the joint starts at {}, beyond its lock at {}, of which the values "
                                   "{} are free",
                                   what, value, lock.at, sign > 0.0 ? "below" : "above"));
  return sign;
}

Lock lock_of(const MechanismAssembly& assembly, const JointDescription& joint, const LockDescription& given,
             const std::string& what, const FreeCoordinate& s, double value) {
  Lock lock;
  lock.name = joint.name;
  lock.s = s;
  lock.is_latch = given.is_latch;
  lock.at = s.is_angle() ? assembly.angle(given.at, what + ": at") : assembly.number(given.at, what + ": at");
  if (given.stiffness) lock.stiffness = assembly.positive(*given.stiffness, what + ": stiffness");
  if (given.damping) lock.damping = assembly.at_least_zero(*given.damping, what + ": damping");
  lock.is_met_at_start = !(std::abs(lock.at - value) > 1e-9 * (1.0 + std::abs(value)));
  if (joint.type == JointDescription::Type::strut && !(lock.at > 0.0))
    throw InvalidInput(given.at.where, fmt::format("{}: at is a length and must be positive, got {}", what, lock.at));
  lock.sign = sign_of(joint, given, what, lock, value);
  return lock;
}

/// Throws InvalidInput for two locks that leave no room, and for one that is behind a rigid one, or at the same place.
void refuse_useless_pairs(const JointDescription& joint, const std::vector<Lock>& locks, const std::string& part) {
  for (std::size_t i = 0; i < locks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Lock &one = locks[i], &other = locks[j];
      const double between = one.sign * (one.at - other.at);
      const double nothing = 1e-9 * (1.0 + std::abs(one.at));
      const Location& where = joint.locks[i].where;
      if (one.sign != other.sign) {
        if (between > nothing) continue;
        throw InvalidInput(
            where,
            fmt::format(
                "{}: the lock at {}, of which the values {} are free, and the lock at {}, "
                "of which those {} are, leave no room between them; {}",
                part, other.at, other.sign > 0.0 ? "below" : "above", one.at, one.sign > 0.0 ? "below" : "above",
                std::abs(between) <= nothing ? "take a rigid joint for what cannot move" : "exchange their sides"));
      }
      if (std::abs(between) <= nothing)
        throw InvalidInput(where,
                           fmt::format("{}: two locks at {} are met from the same side; leave one out", part, one.at));
      const Lock& nearer = between > 0.0 ? other : one;
      const Lock& farther = between > 0.0 ? one : other;
      if (!(nearer.stiffness > 0.0))
        throw InvalidInput(where, fmt::format("{}: its lock at {} is never reached, since that at {} is rigid; give "
                                              "the latter a stiffness, or leave one out",
                                              part, farther.at, nearer.at));
    }
}

}  // namespace

AtLock take_locks(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                  const FreeCoordinate& s, double value) {
  std::vector<Lock> locks;
  for (const LockDescription& given : joint.locks)
    locks.push_back(lock_of(assembly, joint, given, called(joint, given, part), s, value));
  refuse_useless_pairs(joint, locks, part);
  // Latches first: what they end asks the phases of a row of locks.
  std::stable_partition(locks.begin(), locks.end(), [](const Lock& lock) { return lock.is_latch; });
  AtLock ended_by_latches;
  for (const Lock& lock : locks) {
    const int index = assembly.mechanism.add_lock(lock);
    if (!lock.is_latch) continue;
    if (ended_by_latches.count == 0) ended_by_latches = {index, 0, false};
    ++ended_by_latches.count;
  }
  return ended_by_latches;
}

}  // namespace rubato::model
