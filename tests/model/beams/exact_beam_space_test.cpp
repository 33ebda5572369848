#include <rubato/model/beams/exact_beam_space.hpp>

#include <support/space_differences.hpp>

#include <numbers>

namespace rubato {
namespace {

using numerics::Matrix3;
using numerics::rotation_of;
using numerics::Vector3;
using testing::free_space_node;
using testing::SpaceMotion;

const model::SpaceBeamSection section{{40.0, 15.0, 12.0}, {2.0, 3.0, 5.0}};

/// A beam from the origin to (1.2, 0, 0), its section axes along those of the world; its nodes stand askew.
std::unique_ptr<model::Element> straight_beam(SpaceMotion& at) {
  const double ends[2] = {0.0, 1.2};
  for (std::size_t i = 0; i < 2; ++i) {
    double* numbers = at.q.data() + 7 * (i + 1);
    numbers[0] = ends[i];
    numbers[1] = numbers[2] = 0.0;
  }
  return model::make_exact_beam_space("beam", free_space_node(0), free_space_node(1), at.q.data(), Matrix3::Identity(),
                                      Matrix3::Identity(), section);
}

std::vector<double> force_on(const model::Element& beam, const SpaceMotion& at) {
  std::vector<double> force(12);
  beam.force(at.motion(), force.data());
  return force;
}

TEST(ExactBeamInSpace, HasForcesOfItsEnergyAndTheirSlopes) {
  for (unsigned seed = 1; seed < 8; ++seed) {
    SpaceMotion at(2, seed);
    const auto beam = straight_beam(at);
    const SpaceMotion bent(2, seed + 20, 0.8);
    testing::expect_force_of_energy(*beam, bent, 100.0);
    testing::expect_consistent_tangent(*beam, bent, 100.0);
  }
}

TEST(ExactBeamInSpace, IsWithoutStressWhereItWasMade) {
  SpaceMotion at(2, 3);
  const auto beam = straight_beam(at);
  for (const double force : force_on(*beam, at)) EXPECT_NEAR(force, 0.0, 1e-14);
  testing::expect_consistent_tangent(*beam, at, 100.0);
}

TEST(ExactBeamInSpace, FeelsNothingOfARigidMotionOfAnySize) {
  SpaceMotion at(2, 4);
  const auto beam = straight_beam(at);
  SpaceMotion bent(2, 9, 0.6);
  const double energy = beam->stored_energy(bent.motion());
  const std::vector<double> before = force_on(*beam, bent);
  const auto turn = rotation_of({2.0, -1.5, 1.0});
  bent.move_all(turn, {3.0, -7.0, 2.0});
  EXPECT_NEAR(beam->stored_energy(bent.motion()), energy, 1e-13 * energy);
  const std::vector<double> after = force_on(*beam, bent);
  for (const std::size_t node : {0u, 6u}) {
    const Vector3 turned = turn * Vector3(before[node], before[node + 1], before[node + 2]);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(after[node + i], turned[Index(i)], 1e-12);          // forces turn with it
      EXPECT_NEAR(after[node + 3 + i], before[node + 3 + i], 1e-12);  // moments are in body axes
    }
  }
}

TEST(ExactBeamInSpace, BendsIntoACircleUnderAMoment) {
  // M = E I kappa: with ends turned against each other by E I^-1 M L the chord of the arc is that of one integration
  // point, along the mean section.
  SpaceMotion at(2, 1, 0.0);
  const auto beam = straight_beam(at);
  const double angle = 1.1;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto turn = rotation_of({0.0, 0.0, (i == 0 ? -0.5 : 0.5) * angle});
    double* numbers = at.q.data() + 7 * (i + 1);
    numbers[3] = turn.w();
    numbers[6] = turn.z();
  }
  const std::vector<double> force = force_on(*beam, at);
  const double moment = section.moment[2] * angle / 1.2;
  for (std::size_t i = 0; i < 12; ++i) {
    const double expected = i == 5 ? -moment : i == 11 ? moment : 0.0;
    EXPECT_NEAR(force[i], expected, 1e-13) << i;
  }
}

TEST(ExactBeamInSpace, LooksTheSameFromEitherEnd) {
  SpaceMotion at(2, 6);
  const auto beam = straight_beam(at);
  // From the other end the first section axis points back: half a turn about the third.
  const Matrix3 back = rotation_of({0.0, 0.0, std::numbers::pi}).toRotationMatrix();
  const auto other =
      model::make_exact_beam_space("beam", free_space_node(1), free_space_node(0), at.q.data(), back, back, section);
  const SpaceMotion bent(2, 12, 0.7);
  const std::vector<double> one = force_on(*beam, bent), two = force_on(*other, bent);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(one[i], two[i + 6], 1e-12);
    EXPECT_NEAR(one[i + 6], two[i], 1e-12);
  }
}

std::unique_ptr<model::Element> viscous_beam() {
  SpaceMotion at(2, 3);
  (void)straight_beam(at);
  return model::make_viscous_beam_space("beam", free_space_node(0), free_space_node(1), at.q.data(),
                                        Matrix3::Identity(), Matrix3::Identity(), section, 0.3);
}

TEST(ExactBeamInSpace, OfAViscousMaterialHasTheSlopesOfItsForces) {
  for (unsigned seed = 1; seed < 8; ++seed) {
    const SpaceMotion bent(2, seed + 20, 0.8);
    testing::expect_consistent_tangent(*viscous_beam(), bent, 100.0);
    testing::expect_consistent_damping(*viscous_beam(), bent, 100.0);
  }
}

// The force of the elastic beam grows by tau K v where there is no stress, since its strains alone change it.
TEST(ExactBeamInSpace, OfAViscousMaterialResistsWhereItIsStraightLikeItsStiffness) {
  SpaceMotion at(2, 3);
  const auto elastic = straight_beam(at);
  std::vector<double> force(12), stiffness(144);
  elastic->tangent(at.motion(), 1.0, 0.0, force.data(), stiffness.data());
  viscous_beam()->force(at.motion(), force.data());
  for (std::size_t i = 0; i < 12; ++i) {
    double expected = 0.0;
    for (std::size_t j = 0; j < 12; ++j) expected += 0.3 * stiffness[i * 12 + j] * at.padded[1 + j];
    EXPECT_NEAR(force[i], expected, 1e-12) << i;
  }
}

TEST(ExactBeamInSpace, OfAViscousMaterialTurnsAndTravelsFreely) {
  SpaceMotion bent(2, 9, 0.6);
  const Vector3 speed(5.0, -7.0, 2.0), spin(2.0, 1.0, -3.0);
  for (std::size_t node = 0; node < 2; ++node) {
    const double* q = bent.q.data() + 7 * (node + 1);
    const Vector3 velocity = speed + spin.cross(Vector3(q[0], q[1], q[2]));
    const Vector3 turning = numerics::Rotation(q[3], q[4], q[5], q[6]).conjugate() * spin;
    for (std::size_t i = 0; i < 3; ++i) {
      bent.padded[1 + 6 * node + i] = velocity[Index(i)];
      bent.padded[4 + 6 * node + i] = turning[Index(i)];
    }
  }
  for (const double force : force_on(*viscous_beam(), bent)) EXPECT_NEAR(force, 0.0, 1e-12);
}

}  // namespace
}  // namespace rubato
