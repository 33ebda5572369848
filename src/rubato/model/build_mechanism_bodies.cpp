#include <rubato/model/build_structure.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Rotation;

/// Mass, and inertia about the centre of mass.
struct Inertia {
  double mass = 0.0;
  Matrix3 tensor = Matrix3::Zero();
};

/// A body of one material: its volume, and its inertia over its mass.
struct Solid {
  double volume;
  Axis inertia;
};

Solid solid_of(const MechanismAssembly& assembly, const ShapeDescription& shape, const std::string& part) {
  using Kind = ShapeDescription::Kind;
  const auto length = [&](const Quantity& quantity, const char* key) {
    return assembly.positive(quantity, part + "shape: " + key);
  };
  if (shape.kind == Kind::box) {
    Axis size;
    for (Index i = 0; i < 3; ++i) size[i] = length(shape.size[static_cast<std::size_t>(i)], "size");
    const Axis square = size.cwiseAbs2();
    return {size.prod(), (Axis::Constant(square.sum()) - square) / 12.0};
  }
  const double r = length(*shape.radius, "radius");
  if (shape.kind == Kind::sphere) return {4.0 / 3.0 * std::numbers::pi * r * r * r, Axis::Constant(0.4 * r * r)};
  const double h = length(*shape.length, "length"), across = (3.0 * r * r + h * h) / 12.0;
  return {std::numbers::pi * r * r * h, {across, across, 0.5 * r * r}};
}

/// How a picture shows a shape that has been found to be possible.
DrawnShape drawn_shape(const MechanismAssembly& assembly, const ShapeDescription& shape, Index node) {
  const auto length = [&](const Quantity& quantity) { return assembly.positive(quantity, "shape"); };
  DrawnShape drawn{shape.kind, node, {}};
  if (shape.kind == ShapeDescription::Kind::box) {
    for (std::size_t i = 0; i < 3; ++i) drawn.size[i] = length(shape.size[i]);
    return drawn;
  }
  drawn.size.fill(2.0 * length(*shape.radius));
  if (shape.kind == ShapeDescription::Kind::cylinder) drawn.size[2] = length(*shape.length);
  return drawn;
}

Inertia inertia_of_shape(const MechanismAssembly& assembly, const BodyDescription& body, const std::string& part) {
  const Solid solid = solid_of(assembly, *body.shape, part);
  const double mass = body.mass ? assembly.positive(*body.mass, part + "mass")
                                : assembly.positive(*body.shape->density, part + "shape: density") * solid.volume;
  return {mass, (mass * solid.inertia).asDiagonal()};
}

/// A tensor that some distribution of mass has: positive, and no principal inertia more than the sum of the others.
void require_possible(const Matrix3& tensor, const std::string& part, const Location& where) {
  const Axis principal = Eigen::SelfAdjointEigenSolver<Matrix3>(tensor).eigenvalues();
  constexpr double round_off = 1e-9;
  const std::string list = fmt::format("{:.6g}, {:.6g}, {:.6g}", principal[0], principal[1], principal[2]);
  if (!(principal[0] > round_off * principal[2]))
    throw InvalidInput(where, fmt::format("{}inertia must be positive about every axis, and its principal values are "
                                          "{}: a rotation that is free would have no inertia; a mass that does not "
                                          "turn is a [[node]] with a [[mass]]",
                                          part, list));
  if (!(principal[2] <= (principal[0] + principal[1]) * (1.0 + round_off)))
    throw InvalidInput(where, fmt::format("{}no body has the principal inertias {}: the largest exceeds the sum of the "
                                          "others; check products of inertia, given as entries of the matrix, and "
                                          "units",
                                          part, list));
}

Matrix3 space_tensor(const MechanismAssembly& assembly, const BodyDescription& body, const std::string& part) {
  if (body.inertia.size() != 3 && body.inertia.size() != 6)
    throw InvalidInput(body.inertia_where,
                       fmt::format("{}inertia takes three numbers in space (xx, yy, zz) or six (xx, "
                                   "yy, zz, xy, xz, yz), got {}",
                                   part, body.inertia.size()));
  Matrix3 tensor = Matrix3::Zero();
  const auto value = [&](std::size_t i) { return assembly.number(body.inertia[i], part + "inertia"); };
  for (Index i = 0; i < 3; ++i) tensor(i, i) = value(static_cast<std::size_t>(i));
  if (body.inertia.size() == 6) {
    tensor(0, 1) = tensor(1, 0) = value(3);
    tensor(0, 2) = tensor(2, 0) = value(4);
    tensor(1, 2) = tensor(2, 1) = value(5);
  }
  require_possible(tensor, part, body.inertia_where);
  return tensor;
}

