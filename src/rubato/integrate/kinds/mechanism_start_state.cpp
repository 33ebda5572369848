#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/kinds/start_on_locks.hpp>
#include <rubato/integrate/kinds/start_rates.hpp>
#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/stop_impacts.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

std::string row_names(const std::vector<Index>& rows, const system::Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const Index row : rows) names.push_back(fmt::format("\"{}\"", mechanism.rows()[static_cast<std::size_t>(row)]));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Of a row of constraints, "JOINT.lock_moment", by the name that its force gives it.
const char* unit_of_row(const std::string& row) {
  const std::size_t dot = row.rfind('.');
  return dot != std::string::npos && row.find("moment", dot) != std::string::npos ? "rad" : "m";
}

const char* unit_of_coordinate(Index coordinate, const system::Mechanism& mechanism) {
  return mechanism.model().is_rotation[static_cast<std::size_t>(coordinate)] != 0 ? "rad" : "m";
}

void warn_of_velocities(const ConsistentStart& start, const system::Mechanism& mechanism,
                        std::vector<std::string>& warnings) {
  if (start.most_changed < 0) return;
  warnings.push_back(fmt::format(
      "the velocities given do not satisfy the joints; they were changed, \"{}\" most, by "
      "{:.4g} {}/s, which {} {:.4g} J",
      mechanism.coordinates()[static_cast<std::size_t>(start.most_changed)], start.velocity_changed,
      unit_of_coordinate(start.most_changed, mechanism), start.energy_lost >= start.drive_work ? "took" : "gave",
      std::abs(start.energy_lost - start.drive_work)));
}

/// With the velocities that follow from the rates of joints, in the configuration that the joints leave.
ConsistentStart start_with_rates(system::MechanismEquations& equations, std::vector<std::string>& warnings) {
  system::State given = equations.mechanism().start();
  const ConsistentStart placed = make_consistent(equations, given);
  if (!placed.is_consistent) return placed;
  given.q = placed.state.q;
  set_start_rates(equations, given, warnings);
  ConsistentStart start = make_consistent_on_locks(equations, given);
  start.position_moved = placed.position_moved;
  start.most_moved = placed.most_moved;
  return start;
}

/// Opens the stops with stiffness that do not press with the velocities of a state. Returns whether there was one.
bool leave_elastic_stops(const system::Mechanism& mechanism, system::State& state) {
  constexpr double no_way = 1e-9;
  std::vector<double> velocity(static_cast<std::size_t>(state.v.size()) + 1, 0.0);
  std::copy(state.v.begin(), state.v.end(), velocity.begin() + 1);
  model::Motion motion;
  motion.q = state.q.data();
  motion.v = velocity.data() + 1;
  const auto& locks = mechanism.model().locks;
  bool has_left = false;
  for (std::size_t i = 0; i < locks.size(); ++i) {
    const model::Lock& lock = locks[i];
    if (state.phase[i] != model::lock_engaged || lock.is_latch || lock.is_rigid()) continue;
    const double rate = lock.s.rate(motion), way = lock.s.value(motion.q) - lock.at;
    const double press = lock.sign * (lock.stiffness * way + lock.damping * rate);
    if (!(lock.sign * rate < 0.0) || press > lock.stiffness * no_way * (1.0 + std::abs(lock.at))) continue;
    state.phase[i] = model::lock_open;
    has_left = true;
  }
  return has_left;
}

