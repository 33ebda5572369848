#include <rubato/model/laws/elastic_contact.hpp>
#include <rubato/model/laws/jenkins.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rubato::model {
namespace {

using Numbers = std::array<double, largest_block>;

std::shared_ptr<const BlockLaw> contact_of(Index directions, double stiffness = 2.0, double normal_stiffness = 1.5,
                                           double mu = 0.5, double gap = -0.4) {
  return make_elastic_contact({directions, stiffness, normal_stiffness, mu, gap});
}

/// A straight motion from a state of a contact with two directions.
struct Segment {
  BlockPoint from, to;
  double memory[2] = {0.0, 0.0};

  BlockPoint at(double share) const {
    BlockPoint point;
    for (Index i = 0; i < largest_block; ++i) point.u[i] = from.u[i] + share * (to.u[i] - from.u[i]);
    return point;
  }
};

class Segments {
 public:
  explicit Segments(unsigned seed) : generator_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(generator_); }
  /// Pressed at its start or not, within its circle or on it.
  Segment next() {
    Segment segment;
    for (Index i = 0; i < largest_block; ++i) {
      segment.from.u[i] = between(-1.0, 1.0);
      segment.to.u[i] = segment.from.u[i] + between(-1.5, 1.5);
    }
    const double pressed = 1.5 * (segment.from.u[2] + 0.4), limit = 0.5 * std::max(pressed, 0.0);
    const double size = limit * std::min(1.0, between(0.0, 1.6)), angle = between(-3.1, 3.1);
    segment.memory[0] = size * std::cos(angle);
    segment.memory[1] = size * std::sin(angle);
    return segment;
  }

 private:
  std::mt19937 generator_;
};

/// The laws in their plainest form, in many small steps: the spring is stretched, and its force is let slip back to the
/// circle by what it is beyond.
struct Marched {
  double force[2] = {0.0, 0.0}, normal = 0.0, work = 0.0, rubbed = 0.0;
};
Marched march(const Segment& segment, int steps, double stiffness = 2.0, double kn = 1.5, double mu = 0.5,
              double gap = -0.4) {
  Marched now{{segment.memory[0], segment.memory[1]}, 0.0, 0.0, 0.0};
  const auto pressing = [&](double u) { return std::max(0.0, kn * (u - gap)); };
  now.normal = pressing(segment.from.u[2]);
  for (int i = 1; i <= steps; ++i) {
    const BlockPoint before = segment.at((i - 1.0) / steps), after = segment.at(static_cast<double>(i) / steps);
    const double normal = pressing(after.u[2]), limit = mu * normal;
    double trial[2], size = 0.0;
    for (int k = 0; k < 2; ++k) trial[k] = now.force[k] + stiffness * (after.u[k] - before.u[k]);
    size = std::hypot(trial[0], trial[1]);
    const double kept = size > limit ? limit / size : 1.0;
    now.rubbed += limit * std::max(0.0, size - limit) / stiffness;
    for (int k = 0; k < 2; ++k) {
      now.work += 0.5 * (now.force[k] + kept * trial[k]) * (after.u[k] - before.u[k]);
      now.force[k] = kept * trial[k];
    }
    now.work += 0.5 * (now.normal + normal) * (after.u[2] - before.u[2]);
    now.normal = normal;
  }
  return now;
}

/// By Richardson's extrapolation of the march, whose error falls with the step.
Marched limit_of_march(const Segment& segment) {
  const int steps = 40'000;
  const Marched coarse = march(segment, steps), fine = march(segment, 2 * steps);
  Marched limit = fine;
  for (int k = 0; k < 2; ++k) limit.force[k] = 2.0 * fine.force[k] - coarse.force[k];
  limit.work = 2.0 * fine.work - coarse.work;
  limit.rubbed = 2.0 * fine.rubbed - coarse.rubbed;
  return limit;
}

