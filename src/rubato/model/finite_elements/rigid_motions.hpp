#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/structure.hpp>

#include <optional>
#include <vector>

// Private to the model floor.
namespace rubato::model {

/// Three translations and three turns about a point, at the rows of a model [n x 6]. Turns are zero where no file tells
/// the positions.
Matrix rigid_motions(const FiniteElements& model, const Axis& about = Axis::Zero());

/// Rows of nodes that share no element with a node that is held, wholly or in part. Without elements: all rows where no
/// node is held, else none.
std::vector<Index> rows_far_from_held(const FiniteElements& model);

/// The largest |sum_j K_ij r_j| / sum_j |K_ij r_j| over rows and rigid motions: the same in any unit [-].
struct RigidCost {
  double worst = 0.0;
  Index row = 0, motion = 0;
};
RigidCost rigid_cost(const FiniteElements& model, const Matrix& motions, const std::vector<Index>& rows);

/// A turning structure in the axes that turn with it: K u = -Omega^2 M u for translations across the axis, 0 along it.
struct SpinSoftening {
  double speed = 0.0;  ///< Omega [rad/s]
  Axis axis = Axis::Zero();
};
/// Nothing where that does not describe what translations cost.
/// @param inertia  M times the motions [n x 6]
/// @param noise    relative round-off of the entries [-]
std::optional<SpinSoftening> spin_softening(const FiniteElements& model, const Matrix& motions, const Matrix& inertia,
                                            const std::vector<Index>& rows, double noise);

}  // namespace rubato::model
