#pragma once

#include <rubato/model/joints/joint.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rubato::testing {

/// What a joint says in one call is what it says in two, and nothing lies outside of the pattern that it announces.
/// @param g, jacobian, curvature  of the motion and these multipliers
inline void expect_pattern(const model::Joint& joint, const model::Motion& motion, const std::vector<double>& g,
                           const std::vector<double>& jacobian, const std::vector<double>& multiplier,
                           const std::vector<double>& curvature) {
  std::vector<double> g_again(g.size()), jacobian_again(jacobian.size()), curvature_again(curvature.size());
  joint.linearise(motion, multiplier.data(), g_again.data(), jacobian_again.data(), curvature_again.data());
  EXPECT_EQ(g_again, g);
  EXPECT_EQ(jacobian_again, jacobian);
  const model::JointPattern pattern = joint.pattern();
  ASSERT_EQ(pattern.jacobian.size(), jacobian.size());
  ASSERT_EQ(pattern.curvature.size(), curvature.size());
  const auto has_place = [&](std::size_t i) { return joint.places()[i % joint.places().size()] != ground; };
  for (std::size_t i = 0; i < jacobian.size(); ++i) {
    if (has_place(i) && !pattern.jacobian[i]) {
      EXPECT_EQ(jacobian[i], 0.0) << "entry " << i;
    }
  }
  const std::size_t k = joint.places().size();
  for (std::size_t i = 0; i < curvature.size(); ++i) {
    if (!has_place(i) || !has_place(i / k)) continue;
    // The same sums in another order.
    EXPECT_NEAR(curvature_again[i], curvature[i], 1e-14 * (1.0 + std::abs(curvature[i]))) << "entry " << i;
    if (!pattern.curvature[i]) {
      EXPECT_EQ(curvature[i], 0.0) << "entry " << i;
    }
  }
}

}  // namespace rubato::testing