TEST(ElasticContact, FollowsAStraightMotionThatSticksSlipsOpensAndCloses) {
  const auto law = contact_of(2);
  Segments segments(1);
  for (int i = 0; i < 60; ++i) {
    const Segment segment = segments.next();
    double next[2];
    const BlockAnswer answer = law->advance(segment.from, segment.memory, segment.to, next);
    const Marched expected = limit_of_march(segment);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(answer.force[k], expected.force[k], 2e-5) << i;
      EXPECT_EQ(answer.force[k], next[k]);
    }
    EXPECT_NEAR(answer.force[2], expected.normal, 1e-12) << i;
    EXPECT_NEAR(law->dissipated(segment.from, segment.memory, segment.to, next), expected.rubbed, 2e-5) << i;
  }
}

// Stored before + work = stored after + dissipated, each by its own formula.
TEST(ElasticContact, KeepsItsBalanceOfEnergy) {
  Segments segments(2);
  const auto law = contact_of(2);
  for (int i = 0; i < 60; ++i) {
    const Segment segment = segments.next();
    // The work of a straight motion by Simpson's rule on the exact law.
    const int parts = 2000;
    double work = 0.0, memory[2] = {segment.memory[0], segment.memory[1]}, rubbed = 0.0, next[2];
    BlockPoint from = segment.from;
    Numbers force{segment.memory[0], segment.memory[1], std::max(0.0, 1.5 * (from.u[2] + 0.4))};
    for (int p = 1; p <= parts; ++p) {
      const BlockPoint to = segment.at(static_cast<double>(p) / parts), middle = segment.at((p - 0.5) / parts);
      const BlockAnswer half = law->advance(from, memory, middle, next), end = law->advance(from, memory, to, next);
      rubbed += law->dissipated(from, memory, to, next);
      for (std::size_t k = 0; k < largest_block; ++k) {
        work += (force[k] + 4.0 * half.force[k] + end.force[k]) / 6.0 * (to.u[k] - from.u[k]);
        force[k] = end.force[k];
      }
      std::copy_n(next, 2, memory);
      from = to;
    }
    const double stored = law->stored_energy(segment.from.u, segment.memory);
    EXPECT_NEAR(stored + work, law->stored_energy(segment.to.u, next) + rubbed, 1e-6) << i;
    // In one step as in many.
    EXPECT_NEAR(law->dissipated(segment.from, segment.memory, segment.to, next), rubbed, 1e-8) << i;
  }
}

TEST(ElasticContact, EndsWhereTwoPartsOfAStraightMotionEnd) {
  const auto law = contact_of(2);
  Segments segments(3);
  for (int i = 0; i < 300; ++i) {
    const Segment segment = segments.next();
    const BlockPoint middle = segment.at(segments.between(0.05, 0.95));
    double whole[2], half[2], end[2];
    law->advance(segment.from, segment.memory, segment.to, whole);
    law->advance(segment.from, segment.memory, middle, half);
    law->advance(middle, half, segment.to, end);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(whole[k], end[k], 1e-12) << i;
  }
}

TEST(ElasticContact, HasTheTangentOfItsForces) {
  for (const Index directions : {0, 1, 2}) {
    const auto law = contact_of(directions);
    Segments segments(4);
    for (int i = 0; i < 400; ++i) {
      Segment segment = segments.next();
      if (directions == 1) segment.memory[1] = 0.0;
      for (auto* point : {&segment.from, &segment.to}) std::swap(point->u[2], point->u[directions]);
      const double step = 1e-6;
      double next[2];
      const BlockAnswer answer = law->advance(segment.from, segment.memory, segment.to, next);
      for (Index j = 0; j <= directions; ++j) {
        BlockPoint above = segment.to, below = segment.to;
        above.u[j] += step;
        below.u[j] -= step;
        const BlockAnswer up = law->advance(segment.from, segment.memory, above, next);
        const BlockAnswer down = law->advance(segment.from, segment.memory, below, next);
        const auto kind = [&](const BlockAnswer& a) { return a.force[directions] > 0.0; };
        if (kind(up) != kind(down)) continue;  // over the kink of opening
        for (Index r = 0; r <= directions; ++r)
          EXPECT_NEAR(answer.by_u[r][j], (up.force[r] - down.force[r]) / (2.0 * step), 2e-6)
              << i << " of " << directions << ", " << r << " by " << j;
      }
    }
  }
}

