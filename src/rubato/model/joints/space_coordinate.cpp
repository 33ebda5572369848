#include <rubato/model/joints/coordinate_law.hpp>
#include <rubato/model/joints/space_coordinate.hpp>

#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

constexpr int k = SpaceCoordinate::tangent_size;

SpaceValue value_of(const SpaceCoordinate& s, const double* q, SpaceDetail detail) {
  SpaceValue value;
  const SpacePair pair = pair_of(q, s.first, s.second);
  evaluate(s.row, pair, value, detail);
  if (s.counter >= 0) value.value = nearest_turn(value.value, q[s.counter]);
  if (s.way_share == 0.0) return value;
  SpaceValue way;
  evaluate(s.way, pair, way, detail);
  value.value = s.share * value.value + s.way_share * way.value;
  value.gradient = s.share * value.gradient + s.way_share * way.gradient;
  if (detail == SpaceDetail::slope) value.slope = s.share * value.slope + s.way_share * way.slope;
  return value;
}

Vector12 part_of(const SpaceCoordinate& s, const double* of_coordinates) {
  Vector12 part;
  for (Index i = 0; i < 6; ++i) {
    part[i] = of_coordinates[s.first.node.place[static_cast<std::size_t>(i)]];
    part[i + 6] = of_coordinates[s.second.node.place[static_cast<std::size_t>(i)]];
  }
  return part;
}

}  // namespace

std::vector<Index> SpaceCoordinate::places() const {
  std::vector<Index> places(first.node.place.begin(), first.node.place.end());
  places.insert(places.end(), second.node.place.begin(), second.node.place.end());
  return places;
}

double SpaceCoordinate::value(const double* q) const { return value_of(*this, q, SpaceDetail::gradient).value - zero; }

void SpaceCoordinate::slope(const double* q, double* slope) const {
  Eigen::Map<Vector12> out(slope);
  out = value_of(*this, q, SpaceDetail::gradient).gradient;
}

void SpaceCoordinate::curvature(const double* q, double weight, double* curvature) const {
  Eigen::Map<Eigen::Matrix<double, k, k, Eigen::RowMajor>> out(curvature);
  out = weight * value_of(*this, q, SpaceDetail::slope).slope;
}

double SpaceCoordinate::rate(const Motion& motion) const {
  return value_of(*this, motion.q, SpaceDetail::gradient).gradient.dot(part_of(*this, motion.v));
}

double SpaceCoordinate::second_rate(const Motion& motion, const double* acceleration) const {
  const SpaceValue now = value_of(*this, motion.q, SpaceDetail::slope);
  const Vector12 v = part_of(*this, motion.v);
  return now.gradient.dot(part_of(*this, acceleration)) + v.dot(now.slope * v);
}

SpaceCoordinate path_along_thread(const SpaceCoordinate& angle, const numerics::Vector3& axis, double lead,
                                  double radius) {
  SpaceCoordinate path = angle;
  const double slope = lead / (2.0 * std::numbers::pi * radius);
  path.share = 1.0 / (1.0 + slope * slope);
  path.way = BodyGap{axis};
  path.way_share = path.share * slope / radius;
  return path;
}

double nearest_turn(double angle, double known) {
  constexpr double turn = 2.0 * std::numbers::pi;
  return angle + turn * std::round((known - angle) / turn);
}

std::unique_ptr<Element> make_joint_spring(std::string name, const SpaceCoordinate& s, double stiffness, double rest,
                                           const AtLock& when) {
  return std::make_unique<Spring<SpaceCoordinate>>(std::move(name), s, stiffness, rest, when);
}

std::unique_ptr<Element> make_joint_damper(std::string name, const SpaceCoordinate& s, double damping,
                                           const AtLock& when) {
  return std::make_unique<Damper<SpaceCoordinate>>(std::move(name), s, damping, when);
}

std::unique_ptr<Element> make_joint_drive(std::string name, const SpaceCoordinate& s, const std::string& formula,
                                          const numerics::Parameters& parameters, const AtLock& when) {
  return std::make_unique<Drive<SpaceCoordinate>>(std::move(name), s, formula, parameters, when);
}

std::unique_ptr<Element> make_joint_table(std::string name, const SpaceCoordinate& s, CoordinateTable table,
                                          const AtLock& when) {
  return std::make_unique<TabulatedLaw<SpaceCoordinate>>(std::move(name), s, std::move(table), when);
}

std::unique_ptr<Joint> make_lock_joint(std::string name, const SpaceCoordinate& s, double at, int lock) {
  return std::make_unique<LockJoint<SpaceCoordinate>>(std::move(name), s, at, lock);
}

}  // namespace rubato::model
