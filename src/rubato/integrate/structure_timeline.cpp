#include <rubato/integrate/structure_timeline.hpp>
#include <rubato/model/laws/law_resolution.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {

/// The relative displacement over a step: the cubic through displacement and velocity of both ends.
struct StructureTimeline::Path {
  double h, u0, v0, u1, v1;

  double displacement(double share) const {
    const double s = share, r = 1.0 - s;
    return r * r * (1.0 + 2.0 * s) * u0 + s * s * (3.0 - 2.0 * s) * u1 + h * s * r * (r * v0 - s * v1);
  }
  double velocity(double share) const {
    const double s = share, r = 1.0 - s;
    return 6.0 * s * r * (u1 - u0) / h + r * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1;
  }
  double final_acceleration() const { return (6.0 * (u0 - u1) / h + 2.0 * v0 + 4.0 * v1) / h; }
};

namespace {

/// Where a function that is positive at first and negative at 1 passes zero.
template <class Function>
double root(const Function& function) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) > 0.0 ? low : high) = middle;
  }
  return high;
}

constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon();

/// The displacements that make a relative one: what its round-off follows.
double size_of(const system::LocallyNonlinear& system, Index contact, const Vector& q) {
  const auto& ends = system.contacts()[static_cast<std::size_t>(contact)];
  double size =
      (ends.first == ground ? 0.0 : std::abs(q[ends.first])) + (ends.second == ground ? 0.0 : std::abs(q[ends.second]));
  for (const auto& share : system.shares())
    if (share.contact == contact) size += std::abs(share.weight * q[share.coordinate]);
  return size;
}

}  // namespace

StructureTimeline::StructureTimeline(const system::LocallyNonlinear& system, double resolution, bool watches_sliders)
    : system_(system),
      resolution_(resolution),
      watches_sliders_(watches_sliders),
      loads_(system.loads()),
      left_(system.size()),
      right_(system.size()),
      beyond_(system.start()),
      equilibrium_(system),
      pressed_(system) {
  pushing_.reserve(static_cast<std::size_t>(system.block_count()));
}

std::vector<double> StructureTimeline::breakpoints(double from, double to) const {
  std::vector<double> times = loads_.breakpoints(from, to);
  system_.add_law_breakpoints(from, to, times);
  return times;
}

bool StructureTimeline::jumps_at(double t) {
  std::vector<double> of_laws;
  system_.add_law_breakpoints(t - resolution_, t + resolution_, of_laws);
  if (!of_laws.empty()) return true;
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
}

bool StructureTimeline::restart(system::State& state) {
  system_.set_law_forces(state, model::Side::right);
  equilibrium_(state, state.auxiliary_acceleration);
  return true;
}

bool StructureTimeline::has_ended_at(Index contact, const system::State& from, const system::State& to) {
  const GuardValue end = guard(contact, from, to);
  return end.value <= 2.0 * resolution_ * std::abs(end.rate);
}

// A damped stop that closes pushes at once. All other forces are the same on both sides of a transition, and so is the
// acceleration: what jumps is their rate. A slider that begins to slip loses kT du/dt, one that comes to rest has none
// on either side; a stop gains or loses k du/dt + c d2u/dt2.
Passage StructureTimeline::pass(const system::State& before, system::State& state, double shift) {
  bool has_kink = false, has_jump = false;
  pushing_.clear();
  beyond_.slider_force = state.slider_force;
  for (Index i = 0; i < system_.contact_count(); ++i) {
    if (i >= system_.first_law() && !is_gap(i)) continue;
    const Watch watch = watch_of(i, before);
    if (watch == Watch::nothing || watch == Watch::rest_after_positive || watch == Watch::rest_after_negative) continue;
    if (!has_ended_at(i, before, state)) continue;
    has_kink = true;
    const Path path = path_of(i, before, state);
    if (watch == Watch::limit) {
      beyond_.slider_force[i] -= shift * system_.sliders()[static_cast<std::size_t>(i)].stiffness * path.v1;
      continue;
    }
    if (i >= system_.first_block() && watch == Watch::closing && gap_of(i).damping > 0.0) {
      has_jump = true;
      pushing_.emplace_back(i, gap_of(i).damping * path.v1);
      continue;
    }
    if (i >= system_.first_block()) {
      go_on_beyond(i, shift, watch != Watch::opening, state);
      continue;
    }
    const Gap stop = gap_of(i);
    const double rate = stop.stiffness * path.v1 + stop.damping * path.final_acceleration();
    if (watch == Watch::closing && stop.damping > 0.0) {
      has_jump = true;
      state.slider_force[i] = stop.damping * path.v1;
    } else {
      beyond_.slider_force[i] += watch == Watch::opening ? -shift * rate : shift * rate;
    }
  }
  if (has_jump) {
    restart(state);
    for (const auto& [contact, force] : pushing_) state.slider_force[contact] = force;
    if (!pushing_.empty()) equilibrium_(state, state.auxiliary_acceleration);
    return Passage::restarts;
  }
  if (!has_kink || shift == 0.0) return Passage::continues;
  beyond_.t = state.t;
  beyond_.q = state.q;
  beyond_.v = state.v;
  equilibrium_(state, left_);
  equilibrium_(beyond_, right_);
  state.auxiliary_acceleration += right_ - left_;
  return Passage::continues;
}

