#pragma once

#include <rubato/core/types.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// What a part of a system can do in a march: a lock that lets go or locks, friction that slips or sticks.
enum class Change { lets_go, locks, slips, sticks };

struct Event {
  double t = 0.0;        ///< [s]
  std::size_t part = 0;  ///< among the names
  Change change = Change::lets_go;
  double energy_lost = 0.0;  ///< to an impact, or held by a spring as it let go [J]
};

/// What parts did in a march, in the order of time.
struct Events {
  std::vector<std::string> parts;  ///< names of all that can change
  std::vector<Event> all;
};

/// "locks", for messages.
inline const char* name_of(Change change) {
  switch (change) {
    case Change::lets_go:
      return "lets go";
    case Change::locks:
      return "locks";
    case Change::slips:
      return "slips";
    case Change::sticks:
      return "sticks";
  }
  return "";
}

}  // namespace rubato::integrate
