#include <rubato/model/finite_elements/cyclic.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/model.hpp>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace rubato::model {
namespace {

using Point = Eigen::Vector3d;

constexpr double pairing_tolerance = 1e-3;  // of the smallest distance of two nodes of a side
constexpr double on_axis = 1e-6;            // of the largest radius

Point point_of(const std::vector<Quantity>& values, const numerics::Parameters& parameters, const char* what) {
  Point point = Point::Zero();
  for (std::size_t i = 0; i < values.size() && i < 3; ++i)
    point[static_cast<Index>(i)] = evaluate(values[i], parameters, fmt::format("[cyclic]: {}", what));
  return point;
}

/// Places among the nodes of the structure, of those nodes of a set that the model has.
std::vector<std::size_t> nodes_of(const std::string& name, const Location& where, const FiniteElements& elements,
                                  const Structure& structure) {
  if (!elements.mesh)
    throw InvalidInput(where,
                       fmt::format("[cyclic] names the node set \"{}\", and [model] has no mesh; give mesh", name));
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  std::unordered_map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < structure.names.size(); ++i) places.emplace(structure.names[i], i);
  std::vector<std::string> known;
  for (const NodeSet& set : elements.mesh->sets) {
    known.push_back(set.name);
    if (set.name != upper) continue;
    std::vector<std::size_t> nodes;
    for (const std::int64_t node : set.nodes)
      if (const auto found = places.find(std::to_string(node)); found != places.end()) nodes.push_back(found->second);
    if (nodes.empty())
      throw InvalidInput(where, fmt::format("[cyclic]: the node set \"{}\" has no node of the model", name));
    return nodes;
  }
  throw InvalidInput(where, fmt::format("[cyclic] names \"{}\", which is no node set of \"{}\"{}", name,
                                        elements.mesh->file, suggestion(upper, known)));
}

struct Pairing {
  std::vector<std::size_t> partner;  // of each node of the first side, a place in the second
  std::size_t worst = 0, far = 0;    // place of the worst; how many are too far
  double distance = 0.0;             // of the worst [m]
};

Pairing paired(const std::vector<Point>& turned, const std::vector<Point>& second, double tolerance) {
  Pairing pairing;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    std::size_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < second.size(); ++j)
      if (const double away = (second[j] - turned[i]).norm(); away < distance) {
        distance = away;
        nearest = j;
      }
    pairing.partner.push_back(nearest);
    if (distance > tolerance) ++pairing.far;
    if (distance > pairing.distance) {
      pairing.distance = distance;
      pairing.worst = i;
    }
  }
  return pairing;
}

double smallest_distance(const std::vector<Point>& points) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, (points[i] - points[j]).norm());
  return smallest;
}

/// The sectors lie about an axis, each turned by alpha from the one before.
struct DiskAxis {
  Point direction, origin;
  Eigen::Matrix3d turn;  ///< by alpha

  double radius(const Point& point) const {
    const Point at = point - origin;
    return (at - at.dot(direction) * direction).norm();
  }
};

DiskAxis axis_of(const CyclicDescription& description, const numerics::Parameters& parameters) {
  if (description.axis.size() != 3)
    throw InvalidInput(description.axis_where, "[cyclic]: axis takes three numbers, along x, y and z");
  if (!description.origin.empty() && description.origin.size() != 3)
    throw InvalidInput(description.origin_where, "[cyclic]: origin takes three numbers [m]");
  DiskAxis axis{point_of(description.axis, parameters, "axis"), point_of(description.origin, parameters, "origin"), {}};
  if (!(axis.direction.norm() > 0.0) || !axis.direction.allFinite())
    throw InvalidInput(description.axis_where, "[cyclic]: axis must have a length");
  if (!axis.origin.allFinite()) throw InvalidInput(description.origin_where, "[cyclic]: origin must be finite");
  axis.direction.normalize();
  const double alpha = 2.0 * std::numbers::pi / static_cast<double>(description.sectors);
  axis.turn = Eigen::AngleAxisd(alpha, axis.direction).toRotationMatrix();
  return axis;
}