/// Refuses friction that follows a reaction which joints share in a way that nothing determines: what they share is
/// known to the share of the matrix that lets them repeat each other, and steps that end at an event carry round-off
/// over that share and the square of their length into it.
void refuse_unknown_reactions(const Location& where, system::MechanismEquations& equations,
                              const system::State& state) {
  const auto& mechanism = equations.mechanism();
  Vector motion(mechanism.size()), row(mechanism.constraint_count()), rate(row.size());
  equations.go_to(state, model::Side::right);
  equations.linearise({}, state.multiplier, motion, row);
  if (!equations.factorise() || equations.redundant_rows().empty()) return;
  const auto require_alone = [&](const std::string& what, Index first, int rows, const char* remedy) {
    for (int i = 0; i < rows; ++i) {
      // A row that can be moved alone is held by its joint alone.
      const Index moved = first + i;
      motion.setZero();
      row.setZero();
      row[moved] = 1.0;
      equations.solve(motion, row);
      equations.constraint_rate(motion, rate);
      if (rate[moved] > 0.999) continue;
      throw InvalidInput(where,
                         fmt::format("{} follows a reaction that is not determined: what \"{}\" holds is held by "
                                     "other joints too, in shares that nothing tells; {}, or let one of "
                                     "the joints hold less (spherical or cylindrical for revolute)",
                                     what, mechanism.rows()[static_cast<std::size_t>(moved)], remedy));
    }
  };
  for (const auto& friction : mechanism.model().frictions)
    if (friction.pressing_rows > 0)
      require_alone(fmt::format("the friction of \"{}\"", friction.name),
                    mechanism.first_row(friction.joint) + friction.first_pressing_row, friction.pressing_rows,
                    "give the friction a \"preload\"");
  for (const auto& law : mechanism.model().laws)
    if (law.reaction.presses())
      require_alone(fmt::format("the {} \"{}\"", law.kind, law.name), law.reaction.multiplier, law.reaction.rows,
                    "give it a \"normal_load\" in numbers");
}

/// Of a law with a memory on a strut, whose spring would act from the length zero.
void warn_of_pressed_struts(system::MechanismEquations& equations, const system::State& start,
                            std::vector<std::string>& warnings) {
  const auto& laws = equations.mechanism().model().laws;
  equations.go_to(start, model::Side::right);
  for (std::size_t j = 0; j < laws.size(); ++j) {
    if (!laws[j].is_length() || laws[j].law->memory_size() == 0 || equations.law_force(j) == 0.0) continue;
    if (laws[j].law->sticking_stiffness() > 0.0) continue;  // friction counts from where it is
    warnings.push_back(
        fmt::format("{} \"{}\" starts with {:.4g} N, since it acts on a strut, where u is the length of {:.6g} m; to "
                    "have it act from "
                    "that length, give the strut the part of its stiffness that does not yield, and the law none",
                    laws[j].kind, laws[j].name, equations.law_force(j), equations.law_displacement(j)));
  }
}

/// Of masses and places that double precision cannot hold beside each other.
std::string immense_numbers(const system::Mechanism& mechanism) {
  const Vector inertia = mechanism.mass().diagonal(), place = mechanism.start().q.cwiseAbs();
  Index least = 0, most = 0;
  const double low = inertia.minCoeff(&least), high = inertia.maxCoeff(&most);
  const auto told = [&](double value, Index at) {
    return fmt::format("{:.4g} {} at \"{}\"", value,
                       mechanism.model().is_rotation[static_cast<std::size_t>(at)] != 0 ? "kg m2" : "kg",
                       mechanism.coordinates()[static_cast<std::size_t>(at)]);
  };
  return fmt::format(
      "the numbers of the model are too large or too small to compute with: masses and inertias reach "
      "from {} to {}, places to {:.4g} m; look at their units",
      told(low, least), told(high, most), place.maxCoeff());
}

}  // namespace

