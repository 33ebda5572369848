#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/model/laws/elastic_contact.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// Static states of structures on contacts that just touch where nothing has moved: their forces follow the loads in
// proportion from the start, so that no share of the loads is easier than another. Newton's method from there went
// round among open, stuck and slipping for some of them, and the run said that there was no equilibrium.
namespace rubato::integrate {
namespace {

struct Touching {
  Matrix stiffness;
  Vector load;
  std::vector<model::ContactValues> values;
  std::vector<std::vector<Vector>> columns;  ///< of each contact: those along the plane, and that across it
};

system::LocallyNonlinear structure(const Touching& given) {
  system::LocallyNonlinear::Parts parts;
  const Index n = given.load.size();
  parts.mass = testing::sparse(Matrix::Identity(n, n));
  parts.damping.resize(n, n);
  parts.stiffness = testing::sparse(given.stiffness);
  std::vector<system::LoadTerm> loads;
  for (Index i = 0; i < n; ++i) {
    parts.coordinates.push_back("q" + std::to_string(i));
    loads.push_back(testing::harmonic(i, given.load[i], 0.0));
  }
  parts.loads = system::Loads(loads);
  for (std::size_t c = 0; c < given.values.size(); ++c) {
    model::BlockBetween block{"c" + std::to_string(c), "contact", model::make_elastic_contact(given.values[c]), {}};
    for (std::size_t i = 0; i < given.columns[c].size(); ++i)
      for (Index k = 0; k < n; ++k) block.columns[i].push_back({k, given.columns[c][i][k]});
    parts.blocks.push_back(block);
  }
  return system::LocallyNonlinear(std::move(parts));
}

/// Forces balance, nothing pulls, |T| <= mu N, T = kT u of what sticks, and T along u of what slips.
void expect_rest(const Touching& given) {
  const StaticEquilibrium found = find_equilibrium(structure(given), {});
  ASSERT_EQ(found.outcome, StaticOutcome::found);
  const Vector &q = found.state.q, &force = found.state.slider_force;
  Vector residual = given.load - given.stiffness * q;
  Vector terms = given.load.cwiseAbs() + given.stiffness.cwiseAbs() * q.cwiseAbs();
  Index row = 0;
  for (std::size_t c = 0; c < given.values.size(); ++c) {
    const model::ContactValues& contact = given.values[c];
    const Vector& across = given.columns[c].back();
    const double d = across.dot(q), pressed = force[row + contact.directions];
    const double round_off = 1e-12 * contact.normal_stiffness * across.cwiseAbs().dot(q.cwiseAbs());
    EXPECT_NEAR(pressed, contact.normal_stiffness * std::max(0.0, d - contact.gap), round_off);
    residual -= pressed * across;
    terms += contact.normal_stiffness * across.cwiseAbs().dot(q.cwiseAbs()) * across.cwiseAbs();
    Eigen::Vector2d rubs(0.0, 0.0), trial(0.0, 0.0);
    for (Index i = 0; i < contact.directions; ++i, ++row) {
      const Vector& along = given.columns[c][static_cast<std::size_t>(i)];
      rubs[i] = force[row];
      trial[i] = contact.tangential_stiffness * along.dot(q);
      residual -= rubs[i] * along;
      terms += contact.tangential_stiffness * along.cwiseAbs().dot(q.cwiseAbs()) * along.cwiseAbs();
    }
    ++row;
    const double limit = contact.friction_coefficient * pressed;
    EXPECT_LE(rubs.norm(), limit + contact.friction_coefficient * round_off);
    if (contact.gap != 0.0) continue;
    const double part = trial.norm() > limit ? limit / trial.norm() : 1.0;
    EXPECT_NEAR((rubs - part * trial).norm(), 0.0, 1e-10 * (limit + 1e-3 * trial.norm()));
  }
  EXPECT_LT((residual.cwiseAbs().array() / terms.array()).maxCoeff(), 1e-12);
}

Touching inclined(double normal_stiffness, double friction, double load) {
  return {Eigen::Vector2d(2.8, 3.0).asDiagonal().toDenseMatrix(),
          load * Eigen::Vector2d(-1.64, 1.67),
          {{1, 3.0, normal_stiffness, friction, 0.0}},
          {{Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(0.558, 0.806)}}};
}

TEST(TouchingContacts, RestOnAnInclinedPlaneOfAnyStiffnessAndFriction) {
  for (const double normal_stiffness : {10.0, 100.0, 1000.0, 1e6})
    for (const double friction : {0.0, 0.05, 0.2, 0.5}) {
      SCOPED_TRACE(std::to_string(normal_stiffness) + ", " + std::to_string(friction));
      expect_rest(inclined(normal_stiffness, friction, 1.0));
    }
}

TEST(TouchingContacts, RestInProportionToTheLoads) {
  const Vector one = find_equilibrium(structure(inclined(1000.0, 0.05, 1.0)), {}).state.q;
  const Vector small = find_equilibrium(structure(inclined(1000.0, 0.05, 1e-3)), {}).state.q;
  EXPECT_NEAR((small - 1e-3 * one).norm(), 0.0, 1e-14);
}

// A second contact that is pressed at rest, and a third that closes on the way.
TEST(TouchingContacts, RestBesideOthersThatArePressedOrOpen) {
  Touching given{Eigen::Vector4d(2.8, 3.0, 1.0, 1.0).asDiagonal().toDenseMatrix(),
                 Eigen::Vector4d(-1.64, 1.67, 0.8, 2.0),
                 {{1, 3.0, 1000.0, 0.05, 0.0}, {1, 5.0, 20.0, 0.3, -0.2}, {1, 5.0, 20.0, 0.3, 0.4}},
                 {}};
  const auto axis = [](Index i) -> Vector { return Vector::Unit(4, i); };
  given.columns = {
      {axis(1), Eigen::Vector4d(0.558, 0.806, 0.0, 0.0)}, {axis(2), axis(2) - axis(3)}, {axis(2), axis(3)}};
  given.stiffness(0, 2) = given.stiffness(2, 0) = -0.5;
  expect_rest(given);
}

TEST(TouchingContacts, RestInRandomStructures) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const auto n = static_cast<Index>(2 + static_cast<int>(4.0 * share(random)));
    const auto drawn = [&]() -> Vector { return Vector::NullaryExpr(n, [&] { return normal(random); }); };
    Touching given{0.3 * Matrix::Identity(n, n), drawn(), {}, {}};
    for (Index k = 0; k < n; ++k) {
      const Vector spring = drawn();
      given.stiffness += 0.3 * spring * spring.transpose();
    }
    const int contacts = 1 + static_cast<int>(3.0 * share(random));
    for (int c = 0; c < contacts; ++c) {
      const auto directions = static_cast<Index>(share(random) < 0.5 ? 1 : 2);
      given.values.push_back({directions, std::pow(10.0, 3.0 * share(random) - 1.0),
                              std::pow(10.0, 4.0 * share(random) - 1.0), std::pow(10.0, 2.0 * share(random) - 1.5),
                              0.0});
      std::vector<Vector> columns;
      for (Index d = 0; d <= directions; ++d) columns.push_back(drawn());
      given.columns.push_back(columns);
    }
    expect_rest(given);
  }
}

}  // namespace
}  // namespace rubato::integrate
