#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/beams/line_element.hpp>

#include <array>
#include <string>
#include <vector>

namespace rubato::model {

/// The degrees of freedom of a node, in this order; a plane node has x, y and rz.
inline constexpr std::array<const char*, 6> axis_names{"x", "y", "z", "rx", "ry", "rz"};
inline constexpr bool is_rotation(std::size_t axis) { return axis >= 3; }

/// A straight line between two nodes.
struct LineElement {
  Index first = 0, second = 0;  ///< nodes
  int properties = 0;
  Axis orientation = Axis::Zero();  ///< of a beam in space, in its local x-y plane
};

/// Nodes in the plane or in space and the elements between them, with the coordinate that each degree of freedom is.
struct Structure {
  int dimension = 2;                         ///< 2: plane, 3: space
  std::vector<std::string> names;            ///< of the nodes, [p]
  std::vector<Axis> positions;               ///< [p] [m]; in the plane z = 0
  std::vector<std::array<Index, 6>> places;  ///< coordinate of x, y, z, rx, ry, rz; `ground` where fixed or absent
  std::vector<LineProperties> properties;
  std::vector<LineElement> elements;

  bool is_empty() const { return names.empty(); }
};

/// What an element adds to the equations: matrices over its degrees of freedom, in the axes of the model.
struct ElementEquations {
  int size = 0;                        ///< k
  std::array<Index, 12> place{};       ///< coordinate of each, or `ground` [k]
  std::array<std::size_t, 12> axis{};  ///< which of x, y, z, rx, ry, rz each is [k]
  LineMatrix stiffness, mass;          ///< [k x k]
};

/// The axes of an element, as rows in those of the model; the third is that of the plane.
Eigen::Matrix3d axes_of(const Structure& structure, const LineElement& element, bool is_beam);

/// The equations of an element of a structure. `equations` is overwritten; allocates nothing.
void equations_of(const Structure& structure, const LineElement& element, ElementEquations& equations);

/// Forces and moments on the degrees of freedom of an element under an even load: the integral of its shape functions,
/// which make them the fixed-end forces. Places and axes as in ElementEquations.
/// @param per_length  in the axes of the model [N/m]
/// @param equations   overwritten
Eigen::Matrix<double, 12, 1> even_load_of(const Structure& structure, const LineElement& element,
                                          const Axis& per_length, ElementEquations& equations);

/// Characteristic size of a structure for error measures (Cardona and Cassano 1991, appendix A-1) [m sqrt(kg)]:
///
///   l = sqrt(3 m box^2 / elements + J (pi/10)^2)
///
/// with m all translational mass (three components, also in the plane), box the diagonal of the bounding box of all
/// nodes, held ones included, and J the sum of the point inertias. 0 without elements or extent.
/// @param point_mass  masses and inertias by coordinate [n] [kg] or [kg m2]
double reference_value(const Structure& structure, const Vector& point_mass);

}  // namespace rubato::model
