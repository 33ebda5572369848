#include <rubato/integrate/methods/alpha_step.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace rubato::integrate {
namespace {

// The two implementations of one formula, which share only the contact problem: 300 steps of each from rest under the
// same load. Both round each step to some tens of the last place of the largest term, and damping forgets: 1e-12 of
// the response is ample, and a wrong coefficient shows in the third digit.
void expect_agreement(const system::LocallyNonlinear& system) {
  for (const GeneralizedAlpha parameters : {GeneralizedAlpha{0.0, 0.0, 0.25, 0.5}, GeneralizedAlpha{0.2, 0.3, 0.3, 0.6},
                                            GeneralizedAlpha{0.0, 0.05, 0.275625, 0.55}}) {
    const auto dense = make_dense_alpha_step(parameters, system), sparse = make_sparse_alpha_step(parameters, system);
    ASSERT_TRUE(dense->prepare(0.1));
    ASSERT_TRUE(sparse->prepare(0.1));
    system::State a = consistent_start(system, system.start()), b = a, next_a = a, next_b = a;
    double largest = 0.0;
    bool has_slipped = false;
    for (int i = 0; i < 300; ++i) {
      const std::vector<double> load(system.loads().terms().size(), std::cos(0.07 * i));
      ASSERT_EQ(dense->solve(a, load.data(), next_a).outcome, StepOutcome::accepted);
      ASSERT_EQ(sparse->solve(b, load.data(), next_b).outcome, StepOutcome::accepted);
      std::swap(a, next_a);
      std::swap(b, next_b);
      largest = std::max(largest, a.q.cwiseAbs().maxCoeff());
      has_slipped |= std::abs(a.slider_force[0]) == system.sliders()[0].limit;
      ASSERT_LT((a.q - b.q).cwiseAbs().maxCoeff(), 1e-12 * largest) << "step " << i;
      ASSERT_LT((a.v - b.v).cwiseAbs().maxCoeff(), 1e-11 * largest) << "step " << i;
      ASSERT_LT((a.slider_force - b.slider_force).cwiseAbs().maxCoeff(), 1e-11 * largest) << "step " << i;
    }
    EXPECT_TRUE(has_slipped);
  }
}

system::LocallyNonlinear::Parts short_chain() {
  const auto chain = testing::chain(40, 3, 0.2);
  system::LocallyNonlinear::Parts parts;
  parts.mass = chain.mass();
  parts.damping = chain.damping();
  parts.stiffness = chain.stiffness();
  parts.sliders = chain.sliders();
  parts.sliders[1].second = parts.sliders[2].first;  // two sliders share a coordinate
  parts.loads = system::Loads({testing::harmonic(6, 5.0, 0.7), testing::harmonic(20, 3.0, 0.7)});
  parts.coordinates = chain.coordinates();
  return parts;
}

TEST(SparseAlphaStep, AgreesWithTheDenseOneUnderRayleighDamping) {
  expect_agreement(system::LocallyNonlinear(short_chain()));
}

TEST(SparseAlphaStep, AgreesWithTheDenseOneWithADashpot) {
  auto parts = short_chain();
  parts.damping.coeffRef(11, 11) += 0.5;
  expect_agreement(system::LocallyNonlinear(std::move(parts)));
}

TEST(SparseAlphaStep, AgreesWithTheDenseOneWithAConsistentMass) {
  auto parts = short_chain();
  parts.mass = SparseMatrix(parts.mass + 0.1 * parts.stiffness);
  expect_agreement(system::LocallyNonlinear(parts));
  parts.damping.coeffRef(11, 11) += 0.5;
  expect_agreement(system::LocallyNonlinear(std::move(parts)));
}

TEST(SparseAlphaStep, AgreesWithTheDenseOneForMassesThatOnlySlidersHold) {
  auto parts = short_chain();
  Matrix stiffness(parts.stiffness);
  stiffness.row(6).setZero();
  stiffness.col(6).setZero();
  parts.stiffness = stiffness.sparseView();
  parts.damping = SparseMatrix(0.05 * parts.mass);
  expect_agreement(system::LocallyNonlinear(std::move(parts)));
}

TEST(SparseAlphaStep, AgreesWithTheDenseOneWhereThePatternFillsIn) {
  const auto plate = testing::plate(20, 4, 0.02);
  numerics::OrderedFactor factor;
  factor.analyse(plate.stiffness());
  ASSERT_TRUE(factor.has_panels());
  expect_agreement(plate);
}

}  // namespace
}  // namespace rubato::integrate
