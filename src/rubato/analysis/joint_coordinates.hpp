#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/results/sink.hpp>
#include <rubato/system/mechanism.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// The coordinates that the joints of a mechanism leave free, as columns of results: angles stand beside the rotations
/// of nodes, after all coordinates, displacements by themselves.
class JointCoordinates {
 public:
  explicit JointCoordinates(const system::Mechanism& mechanism);

  /// Adds the angles to what is observed.
  std::vector<Observed> with_angles(std::vector<Observed> observed) const;
  /// Adds a block of the displacements, where there are any.
  void add_displacements(results::TableLayout& layout) const;

  /// Goes to a state.
  void go_to(const system::State& state);
  /// Where the mechanism is, for its joints; valid until the next go_to().
  const model::Motion& motion() const { return motion_; }
  /// Coordinates and angles, their rates and second rates [n + angles].
  /// @param acceleration  [n]
  void positions(Vector& out);
  void velocities(Vector& out) const;
  void accelerations(const Vector& acceleration, Vector& out);
  /// Appends the displacements.
  void append_displacements(std::vector<double>& row) const;

 private:
  const system::Mechanism& mechanism_;
  std::vector<std::string> turning_, sliding_;
  const system::State* state_ = nullptr;
  std::vector<double> velocity_, acceleration_;  // after a zero
  model::Motion motion_;
  Vector values_;
};

}  // namespace rubato::analysis
