#include <rubato/model/laws/jenkins.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace rubato::model {
namespace {

constexpr double stiffness = 2.0, mu = 0.5;

/// A motion in which u and what presses go in straight lines, by its start and end.
struct Segment {
  LawPoint from, to;
  double memory = 0.0;

  LawPoint at(double share) const {
    LawPoint point;
    point.u = from.u + share * (to.u - from.u);
    point.normal = from.normal + share * (to.normal - from.normal);
    return point;
  }
};

Segment random_segment(std::mt19937& generator) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(generator); };
  Segment segment;
  segment.from.u = between(-1.0, 1.0);
  segment.to.u = segment.from.u + between(-2.0, 2.0);
  segment.from.normal = between(-1.0, 2.0);
  segment.to.normal = between(-1.0, 2.0);
  segment.memory = between(-1.0, 1.0) * mu * std::max(segment.from.normal, 0.0);
  return segment;
}

/// Force, work on the element and slip times mu N after a segment, by many small steps of the rules in their plainest
/// form: the force follows the spring, and is cut off at mu N.
struct Marched {
  double force = 0.0, work = 0.0, rubbed = 0.0;
};
Marched march(const Segment& segment, int steps) {
  Marched now{segment.memory, 0.0, 0.0};
  const double travel = (segment.to.u - segment.from.u) / steps;
  for (int i = 1; i <= steps; ++i) {
    const double limit = mu * std::max(segment.at(static_cast<double>(i) / steps).normal, 0.0), before = now.force;
    const double trial = now.force + stiffness * travel;
    now.force = std::max(-limit, std::min(limit, trial));
    now.work += 0.5 * (before + now.force) * travel;
    now.rubbed += std::abs(trial - now.force) / stiffness * limit;
  }
  return now;
}

TEST(Jenkins, FollowsSlipUnderALoadThatChangesAndOpensAndCloses) {
  const auto law = make_jenkins(stiffness, mu);
  std::mt19937 generator(1);
  for (int i = 0; i < 300; ++i) {
    const Segment segment = random_segment(generator);
    SCOPED_TRACE(testing::Message() << "u " << segment.from.u << " to " << segment.to.u << ", normal "
                                    << segment.from.normal << " to " << segment.to.normal << ", from "
                                    << segment.memory);
    double next = 0.0;
    const LawAnswer answer = law->advance(segment.from, &segment.memory, segment.to, &next);
    const int steps = 20000;
    const Marched marched = march(segment, steps);
    EXPECT_EQ(answer.force, next);
    EXPECT_NEAR(answer.force, marched.force, 10.0 / steps);  // of first order where contact is made
    EXPECT_NEAR(law->dissipated(segment.from, &segment.memory, segment.to, &next), marched.rubbed, 20.0 / steps);
    const double stored = law->stored_energy(0.0, &next) - law->stored_energy(0.0, &segment.memory);
    EXPECT_NEAR(stored + law->dissipated(segment.from, &segment.memory, segment.to, &next), marched.work, 20.0 / steps);
  }
}

TEST(Jenkins, DoesNotMindInHowManyPartsAMotionIsMade) {
  const auto law = make_jenkins(stiffness, mu);
  std::mt19937 generator(2);
  for (int i = 0; i < 300; ++i) {
    const Segment segment = random_segment(generator);
    double once = 0.0, memory = segment.memory, dissipated = 0.0;
    law->advance(segment.from, &segment.memory, segment.to, &once);
    LawPoint from = segment.from;
    for (const double share : {0.13, 0.5, 0.77, 1.0}) {
      const LawPoint to = share == 1.0 ? segment.to : segment.at(share);
      double next = 0.0;
      law->advance(from, &memory, to, &next);
      dissipated += law->dissipated(from, &memory, to, &next);
      memory = next;
      from = to;
    }
    EXPECT_NEAR(memory, once, 1e-13);
    EXPECT_NEAR(dissipated, law->dissipated(segment.from, &segment.memory, segment.to, &once), 1e-13);
  }
}

TEST(Jenkins, HasTheTangentThatBelongsToItsForceByMotionAndLoad) {
  const auto law = make_jenkins(stiffness, mu);
  std::mt19937 generator(3);
  int slipped = 0, met = 0;
  for (int i = 0; i < 300; ++i) {
    const Segment segment = random_segment(generator);
    double next = 0.0;
    const LawAnswer answer = law->advance(segment.from, &segment.memory, segment.to, &next);
    const double small = 1e-6;
    const auto force = [&](double du, double dn) {
      LawPoint to = segment.to;
      to.u += du;
      to.normal += dn;
      return law->advance(segment.from, &segment.memory, to, &next).force;
    };
    EXPECT_NEAR(answer.by_u, (force(small, 0.0) - force(-small, 0.0)) / (2.0 * small), 1e-5);
    EXPECT_NEAR(answer.by_normal, (force(0.0, small) - force(0.0, -small)) / (2.0 * small), 1e-5);
    slipped += answer.by_u == 0.0 && answer.by_normal != 0.0 ? 1 : 0;
    met += segment.from.normal < 0.0 && answer.by_u != 0.0 ? 1 : 0;
  }
  EXPECT_GT(slipped, 50);
  EXPECT_GT(met, 5);
}

