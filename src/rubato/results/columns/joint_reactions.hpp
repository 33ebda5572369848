#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/state_motion.hpp>

#include <array>
#include <string>
#include <vector>

namespace rubato::results {

/// The reactions of the joints of a mechanism as columns of results: what a joint does to its second part (to its first
/// the opposite); a tension pulls. In the plane they are its multipliers, by the names of their rows; in space a force
/// and a moment about the point where the joint holds its second part, by the axes of the world. What a drive gives
/// stands beside them, by the coordinate that it moves.
class JointReactions final : public ColumnGroup {
 public:
  explicit JointReactions(const system::Mechanism& mechanism);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  /// Rows of constraints that bear one name, "x" or "drive_moment"; in space those of drives only.
  struct Rows {
    std::string name;
    std::vector<std::string> joints;
    std::vector<std::vector<Index>> places;  // of each joint: several locks make one reaction
    double sign = -1.0;
  };
  void add_space(TableLayout& layout) const;
  void append_space(const model::Motion& motion, const Vector& multiplier, std::vector<double>& row);
  /// Force and moment of a joint in space on its second part.
  std::array<double, 6> wrench(const model::SpaceReaction& reaction, Index first_row, const model::Motion& motion,
                               const Vector& multiplier);

  const system::Mechanism& mechanism_;
  system::StateMotion motion_;
  std::vector<Rows> rows_;
  std::vector<Index> first_row_;  // of each joint
  std::vector<double> constraint_, jacobian_;
};

}  // namespace rubato::results
