#pragma once

#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace rubato::testing {

/// The displacements of some coordinates.
inline steady::SteadyRequest observing(std::initializer_list<Index> coordinates) {
  steady::SteadyRequest request;
  for (const Index i : coordinates) request.observed.push_back({i, ground});
  return request;
}

/// By harmonic balance, which must converge.
inline steady::SteadyResponse respond(const system::LocallyNonlinear& system, const steady::SteadyRequest& request,
                                      double tolerance = 1e-6, int most_harmonics = 201) {
  steady::HarmonicBalanceSolver solver(system, request, {.tolerance = tolerance, .most_harmonics = most_harmonics});
  steady::SteadyResponse response;
  solver.solve(system::excitation_of(system), steady::SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, steady::SteadyStatus::converged);
  return response;
}

/// What comes in is what dampers and sliders take.
inline void expect_balance(const steady::SteadyResponse& r) {
  EXPECT_NEAR(r.input_work, r.viscous_work + r.dissipated.sum(), 1e-10 * r.input_work);
}

/// A linear structure with sliders, by hand: dense M, C, K.
inline system::LocallyNonlinear structure(const Matrix& mass, const Matrix& damping, const Matrix& stiffness,
                                          std::vector<model::Slider> sliders, std::vector<system::LoadTerm> loads) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(mass);
  parts.damping = testing::sparse(damping);
  parts.stiffness = testing::sparse(stiffness);
  parts.sliders = std::move(sliders);
  parts.loads = system::Loads(std::move(loads));
  for (Index i = 0; i < mass.rows(); ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  return system::LocallyNonlinear(std::move(parts));
}

}  // namespace rubato::testing
