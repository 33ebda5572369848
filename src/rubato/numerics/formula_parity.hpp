#pragma once

#include <rubato/numerics/formula.hpp>

namespace rubato::numerics {

/// Whether a formula is even or odd in all of its further values together (Formula), t held: what the opposite values
/// make of it. Found from its operations (an odd times an odd is even), never from samples: what is claimed holds for
/// all values, to the last bit, wherever nothing divides by zero. Some formulas that are odd are not known to be, such
/// as those that are put together from pieces: `u > 1 ? u - 1 : u < -1 ? u + 1 : 0`.
Parity parity_of(const Formula& formula);

}  // namespace rubato::numerics
