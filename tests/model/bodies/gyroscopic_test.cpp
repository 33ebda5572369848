#include <rubato/model/bodies/gyroscopic.hpp>

#include <support/space_differences.hpp>

namespace rubato {
namespace {

TEST(GyroscopicMoment, HasAConsistentTangentAndDoesNoWork) {
  numerics::Matrix3 inertia;
  inertia << 2.0, 0.1, -0.2, 0.1, 3.0, 0.3, -0.2, 0.3, 1.5;
  const auto element = model::make_gyroscopic_moment("body", testing::free_space_node(0), inertia);
  for (unsigned seed = 1; seed < 4; ++seed) {
    const testing::SpaceMotion at(1, seed);
    testing::expect_consistent_damping(*element, at, 1.0);
    double moment[3];
    element->force(at.motion(), moment);
    EXPECT_NEAR(moment[0] * at.padded[4] + moment[1] * at.padded[5] + moment[2] * at.padded[6], 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace rubato
