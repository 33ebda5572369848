#include <rubato/model/joints/coordinate_law.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/plane_length.hpp>

#include <algorithm>

namespace rubato::model {
namespace {

constexpr int k = PlaneCoordinate::tangent_size;

}  // namespace

std::vector<Index> PlaneCoordinate::places() const {
  std::vector<Index> places(along.first.node.place.begin(), along.first.node.place.end());
  places.insert(places.end(), along.second.node.place.begin(), along.second.node.place.end());
  return places;
}

double PlaneCoordinate::value(const double* q) const {
  if (kind == Kind::angle) return q[along.second.node.q + 2] - q[along.first.node.q + 2] - zero;
  if (kind == Kind::length) return PlaneLength(along.first, along.second, q).value() - zero;
  return along.at(q).value() - zero;
}

void PlaneCoordinate::slope(const double* q, double* slope) const {
  if (kind == Kind::displacement) return PlaneProjection::slope(along.at(q), slope);
  if (kind == Kind::length) return PlaneLength(along.first, along.second, q).slope(slope);
  std::fill(slope, slope + k, 0.0);
  slope[2] = -1.0;
  slope[5] = 1.0;
}

void PlaneCoordinate::curvature(const double* q, double weight, double* curvature) const {
  if (kind == Kind::displacement) return PlaneProjection::curvature(along.at(q), weight, curvature);
  if (kind == Kind::length) return PlaneLength(along.first, along.second, q).curvature(weight, curvature);
  std::fill(curvature, curvature + k * k, 0.0);
}

double PlaneCoordinate::rate(const Motion& motion) const {
  const auto speed = [&](const PlaneNode& node, std::size_t axis) { return motion.v[node.place[axis]]; };
  if (kind == Kind::angle) return speed(along.second.node, 2) - speed(along.first.node, 2);
  double slopes[k], sum = 0.0;
  slope(motion.q, slopes);
  for (std::size_t i = 0; i < 3; ++i)
    sum += slopes[i] * speed(along.first.node, i) + slopes[i + 3] * speed(along.second.node, i);
  return sum;
}

double PlaneCoordinate::second_rate(const Motion& motion, const double* acceleration) const {
  const PlaneNode& first = along.first.node;
  const PlaneNode& second = along.second.node;
  if (kind == Kind::angle) return acceleration[second.place[2]] - acceleration[first.place[2]];
  double slopes[k], bends[k * k], v[k], sum = 0.0;
  slope(motion.q, slopes);
  curvature(motion.q, 1.0, bends);
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = motion.v[first.place[i]];
    v[i + 3] = motion.v[second.place[i]];
    sum += slopes[i] * acceleration[first.place[i]] + slopes[i + 3] * acceleration[second.place[i]];
  }
  for (int i = 0; i < k; ++i)
    for (int j = 0; j < k; ++j) sum += v[i] * bends[i * k + j] * v[j];
  return sum;
}

std::unique_ptr<Element> make_joint_spring(std::string name, const PlaneCoordinate& s, double stiffness, double rest,
                                           const AtLock& when) {
  return std::make_unique<Spring<PlaneCoordinate>>(std::move(name), s, stiffness, rest, when);
}

std::unique_ptr<Element> make_joint_damper(std::string name, const PlaneCoordinate& s, double damping,
                                           const AtLock& when) {
  return std::make_unique<Damper<PlaneCoordinate>>(std::move(name), s, damping, when);
}

std::unique_ptr<Element> make_joint_drive(std::string name, const PlaneCoordinate& s, const std::string& formula,
                                          const numerics::Parameters& parameters, const AtLock& when) {
  return std::make_unique<Drive<PlaneCoordinate>>(std::move(name), s, formula, parameters, when);
}

std::unique_ptr<Element> make_joint_table(std::string name, const PlaneCoordinate& s, CoordinateTable table,
                                          const AtLock& when) {
  return std::make_unique<TabulatedLaw<PlaneCoordinate>>(std::move(name), s, std::move(table), when);
}

std::unique_ptr<Joint> make_lock_joint(std::string name, const PlaneCoordinate& s, double at, int lock) {
  return std::make_unique<LockJoint<PlaneCoordinate>>(std::move(name), s, at, lock);
}

}  // namespace rubato::model