/// @return the largest radius of a node [m]
double require_a_bore(const DiskAxis& axis, const CyclicDescription& description, const Structure& structure) {
  double largest = 0.0;
  for (const Point& position : structure.positions) largest = std::max(largest, axis.radius(position));
  for (std::size_t i = 0; i < structure.names.size(); ++i) {
    const auto& places = structure.places[i];
    const bool moves = std::any_of(places.begin(), places.end(), [](Index place) { return place != ground; });
    if (moves && !(axis.radius(structure.positions[i]) > on_axis * largest))
      throw InvalidInput(description.axis_where,
                         fmt::format("[cyclic]: node {} lies on the axis, where all sectors meet; cyclic symmetry "
                                     "takes sectors with a bore, or nodes on the axis that are held",
                                     structure.names[i]));
  }
  return largest;
}

/// Nodes of both sides, those that pair beside each other.
struct Sides {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< from the side at the smaller angle to the other
  double distance = 0.0;                                   ///< largest, of a turned node from its partner [m]
  bool is_exchanged = false;                               ///< the set called left lies at the larger angle
};

void require_two_sides(const std::vector<std::size_t>& left, const std::vector<std::size_t>& right,
                       const CyclicDescription& description, const Structure& structure) {
  for (const std::size_t node : left)
    if (std::find(right.begin(), right.end(), node) != right.end())
      throw InvalidInput(description.right_where,
                         fmt::format("[cyclic]: node {} belongs to both sides, \"{}\" and "
                                     "\"{}\"; the sides of a sector have no node in common",
                                     structure.names[node], description.left, description.right));
  if (left.size() != right.size())
    throw InvalidInput(
        description.right_where,
        fmt::format("[cyclic]: \"{}\" has {} nodes and \"{}\" has {}; both sides must have the same "
                    "mesh, turned by 360/{} degrees",
                    description.left, left.size(), description.right, right.size(), description.sectors));
}

Sides paired_sides(const DiskAxis& axis, double largest_radius, const CyclicDescription& description,
                   const FiniteElements& elements, const Structure& structure) {
  const std::vector<std::size_t> left = nodes_of(description.left, description.left_where, elements, structure);
  const std::vector<std::size_t> right = nodes_of(description.right, description.right_where, elements, structure);
  require_two_sides(left, right, description, structure);
  const auto points_of = [&](const std::vector<std::size_t>& nodes, const Eigen::Matrix3d& turn) {
    std::vector<Point> points;
    for (const std::size_t node : nodes)
      points.push_back(axis.origin + turn * (structure.positions[node] - axis.origin));
    return points;
  };
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  const double tolerance = pairing_tolerance * std::min(smallest_distance(points_of(left, none)), largest_radius);
  Pairing pairing = paired(points_of(left, axis.turn), points_of(right, none), tolerance);
  const Pairing backwards = paired(points_of(left, axis.turn.transpose()), points_of(right, none), tolerance);
  Sides sides;
  if (backwards.distance < pairing.distance && pairing.far > 0) {
    sides.is_exchanged = true;
    pairing = backwards;
  }
  if (pairing.far > 0)
    throw InvalidInput(
        description.sectors_where,
        fmt::format("[cyclic]: the sides do not pair: of {} nodes of \"{}\" turned by 360/{} degrees about the axis {} "
                    "lie farther than {:.2g} m from any of \"{}\", the worst is node {}, {:.4g} m from node {}; are "
                    "sectors, axis, origin and both sets those of the mesh?",
                    left.size(), description.left, description.sectors, pairing.far, tolerance, description.right,
                    structure.names[left[pairing.worst]], pairing.distance,
                    structure.names[right[pairing.partner[pairing.worst]]]));
  std::vector<char> is_taken(right.size(), 0);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::size_t partner = right[pairing.partner[i]];
    if (is_taken[pairing.partner[i]]++ != 0)
      throw InvalidInput(description.left_where,
                         fmt::format("[cyclic]: two nodes of \"{}\" pair with node {} of \"{}\"", description.left,
                                     structure.names[partner], description.right));
    sides.pairs.push_back(sides.is_exchanged ? std::pair(partner, left[i]) : std::pair(left[i], partner));
  }
  sides.distance = pairing.distance;
  return sides;
}

}  // namespace

