#pragma once

#include <rubato/results/columns/column_group.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// A coordinate to record, or the difference of two.
struct Observed {
  std::string label;
  Index first = 0;
  Index second = ground;     ///< ground: `first` alone
  bool is_rotation = false;  ///< in radians

  double of(const Vector& x) const { return second == ground ? x[first] : x[first] - x[second]; }
};

struct ColumnNames {
  std::string variable, unit, description;
};

/// Adds a block of the displacements that are observed and one of the rotations, where there are any.
/// @param observed  displacements before rotations, as analysis::observed_or_all gives them
void add_blocks(const std::vector<Observed>& observed, const ColumnNames& of_displacements,
                const ColumnNames& of_rotations, std::vector<Block>& blocks);

/// Columns of what is observed: displacements in metres, then rotations in radians.
class ObservedColumns : public ColumnGroup {
 public:
  enum class Quantity { position, velocity, acceleration };
  static const std::vector<Quantity> of_motion;  ///< all three

  ObservedColumns(const std::vector<Observed>& observed, std::vector<Quantity> quantities);

  /// Adds a block a quantity for displacements (`position`, `velocity`, `acceleration`), then for rotations (`angle`,
  /// `angular_velocity`, `angular_acceleration`).
  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  /// A quantity of all coordinates that may be observed. Where these are not those of the system alone, of a class
  /// derived from this.
  /// @param workspace  for the values, where they are not at hand
  virtual const Vector& values(Quantity quantity, const system::State& state, Vector& workspace);

  std::vector<Observed> displacements_, rotations_;
  std::vector<Quantity> quantities_;
  std::vector<Vector> workspace_;  // by quantity
};

}  // namespace rubato::results
