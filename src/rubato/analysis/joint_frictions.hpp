#pragma once

#include <rubato/results/sink.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <cstddef>
#include <vector>

namespace rubato::analysis {

/// What the friction of joints does to their second parts, as columns of results: `friction_moment` [N m] of those that
/// turn, then `friction_force` [N] of those that slide, then `friction_force_x`, `_y` and `_z` [N] of planar ones, by
/// the axes of the world. While a joint sticks it is what holds it.
class JointFrictions {
 public:
  explicit JointFrictions(const system::Mechanism& mechanism);

  void add(results::TableLayout& layout) const;
  /// Appends the values, in the order of `add`.
  /// @param equations   at the state of the row
  /// @param motion      the same
  /// @param multiplier  of equilibrium there [c]
  void append(const system::MechanismEquations& equations, const model::Motion& motion, const Vector& multiplier,
              std::vector<double>& row) const;

 private:
  const system::Mechanism& mechanism_;
  std::vector<std::size_t> turning_, sliding_;  // among the frictions
  std::vector<std::size_t> planar_;             // those that lead
};

}  // namespace rubato::analysis
