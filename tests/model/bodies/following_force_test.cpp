#include <rubato/model/bodies/following_force.hpp>

#include <support/space_differences.hpp>

namespace rubato {
namespace {

using numerics::Vector3;

const model::TimeLaw steady = model::HarmonicLaw{2.5, 0.0, 0.0};

TEST(SpaceFollowingForce, HasAConsistentTangent) {
  const model::SpacePoint point{testing::free_space_node(0), {0.3, -0.7, 0.4}};
  for (const std::size_t axis : {0u, 1u, 2u}) {
    const auto force = model::make_following_force("thrust", point, axis, steady);
    for (unsigned seed = 1; seed < 4; ++seed)
      testing::expect_consistent_tangent(*force, testing::SpaceMotion(1, seed), 2.5);
  }
}

TEST(FixedMoment, HasAConsistentTangent) {
  for (const std::size_t axis : {0u, 1u, 2u}) {
    const auto moment = model::make_fixed_moment("m", testing::free_space_node(0), axis, steady);
    for (unsigned seed = 1; seed < 4; ++seed)
      testing::expect_consistent_tangent(*moment, testing::SpaceMotion(1, seed), 2.5);
  }
}

// The power of a force at a moving point: F R e . (v + R (omega x offset)).
TEST(SpaceFollowingForce, WorksOnTheVelocityOfItsPoint) {
  const Vector3 offset(0.3, -0.7, 0.4);
  const auto force =
      model::make_following_force("thrust", model::SpacePoint{testing::free_space_node(0), offset}, 1, steady);
  const testing::SpaceMotion at(1, 5);
  double out[6], power = 0.0;
  force->force(at.motion(), out);
  for (std::size_t i = 0; i < 6; ++i) power -= out[i] * at.padded[i + 1];
  const auto turn = testing::free_space_node(0).rotation(at.q.data()).toRotationMatrix();
  const Vector3 v(at.padded[1], at.padded[2], at.padded[3]), omega(at.padded[4], at.padded[5], at.padded[6]);
  EXPECT_NEAR(power, 2.5 * turn.col(1).dot(v + turn * omega.cross(offset)), 1e-14);
}

}  // namespace
}  // namespace rubato