system::State assembled_start(const Location& where, const system::Mechanism& mechanism,
                              std::vector<std::string>& warnings, bool moves) {
  system::MechanismEquations equations(mechanism);
  const bool has_rates = moves && !mechanism.model().start_rates.empty();
  system::State given = mechanism.start();
  if (!moves) given.v.setZero();
  const ConsistentStart start =
      has_rates ? start_with_rates(equations, warnings) : make_consistent_on_locks(equations, given, !moves);
  const auto coordinate = [&](Index i) { return mechanism.coordinates()[static_cast<std::size_t>(i)]; };
  if (start.is_assembled && start.worst_rate >= 0) {
    std::vector<std::string> drives;
    for (const auto& drive : mechanism.model().drives) drives.push_back(fmt::format("\"{}\"", drive.name));
    throw InvalidInput(
        where, fmt::format(
                   "drives contradict each other or the joints: all hold at the start, but at once \"{}\" would "
                   "come apart at {:.4g} {}/s; leave one of the drives of {} out, or let it say what the "
                   "others make of it",
                   mechanism.rows()[static_cast<std::size_t>(start.worst_rate)], start.gap_rate,
                   unit_of_row(mechanism.rows()[static_cast<std::size_t>(start.worst_rate)]), fmt::join(drives, ", ")));
  }
  if (!start.is_consistent) {
    equations.go_to(start.state, model::Side::right);
    const std::string part = equations.non_finite_part();
    if (start.is_assembled || !part.empty())
      throw InvalidInput(where, fmt::format("there are no finite accelerations at the start{}",
                                            part.empty() ? "" : ": " + part + " is not finite there"));
  }
  if (!start.is_consistent) {
    if (start.worst_row < 0 || !std::isfinite(start.gap)) throw InvalidInput(where, immense_numbers(mechanism));
    const std::string row = mechanism.rows()[static_cast<std::size_t>(start.worst_row)];
    if (!start.redundant.empty())
      throw InvalidInput(where, fmt::format("the joints cannot be assembled: they contradict each other; \"{}\" stays "
                                            "apart by {:.4g} {}, and {} can only repeat what other joints say",
                                            row, start.gap, unit_of_row(row), row_names(start.redundant, mechanism)));
    throw InvalidInput(where,
                       fmt::format("the joints cannot be assembled: \"{}\" stays apart by {:.4g} {}; look at the "
                                   "places and lengths around it",
                                   row, start.gap, unit_of_row(row)));
  }
  if (start.most_moved >= 0)
    warnings.push_back(fmt::format(
        "the positions given do not satisfy the joints; they were moved, \"{}\" most, by "
        "{:.4g} {}",
        coordinate(start.most_moved), start.position_moved, unit_of_coordinate(start.most_moved, mechanism)));
  if (moves) warn_of_velocities(start, mechanism, warnings);
  warn_of_pressed_struts(equations, start.state, warnings);
  if (!start.redundant.empty())
    warnings.push_back(
        fmt::format("{} repeat{} what other joints say; of the reactions that make the same motion the "
                    "least ones are given",
                    row_names(start.redundant, mechanism), start.redundant.size() == 1 ? "s" : ""));
  return start.state;
}

system::State set_in_motion(const Location& where, const system::Mechanism& mechanism, system::State at_rest,
                            std::vector<std::string>& warnings) {
  at_rest.v = mechanism.start().v;
  system::MechanismEquations equations(mechanism);
  if (!mechanism.model().start_rates.empty()) set_start_rates(equations, at_rest, warnings);
  if (mechanism.model().drives.empty() && at_rest.v.isZero(0.0)) return at_rest;
  ConsistentStart start = make_consistent_pressing(equations, at_rest, model::Side::right);
  if (start.is_consistent && leave_elastic_stops(mechanism, start.state))
    start.is_consistent = find_acceleration(equations, start.state, model::Side::right);
  if (!start.is_consistent)
    throw InvalidInput(
        where,
        "no velocities and accelerations were found at the equilibrium that the drives and joints allow; "
        "look for a drive that the joints hinder there");
  const bool has_velocities = !mechanism.start().v.isZero(0.0) || !mechanism.model().start_rates.empty();
  if (has_velocities) warn_of_velocities(start, mechanism, warnings);
  return start.state;
}

void settle_start(const Location& where, const system::Mechanism& mechanism, double duration, system::State& state) {
  if (mechanism.model().frictions.empty() && !mechanism.has_followed_reactions()) return;
  system::MechanismEquations equations(mechanism);
  equations.set_duration(duration);
  refuse_unknown_reactions(where, equations, state);
  if (mechanism.model().frictions.empty()) return;
  bool is_settled = find_phases_of_new_velocities(equations, state, 1e-6 * duration);
  while (is_settled && release_pulling_stop(mechanism, state))
    is_settled = find_phases_of_new_velocities(equations, state, 1e-6 * duration);
  if (!is_settled)
    throw InvalidInput(
        where,
        "no accelerations were found at the start that go with the friction of the joints: with "
        "so large a coefficient their reactions grow without bound; take a smaller one, or a preload for "
        "some of them");
}

void warn_of_locks_behind(const system::Mechanism& mechanism, const system::State& start,
                          std::vector<std::string>& warnings) {
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i) {
    const model::Lock& lock = locks[i];
    const double beyond = lock.sign * (lock.s.value(start.q.data()) - lock.at);
    if (start.phase[i] != model::lock_open || !(beyond > 1e-9 * (1.0 + std::abs(lock.at)))) continue;
    warnings.push_back(
        fmt::format("\"{0}\" starts {1:.4g} {2} beyond its lock at {3:.6g} {2}, which does not hold it there: it would "
                    "have to come back and reach the lock from the other side",
                    lock.name, beyond, lock.s.is_angle() ? "rad" : "m", lock.at));
  }
}

}  // namespace rubato::integrate