double plane_inertia(const MechanismAssembly& assembly, const BodyDescription& body, const std::string& part) {
  if (body.inertia.size() != 1)
    throw InvalidInput(body.inertia_where,
                       fmt::format("{}inertia takes one number in the plane, got {}", part, body.inertia.size()));
  const double inertia = assembly.number(body.inertia[0], part + "inertia");
  if (!(inertia > 0.0))
    throw InvalidInput(body.inertia[0].where,
                       fmt::format("{}inertia must be positive, got {}: its rotation is free; a mass that does not "
                                   "turn is a [[node]] with a [[mass]]",
                                   part, inertia));
  return inertia;
}

Inertia inertia_of(const MechanismAssembly& assembly, const BodyDescription& body, const std::string& part) {
  if (body.shape) return inertia_of_shape(assembly, body, part);
  Inertia inertia{assembly.positive(*body.mass, part + "mass")};
  if (assembly.in_plane())
    inertia.tensor(2, 2) = plane_inertia(assembly, body, part);
  else
    inertia.tensor = space_tensor(assembly, body, part);
  return inertia;
}

void set_velocity(Mechanism& mechanism, Index node, std::size_t axis, double velocity) {
  MechanismNode& of = mechanism.nodes[static_cast<std::size_t>(node)];
  of.velocity[axis] = velocity;
  of.has_velocity[axis] = true;
}

Index add_plane_body(MechanismAssembly& assembly, const BodyDescription& body, const std::string& part,
                     const Inertia& inertia) {
  if (!body.rotation.empty())
    throw InvalidInput(body.rotation_where, part + "rotation is for bodies in space; in the plane give \"angle\"");
  if (body.angular_velocity.size() > 1)
    throw InvalidInput(body.where, part + "angular_velocity takes one number in the plane");
  const Axis at = assembly.point(body.position, body.where, part + "position");
  const double turn = body.angle ? assembly.angle(*body.angle, part + "angle") : 0.0;
  Mechanism& mechanism = assembly.mechanism;
  const Index node = mechanism.add_node(body.name, {at[0], at[1], turn});
  mechanism.add_mass(node, inertia.mass, inertia.tensor(2, 2));
  if (!body.angular_velocity.empty())
    set_velocity(mechanism, node, 5, assembly.number(body.angular_velocity[0], part + "angular_velocity"));
  assembly.inertia += inertia.tensor(2, 2);
  return node;
}

Index add_space_body(MechanismAssembly& assembly, const BodyDescription& body, const std::string& part,
                     const Inertia& inertia) {
  if (body.angle)
    throw InvalidInput(body.angle->where,
                       part +
                           "angle is for bodies in the plane; in space give \"rotation\", a rotation vector: the "
                           "axis times the angle [rad]");
  const Axis at = assembly.point(body.position, body.where, part + "position");
  Axis turn = Axis::Zero();
  if (!body.rotation.empty()) {
    turn = assembly.point(body.rotation, body.rotation_where, part + "rotation");
    if (!(turn.norm() <= 2.0 * std::numbers::pi))
      throw InvalidInput(body.rotation_where,
                         fmt::format("{}rotation turns by {} rad, more than a turn; it is a rotation vector, the axis "
                                     "times the angle; if degrees are meant, multiply by pi/180",
                                     part, turn.norm()));
  }
  Mechanism& mechanism = assembly.mechanism;
  const Index node = mechanism.add_space_node(body.name, at, numerics::rotation_of(turn));
  mechanism.add_space_body(node, inertia.mass, inertia.tensor);
  if (!body.angular_velocity.empty()) {
    const Axis given = assembly.point(body.angular_velocity, body.where, part + "angular_velocity");
    for (Index i = 0; i < 3; ++i) set_velocity(mechanism, node, static_cast<std::size_t>(i) + 3, given[i]);
  }
  assembly.inertia += inertia.tensor.trace() / 3.0;
  return node;
}

}  // namespace

void take_body(MechanismAssembly& assembly, const BodyDescription& body) {
  const std::string part = fmt::format("body \"{}\": ", body.name);
  refuse_unfit_name(body.name, body.where);
  if (body.name.empty() || body.name == "ground")
    throw InvalidInput(body.where, body.name.empty() ? "a body needs a name"
                                                     : "the name \"ground\" is taken: it stands for what does not "
                                                       "move");
  if (assembly.nodes.count(body.name) > 0)
    throw InvalidInput(body.where, fmt::format("two nodes or bodies are called \"{}\"", body.name));
  const Inertia inertia = inertia_of(assembly, body, part);
  const Index node = assembly.in_plane() ? add_plane_body(assembly, body, part, inertia)
                                         : add_space_body(assembly, body, part, inertia);
  if (!body.velocity.empty()) {
    const Axis given = assembly.point(body.velocity, body.where, part + "velocity");
    for (Index i = 0; i < assembly.mechanism.dimension; ++i)
      set_velocity(assembly.mechanism, node, static_cast<std::size_t>(i), given[i]);
  }
  if (body.shape) assembly.mechanism.drawing.shapes.push_back(drawn_shape(assembly, *body.shape, node));
  assembly.nodes.emplace(body.name, node);
  assembly.extend(assembly.position(node));
  assembly.mass += inertia.mass;
}

}  // namespace rubato::model
