#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/mechanism.hpp>
#include <rubato/system/constrained_system.hpp>

#include <array>
#include <string>
#include <vector>

namespace rubato::system {

/// A mechanism in redundant coordinates. q holds all numbers of all nodes (three a node in the plane, seven in space,
/// the ground first), those of fixed axes too, and behind them the angles of joints in space whose turns are counted.
class Mechanism final : public ConstrainedSystem {
 public:
  /// Throws InvalidInput for a coordinate without mass.
  explicit Mechanism(model::Mechanism model);

  Index size() const override { return model_.size(); }                                 ///< n
  Index constraint_count() const override { return static_cast<Index>(rows_.size()); }  ///< c
  const model::Mechanism& model() const { return model_; }
  const SparseMatrix& mass() const override { return mass_; }
  bool has_diagonal_mass() const { return has_diagonal_mass_; }
  const std::vector<std::string>& coordinates() const override { return model_.coordinates; }
  bool is_rotation(Index i) const override { return model_.is_rotation[static_cast<std::size_t>(i)] != 0; }
  const std::vector<std::string>& rows() const override { return rows_; }  ///< of constraints, "JOINT.x" [c]
  /// The first row of a joint, among the model's.
  Index first_row(int joint) const { return first_row_[static_cast<std::size_t>(joint)]; }
  const State& start() const override { return start_; }
  double reference() const override { return model_.reference; }
  /// The diagonal of the box around all positions [m]; rotations have no size. Of a single point 1 m.
  double extent(const Vector& q) const;
  /// Constant external force: weights [n] [N].
  const Vector& weight() const { return weight_; }

  bool is_flat() const override { return false; }
  double largest_turn() const override;
  /// The configuration after a motion dq [n] from q: q + dq, exponential map for rotations.
  void retract(const Vector& q, const Vector& dq, Vector& out) const override;
  /// The dq that leads from q to `to` along one retraction.
  void difference(const Vector& q, const Vector& to, Vector& dq) const override;
  /// The numbers of q that the tangent coordinates move, in space the rotation vectors [n] [m], [rad].
  void coordinate_values(const Vector& q, Vector& out) const;
  /// T(rotation)^-1 of each node in space (Bruels, Cardona and Arnold 2012); in the plane they are the same.
  void to_travel(const Vector& travel, Vector& motion) const override;
  void times_mass(const Vector& x, Vector& out) const override;
  std::vector<Index> driven_rows() const override;
  bool has_kinks() const override;
  bool has_followed_reactions() const override;
  bool has_slip_directions() const override;
  bool has_stops() const override;
  bool touches(const State& state) const override;
  bool has_memory() const override { return model_.law_memory_size > 0 || !model_.contacts.empty(); }
  std::unique_ptr<ConstrainedEquations> equations() const override;

 private:
  /// Sets the angles that are counted with their turns to those of q, by continuity from `before`.
  void count_turns(const Vector& before, Vector& q) const;

  model::Mechanism model_;
  SparseMatrix mass_;
  Vector diagonal_, weight_;
  bool has_diagonal_mass_ = false;
  std::vector<std::string> rows_;
  std::vector<Index> first_row_;  // of each joint
  struct Turn {
    Index quaternion = 0;          // its first number in q
    std::array<Index, 3> place{};  // tangent coordinates of the body axes, or `ground`
  };
  std::vector<Index> number_;  // of q to which a tangent coordinate is added; -1: one of a turn [n]
  std::vector<Turn> turns_;    // of nodes in space that are free to
  State start_;
};

}  // namespace rubato::system