TEST(ElasticContact, IsAPressedSliderOverAOneSidedSpringInOneDirection) {
  const auto contact = contact_of(1), in_space = contact_of(2);
  const auto slider = make_jenkins(2.0, 0.5);
  Segments segments(5);
  for (int i = 0; i < 400; ++i) {
    Segment segment = segments.next();
    segment.memory[1] = 0.0;
    segment.from.u[1] = segment.to.u[1] = 0.0;
    const LawPoint from{segment.from.u[0], 0.0, 0.0, Side::right, 1.5 * (segment.from.u[2] + 0.4)};
    const LawPoint to{segment.to.u[0], 0.0, 1.0, Side::left, 1.5 * (segment.to.u[2] + 0.4)};
    Segment planar = segment;
    for (auto* point : {&planar.from, &planar.to}) point->u[1] = point->u[2];
    double next[2], expected = 0.0;
    const LawAnswer force = slider->advance(from, segment.memory, to, &expected);
    const double rubbed = slider->dissipated(from, segment.memory, to, &expected);
    const BlockAnswer one = contact->advance(planar.from, planar.memory, planar.to, next);
    EXPECT_NEAR(one.force[0], force.force, 1e-15);
    EXPECT_NEAR(one.by_u[0][0], force.by_u, 1e-14);
    EXPECT_NEAR(one.by_u[0][1], 1.5 * force.by_normal, 1e-14);
    EXPECT_NEAR(one.force[1], std::max(0.0, to.normal), 1e-15);
    EXPECT_NEAR(contact->dissipated(planar.from, planar.memory, planar.to, next), rubbed, 1e-14) << i;
    const BlockAnswer two = in_space->advance(segment.from, segment.memory, segment.to, next);
    EXPECT_NEAR(two.force[0], force.force, 1e-14);
    EXPECT_EQ(two.force[1], 0.0);
    EXPECT_NEAR(in_space->dissipated(segment.from, segment.memory, segment.to, next), rubbed, 1e-13) << i;
  }
}

// What presses at the start of a step is known to round-off only.
TEST(ElasticContact, GoesOnFromAForceThatIsBeyondItsLimitByRoundOff) {
  Segments segments(6);
  for (const Index directions : {1, 2}) {
    const auto law = contact_of(directions);
    for (int i = 0; i < 100; ++i) {
      Segment segment = segments.next();
      segment.from.u[directions] = 0.3;
      segment.to.u[directions] = 0.3 + segments.between(-0.01, 0.01);
      segment.to.u[0] = segment.from.u[0] + segments.between(-0.02, 0.02);
      const double limit = 0.5 * 1.5 * 0.7, angle = directions > 1 ? segments.between(-3.0, 3.0) : 0.0;
      double expected[2], found[2];
      segment.memory[0] = limit * (1.0 - 4e-15) * std::cos(angle);
      segment.memory[1] = limit * (1.0 - 4e-15) * std::sin(angle);
      law->advance(segment.from, segment.memory, segment.to, expected);
      const double rubbed = law->dissipated(segment.from, segment.memory, segment.to, expected);
      for (double& memory : segment.memory) memory *= 1.0 + 8e-15;
      law->advance(segment.from, segment.memory, segment.to, found);
      for (Index k = 0; k < directions; ++k) EXPECT_NEAR(found[k], expected[k], 1e-13);
      EXPECT_NEAR(law->dissipated(segment.from, segment.memory, segment.to, found), rubbed, 1e-13);
    }
  }
}

TEST(ElasticContact, SlipsOnACircleNotOnASquare) {
  const auto law = contact_of(2);
  BlockPoint from, to;
  to.u[0] = to.u[1] = 10.0;
  const double none[2] = {0.0, 0.0};
  double next[2];
  const BlockAnswer answer = law->advance(from, none, to, next);
  EXPECT_NEAR(std::hypot(answer.force[0], answer.force[1]), 0.5 * 1.5 * 0.4, 1e-15);
  EXPECT_NEAR(answer.force[0], answer.force[1], 1e-15);
}

