#pragma once

#include <cstdio>
#include <string>

namespace rubato::app {

/// A line for people, on stderr. Nothing happens where nobody reads it any more: a run goes on.
inline void tell(const std::string& line) { std::fputs((line + "\n").c_str(), stderr); }

}  // namespace rubato::app
