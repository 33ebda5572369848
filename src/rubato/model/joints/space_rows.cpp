#include <rubato/model/joints/space_rows.hpp>
#include <rubato/model/joints/space_slopes.hpp>

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

// Values with their gradients, and beside each what adds a multiple of its slope to a matrix [12 x 12].

void evaluate_row(const WorldGap& row, const SpacePair& p, SpaceValue& out) {
  const Vector3 in1 = p.turn1.transpose() * row.along, in2 = p.turn2.transpose() * row.along;
  out.value = row.along.dot(p.between);
  out.gradient << -row.along, -p.offset1.cross(in1), row.along, p.offset2.cross(in2);
}

template <class Sum>
void add_row_slope(const WorldGap& row, const SpacePair& p, double weight, Sum& sum) {
  const Vector3 in1 = weight * (p.turn1.transpose() * row.along), in2 = weight * (p.turn2.transpose() * row.along);
  sum.template block<3, 3>(r1, r1) -= twice_across(p.offset1, in1);
  sum.template block<3, 3>(r2, r2) += twice_across(p.offset2, in2);
}

void evaluate_row(const BodyGap& row, const SpacePair& p, SpaceValue& out) {
  const Vector3 in_world = p.turn1 * row.along, in2 = p.relative.transpose() * row.along;
  const Vector3 seen = p.turn1.transpose() * p.between + p.offset1;  // the second point from the first node
  out.value = in_world.dot(p.between);
  out.gradient << -in_world, row.along.cross(seen), in_world, p.offset2.cross(in2);
}

template <class Sum>
void add_row_slope(const BodyGap& row, const SpacePair& p, double weight, Sum& sum) {
  const Vector3 along = weight * row.along, in2 = p.relative.transpose() * along;
  const Vector3 seen = p.turn1.transpose() * p.between + p.offset1;
  const Matrix3 turned = times_skew(p.turn1, along);
  const Matrix3 both = times_skew(times_skew(p.relative.transpose(), along).transpose(), p.offset2);
  sum.template block<3, 3>(x1, r1) += turned;
  sum.template block<3, 3>(x2, r1) -= turned;
  sum.template block<3, 3>(r1, x1) += turned.transpose();
  sum.template block<3, 3>(r1, x2) -= turned.transpose();
  sum.template block<3, 3>(r1, r1) += twice_across(along, seen);
  sum.template block<3, 3>(r1, r2) += both;
  sum.template block<3, 3>(r2, r1) += both.transpose();
  sum.template block<3, 3>(r2, r2) += twice_across(p.offset2, in2);
}

void evaluate_row(const Alignment& row, const SpacePair& p, SpaceValue& out) {
  const Vector3 second_in1 = p.relative * row.second, first_in2 = p.relative.transpose() * row.first;
  out.value = row.first.dot(second_in1);
  out.gradient.setZero();
  out.gradient.segment<3>(r1) = row.first.cross(second_in1);
  out.gradient.segment<3>(r2) = row.second.cross(first_in2);
}

template <class Sum>
void add_row_slope(const Alignment& row, const SpacePair& p, double weight, Sum& sum) {
  const Vector3 first = weight * row.first;
  const Vector3 second_in1 = p.relative * row.second, first_in2 = p.relative.transpose() * first;
  const Matrix3 both = times_skew(times_skew(p.relative.transpose(), first).transpose(), row.second);
  sum.template block<3, 3>(r1, r1) += twice_across(first, second_in1);
  sum.template block<3, 3>(r1, r2) += both;
  sum.template block<3, 3>(r2, r1) += both.transpose();
  sum.template block<3, 3>(r2, r2) += twice_across(row.second, first_in2);
}

/// How the vector between the points moves.
Eigen::Matrix<double, 3, 12> moves_of(const SpacePair& p) {
  Eigen::Matrix<double, 3, 12> moves;
  moves << -Matrix3::Identity(), times_skew(p.turn1, p.offset1), Matrix3::Identity(), -times_skew(p.turn2, p.offset2);
  return moves;
}

void evaluate_row(const DistanceGap& row, const SpacePair& p, SpaceValue& out) {
  out.value = (p.between.squaredNorm() - row.length * row.length) / (2.0 * row.length);
  out.gradient = moves_of(p).transpose() * p.between / row.length;
}

template <class Sum>
void add_row_slope(const DistanceGap& row, const SpacePair& p, double weight, Sum& sum) {
  const Eigen::Matrix<double, 3, 12> moves = moves_of(p);
  const double share = weight / row.length;
  sum += share * (moves.transpose() * moves);
  sum.template block<3, 3>(r1, r1) -= share * twice_across(p.offset1, p.turn1.transpose() * p.between);
  sum.template block<3, 3>(r2, r2) += share * twice_across(p.offset2, p.turn2.transpose() * p.between);
}

