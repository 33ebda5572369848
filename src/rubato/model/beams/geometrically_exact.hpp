#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/plane_point.hpp>

#include <array>
#include <memory>
#include <string>

namespace rubato::model {

/// Stiffness of a section in the plane.
struct PlaneSection {
  double axial = 0.0;    ///< E A [N]
  double shear = 0.0;    ///< shear factor times G A [N]
  double bending = 0.0;  ///< E I [N m2]
};

/// Geometrically exact beam in the plane (Reissner 1972; Simo and Vu-Quoc 1986): two nodes, positions and angle linear
/// between them, one point of integration, which keeps it from locking. With d = (p2 - p1)/L and the mean angle m of
/// the section,
///
///   stretch = cos(m) dx + sin(m) dy - 1,  slide = -sin(m) dx + cos(m) dy,  bend = (angle2 - angle1)/L
///   energy = L/2 (E A stretch^2 + k G A slide^2 + E I bend^2)
///
/// straight and free of stress as it lies between the points given.
/// @param first, second      nodes
/// @param position, other    where they lie at the start: x, y, angle
std::unique_ptr<Element> make_plane_beam(std::string name, const PlaneNode& first, const PlaneNode& second,
                                         const std::array<double, 3>& position, const std::array<double, 3>& other,
                                         const PlaneSection& section);

/// The viscous part of such a beam of a Kelvin-Voigt material: strains resist with their stiffness times the
/// retardation time tau [s] times their rates, which a rigid motion does not have (Linn, Lang and Tuganov 2013):
///
///   power taken = tau L (E A stretch'^2 + k G A slide'^2 + E I bend'^2)
///
/// It stores nothing, and is added to the elastic one.
std::unique_ptr<Element> make_viscous_plane_beam(std::string name, const PlaneNode& first, const PlaneNode& second,
                                                 const std::array<double, 3>& position,
                                                 const std::array<double, 3>& other, const PlaneSection& section,
                                                 double retardation_time);

}  // namespace rubato::model
