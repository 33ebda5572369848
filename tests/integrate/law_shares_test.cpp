#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>

#include <support/harmonic_response.hpp>
#include <support/laws.hpp>
#include <support/models.hpp>
#include <support/prepared_study.hpp>

#include <gtest/gtest.h>

#include <cmath>

// Laws whose u is a sum of shares of coordinates: a linear one adds k w w^T to the stiffness and c w w^T to the
// damping.
namespace rubato::integrate {
namespace {

constexpr double stiffness_of_law = 7.0, damping_of_law = 0.3;

/// The shares of three coordinates of a chain, levers of several lengths.
Vector shares(Index n) {
  Vector w = Vector::Zero(n);
  w[1] = 0.6;
  w[n / 2] = -1.3;
  w[n - 1] = 0.4;
  return w;
}

enum class Law { none, linear, as_law, stiffening };

/// A chain of n masses under two forces, with the law as an element or as matrices.
system::LocallyNonlinear chain(Index n, Law kind) {
  system::LocallyNonlinear::Parts parts;
  Matrix mass = Matrix::Identity(n, n), stiffness = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    mass(i, i) = 1.0 + 0.1 * static_cast<double>(i % 4);
    stiffness(i, i) += 20.0 + static_cast<double>(i % 3);
    if (i + 1 == n) continue;
    stiffness(i + 1, i + 1) += 20.0 + static_cast<double>(i % 3);
    stiffness(i, i + 1) -= 12.0;
    stiffness(i + 1, i) -= 12.0;
  }
  Matrix damping = 0.05 * mass + 0.01 * stiffness;
  const Vector w = shares(n);
  if (kind == Law::linear) {
    stiffness += stiffness_of_law * w * w.transpose();
    damping += damping_of_law * w * w.transpose();
  }
  parts.mass = testing::sparse(mass);
  parts.damping = testing::sparse(damping);
  parts.stiffness = testing::sparse(stiffness);
  parts.loads = system::Loads({testing::harmonic(0, 3.0, 2.1), testing::harmonic(n - 1, 2.0, 2.1, 0.7)});
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i));
  if (kind == Law::as_law || kind == Law::stiffening) {
    model::LawBetween law{"law", "nonlinear_spring", ground, ground, {}, {}};
    law.law = testing::spring(kind == Law::as_law ? "7*u + 0.3*rate" : "7*u + 5000*u^3");
    for (Index i = 0; i < n; ++i)
      if (w[i] != 0.0) law.shares.push_back({i, w[i]});
    parts.laws = {law};
  }
  parts.start.q = Vector::Zero(n);
  parts.start.q[1] = 0.2;
  return system::LocallyNonlinear(std::move(parts));
}

system::State march_of(const system::LocallyNonlinear& system, const std::string& method, double h) {
  const auto stepper = make_stepper(make_method(method), system);
  system::State state = consistent_start(system, system.start());
  EXPECT_EQ(march(*stepper, state, h, 3.0).end, MarchEnd::reached) << method;
  return state;
}

// 90 coordinates go the sparse way.
TEST(LawShares, AddTheirSharesToTheMatricesInTransients) {
  for (const Index n : {6, 90})
    for (const char* method : {"generalized_alpha", "average_acceleration", "hht", "wbz", "galerkin", "wilson_theta",
                               "rk4", "dormand_prince", "central_difference", "exponential"}) {
      SCOPED_TRACE(method);
      const std::string name = method;
      const double h = name == "exponential" ? 5e-4 : 0.01;  // which takes forces of contacts as linear in a step
      const auto exact = march_of(chain(n, Law::linear), method, h), found = march_of(chain(n, Law::as_law), method, h);
      const double allowed = name == "exponential" ? 2e-6 : name == "wilson_theta" ? 3e-3 : 1e-12;
      EXPECT_LT((exact.q - found.q).norm(), allowed * exact.q.norm()) << n;
      EXPECT_LT((exact.v - found.v).norm(), 5.0 * allowed * exact.v.norm()) << n;
      const double u = shares(n).dot(found.q), rate = shares(n).dot(found.v);
      EXPECT_NEAR(found.slider_force[0], stiffness_of_law * u + damping_of_law * rate, 1e-9);
    }
}

TEST(LawShares, AddTheirSharesToTheMatricesOfSmallMotions) {
  const auto exact = chain(6, Law::linear), found = chain(6, Law::as_law);
  EXPECT_LT((Matrix(exact.stiffness()) - Matrix(found.free_stiffness())).norm(), 1e-13);
  EXPECT_LT((Matrix(exact.damping()) - Matrix(found.free_damping())).norm(), 1e-13);
}

TEST(LawShares, AddTheirSharesToTheMatricesInStaticStates) {
  for (const Index n : {6, 90}) {
    const std::vector<model::Held> held{{0, 0.3}, {n - 1, -0.1}};
    const StaticEquilibrium exact = find_equilibrium(chain(n, Law::linear), held);
    const StaticEquilibrium found = find_equilibrium(chain(n, Law::as_law), held);
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    EXPECT_LT((exact.state.q - found.state.q).norm(), 1e-13 * exact.state.q.norm());
    EXPECT_LT((exact.reaction - found.reaction).norm(), 1e-12 * exact.reaction.norm());
  }
}