/// The rates that the forces of a contact gain where its ends meet, or lose where they part.
void StructureTimeline::go_on_beyond(Index contact, double shift, bool closes, const system::State& state) {
  const Index b = system_.block_at(contact), first = system_.row_of_block(b);
  const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(b)].law;
  const Index across = law.size() - 1;
  const Gap gap = gap_of(contact);
  model::BlockPoint point = system_.block_point(b, state), beyond = point;
  if (!closes) {  // friction goes down with what presses
    const double rate = gap.stiffness * point.rate[across], pressed = state.slider_force[contact];
    for (Index i = 0; i < across && pressed > 0.0; ++i)
      beyond_.slider_force[first + i] -= shift * rate * state.slider_force[first + i] / pressed;
    beyond_.slider_force[contact] -= shift * rate;
    return;
  }
  // As it goes on from the gap.
  point.u[across] = gap.gap;
  std::copy_n(point.u, law.size(), beyond.u);
  for (Index i = 0; i < law.size(); ++i) beyond.u[i] += std::abs(shift) * point.rate[i];
  const Vector rest = Vector::Zero(law.memory_size());
  Vector next = rest;
  const model::BlockAnswer answer = law.advance(point, rest.data(), beyond, next.data());
  for (Index i = 0; i < law.size(); ++i)
    beyond_.slider_force[first + i] += (shift < 0.0 ? -1.0 : 1.0) * answer.force[i];
}

StructureTimeline::Path StructureTimeline::path_of(Index contact, const system::State& from,
                                                   const system::State& to) const {
  return {to.t - from.t, system_.relative_displacement(contact, from.q), system_.relative_displacement(contact, from.v),
          system_.relative_displacement(contact, to.q), system_.relative_displacement(contact, to.v)};
}

StructureTimeline::Watch StructureTimeline::watch_of(Index contact, const system::State& from) const {
  if (contact >= system_.first_block()) return is_gap(contact) ? watch_of_stop(contact, from) : Watch::nothing;
  if (contact >= system_.first_law()) return watches_sliders_ ? Watch::law : Watch::nothing;
  if (contact >= system_.slider_count()) return watch_of_stop(contact, from);
  return watches_sliders_ ? watch_of_slider(contact, from) : Watch::nothing;
}

int StructureTimeline::branch(Index contact, const system::State& state) const {
  if (contact >= system_.slider_count()) return watch_of_stop(contact, state) == Watch::opening ? 1 : 0;
  if (watches_sliders_) {
    const Watch watch = watch_of_slider(contact, state);
    return watch == Watch::rest_after_positive ? 1 : watch == Watch::rest_after_negative ? -1 : 0;
  }
  const double force = state.slider_force[contact], limit = system_.sliders()[static_cast<std::size_t>(contact)].limit;
  return force >= limit ? 1 : force <= -limit ? -1 : 0;
}

StructureTimeline::Watch StructureTimeline::watch_of_slider(Index i, const system::State& from) const {
  const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
  if (slider.limit == 0.0) return Watch::nothing;
  const double force = from.slider_force[i], velocity = system_.relative_displacement(i, from.v);
  const double least = round_off * (slider.limit + slider.stiffness * size_of(system_, i, from.q));
  if (slider.limit - std::abs(force) > std::max(least, 2.0 * resolution_ * slider.stiffness * std::abs(velocity)))
    return Watch::limit;
  const double side = force > 0.0 ? 1.0 : -1.0;
  const double acceleration = system_.relative_displacement(i, from.auxiliary_acceleration);
  const bool rests = std::abs(velocity) <= 2.0 * resolution_ * std::abs(acceleration) || velocity == 0.0;
  if (!(side * (rests ? acceleration : velocity) > 0.0)) return Watch::limit;
  return side > 0.0 ? Watch::rest_after_positive : Watch::rest_after_negative;
}

