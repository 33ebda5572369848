#include <rubato/model/joints/law_element.hpp>
#include <rubato/model/laws/jenkins.hpp>

#include <support/laws.hpp>
#include <support/mechanism_differences.hpp>

#include <array>
#include <string>
#include <tuple>

// Laws of mechanisms that press on each other: a spring on a strut, a slider on a rail that it presses, and a slider on
// an angle that the first presses.
namespace rubato {
namespace {

using model::PlaneCoordinate;
using testing::free_plane_node;
using testing::RandomMotion;

PlaneCoordinate coordinate(PlaneCoordinate::Kind kind, int first, int second) {
  PlaneCoordinate s;
  s.kind = kind;
  s.along = {{free_plane_node(first), {0.3, -0.4}}, {free_plane_node(second), {-0.2, 0.5}}, {0.6, 0.8}};
  return s;
}

struct Chain {
  explicit Chain(double stiffness) {
    model::MechanismLaw press{"press",
                              "nonlinear_spring",
                              coordinate(PlaneCoordinate::Kind::length, 0, 1),
                              testing::spring("9 + 2*u^3 + 0.2*rate"),
                              0,
                              0};
    model::MechanismLaw rub{
        "rub", "slider", coordinate(PlaneCoordinate::Kind::displacement, 2, 3), model::make_jenkins(stiffness, 0.4),
        1,     0};
    rub.normal.law = 0;
    rub.pressing = std::make_shared<model::MechanismLaw>(press);
    model::MechanismLaw turn{
        "turn", "slider", coordinate(PlaneCoordinate::Kind::angle, 4, 5), model::make_jenkins(stiffness, 0.7), 2, 1};
    turn.normal.law = 1;
    turn.pressing = std::make_shared<model::MechanismLaw>(rub);
    laws = {press, rub, turn};
  }
  /// From a start at which all are pressed a little, and the sliders were moved backwards.
  void start(RandomMotion& at) {
    for (auto& point : from) point = {-1.5, 0.1, 0.0, model::Side::right, 3.0};
    at.laws = {from.data(), memory.data(), next.data()};
  }

  std::array<model::MechanismLaw, 3> laws;
  std::array<model::LawPoint, 3> from;
  std::array<double, 2> memory{0.3, 0.2}, next{};
};

// The slopes by what presses are those of the strut and its rate, through each slider that slips; one that sticks feels
// nothing of it.
TEST(PressedLaws, HaveConsistentTangentsDownTheChain) {
  for (const unsigned seed : {1U, 2U, 3U, 4U})
    for (const double stiffness : {0.01, 50.0}) {
      Chain chain(stiffness);
      RandomMotion at(6, seed);
      chain.start(at);
      for (const auto& law : chain.laws) testing::expect_consistent_tangent(*model::make_law_element(law), at, 50.0);
      const model::LawAnswer turn = chain.laws[2].answer(at.motion());
      EXPECT_EQ(turn.by_normal != 0.0, stiffness > 1.0);
    }
}

TEST(PressedLaws, OfASliderThatSlipsAreItsLimitByWhatPressesThen) {
  Chain chain(50.0);
  RandomMotion at(6, 5);
  chain.start(at);
  const double press = chain.laws[0].answer(at.motion()).force, rub = chain.laws[1].answer(at.motion()).force;
  EXPECT_NEAR(rub, 0.4 * press, 1e-12);
  EXPECT_NEAR(chain.laws[2].point(at.motion()).normal, rub, 1e-12);
}

// Of a stop that is open the ends are apart by less than nothing, so that a slider is open as well.
TEST(PressedLaws, FollowTheStopOfAJoint) {
  model::Lock stop;
  stop.s = coordinate(PlaneCoordinate::Kind::displacement, 0, 1);
  stop.at = -4.0;
  stop.stiffness = 7.0;
  stop.damping = 0.3;
  model::MechanismLaw rub{
      "rub", "slider", coordinate(PlaneCoordinate::Kind::length, 2, 3), model::make_jenkins(50.0, 0.4), 0, 0};
  rub.normal.stop = 2;
  rub.stop = std::make_shared<model::Lock>(stop);
  const std::unique_ptr<model::Element> element = model::make_law_element(rub);
  const std::array<model::LawPoint, 1> from{model::LawPoint{0.0, 0.0, 0.0, model::Side::right, 3.0}};
  const std::array<double, 1> memory{0.1};
  std::array<double, 1> next{};
  RandomMotion at(6, 6);
  at.laws = {from.data(), memory.data(), next.data()};
  at.phase[2] = 1;
  testing::expect_consistent_tangent(*element, at, 50.0);
  const double depth = stop.s.value(at.q.data()) + 4.0, rate = stop.s.rate(at.motion());
  EXPECT_NEAR(rub.answer(at.motion()).force, 0.4 * (7.0 * depth + 0.3 * rate), 1e-12);
  at.phase[2] = 0;
  EXPECT_EQ(rub.answer(at.motion()).force, 0.0);
  EXPECT_LE(rub.point(at.motion()).normal, 0.0);
}

}  // namespace
}  // namespace rubato
