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

/// skew(a) skew(b)
Matrix3 twice_across(const Vector3& a, const Vector3& b) {
  Matrix3 product = b * a.transpose();
  product.diagonal().array() -= a.dot(b);
  return product;
}

/// matrix skew(v)
Matrix3 times_skew(const Matrix3& matrix, const Vector3& v) {
  Matrix3 product;
  product << v[2] * matrix.col(1) - v[1] * matrix.col(2), v[0] * matrix.col(2) - v[2] * matrix.col(0),
      v[1] * matrix.col(0) - v[0] * matrix.col(1);
  return product;
}

void world_gap(const Vector3& along, const SpacePair& p, SpaceValue& out, SpaceDetail detail) {
  const Vector3 in1 = p.turn1.transpose() * along, in2 = p.turn2.transpose() * along;
  out.value = along.dot(p.between);
  out.gradient << -along, -p.offset1.cross(in1), along, p.offset2.cross(in2);
  if (detail == SpaceDetail::gradient) return;
  out.slope.setZero();
  out.slope.block<3, 3>(r1, r1) = -twice_across(p.offset1, in1);
  out.slope.block<3, 3>(r2, r2) = twice_across(p.offset2, in2);
}

void body_gap(const Vector3& along, const SpacePair& p, SpaceValue& out, SpaceDetail detail) {
  const Vector3 in_world = p.turn1 * along, in2 = p.relative.transpose() * along;
  const Vector3 seen = p.turn1.transpose() * p.between + p.offset1;  // the second point from the first node
  out.value = in_world.dot(p.between);
  out.gradient << -in_world, along.cross(seen), in_world, p.offset2.cross(in2);
  if (detail == SpaceDetail::gradient) return;
  const Matrix3 turned = times_skew(p.turn1, along);
  const Matrix3 both = times_skew(times_skew(p.relative.transpose(), along).transpose(), p.offset2);
  out.slope.setZero();
  out.slope.block<3, 3>(x1, r1) = turned;
  out.slope.block<3, 3>(x2, r1) = -turned;
  out.slope.block<3, 3>(r1, x1) = turned.transpose();
  out.slope.block<3, 3>(r1, x2) = -turned.transpose();
  out.slope.block<3, 3>(r1, r1) = twice_across(along, seen);
  out.slope.block<3, 3>(r1, r2) = both;
  out.slope.block<3, 3>(r2, r1) = both.transpose();
  out.slope.block<3, 3>(r2, r2) = twice_across(p.offset2, in2);
}

void alignment(const Vector3& first, const Vector3& second, const SpacePair& p, SpaceValue& out, SpaceDetail detail) {
  const Vector3 second_in1 = p.relative * second, first_in2 = p.relative.transpose() * first;
  out.value = first.dot(second_in1);
  out.gradient.setZero();
  out.gradient.segment<3>(r1) = first.cross(second_in1);
  out.gradient.segment<3>(r2) = second.cross(first_in2);
  if (detail == SpaceDetail::gradient) return;
  const Matrix3 both = times_skew(times_skew(p.relative.transpose(), first).transpose(), second);
  out.slope.setZero();
  out.slope.block<3, 3>(r1, r1) = twice_across(first, second_in1);
  out.slope.block<3, 3>(r1, r2) = both;
  out.slope.block<3, 3>(r2, r1) = both.transpose();
  out.slope.block<3, 3>(r2, r2) = twice_across(second, first_in2);
}

void distance_gap(double length, const SpacePair& p, SpaceValue& out, SpaceDetail detail) {
  Eigen::Matrix<double, 3, 12> moves;  // of the vector between the points
  moves << -Matrix3::Identity(), times_skew(p.turn1, p.offset1), Matrix3::Identity(), -times_skew(p.turn2, p.offset2);
  out.value = (p.between.squaredNorm() - length * length) / (2.0 * length);
  out.gradient = moves.transpose() * p.between / length;
  if (detail == SpaceDetail::gradient) return;
  out.slope = moves.transpose() * moves / length;
  out.slope.block<3, 3>(r1, r1) -= twice_across(p.offset1, p.turn1.transpose() * p.between) / length;
  out.slope.block<3, 3>(r2, r2) += twice_across(p.offset2, p.turn2.transpose() * p.between) / length;
}

void turn_angle(const TurnAngle& row, const SpacePair& p, SpaceValue& out, SpaceDetail detail) {
  SpaceValue cosine, sine;
  alignment(row.x, row.start, p, cosine, detail);
  alignment(row.y, row.start, p, sine, detail);
  const double c = cosine.value, s = sine.value, square = c * c + s * s;
  out.value = std::atan2(s, c);
  const Vector12 turn = c * sine.gradient - s * cosine.gradient;
  out.gradient = turn / square;
  if (detail == SpaceDetail::gradient) return;
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
  pair.relative.noalias() = pair.turn1.transpose() * pair.turn2;
  pair.between = pair.position2 + pair.turn2 * pair.offset2 - pair.position1 - pair.turn1 * pair.offset1;
  return pair;
}

void evaluate(const SpaceRow& row, const SpacePair& pair, SpaceValue& result, SpaceDetail detail) {
  if (const auto* gap = std::get_if<WorldGap>(&row)) world_gap(gap->along, pair, result, detail);
  if (const auto* gap = std::get_if<BodyGap>(&row)) body_gap(gap->along, pair, result, detail);
  if (const auto* dot = std::get_if<Alignment>(&row)) alignment(dot->first, dot->second, pair, result, detail);
  if (const auto* gap = std::get_if<DistanceGap>(&row)) distance_gap(gap->length, pair, result, detail);
  if (const auto* angle = std::get_if<TurnAngle>(&row)) turn_angle(*angle, pair, result, detail);
}

double angle_of(const TurnAngle& row, const SpacePair& pair) {
  const Vector3 start = pair.relative * row.start;
  return std::atan2(row.y.dot(start), row.x.dot(start));
}

}  // namespace rubato::model