// At the gap, to what a located step leaves, the velocity tells.
StructureTimeline::Watch StructureTimeline::watch_of_stop(Index i, const system::State& from) const {
  const Gap stop = gap_of(i);
  const double depth = system_.relative_displacement(i, from.q) - stop.gap;
  const double velocity = system_.relative_displacement(i, from.v);
  const double size = size_of(system_, i, from.q) + std::abs(stop.gap);
  if (std::abs(depth) <= std::max(round_off * size, 2.0 * resolution_ * std::abs(velocity)))
    return velocity > 0.0 ? Watch::opening : Watch::closing;
  if (depth < 0.0) return Watch::closing;
  return from.slider_force[i] > 0.0 ? Watch::opening : Watch::pushing_again;
}

GuardValue StructureTimeline::guard(Index guard, const system::State& from, const system::State& to) {
  const Path path = path_of(guard, from, to);
  switch (watch_of(guard, from)) {
    case Watch::limit: {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(guard)];
      const double force = from.slider_force[guard] + slider.stiffness * (path.u1 - path.u0);
      return {slider.limit - std::abs(force), -std::copysign(slider.stiffness, force) * path.v1};
    }
    case Watch::rest_after_positive:
      return {path.v1, path.final_acceleration()};
    case Watch::rest_after_negative:
      return {-path.v1, -path.final_acceleration()};
    case Watch::closing: {
      const Gap stop = gap_of(guard);
      const double size = size_of(system_, guard, to.q) + std::abs(stop.gap);
      // Held at the gap by the force of the step itself: how long ago it closed only the bracket tells.
      if (stop.damping > 0.0 && to.slider_force[guard] > 0.0 && path.u1 - stop.gap <= round_off * size)
        return {-1.0, 0.0};
      return {stop.gap - path.u1, -path.v1};
    }
    case Watch::opening:
    case Watch::pushing_again: {
      const Gap stop = gap_of(guard);
      const double sign = watch_of(guard, from) == Watch::opening ? 1.0 : -1.0;
      if (sign < 0.0 && path.u1 <= stop.gap) return {1.0, 0.0};  // left before
      return {sign * (stop.stiffness * (path.u1 - stop.gap) + stop.damping * path.v1),
              sign * (stop.stiffness * path.v1 + stop.damping * path.final_acceleration())};
    }
    case Watch::law: {
      constexpr double least = 1e-4;  // of the step, for the slope of the guard at its end
      const double end = guard_of_law(guard, from, to, 1.0);
      return {end, (end - guard_of_law(guard, from, to, 1.0 - least)) / (least * path.h)};
    }
    case Watch::nothing:
      break;
  }
  return {1.0, 0.0};
}

double StructureTimeline::unresolved(const system::State& from, const system::State& to) {
  double largest = 0.0;
  for (Index j = 0; j < system_.law_count(); ++j) {
    const auto* law = dynamic_cast<const model::LawResolution*>(system_.laws()[static_cast<std::size_t>(j)].law.get());
    if (!law) continue;
    largest = std::max(largest, law->unresolved(system_.law_point(j, from, model::Side::right),
                                                system_.law_point(j, to, model::Side::left)));
  }
  return largest;
}

double StructureTimeline::guard_of_law(Index contact, const system::State& from, const system::State& to,
                                       double share) {
  const Index law = contact - system_.first_law();
  const model::Law& watched = *system_.laws()[static_cast<std::size_t>(law)].law;
  const double* const memory = from.memory.data() + system_.memory_of(law);
  if (watched.takes_normal())
    return watched.guard(pressed_.going_on(law, from, to, 0.0, 2.0 * resolution_), memory,
                         pressed_.at(law, from, to, share), 2.0 * resolution_);
  const Path path = path_of(contact, from, to);
  // A travel of round-off turns at random.
  const double size = size_of(system_, contact, from.q);
  if (std::abs(path.u1 - path.u0) + path.h * std::abs(path.v1) <= round_off * size) return 1.0;
  model::LawPoint start = system_.law_point(law, from, model::Side::right);
  model::LawPoint end = system_.law_point(law, to, model::Side::left);
  const double acceleration = system_.relative_displacement(contact, from.auxiliary_acceleration);
  if (std::abs(start.rate) <= 2.0 * resolution_ * std::abs(acceleration))
    start.rate = std::copysign(std::numeric_limits<double>::min(), acceleration);
  end.u = path.displacement(share);
  end.rate = path.velocity(share);
  end.t = from.t + share * path.h;
  return watched.guard(start, memory, end, 2.0 * resolution_);
}

