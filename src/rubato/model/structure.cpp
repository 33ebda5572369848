#include <rubato/model/structure.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::model {

namespace {

Axis along_of(const Structure& structure, const LineElement& element) {
  return structure.positions[static_cast<std::size_t>(element.second)] -
         structure.positions[static_cast<std::size_t>(element.first)];
}

void equations_with(const LineProperties& properties, const Structure& structure, const LineElement& element,
                    ElementEquations& equations) {
  const bool is_beam = properties.kind == LineProperties::Kind::beam;
  static constexpr std::size_t plane_beam[] = {0, 1, 5}, others[] = {0, 1, 2, 3, 4, 5};
  const bool in_plane = structure.dimension == 2;
  const std::size_t* const axes_of_node = is_beam && in_plane ? plane_beam : others;
  const int width = is_beam ? 3 * (structure.dimension - 1) : structure.dimension;
  equations.size = 2 * width;
  for (int i = 0; i < 2 * width; ++i) {
    const auto node = static_cast<std::size_t>(i < width ? element.first : element.second);
    const std::size_t axis = axes_of_node[i % width];
    equations.axis[static_cast<std::size_t>(i)] = axis;
    equations.place[static_cast<std::size_t>(i)] = structure.places[node][axis];
  }
  const double length = along_of(structure, element).norm();
  local_matrices(properties, structure.dimension, length, equations.stiffness, equations.mass);
  if (properties.released != 0) (void)release(properties.released, equations.stiffness, equations.mass);
  const Eigen::Matrix3d axes = axes_of(structure, element, is_beam);
  turn_into_model_axes(axes, structure.dimension, is_beam, equations.stiffness);
  turn_into_model_axes(axes, structure.dimension, is_beam, equations.mass);
}

}  // namespace

Eigen::Matrix3d axes_of(const Structure& structure, const LineElement& element, bool is_beam) {
  const Axis along = along_of(structure, element);
  if (structure.dimension == 2) return local_axes(along, Axis(-along.y(), along.x(), 0.0));
  // A truss is the same about its axis, and so is its mass: any orientation across it will do.
  return local_axes(along, is_beam ? element.orientation : Axis(along.unitOrthogonal()));
}

void equations_of(const Structure& structure, const LineElement& element, ElementEquations& equations) {
  equations_with(structure.properties[static_cast<std::size_t>(element.properties)], structure, element, equations);
}

Eigen::Matrix<double, 12, 1> even_load_of(const Structure& structure, const LineElement& element,
                                          const Axis& per_length, ElementEquations& equations) {
  // The consistent mass times an even acceleration is the integral of rho A h; its rotary part takes no share.
  LineProperties properties = structure.properties[static_cast<std::size_t>(element.properties)];
  properties.lumped_mass = false;
  equations_with(properties, structure, element, equations);
  const double mass_per_length = properties.density * properties.area;
  Eigen::Matrix<double, 12, 1> load = Eigen::Matrix<double, 12, 1>::Zero();
  for (int j = 0; j < equations.size; ++j) {
    const std::size_t axis = equations.axis[static_cast<std::size_t>(j)];
    if (is_rotation(axis)) continue;
    load.head(equations.size) += equations.mass.col(j) * (per_length[static_cast<Index>(axis)] / mass_per_length);
  }
  return load;
}

double reference_value(const Structure& structure, const Vector& point_mass) {
  if (structure.elements.empty()) return 0.0;
  Eigen::AlignedBox3d box;
  for (const Axis& position : structure.positions) box.extend(position);
  double mass = 0.0, inertia = 0.0;
  for (const LineElement& element : structure.elements) {
    const LineProperties& properties = structure.properties[static_cast<std::size_t>(element.properties)];
    const Axis &a = structure.positions[static_cast<std::size_t>(element.first)],
               &b = structure.positions[static_cast<std::size_t>(element.second)];
    mass += properties.density * properties.area * (b - a).norm();
  }
  for (const auto& places : structure.places) {
    double largest = 0.0;  // the mass of a node is the same along the axes that no support holds
    for (std::size_t axis = 0; axis < places.size(); ++axis) {
      const double value = places[axis] == ground ? 0.0 : point_mass[places[axis]];
      if (is_rotation(axis))
        inertia += value;
      else
        largest = std::max(largest, value);
    }
    mass += largest;
  }
  const double angle = std::numbers::pi / 10.0, elements = static_cast<double>(structure.elements.size());
  return std::sqrt(3.0 * mass * box.diagonal().squaredNorm() / elements + inertia * angle * angle);
}

}  // namespace rubato::model
