#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/results/sink.hpp>

#include <initializer_list>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Columns of what is observed: displacements in metres, then rotations in radians.
class ObservedBlocks {
 public:
  enum class Quantity { position, velocity, acceleration };

  explicit ObservedBlocks(const std::vector<Observed>& observed);

  /// Adds a block a quantity for displacements (`position`, `velocity`, `acceleration`), then for rotations (`angle`,
  /// `angular_velocity`, `angular_acceleration`).
  void add(results::TableLayout& layout, std::initializer_list<Quantity> quantities) const;
  /// Appends the values, in the order of `add`; `vectors` are the quantities [n] each.
  void append(std::initializer_list<const Vector*> vectors, std::vector<double>& row) const;

 private:
  std::vector<Observed> displacements_, rotations_;
};

/// Columns of the sliders: `force` and `slip` of those between displacements, `moment` and `slip_angle` of those
/// between rotations.
class SliderBlocks {
 public:
  explicit SliderBlocks(const system::LocallyNonlinear& system);

  void add(results::TableLayout& layout) const;
  void append(const system::State& state, std::vector<double>& row) const;
  /// The sliders in the order of the columns.
  std::vector<Index> order() const;

 private:
  const system::LocallyNonlinear& system_;
  std::vector<Index> of_displacements_, of_rotations_;
};

}  // namespace rubato::analysis
