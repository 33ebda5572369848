#pragma once

#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/state_motion.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// What is observed of a mechanism, and the angles that its joints leave free, which stand beside the rotations of
/// nodes, after all coordinates.
class JointAngles final : public ObservedColumns {
 public:
  JointAngles(const system::Mechanism& mechanism, std::vector<Observed> observed, std::vector<Quantity> quantities);

 private:
  const Vector& values(Quantity quantity, const system::State& state, Vector& out) override;

  const system::Mechanism& mechanism_;
  system::StateMotion motion_;
  std::vector<double> acceleration_;  // after a zero
  Vector coordinates_;
  Index turning_ = 0;  // how many of the joints' coordinates are angles
};

/// The displacements that the joints of a mechanism leave free.
class JointDisplacements final : public ColumnGroup {
 public:
  explicit JointDisplacements(const system::Mechanism& mechanism) : mechanism_(mechanism) {}

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  const system::Mechanism& mechanism_;
};

}  // namespace rubato::results
