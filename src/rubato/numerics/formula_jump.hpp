#pragma once

#include <rubato/numerics/formula.hpp>

#include <optional>

namespace rubato::numerics {

/// The first time in (from, to) at which a formula, or its derivative of order 1 or 2, jumps by more than round-off:
/// 1e-9 of the largest of what stands on either side of the switches and at some points between them.
std::optional<double> first_jump(const Formula& formula, int order, double from, double to);

}  // namespace rubato::numerics
