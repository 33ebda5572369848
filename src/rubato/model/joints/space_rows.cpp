#include <rubato/model/joints/space_rows.hpp>

#include <cmath>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::skew;
using numerics::Vector3;

// Where the increments of positions and rotations begin.
constexpr int x1 = 0, r1 = 3, x2 = 6, r2 = 9;

// With R' = R (I + skew(d)) for a body increment d:  d(R e) = R (d x e),  d(R^T a) = (R^T a) x d.

void world_gap(const Vector3& along, const SpacePair& p, SpaceValue& out) {
  const Vector3 in1 = p.turn1.transpose() * along, in2 = p.turn2.transpose() * along;
  out.value = along.dot(p.between);
  out.gradient << -along, -p.offset1.cross(in1), along, p.offset2.cross(in2);
  out.slope.setZero();
  out.slope.block<3, 3>(r1, r1) = -skew(p.offset1) * skew(in1);
  out.slope.block<3, 3>(r2, r2) = skew(p.offset2) * skew(in2);
}

void body_gap(const Vector3& along, const SpacePair& p, SpaceValue& out) {
  const Vector3 in_world = p.turn1 * along, in2 = p.turn2.transpose() * in_world;
  const Vector3 seen = p.turn1.transpose() * p.between + p.offset1;  // the second point from the first node
  const Matrix3 turned = p.turn1 * skew(along), relative = p.turn1.transpose() * p.turn2;
  out.value = in_world.dot(p.between);
  out.gradient << -in_world, along.cross(seen), in_world, p.offset2.cross(in2);
  out.slope.setZero();
  out.slope.block<3, 3>(x1, r1) = turned;
  out.slope.block<3, 3>(x2, r1) = -turned;
  out.slope.block<3, 3>(r1, x1) = -skew(along) * p.turn1.transpose();
  out.slope.block<3, 3>(r1, x2) = skew(along) * p.turn1.transpose();
  out.slope.block<3, 3>(r1, r1) = skew(along) * skew(seen);
  out.slope.block<3, 3>(r1, r2) = -skew(along) * relative * skew(p.offset2);
  out.slope.block<3, 3>(r2, r1) = -skew(p.offset2) * relative.transpose() * skew(along);
  out.slope.block<3, 3>(r2, r2) = skew(p.offset2) * skew(in2);
}

void alignment(const Vector3& first, const Vector3& second, const SpacePair& p, SpaceValue& out) {
  const Matrix3 relative = p.turn1.transpose() * p.turn2;
  const Vector3 second_in1 = relative * second, first_in2 = relative.transpose() * first;
  out.value = first.dot(second_in1);
  out.gradient.setZero();
  out.gradient.segment<3>(r1) = first.cross(second_in1);
  out.gradient.segment<3>(r2) = second.cross(first_in2);
  out.slope.setZero();
  out.slope.block<3, 3>(r1, r1) = skew(first) * skew(second_in1);
  out.slope.block<3, 3>(r1, r2) = -skew(first) * relative * skew(second);
  out.slope.block<3, 3>(r2, r1) = -skew(second) * relative.transpose() * skew(first);
  out.slope.block<3, 3>(r2, r2) = skew(second) * skew(first_in2);
}

void distance_gap(double length, const SpacePair& p, SpaceValue& out) {
  Eigen::Matrix<double, 3, 12> moves;  // of the vector between the points
  moves << -Matrix3::Identity(), p.turn1 * skew(p.offset1), Matrix3::Identity(), -p.turn2 * skew(p.offset2);
  out.value = (p.between.squaredNorm() - length * length) / (2.0 * length);
  out.gradient = moves.transpose() * p.between / length;
  out.slope = moves.transpose() * moves / length;
  out.slope.block<3, 3>(r1, r1) -= skew(p.offset1) * skew(p.turn1.transpose() * p.between) / length;
  out.slope.block<3, 3>(r2, r2) += skew(p.offset2) * skew(p.turn2.transpose() * p.between) / length;
}

void turn_angle(const TurnAngle& row, const SpacePair& p, SpaceValue& out) {
  SpaceValue cosine, sine;
  alignment(row.x, row.start, p, cosine);
  alignment(row.y, row.start, p, sine);
  const double c = cosine.value, s = sine.value, square = c * c + s * s;
  out.value = std::atan2(s, c);
  const Vector12 turn = c * sine.gradient - s * cosine.gradient;
  out.gradient = turn / square;
  out.slope = (c * sine.slope - s * cosine.slope + sine.gradient * cosine.gradient.transpose() -
               cosine.gradient * sine.gradient.transpose()) /
                  square -
              2.0 / (square * square) * turn * (c * cosine.gradient + s * sine.gradient).transpose();
}

}  // namespace

SpacePair pair_of(const double* q, const SpacePoint& first, const SpacePoint& second) {
  SpacePair pair;
  pair.position1 = first.node.position(q);
  pair.position2 = second.node.position(q);
  pair.turn1 = first.node.rotation(q).toRotationMatrix();
  pair.turn2 = second.node.rotation(q).toRotationMatrix();
  pair.offset1 = first.offset;
  pair.offset2 = second.offset;
  pair.between = pair.position2 + pair.turn2 * pair.offset2 - pair.position1 - pair.turn1 * pair.offset1;
  return pair;
}

void evaluate(const SpaceRow& row, const SpacePair& pair, SpaceValue& result) {
  if (const auto* gap = std::get_if<WorldGap>(&row)) world_gap(gap->along, pair, result);
  if (const auto* gap = std::get_if<BodyGap>(&row)) body_gap(gap->along, pair, result);
  if (const auto* dot = std::get_if<Alignment>(&row)) alignment(dot->first, dot->second, pair, result);
  if (const auto* gap = std::get_if<DistanceGap>(&row)) distance_gap(gap->length, pair, result);
  if (const auto* angle = std::get_if<TurnAngle>(&row)) turn_angle(*angle, pair, result);
}

}  // namespace rubato::model
