#include <rubato/steady/harmonic_balance/group_by_samples.hpp>

#include "support/contact_problems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

// The forces of contacts over a period, and their derivatives.
namespace rubato::steady {
namespace {

struct Motion {
  Vector mean;
  ComplexMatrix series;  // [orders x d]
  std::vector<const Complex*> columns() const {
    std::vector<const Complex*> result;
    for (Index j = 0; j < series.cols(); ++j) result.push_back(series.data() + j * series.rows());
    return result;
  }
};

Motion random_motion(Index d, int count, std::mt19937& engine) {
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  Motion motion{Vector(d), ComplexMatrix(count, d)};
  for (Index j = 0; j < d; ++j) {
    motion.mean[j] = 0.5 * draw(engine);
    for (int k = 0; k < count; ++k) motion.series(k, j) = Complex(draw(engine), draw(engine)) / (1.0 + k * k);
  }
  return motion;
}

void expect_derivatives(const system::LocallyNonlinear& system, unsigned seed, int samples) {
  const GroupedLaws laws = group_laws(system);
  ASSERT_EQ(laws.groups.size(), 1u);
  const LawGroup& law = *laws.groups.front().law;
  std::mt19937 engine(seed);
  const Orders orders{1, 3};
  const double w = 1.3;
  SampleAngles angles;
  angles.prepare(samples, orders);
  const Motion motion = random_motion(law.size(), orders.count, engine);
  GroupBySamples group(law), moved(law);
  group.pass(angles, w, motion.mean, orders, motion.columns());
  group.differentiate();
  EXPECT_TRUE(group.has_closed());
  constexpr double by = 1e-6;
  const auto expect_differences = [&](const Motion& there, auto&& derivative) {
    moved.pass(angles, w, there.mean, orders, there.columns());
    for (Index i = 0; i < law.size(); ++i) {
      for (int k = 0; k < orders.count; ++k) {
        const int order = orders.at(k);
        EXPECT_LE(std::abs((moved.force(i, order) - group.force(i, order)) / by - derivative(i, order)), 2e-3)
            << i << k;
      }
      EXPECT_LE(std::abs((moved.mean_force(i) - group.mean_force(i)) / by - derivative(i, 0)), 2e-3) << i;
    }
  };
  for (Index j = 0; j < law.size(); ++j) {
    Motion there = motion;
    there.mean[j] += by;
    expect_differences(there, [&](Index i, int k) {
      return k == 0 ? Complex(group.mean_derivative(i, j)) : group.derivative_by_mean(i, j, k);
    });
    for (int l = 0; l < orders.count; ++l) {
      SCOPED_TRACE(::testing::Message() << "number " << j << ", order " << orders.at(l));
      for (const bool is_real : {true, false}) {
        there = motion;
        there.series(l, j) += is_real ? Complex(by) : Complex(0.0, by);
        expect_differences(there, [&](Index i, int k) {
          Complex real, imaginary;
          if (k > 0) {
            group.derivative(i, j, k, orders.at(l), real, imaginary);
          } else {
            double mean_real, mean_imaginary;
            group.mean_derivative(i, j, orders.at(l), mean_real, mean_imaginary);
            real = mean_real;
            imaginary = mean_imaginary;
          }
          return is_real ? real : imaginary;
        });
      }
    }
  }
}

TEST(GroupBySamples, KnowsTheDerivativesOfContactsThatSlipAndOpen) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    for (const int samples : {256, 8192}) {
      expect_derivatives(testing::coupled(1.3, true), seed, samples);
      expect_derivatives(testing::coupled(1.3, false), seed, samples);
      expect_derivatives(testing::in_space(), seed, samples);
    }
  }
}

// |T| <= mu N at every sample, and a contact dissipates what its loop encloses.
TEST(GroupBySamples, DissipatesTheAreaOfItsLoops) {
  const auto system = testing::in_space();
  const GroupedLaws laws = group_laws(system);
  std::mt19937 engine(7);
  const Orders orders{1, 3};
  SampleAngles angles;
  angles.prepare(4096, orders);
  const Motion motion = random_motion(3, orders.count, engine);
  GroupBySamples group(*laws.groups.front().law);
  group.pass(angles, 1.3, motion.mean, orders, motion.columns());
  Vector work = Vector::Zero(1);
  group.add_dissipated(work);
  double area = 0.0;  // pi k Im(F conj(U)) of each order: of the orders of the displacement alone is it the whole
  for (Index i = 0; i < 3; ++i)
    for (int k = 0; k < orders.count; ++k)
      area -= std::numbers::pi * orders.at(k) * (std::conj(group.force(i, orders.at(k))) * motion.series(k, i)).imag();
  EXPECT_GT(work[0], 0.0);
  EXPECT_NEAR(work[0], std::abs(area), 1e-4 * work[0]);
}

}  // namespace
}  // namespace rubato::steady
