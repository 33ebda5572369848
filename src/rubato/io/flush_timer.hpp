#pragma once

#include <algorithm>
#include <chrono>

namespace rubato::io {

/// Says once a second that rows should reach the disk. Where rows come fast it looks at the clock only at every 32nd,
/// so that asking costs nothing beside formatting a row.
class FlushTimer {
 public:
  bool is_due() {
    if (++calls_ < calls_a_look_) return false;
    calls_ = 0;
    const auto now = Clock::now();
    calls_a_look_ = now - last_look_ < std::chrono::milliseconds(10) ? std::min(2 * calls_a_look_, 32) : 1;
    last_look_ = now;
    if (now - last_flush_ < std::chrono::seconds(1)) return false;
    last_flush_ = now;
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_look_ = Clock::now(), last_flush_ = last_look_;
  int calls_ = 0, calls_a_look_ = 1;
};

}  // namespace rubato::io
