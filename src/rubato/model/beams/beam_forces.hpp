#pragma once

#include <rubato/model/bodies/motion.hpp>

#include <string>
#include <vector>

namespace rubato::model {

/// What the section in the middle of a beam element carries, in its axes, from which side ever it is looked at: a force
/// along the beam that pulls is positive, and a moment that bends it as its angle grows from the first node to the
/// second.
class BeamForces {
 public:
  /// Of a beam in the plane: normal force, shear force along y, bending moment. In space: normal force, shear forces
  /// along y and z, torsion, bending moments about y and z.
  static constexpr int in_plane = 3, in_space = 6;

  virtual ~BeamForces() = default;
  /// @param forces  [3] or [6] [N], [N m]
  virtual void section_forces(const Motion& motion, double* forces) const = 0;

 protected:
  BeamForces() = default;
  BeamForces(const BeamForces&) = default;
  BeamForces& operator=(const BeamForces&) = default;
};

/// An element of a beam, of which there may be two: what is elastic in it and, after that, what is viscous.
struct BeamPart {
  std::string beam, name;            ///< "arm", "arm(1)"
  std::size_t first = 0, count = 1;  ///< among the elements of the mechanism
};

}  // namespace rubato::model
