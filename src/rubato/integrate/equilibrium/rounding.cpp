#include <rubato/integrate/equilibrium/rounding.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace rubato::integrate {
namespace {

/// A number between -1 and 1 that belongs to another, as good as drawn (the finaliser of SplitMix64; Steele, Lea and
/// Flood 2014).
double drawn(Index i) {
  auto z = (static_cast<std::uint64_t>(i) + 1U) * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return 2.0 * static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53 - 1.0;
}

}  // namespace

double rounding_of_stiffness(const system::LocallyNonlinear& system, const std::vector<Index>& free,
                             const numerics::OrderedFactor& factor, const Vector& q) {
  if (free.empty()) return 0.0;
  const Vector terms = system.stiffness().cwiseAbs() * q.cwiseAbs();
  Vector right(static_cast<Index>(free.size())), change;
  double largest = 0.0;
  for (Index sample = 0; sample < 3; ++sample) {
    for (std::size_t i = 0; i < free.size(); ++i)
      right[static_cast<Index>(i)] =
          std::numeric_limits<double>::epsilon() * drawn(3 * free[i] + sample) * terms[free[i]];
    factor.solve(right, change);
    for (const bool is_rotation : {false, true}) {
      double size = 0.0, changed = 0.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        if (system.is_rotation(free[i]) != is_rotation) continue;
        size = std::max(size, std::abs(q[free[i]]));
        changed = std::max(changed, std::abs(change[static_cast<Index>(i)]));
      }
      if (size > 0.0) largest = std::max(largest, changed / size);
    }
  }
  return largest;
}

}  // namespace rubato::integrate
