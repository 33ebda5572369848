#pragma once

#include <rubato/model/laws/law.hpp>

namespace rubato::model {

/// Of a law whose steps must not be long, whatever the estimate of their error says: where an implicit step may find a
/// way that nothing shows to be wrong, as a friction that weakens with the speed lets go within one long step. Steps
/// that choose themselves ask for it.
class LawResolution {
 public:
  virtual ~LawResolution() = default;

  /// How much of what the law does with the rate changes within a step, over what may: to 1 the step is short enough.
  virtual double unresolved(const LawPoint& from, const LawPoint& to) const = 0;
};

}  // namespace rubato::model
