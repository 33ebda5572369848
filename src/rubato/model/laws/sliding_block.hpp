#pragma once

#include <rubato/model/laws/block_law.hpp>

namespace rubato::model {

/// Of a law of several numbers whose second end moves on steadily, as a belt or a disc does: V t is added to the first
/// number, V to its rate. What moves it does the work V T.
class SlidingBlock {
 public:
  virtual ~SlidingBlock() = default;

  /// V; 0: it does not move [m/s]
  virtual double sliding_velocity() const = 0;
};

/// V of a law; 0 of one that has none [m/s].
inline double sliding_velocity_of(const BlockLaw& law) {
  const auto* sliding = dynamic_cast<const SlidingBlock*>(&law);
  return sliding ? sliding->sliding_velocity() : 0.0;
}

}  // namespace rubato::model
