#pragma once

#include <rubato/model/bodies/motion.hpp>
#include <rubato/system/mechanism.hpp>

#include <algorithm>
#include <vector>

namespace rubato::system {

/// A state of a mechanism as its elements and joints read it: fixed axes have the velocity before the first, zero. A
/// workspace.
class StateMotion {
 public:
  explicit StateMotion(const Mechanism& mechanism) : velocity_(static_cast<std::size_t>(mechanism.size()) + 1, 0.0) {}

  /// Valid until the next call, and while the state is there.
  /// @param side  which limit to take of what jumps at state.t
  const model::Motion& go_to(const State& state, model::Side side) {
    std::copy(state.v.data(), state.v.data() + state.v.size(), velocity_.data() + 1);
    motion_ = {state.t,
               side,
               state.q.data(),
               velocity_.data() + 1,
               state.phase.data(),
               state.rubbing.data(),
               state.stuck_at.data()};
    return motion_;
  }

 private:
  std::vector<double> velocity_;  // after a zero
  model::Motion motion_;
};

}  // namespace rubato::system