model::Law::Contact StructureTimeline::contact_of_law(Index law, const system::State& before,
                                                      const system::State& after, bool at_end) {
  const model::Law& watched = *system_.laws()[static_cast<std::size_t>(law)].law;
  const system::State& state = at_end ? after : before;
  const double* const memory = state.memory.data() + system_.memory_of(law);
  if (!watches_sliders_ || !watched.takes_normal())
    return watched.contact(system_.law_point(law, state, model::Side::left), memory, 0.0);
  const double near = 2.0 * resolution_;
  return watched.contact(pressed_.going_on(law, before, after, at_end ? 1.0 : 0.0, near), memory, near);
}

model::Law::Contact StructureTimeline::contact_of_block(Index block, const system::State& state) const {
  const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(block)].law;
  model::BlockPoint point = system_.block_point(block, state);
  const Index across = law.size() - 1;
  point.u[across] += 2.0 * resolution_ * point.rate[across];
  return law.contact(point, state.memory.data() + system_.memory_of_block(block));
}

int StructureTimeline::branch_after(Index contact, const system::State& before, const system::State& after) {
  const Watch watch = watch_of(contact, before);
  if (watch == Watch::nothing || !has_ended_at(contact, before, after)) return branch(contact, after);
  switch (watch) {
    case Watch::limit:
      return after.slider_force[contact] > 0.0 ? 1 : -1;
    case Watch::closing:
    case Watch::pushing_again:
      return 1;
    default:
      return 0;
  }
}

/// The share of the step at which a guard that is negative at its end vanishes on the path.
double StructureTimeline::share_of(Index contact, const system::State& from, const system::State& to) {
  const Path path = path_of(contact, from, to);
  const Watch watch = watch_of(contact, from);
  switch (watch) {
    case Watch::limit: {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(contact)];
      const double sign = path.u1 > path.u0 ? 1.0 : -1.0, force = from.slider_force[contact];
      return root([&](double s) {
        return slider.limit - sign * (force + slider.stiffness * (path.displacement(s) - path.u0));
      });
    }
    case Watch::rest_after_positive:
      return root([&](double s) { return path.velocity(s); });
    case Watch::rest_after_negative:
      return root([&](double s) { return -path.velocity(s); });
    case Watch::closing: {
      const Gap stop = gap_of(contact);
      return root([&](double s) { return stop.gap - path.displacement(s); });
    }
    case Watch::opening:
    case Watch::pushing_again: {
      const Gap stop = gap_of(contact);
      const double sign = watch == Watch::opening ? 1.0 : -1.0;
      return root([&](double s) {
        return sign * (stop.stiffness * (path.displacement(s) - stop.gap) + stop.damping * path.velocity(s));
      });
    }
    case Watch::law:
      return root([&](double s) { return guard_of_law(contact, from, to, s); });
    case Watch::nothing:
      break;
  }
  return 1.0;
}

Crossing StructureTimeline::first_crossing(const system::State& from, const system::State& to, double least, Look) {
  Crossing first;
  first.share = HUGE_VAL;
  for (Index i = 0; i < system_.contact_count(); ++i) {
    if (!(guard(i, from, to).value < 0.0)) continue;
    const double share = share_of(i, from, to);
    if (share >= least && share < first.share) first = {i, share};
  }
  return first;
}

bool StructureTimeline::is_gap(Index contact) const {
  if (contact < system_.first_block()) return contact >= system_.slider_count() && contact < system_.first_law();
  const Index block = system_.block_at(contact);
  const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(block)].law;
  return contact == system_.row_of_block(block) + law.size() - 1;
}

StructureTimeline::Gap StructureTimeline::gap_of(Index contact) const {
  if (contact < system_.first_block()) {
    const model::Stop& stop = system_.stops()[static_cast<std::size_t>(contact - system_.slider_count())];
    return {stop.gap, stop.stiffness, stop.damping};
  }
  const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(system_.block_at(contact))].law;
  return {law.clearance(), law.limit_stiffness(law.size() - 1, true), law.closed_damping()};
}

}  // namespace rubato::integrate