/// A contact that is driven by cosines: section 2 of the reference of the friction family ("problem K").
struct Driven {
  double tangential[2][2], phase[2][2];  // amplitude and phase of orders 1 and 2
  double normal[2], normal_phase[2], preload;
};
BlockPoint point_of(const Driven& driven, double t) {
  BlockPoint point;
  for (int order = 0; order < 2; ++order) {
    const double at = (order + 1) * t;
    for (int k = 0; k < 2; ++k) point.u[k] += driven.tangential[k][order] * std::cos(at + driven.phase[k][order]);
    point.u[2] += driven.normal[order] * std::cos(at + driven.normal_phase[order]);
  }
  return point;
}
/// Work of a cycle after so many, in steps.
std::vector<double> works_of(const Driven& driven, int steps, int cycles) {
  const auto law = contact_of(2, 2.0, 1.0, 0.5, -driven.preload);
  std::vector<double> works;
  double memory[2] = {0.0, 0.0}, next[2];
  BlockPoint from = point_of(driven, 0.0);
  for (int cycle = 0; cycle < cycles; ++cycle) {
    double rubbed = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const BlockPoint to = point_of(driven, 2.0 * std::numbers::pi * (cycle + static_cast<double>(i) / steps));
      law->advance(from, memory, to, next);
      rubbed += law->dissipated(from, memory, to, next);
      std::copy_n(next, 2, memory);
      from = to;
    }
    works.push_back(rubbed);
  }
  return works;
}

TEST(ElasticContact, DissipatesOnCurvedPathsWhatTheReferenceDoes) {
  struct Case {
    Driven driven;
    double first, third, bound;
  };
  const double right = 0.5 * std::numbers::pi;
  // The work of the straight case of the reference is that of its dissipation over the cycle from the start.
  const Case cases[] = {
      {{{{1, 0}, {1, 0}}, {{0, 0}, {-right, 0}}, {0, 0}, {0, 0}, 1.0}, 0.0, 3.04183400698, 1e-5},         // circle
      {{{{1, 0}, {0.6, 0}}, {{0, 0}, {-1, 0}}, {1.4, 0}, {0.7, 0}, 1.0}, 0.0, 2.33162227921, 1e-5},       // space_A
      {{{{1, 0}, {0, 0.5}}, {{0, 0}, {0, 0.3}}, {0.7, 0.8}, {0.4, 1.1}, 1.2}, 0.0, 2.40318676447, 1e-5},  // space_B
      {{{{0.3, 0}, {0.2, 0}}, {{0, 0}, {-1, 0}}, {1.4, 0}, {0.7, 0}, 1.0}, 0.0, 0.3539140568, 1e-5},      // space_C
  };
  for (const Case& one : cases) {
    const double coarse = works_of(one.driven, 512, 3).back(), fine = works_of(one.driven, 1024, 3).back();
    EXPECT_NEAR(fine, one.third, 4e-5 * one.third);
    // Of second order.
    EXPECT_NEAR((4.0 * fine - coarse) / 3.0, one.third, 5e-6 * one.third);
  }
}

TEST(ElasticContact, TellsWhatItDoes) {
  const auto law = contact_of(2);
  BlockPoint point;
  const double none[2] = {0.0, 0.0}, limit[2] = {0.18, 0.24};  // mu N = 0.3
  EXPECT_EQ(law->contact(point, none), Law::Contact::sticks);
  EXPECT_EQ(law->contact(point, limit), Law::Contact::slips_forwards);
  const double back[1] = {-0.3};
  EXPECT_EQ(contact_of(1)->contact(point, back), Law::Contact::slips_backwards);
  point.u[2] = -0.5;
  EXPECT_EQ(law->contact(point, none), Law::Contact::open);
}

}  // namespace
}  // namespace rubato::model