CyclicSector::CyclicSector(const CyclicDescription& description, const FiniteElements& elements, const Model& model,
                           const numerics::Parameters& parameters)
    : sectors_(description.sectors) {
  const Structure& structure = model.structure;
  if (elements.positions.empty())
    throw InvalidInput(description.where,
                       "[cyclic] turns nodes about the axis, and no file of [model] tells where they "
                       "are; give mesh");
  const DiskAxis axis = axis_of(description, parameters);
  const double largest = require_a_bore(axis, description, structure);
  const Sides sides = paired_sides(axis, largest, description, elements, structure);
  is_exchanged_ = sides.is_exchanged;
  largest_distance_ = sides.distance;
  pairs_ = static_cast<Index>(sides.pairs.size());

  std::vector<char> follows(static_cast<std::size_t>(model.size()), 0);
  for (const auto& [from, to] : sides.pairs)
    for (const Index place : structure.places[to])
      if (place != ground) follows[static_cast<std::size_t>(place)] = 1;
  std::vector<Index> column(follows.size(), ground);
  Index count = 0;
  std::vector<Eigen::Triplet<double>> own, turned;
  for (std::size_t i = 0; i < follows.size(); ++i)
    if (follows[i] == 0) {
      own.emplace_back(static_cast<int>(i), static_cast<int>(count), 1.0);
      column[i] = count++;
    }
  for (const auto& [from, to] : sides.pairs)
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = a / 3 * 3; b < a / 3 * 3 + 3; ++b) {
        const Index row = structure.places[to][a], source = structure.places[from][b];
        const double share = axis.turn(static_cast<Index>(a % 3), static_cast<Index>(b % 3));
        if (std::abs(share) < 1e-12) continue;
        // Both move along this pair of directions, or neither does.
        if ((row == ground) != (source == ground))
          throw InvalidInput(
              description.where,
              fmt::format("[cyclic]: of the nodes {} and {}, which move alike, one is held in a direction in which the "
                          "other moves; hold both in the same directions, of those across the axis in both or none",
                          structure.names[from], structure.names[to]));
        if (row != ground)
          turned.emplace_back(static_cast<int>(row), static_cast<int>(column[static_cast<std::size_t>(source)]), share);
      }
  own_.resize(model.size(), count);
  turned_.resize(model.size(), count);
  own_.setFromTriplets(own.begin(), own.end());
  turned_.setFromTriplets(turned.begin(), turned.end());
}

SparseMatrix CyclicSector::reduced(const SparseMatrix& matrix, Index diameter) const {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(diameter) / static_cast<double>(sectors_);
  if (is_real(diameter)) {
    const SparseMatrix map = own_ + (diameter == 0 ? 1.0 : -1.0) * turned_;
    const SparseMatrix image = matrix * map;
    const SparseMatrix product = map.transpose() * image;
    const SparseMatrix mirrored = product.transpose();
    return 0.5 * (product + mirrored);
  }
  // T = P + i Q:  T^H A T = P^T A P + Q^T A Q + i (P^T A Q - Q^T A P)
  const SparseMatrix p = own_ + std::cos(angle) * turned_, q = std::sin(angle) * turned_;
  const SparseMatrix ap = matrix * p, aq = matrix * q;
  const SparseMatrix pp = p.transpose() * ap, qq = q.transpose() * aq, pq = p.transpose() * aq;
  const SparseMatrix sum = pp + qq, sum_mirrored = sum.transpose(), pq_mirrored = pq.transpose();
  const SparseMatrix real = 0.5 * (sum + sum_mirrored), imaginary = pq - pq_mirrored;
  const Index m = size();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(2 * (real.nonZeros() + imaginary.nonZeros())));
  for (Index j = 0; j < m; ++j) {
    for (SparseMatrix::InnerIterator entry(real, j); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(j), entry.value());
      entries.emplace_back(static_cast<int>(m + entry.row()), static_cast<int>(m + j), entry.value());
    }
    for (SparseMatrix::InnerIterator entry(imaginary, j); entry; ++entry) {
      entries.emplace_back(static_cast<int>(m + entry.row()), static_cast<int>(j), entry.value());
      entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(m + j), -entry.value());
    }
  }
  SparseMatrix doubled(2 * m, 2 * m);
  doubled.setFromTriplets(entries.begin(), entries.end());
  return doubled;
}

Eigen::VectorXcd CyclicSector::expanded(const Eigen::VectorXcd& y, Index diameter) const {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(diameter) / static_cast<double>(sectors_);
  const Vector real = y.real(), imaginary = y.imag();
  const std::complex<double> factor = is_real(diameter) ? (diameter == 0 ? 1.0 : -1.0) : std::polar(1.0, angle);
  Eigen::VectorXcd x(own_.rows());
  x.real() = own_ * real;
  x.imag() = own_ * imaginary;
  Eigen::VectorXcd follows(own_.rows());
  follows.real() = turned_ * real;
  follows.imag() = turned_ * imaginary;
  return x + factor * follows;
}

}  // namespace rubato::model
