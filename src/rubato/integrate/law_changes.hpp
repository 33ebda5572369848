#pragma once

#include <rubato/integrate/events.hpp>
#include <rubato/model/laws/law.hpp>

namespace rubato::integrate {

/// Tells what a law that sticks and slips did from one branch to another. One that slips one way and then the other has
/// stuck between.
/// @param tell  takes a Change
template <class Tell>
void tell_law_changes(model::Law::Contact before, model::Law::Contact now, const Tell& tell) {
  using enum model::Law::Contact;
  const auto slips = [](model::Law::Contact branch) { return branch == slips_forwards || branch == slips_backwards; };
  if (now == open) {
    tell(Change::opens);
    return;
  }
  if (before == open) tell(Change::closes);
  if (now == sticks || (slips(before) && slips(now))) tell(Change::sticks);
  if (slips(now)) tell(Change::slips);
}

}  // namespace rubato::integrate
