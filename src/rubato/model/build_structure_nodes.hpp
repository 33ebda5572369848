#pragma once

#include <rubato/model/build_structure.hpp>
#include <rubato/model/by_name.hpp>

#include <array>
#include <string>
#include <vector>

// Private to the model floor.
namespace rubato::model {

/// The nodes of a structure while it is built: which degrees of freedom they have, what is held, what they carry and
/// how they start. All throw InvalidInput.
class StructureNodes {
 public:
  /// @param structure  gets the dimension, names and positions of the nodes, and their places
  StructureNodes(const StructureDescription& description, const numerics::Parameters& parameters, Structure& structure)
      : description_(description), parameters_(parameters), structure_(structure) {}

  /// The nodes of the description, with their velocities.
  void take_given();
  /// A node within a beam between two others, with the velocities between theirs.
  /// @param share  of the way from the first to the last [-]
  Index add_between(const std::string& name, const Location& where, Index first, Index last, double share);
  void take_masses_and_supports();
  /// Turns what is free into coordinates, and refuses nodes that nothing joins and velocities that would be lost.
  /// @param offset  the first coordinate
  void number(Index offset, BuiltStructure& built);

  bool has(const std::string& name) const { return names_.has(name); }
  std::size_t place(const std::string& name, const Location& where, const std::string& who) const {
    return names_.place(name, where, who);
  }

  /// What a line gives to its ends: translations, a beam rotations too.
  void give_axes(Index node, bool has_rotations);
  /// What a beam with releases gives to its ends: the inertia of the motions of its own axes that it keeps.
  /// @param is_kept  of x, y, z, rx, ry, rz in the axes of the beam
  /// @param axes     rows: those of the beam, in the axes of the model
  /// @param where    of the releases, for messages
  void give_kept_axes(Index node, const std::array<bool, 6>& is_kept, const Eigen::Matrix3d& axes,
                      const Location& where);

 private:
  struct NodeState {
    std::array<bool, 6> is_fixed{}, has_velocity{};  // the latter: it is given
    std::array<double, 6> mass{}, velocity{};
    /// Of translations and of rotations: the sum of d d^T over unit vectors d along or about which something at the
    /// node has an inertia of its own. A direction in which it is zero has none.
    std::array<Eigen::Matrix3d, 2> inertia{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
    Location where, release_where;
  };

  double evaluated(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }
  bool in_plane() const { return structure_.dimension == 2; }
  /// Something gives the degree of freedom an inertia.
  static bool exists(const NodeState& state, std::size_t axis);
  static void give_axis(NodeState& state, std::size_t axis);

  void add(const std::string& name, const Location& where, const Axis& position);
  void take_velocity(const NodeDescription& node, NodeState& state) const;
  void take_mass(const PointMassDescription& mass);
  void take_support(const SupportDescription& support);
  void refuse_lost_velocity(std::size_t node) const;
  void refuse_direction_without_inertia(std::size_t node) const;

  const StructureDescription& description_;
  const numerics::Parameters& parameters_;
  Structure& structure_;
  ByName<Index> names_{"node"};
  std::vector<NodeState> states_;
};

}  // namespace rubato::model
