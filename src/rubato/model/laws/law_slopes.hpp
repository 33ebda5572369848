#pragma once

#include <rubato/model/laws/law.hpp>

namespace rubato::model {

/// Of a law with memory that knows the slopes of its steps, for what it does over many of them. Of others differences
/// of Law::advance() take their place, to half the digits.
class LawSlopes {
 public:
  virtual ~LawSlopes() = default;

  /// The slopes of what advance() gives: of the force, then of each number of the memory at `to`.
  /// @param slopes  a row of 4 + memory_size() each: by u and the rate at `to`, by u and the rate at `from`, by each
  ///                number of the memory at `from`; [1 + memory_size() rows], one after another, all zero at first
  virtual void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const = 0;
};

}  // namespace rubato::model
