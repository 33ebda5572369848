#pragma once

#include <rubato/core/types.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// What a part of a system can do in a march: a lock that lets go or locks, friction that slips or sticks, a stop of a
/// structure that opens or closes.
enum class Change { lets_go, locks, slips, sticks, opens, closes };

struct Event {
  double t = 0.0;        ///< [s]
  std::size_t part = 0;  ///< among the names
  Change change = Change::lets_go;
  double energy_lost = 0.0;  ///< to an impact, or held by a spring as it let go [J]
};

/// What parts did in a march, in the order of time: the first hundred thousand changes, so that long runs fill neither
/// memory nor disks.
struct Events {
  static constexpr std::size_t most = 100'000;

  std::vector<std::string> parts;  ///< names of all that can change
  std::vector<int> places;  ///< of each part which of its joint's several locks it is, from 1; else 0; may be empty
  bool are_of_contacts = false;  ///< sliders and stops of a structure, else of joints
  std::vector<Event> all;
  std::size_t at_start = 0;  ///< the first so many tell how the march begins: nothing changed then
  long left_out = 0;         ///< further changes, which are counted only

  /// Which of the several locks of its joint a part is, from 1; 0 where there are not several.
  int place_of(std::size_t part) const { return places.empty() ? 0 : places[part]; }

  void add(const Event& event) {
    if (all.size() < most)
      all.push_back(event);
    else
      ++left_out;
  }
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
    case Change::opens:
      return "opens";
    case Change::closes:
      return "closes";
  }
  return "";
}

}  // namespace rubato::integrate
