#pragma once

#include <cstdio>
#include <exception>
#include <new>
#include <string>

namespace rubato::app {

/// A line for people, on stderr. Nothing happens where nobody reads it any more: a run goes on.
inline void tell(const std::string& line) { std::fputs((line + "\n").c_str(), stderr); }

/// What a fault says, in words for people.
inline std::string reason_of(const std::exception& fault) {
  return dynamic_cast<const std::bad_alloc*>(&fault) ? "memory ran out" : fault.what();
}

}  // namespace rubato::app