TEST(Jenkins, TellsHarmonicBalanceTheSlopesOfItsSteps) {
  const auto law = make_jenkins(stiffness, mu);
  const auto* of_steps = dynamic_cast<const LawSlopes*>(law.get());
  ASSERT_NE(of_steps, nullptr);
  std::mt19937 generator(4);
  for (int i = 0; i < 300; ++i) {
    Segment segment = random_segment(generator);
    segment.from.normal = segment.to.normal = 1.0;
    segment.memory = std::uniform_real_distribution(-0.45, 0.45)(generator);
    std::array<double, 10> slopes{};
    of_steps->slopes(segment.from, &segment.memory, segment.to, slopes.data());
    const double small = 1e-6;
    const auto force = [&](double end, double start, double memory) {
      Segment moved = segment;
      moved.to.u += end;
      moved.from.u += start;
      moved.memory += memory;
      double next = 0.0;
      return law->advance(moved.from, &moved.memory, moved.to, &next).force;
    };
    for (const std::size_t row : {std::size_t{0}, std::size_t{5}}) {
      EXPECT_NEAR(slopes[row], (force(small, 0, 0) - force(-small, 0, 0)) / (2.0 * small), 1e-5);
      EXPECT_NEAR(slopes[row + 2], (force(0, small, 0) - force(0, -small, 0)) / (2.0 * small), 1e-5);
      EXPECT_NEAR(slopes[row + 4], (force(0, 0, small) - force(0, 0, -small)) / (2.0 * small), 1e-5);
    }
  }
}

// Straight lines of a contact that is pressed as it slides (kT = 2, mu = 0.5, N = 1 + 1.5 cos(t + phase), u = cos t):
// work of the first and of the third cycle, from events on the smooth path to 1e-8 and better. With N never below zero
// the error of straight steps is of second order.
TEST(Jenkins, DoesTheWorkOfADrivenContactWhoseLoadSwings) {
  struct Case {
    double phase, first, third;
  };
  const double degree = std::numbers::pi / 180.0;
  const auto law = make_jenkins(stiffness, mu);
  for (const Case& one : {Case{0.0, 1.40861742424, 0.94696969697}, Case{45.0, 1.78986158376, 1.65775759725},
                          Case{90.0, 1.68482804195, 1.69242569743}, Case{180.0, 0.94696969697, 0.94696969697}}) {
    const int steps = 16384;
    const auto point = [&](int i) {
      const double t = 2.0 * std::numbers::pi * i / steps;
      LawPoint at{std::cos(t), -std::sin(t), t};
      at.normal = 1.0 + 1.5 * std::cos(t + one.phase * degree);
      return at;
    };
    double memory = 0.0;
    std::array<double, 3> work{};
    for (int i = 0; i < 3 * steps; ++i) {
      double next = 0.0;
      law->advance(point(i), &memory, point(i + 1), &next);
      work[static_cast<std::size_t>(i / steps)] += law->dissipated(point(i), &memory, point(i + 1), &next);
      memory = next;
    }
    EXPECT_NEAR(work[0], one.first, 1e-6) << one.phase;
    EXPECT_NEAR(work[2], one.third, 1e-6) << one.phase;
  }
}

// Slip under a load that rises: the work is mu times the integral of N |du|, but for what the spring has moved.
TEST(Jenkins, RubsAwayTheIntegralOfTheLoadOverTheSlip) {
  const auto law = make_jenkins(1e9, mu);
  double memory = 0.0, sum = 0.0;
  const auto point = [](double t) {
    LawPoint at{3.0 * t, 3.0, t};
    at.normal = 2.0 + 5.0 * t;
    return at;
  };
  for (int i = 0; i < 10; ++i) {
    double next = 0.0;
    law->advance(point(0.1 * i), &memory, point(0.1 * (i + 1)), &next);
    sum += law->dissipated(point(0.1 * i), &memory, point(0.1 * (i + 1)), &next);
    memory = next;
  }
  EXPECT_NEAR(sum, mu * 3.0 * (2.0 + 2.5), 1e-6);
}

TEST(Jenkins, LosesWhatALoadThatFallsAtOnceLetsGo) {
  const auto law = make_jenkins(stiffness, mu);
  const double memory = 0.9;
  LawPoint from{0.3, 0.0, 0.0}, to{0.3, 0.0, 0.1};
  from.normal = to.normal = 1.0;  // 2 before
  EXPECT_EQ(law->at(from, &memory).force, 0.5);
  double next = 0.0;
  EXPECT_EQ(law->advance(from, &memory, to, &next).force, 0.5);
  EXPECT_NEAR(law->dissipated(from, &memory, to, &next),
              law->stored_energy(0.0, &memory) - law->stored_energy(0.0, &next), 1e-15);
}

TEST(Jenkins, SaysWhetherItSticksSlipsOrIsOpen) {
  const auto law = make_jenkins(stiffness, mu);
  LawPoint point;
  point.normal = 1.0;
  const auto contact = [&](double memory) { return law->contact(point, &memory, 0.0); };
  EXPECT_EQ(contact(0.2), Law::Contact::sticks);
  EXPECT_EQ(contact(0.5), Law::Contact::slips_forwards);
  EXPECT_EQ(contact(-0.5), Law::Contact::slips_backwards);
  point.normal = -0.1;
  EXPECT_EQ(contact(0.0), Law::Contact::open);
}

TEST(OneSidedSpring, PushesBeyondItsGapOnly) {
  const auto law = make_one_sided_spring(3.0, 0.2);
  EXPECT_EQ(law->at({0.1}, nullptr).force, 0.0);
  EXPECT_EQ(law->at({0.1}, nullptr).by_u, 0.0);
  EXPECT_DOUBLE_EQ(law->at({0.7}, nullptr).force, 1.5);
  EXPECT_EQ(law->at({0.7}, nullptr).by_u, 3.0);
  EXPECT_DOUBLE_EQ(law->stored_energy(0.7, nullptr), 0.375);
}

}  // namespace
}  // namespace rubato::model