void evaluate_row(const PointDistance&, const SpacePair& p, SpaceValue& out) {
  out.value = p.between.norm();
  out.gradient = moves_of(p).transpose() * p.between / out.value;
}

template <class Sum>
void add_row_slope(const PointDistance& row, const SpacePair& p, double weight, Sum& sum) {
  SpaceValue now;
  evaluate_row(row, p, now);
  add_row_slope(DistanceGap{now.value}, p, weight, sum);
  sum -= (weight / now.value) * now.gradient * now.gradient.transpose();
}

void evaluate_row(const TurnAngle& row, const SpacePair& p, SpaceValue& out) {
  SpaceValue cosine, sine;
  evaluate_row(row.cosine, p, cosine);
  evaluate_row(row.sine, p, sine);
  const double c = cosine.value, s = sine.value, square = c * c + s * s;
  out.value = std::atan2(s, c);
  out.gradient = (c * sine.gradient - s * cosine.gradient) / square;
}

template <class Sum>
void add_row_slope(const TurnAngle& row, const SpacePair& p, double weight, Sum& sum) {
  SpaceValue cosine, sine;
  evaluate_row(row.cosine, p, cosine);
  evaluate_row(row.sine, p, sine);
  const double c = cosine.value, s = sine.value, square = c * c + s * s, share = weight / square;
  add_row_slope(row.sine, p, share * c, sum);
  add_row_slope(row.cosine, p, -share * s, sum);
  const Vector12 turn = c * sine.gradient - s * cosine.gradient;
  sum += share * (sine.gradient * cosine.gradient.transpose() - cosine.gradient * sine.gradient.transpose());
  sum -= 2.0 * share / square * turn * (c * cosine.gradient + s * sine.gradient).transpose();
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
  std::visit([&](const auto& kind) { evaluate_row(kind, pair, result); }, row);
  if (detail == SpaceDetail::gradient) return;
  result.slope.setZero();
  std::visit([&](const auto& kind) { add_row_slope(kind, pair, 1.0, result.slope); }, row);
}

void add_slope(const SpaceRow& row, const SpacePair& pair, double weight, SlopeSum& sum) {
  std::visit([&](const auto& kind) { add_row_slope(kind, pair, weight, sum); }, row);
}

SpacePattern pattern_of(const SpaceRow& row, const SpacePoint& first, const SpacePoint& second) {
  SpacePattern pattern;
  const bool has_arm1 = !first.offset.isZero(0.0), has_arm2 = !second.offset.isZero(0.0);
  const auto move = [&](int block, const Vector3& along) {
    for (int i = 0; i < 3; ++i) pattern.gradient[std::size_t(block + i)] = along[i] != 0.0;
  };
  const auto bend = [&](int row_block, int column_block) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) pattern.slope[std::size_t(row_block + i)][std::size_t(column_block + j)] = true;
  };
  const Vector3 everywhere = Vector3::Ones(), nowhere = Vector3::Zero();
  const auto arm = [&](bool has_arm) { return has_arm ? everywhere : nowhere; };
  if (const auto* gap = std::get_if<WorldGap>(&row)) {
    move(x1, gap->along);
    move(x2, gap->along);
    move(r1, arm(has_arm1));
    move(r2, arm(has_arm2));
    if (has_arm1) bend(r1, r1);
    if (has_arm2) bend(r2, r2);
    return pattern;
  }
  const bool turns_only = std::holds_alternative<Alignment>(row) || std::holds_alternative<TurnAngle>(row);
  const bool is_distance = std::holds_alternative<DistanceGap>(row) || std::holds_alternative<PointDistance>(row);
  const bool sees_turn1 = !is_distance || has_arm1, sees_turn2 = turns_only || has_arm2;
  if (!turns_only) {
    move(x1, everywhere);
    move(x2, everywhere);
  }
  move(r1, arm(sees_turn1));
  move(r2, arm(sees_turn2));
  for (int block = 0; block < 12; block += 3)
    for (int other = 0; other < 12; other += 3) {
      const auto is_seen = [&](int b) { return b == r1 ? sees_turn1 : b == r2 ? sees_turn2 : !turns_only; };
      const bool has_position = block == x1 || block == x2, other_has_position = other == x1 || other == x2;
      // A gap along a direction of the first node: linear in positions, which turns of the second do not change.
      const bool is_linear = !is_distance && ((has_position && other != r1) || (other_has_position && block != r1));
      if (is_seen(block) && is_seen(other) && !is_linear) bend(block, other);
    }
  return pattern;
}

double angle_of(const TurnAngle& row, const SpacePair& pair) {
  return std::atan2(row.sine.first.dot(pair.relative * row.sine.second),
                    row.cosine.first.dot(pair.relative * row.cosine.second));
}

}  // namespace rubato::model