TEST(LawShares, AddTheirSharesToTheMatricesInSteadyResponses) {
  for (const Index n : {6, 90}) {
    const auto linear = chain(n, Law::linear), by_law = chain(n, Law::as_law);
    const steady::SteadyResponse exact = testing::respond(linear, testing::observing({0, 1, n - 1}), 1e-10);
    const steady::SteadyResponse found = testing::respond(by_law, testing::observing({0, 1, n - 1}), 1e-10);
    ASSERT_EQ(found.status, steady::SteadyStatus::converged);
    EXPECT_LT((exact.amplitude - found.amplitude).norm(), 1e-9 * exact.amplitude.norm());
    // The law of C times the rate dissipates pi w c |u|^2 of its own.
    EXPECT_NEAR(found.input_work, found.viscous_work + found.law_dissipated.sum(),
                1e-5 * found.input_work);  // by samples
  }
}

TEST(LawShares, MeetBetweenTimeMarchingAndHarmonicBalance) {
  const auto system = chain(6, Law::stiffening);
  const steady::SteadyRequest request = testing::observing({0, 1, 5});
  const steady::SteadyResponse balanced = testing::respond(system, request, 1e-7);
  steady::TimeMarchingSolver marching(system, {}, request);
  steady::SteadyResponse marched;
  marching.solve(excitation_of(system), steady::SteadyStart::unloaded, marched);
  ASSERT_EQ(marched.status, steady::SteadyStatus::converged);
  EXPECT_LT((balanced.amplitude - marched.amplitude).cwiseAbs().maxCoeff(),
            (balanced.error + marched.error) * balanced.amplitude.maxCoeff());
  const double linear = testing::respond(chain(6, Law::linear), request, 1e-7).amplitude.norm();
  EXPECT_GT(std::abs(balanced.amplitude.norm() - linear), 1e-3 * linear);  // the cube counts
}

TEST(LawShares, AreReadFromAStudy) {
  const testing::PreparedStudy study(R"toml(
parameters = { b = 0.5 }
[[coordinate]]
name = "x1"
mass = 1.0
[[coordinate]]
name = "x2"
mass = 2.0
[[spring]]
between = ["x1", "ground"]
stiffness = 10.0
[[nonlinear_spring]]
name = "brace"
shares = { x2 = "-cos(b)", x1 = "sin(b)", ground = 4.0 }
force = "3*u"
[[analysis]]
name = "rest"
type = "static"
)toml");
  Matrix expected = Matrix::Zero(2, 2);
  expected(0, 0) = 10.0;
  const Eigen::Vector2d w(std::sin(0.5), -std::cos(0.5));
  expected += 3.0 * w * w.transpose();
  EXPECT_LT((Matrix(study.system.free_stiffness()) - expected).norm(), 1e-14);
}

// A sweep of a share may pass zero: there the law does nothing, and the point was told impossible.
TEST(LawShares, MayBeZero) {
  const auto plain = chain(6, Law::none), stiffening = chain(6, Law::stiffening);
  system::LocallyNonlinear::Parts parts;
  parts.mass = plain.mass();
  parts.damping = plain.damping();
  parts.stiffness = plain.stiffness();
  parts.loads = plain.loads();
  parts.coordinates = plain.coordinates();
  parts.laws = stiffening.laws();
  for (model::Share& share : parts.laws[0].shares) share.weight = 0.0;
  const system::LocallyNonlinear zero(std::move(parts));
  const steady::SteadyRequest request = testing::observing({0, 1, 5});
  const steady::SteadyResponse expected = testing::respond(plain, request, 1e-10),
                               found = testing::respond(zero, request, 1e-10);
  ASSERT_EQ(found.status, steady::SteadyStatus::converged);
  EXPECT_LT((expected.amplitude - found.amplitude).norm(), 1e-9 * expected.amplitude.norm());
  EXPECT_EQ(march_of(zero, "hht", 0.01).slider_force[0], 0.0);
  const testing::PreparedStudy study(R"toml(
parameters = { b = 0.0 }
coordinate = [{ name = "x", mass = 1.0 }]
spring = [{ between = ["x", "ground"], stiffness = 2.0 }]
nonlinear_spring = [{ name = "brace", shares = { x = "b" }, force = "3*u" }]
analysis = [{ name = "rest", type = "static" }]
)toml");
  EXPECT_EQ(Matrix(study.system.free_stiffness())(0, 0), 2.0);
}

// The two shares 1 and -1 are the ends of `between`, to the last bit.
TEST(LawShares, OfOneAndMinusOneAreADifference) {
  const auto with = [](bool as_shares) {
    const auto plain = chain(6, Law::none);
    system::LocallyNonlinear::Parts parts;
    parts.mass = plain.mass();
    parts.damping = plain.damping();
    parts.stiffness = plain.stiffness();
    parts.loads = plain.loads();
    parts.coordinates = plain.coordinates();
    parts.laws = {{"law", "bouc_wen", 4, 2, testing::made("bouc_wen", {9.0, 0.1, 1.0, 3.0, 2.0, 1.5}), {}}};
    if (as_shares) {
      parts.laws[0].first = parts.laws[0].second = ground;
      parts.laws[0].shares = {{4, 1.0}, {2, -1.0}};
    }
    return system::LocallyNonlinear(std::move(parts));
  };
  const auto one = march_of(with(false), "generalized_alpha", 0.01),
             other = march_of(with(true), "generalized_alpha", 0.01);
  EXPECT_EQ(one.q, other.q);
  EXPECT_EQ(one.slider_force, other.slider_force);
}

}  // namespace
}  // namespace rubato::integrate
