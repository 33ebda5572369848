#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/law_changes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace rubato::integrate {

ContactEvents::ContactEvents(const system::LocallyNonlinear& system, const system::State& start,
                             StructureTimeline* located)
    : system_(system), located_(located), parts_(static_cast<std::size_t>(system.contact_count()), 0) {
  events_.are_of_contacts = true;
  stops_.resize(static_cast<std::size_t>(system.stop_count()));
  note_gaps(start);
  const Index sliders = system.slider_count();
  constexpr double none = std::numeric_limits<double>::infinity(), least = std::numeric_limits<double>::denorm_min();
  for (Index i = 0; i < system.first_law(); ++i) {
    const auto contact = static_cast<std::size_t>(i);
    const double limit = i < sliders ? system.sliders()[contact].limit : least;
    if (limit == 0.0) continue;  // without a force there is no friction
    parts_[contact] = events_.parts.size();
    events_.parts.push_back(i < sliders ? system.sliders()[contact].name
                                        : system.stops()[static_cast<std::size_t>(i - sliders)].name);
    watched_.push_back({i, limit, i < sliders ? -limit : -none, 0});
    watched_.back().branch = located ? located->branch(i, start) : branch_of(watched_.back(), start);
    if (i >= sliders && watched_.back().branch != 0) note_stop(i, start, true);
  }
  for (Index j = 0; j < system.law_count(); ++j) {
    const model::LawBetween& law = system.laws()[static_cast<std::size_t>(j)];
    if (!(law.law->sticking_stiffness() > 0.0)) continue;
    const Index i = system.first_law() + j;
    parts_[static_cast<std::size_t>(i)] = events_.parts.size();
    events_.parts.push_back(law.name);
    watched_.push_back({i, 0.0, 0.0, branch_of_law(i, start)});
  }
  for (Index b = 0; b < system.block_count(); ++b) {
    const Index i = system.row_of_block(b);
    parts_[static_cast<std::size_t>(i)] = events_.parts.size();
    events_.parts.push_back(system.blocks()[static_cast<std::size_t>(b)].name);
    watched_.push_back({i, 0.0, 0.0, branch_of_law(i, start)});
  }
  events_.at_start = events_.all.size();
}

int ContactEvents::branch_of_law(Index contact, const system::State& state) const {
  if (contact >= system_.first_block()) {
    const Index b = system_.block_at(contact);
    const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(b)].law;
    // What presses is told by the force that came with the memory: the displacement of two ends that move together has
    // the round-off of theirs.
    model::BlockPoint point = system_.block_point(b, state);
    const Index normal = law.size() - 1;
    point.u[normal] = law.clearance() + state.slider_force[contact + normal] / law.limit_stiffness(normal, true);
    point.rate[normal] = 0.0;  // the force has the dashpot in it
    return static_cast<int>(law.contact(point, state.memory.data() + system_.memory_of_block(b)));
  }
  const Index law = contact - system_.first_law();
  return static_cast<int>(system_.laws()[static_cast<std::size_t>(law)].law->contact(
      system_.law_point(law, state, model::Side::left), state.memory.data() + system_.memory_of(law), 0.0));
}

void ContactEvents::note_law(Watched& one, int now, double t) {
  const std::size_t part = parts_[static_cast<std::size_t>(one.contact)];
  tell_law_changes(static_cast<model::Law::Contact>(one.branch), static_cast<model::Law::Contact>(now),
                   [&](Change change) {
                     events_.add({t, part, change});
                   });
  one.branch = now;
}

bool ContactEvents::accepted(const system::State& before, const system::State& after) {
  note_gaps(after);
  for (Watched& one : watched_) {
    if (one.contact >= system_.first_law()) {
      const Index law = one.contact - system_.first_law();
      const bool is_located = located_ && one.contact < system_.first_block();
      const auto branch_at = [&](bool at_end) {
        return static_cast<int>(located_->contact_of_law(law, before, after, at_end));
      };
      // A load that jumps, or rises from zero, changes it where a step begins.
      const int then = is_located ? branch_at(false) : one.branch;
      if (then != one.branch) note_law(one, then, before.t);
      const bool is_block = one.contact >= system_.first_block();
      int now = is_located ? branch_at(true) : branch_of_law(one.contact, after);
      // At the gap, to what a located step leaves, the velocity tells.
      if (located_ && is_block) {
        constexpr int open = static_cast<int>(model::Law::Contact::open);
        const int next = static_cast<int>(located_->contact_of_block(system_.block_at(one.contact), after));
        if ((next == open) != (now == open)) now = next;
      }
      if (now != one.branch) note_law(one, now, after.t);
      continue;
    }
    const int now = located_ ? located_->branch_after(one.contact, before, after) : branch_of(one, after);
    if (now != one.branch) note_change(one, now, after);
  }
  return true;
}

void ContactEvents::note_gaps(const system::State& state) {
  for (Index j = 0; j < system_.stop_count(); ++j) {
    const Index contact = system_.slider_count() + j;
    const double gap = system_.stops()[static_cast<std::size_t>(j)].gap;
    stops_[static_cast<std::size_t>(j)].note(state.t, gap - system_.relative_displacement(contact, state.q));
  }
}

std::vector<std::string> ContactEvents::never_reached() const {
  std::vector<std::string> told;
  for (std::size_t j = 0; j < stops_.size(); ++j) {
    const model::Stop& stop = system_.stops()[j];
    const bool is_angle = system_.is_rotation(stop.first == ground ? stop.second : stop.first);
    if (std::string line = stops_[j].told(fmt::format("the stop \"{}\"", stop.name), is_angle); !line.empty())
      told.push_back(std::move(line));
  }
  return told;
}

void ContactEvents::note_change(Watched& one, int now, const system::State& state) {
  if (one.contact >= system_.slider_count()) {
    note_stop(one.contact, state, now != 0);
  } else {
    if (one.branch != 0) note_slider(state.t, one.contact, true);
    if (now != 0) note_slider(state.t, one.contact, false);
  }
  one.branch = now;
}

void ContactEvents::note_slider(double t, Index slider, bool sticks) {
  events_.add({t, parts_[static_cast<std::size_t>(slider)], sticks ? Change::sticks : Change::slips});
}

void ContactEvents::note_stop(Index contact, const system::State& state, bool closes) {
  const auto& stop = system_.stops()[static_cast<std::size_t>(contact - system_.slider_count())];
  const double depth = std::max(0.0, system_.relative_displacement(contact, state.q) - stop.gap);
  const bool leaves_energy = !closes && stop.damping > 0.0;
  events_.add({state.t, parts_[static_cast<std::size_t>(contact)], closes ? Change::closes : Change::opens,
               leaves_energy ? 0.5 * stop.stiffness * depth * depth : 0.0});
}

}  // namespace rubato::integrate
