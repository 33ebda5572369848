#include <rubato/integrate/law_changes.hpp>
#include <rubato/integrate/mechanism/law_events.hpp>

#include <algorithm>

namespace rubato::integrate {

MechanismLawEvents::MechanismLawEvents(system::MechanismEquations& equations, const system::State& start,
                                       LawGuards* located, LawGuards* touches)
    : equations_(equations), located_(located), touches_(touches) {
  equations_.go_to(start, model::Side::left);
  for (const model::MechanismLaw& law : equations.mechanism().model().laws) {
    if (!(law.law->sticking_stiffness() > 0.0)) continue;
    events_.parts.push_back(law.name);
    watched_.push_back({law.index, equations_.law_contact(static_cast<std::size_t>(law.index))});
  }
  for (const model::MechanismContact& contact : equations.mechanism().model().contacts) {
    events_.parts.push_back(contact.name);
    contacts_.push_back({contact.index, equations_.contact_branch(static_cast<std::size_t>(contact.index))});
  }
}

void MechanismLawEvents::note(std::size_t part, model::Law::Contact now, double t) {
  Watched& one = part < watched_.size() ? watched_[part] : contacts_[part - watched_.size()];
  if (now == one.branch) return;
  tell_law_changes(one.branch, now, [&](Change change) { events_.add({t, part, change}); });
  one.branch = now;
}

bool MechanismLawEvents::accepted(const system::State& before, const system::State& after) {
  if (watched_.empty() && contacts_.empty()) return true;
  if (!located_ || !contacts_.empty()) {
    equations_.set_reaction_lag(before.reaction_lag, after.t - before.t);  // as in the step
    equations_.go_to(after, model::Side::left);
    equations_.set_reaction_lag(before.reaction_lag, 0.0);
  }
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const Index law = watched_[i].law;
    if (!located_) {
      note(i, equations_.law_contact(static_cast<std::size_t>(law)), after.t);
      continue;
    }
    // A load that jumps, or rises from zero, changes it where a step begins.
    note(i, located_->contact(law, before, after, false), before.t);
    note(i, located_->contact(law, before, after, true), after.t);
  }
  for (std::size_t j = 0; j < contacts_.size(); ++j) {
    const auto index = static_cast<std::size_t>(contacts_[j].law);
    const model::Law::Contact then = contacts_[j].branch, now = equations_.contact_branch(index);
    if (now == then) continue;
    // The step before ended where they met or parted, and from there on they are what they are now.
    const bool has_met = (then == model::Law::Contact::open) != (now == model::Law::Contact::open);
    const bool is_late = has_met && touches_ && touches_->stood_at_change(contacts_[j].law, before, after);
    note(watched_.size() + j, now, is_late ? before.t : after.t);
  }
  return true;
}

void MechanismLawEvents::add_to(Events& events) const {
  const std::size_t first = events.parts.size();
  events.parts.insert(events.parts.end(), events_.parts.begin(), events_.parts.end());
  if (!events.places.empty()) events.places.resize(events.parts.size(), 0);
  const auto known = static_cast<std::ptrdiff_t>(events.all.size());
  for (Event event : events_.all) {
    event.part += first;
    events.add(event);
  }
  events.left_out += events_.left_out;
  const auto begin = events.all.begin() + static_cast<std::ptrdiff_t>(events.at_start);
  std::inplace_merge(begin, events.all.begin() + known, events.all.end(),
                     [](const Event& a, const Event& b) { return a.t < b.t; });
}

}  // namespace rubato::integrate
