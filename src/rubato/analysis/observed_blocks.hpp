#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/results/sink.hpp>

#include <initializer_list>
#include <string>
#include <vector>

namespace rubato::analysis {

struct ColumnNames {
  std::string variable, unit, description;
};

/// Adds a block of the displacements that are observed and one of the rotations, where there are any.
/// @param observed  displacements before rotations, as observed_or_all gives them
void add_blocks(const std::vector<Observed>& observed, const ColumnNames& of_displacements,
                const ColumnNames& of_rotations, std::vector<results::Block>& blocks);

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

/// Columns of the sliders: those between displacements before those between rotations.
class SliderBlocks {
 public:
  explicit SliderBlocks(const system::LocallyNonlinear& system);

  /// Adds `force` and `slip`, then `moment` and `slip_angle`.
  void add(results::TableLayout& layout) const;
  /// Appends the values, in the order of `add`.
  void append(const system::State& state, std::vector<double>& row) const;
  /// Adds a quantity of the sliders between displacements and of those between rotations.
  void add(const ColumnNames& of_displacements, const ColumnNames& of_rotations,
           std::vector<results::Block>& blocks) const;
  /// Adds a quantity with the same unit for all.
  void add(const ColumnNames& names, std::vector<results::Block>& blocks) const;
  /// The sliders in the order of the columns.
  std::vector<Index> order() const;

 private:
  std::vector<std::string> labels_of(const std::vector<Index>& sliders) const;

  const system::LocallyNonlinear& system_;
  std::vector<Index> of_displacements_, of_rotations_;
};

/// Columns of the stops: `force` and `penetration`, of those between rotations `moment` and `penetration_angle`.
class StopBlocks {
 public:
  explicit StopBlocks(const system::LocallyNonlinear& system);

  void add(results::TableLayout& layout) const;
  /// Appends the values, in the order of `add`.
  void append(const system::State& state, std::vector<double>& row) const;
  std::size_t width() const { return 2 * (of_displacements_.size() + of_rotations_.size()); }

 private:
  const system::LocallyNonlinear& system_;
  std::vector<Index> of_displacements_, of_rotations_;
};

}  // namespace rubato::analysis
