#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

// Degradation of Bouc-Wen elements (Baber and Wen 1981).
namespace rubato::model {
namespace {

std::shared_ptr<const Law> make(const std::vector<double>& values) {
  LawDescription description;
  description.kind = "bouc_wen";
  for (const double value : values) description.values.emplace_back(value);
  return law_kind("bouc_wen").make(description, {}, "bouc_wen \"law\"");
}

using State = std::array<double, 2>;  // z, e

struct BaberWen {
  double k, alpha, a, beta, gamma, n, da, dnu, deta;

  std::shared_ptr<const Law> law() const { return make({k, alpha, a, beta, gamma, n, da, dnu, deta}); }
  double limit() const { return std::pow(a / (beta + gamma), 1.0 / n); }
  double hysteretic() const { return (1.0 - alpha) * k; }
  double force(double u, double z) const { return alpha * k * u + hysteretic() * z; }
  State rate(const State& at, double direction) const {
    const double sign = at[0] * direction > 0.0 ? 1.0 : at[0] * direction < 0.0 ? -1.0 : 0.0;
    const double e = at[1], left = std::max(0.0, a - da * e);
    return {(left - (1.0 + dnu * e) * std::pow(std::abs(at[0]), n) * (gamma + beta * sign)) / (1.0 + deta * e),
            hysteretic() * at[0]};
  }
  /// The equations as they are published, in small steps of Runge's and Kutta's method.
  State march(State at, double travel) const {
    const int steps = 20000;
    const double h = travel / steps;
    const auto off = [](const State& from, double by, const State& rate) {
      return State{from[0] + by * rate[0], from[1] + by * rate[1]};
    };
    for (int i = 0; i < steps; ++i) {
      const State k1 = rate(at, h), k2 = rate(off(at, 0.5 * h, k1), h), k3 = rate(off(at, 0.5 * h, k2), h),
                  k4 = rate(off(at, h, k3), h);
      for (std::size_t j = 0; j < 2; ++j) at[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
    }
    return at;
  }
};

BaberWen random_element(std::mt19937& generator) {
  const auto from = [&](double low, double high) { return std::uniform_real_distribution(low, high)(generator); };
  const double n = std::array{1.0, 2.0, 1.5, 3.0, 5.3}[std::uniform_int_distribution<std::size_t>(0, 4)(generator)];
  const double beta = from(0.1, 2.0), gamma = from(-0.9, 1.0) * beta;
  BaberWen one{from(0.5, 20.0), from(0.0, 0.9), from(0.3, 3.0), beta, gamma, n, 0.0, 0.0, 0.0};
  const double work = one.hysteretic() * one.limit() * one.limit() / one.a;
  one.da = from(0.0, 0.02) * one.a / work;
  one.dnu = from(0.0, 0.2) / work;
  one.deta = from(0.0, 0.2) / work;
  return one;
}

/// A start that motions reach: after loads one way and the other.
State random_start(const BaberWen& one, std::mt19937& generator) {
  State at{0.0, 0.0};
  for (int i = 0; i < 3; ++i)
    at = one.march(at, std::uniform_real_distribution(-3.0, 3.0)(generator) * one.limit() / one.a);
  return at;
}

TEST(DegradingBoucWen, FollowsItsEquationsBetweenTurns) {
  std::mt19937 generator(1);
  for (int i = 0; i < 60; ++i) {
    const BaberWen one = random_element(generator);
    const auto law = one.law();
    const State start = random_start(one, generator);
    const double travel = std::uniform_real_distribution(-4.0, 4.0)(generator) * one.limit() / one.a, u = 0.3;
    SCOPED_TRACE(testing::Message() << "n = " << one.n << ", z from " << start[0] << " over " << travel);
    State end{};
    const LawAnswer answer = law->advance({u, 0.0}, start.data(), {u + travel, 1.0}, end.data());
    const State expected = one.march(start, travel);
    // The reference loses digits where z passes zero.
    EXPECT_NEAR(end[0], expected[0], 3e-8 * one.limit());
    EXPECT_NEAR(end[1], expected[1], 3e-8 * one.hysteretic() * one.limit() * one.limit());
    EXPECT_NEAR(answer.force, one.force(u + travel, expected[0]), 1e-7 * one.k * one.limit());
  }
}

TEST(DegradingBoucWen, DoesNotMindInHowManyPartsAMotionIsMade) {
  std::mt19937 generator(2);
  for (int i = 0; i < 60; ++i) {
    const BaberWen one = random_element(generator);
    const auto law = one.law();
    const State start = random_start(one, generator);
    const double travel = std::uniform_real_distribution(-3.0, 3.0)(generator) * one.limit() / one.a;
    State once{}, at = start, next{};
    law->advance({}, start.data(), {travel, 0.0}, once.data());
    double u = 0.0;
    for (const double share : {0.13, 0.5, 0.77, 1.0}) {
      law->advance({u, 0.0}, at.data(), {share * travel, 0.0}, next.data());
      u = share * travel;
      at = next;
    }
    // Beside z = 0 powers that are not whole are cut off, at 1e-15 of the limit.
    EXPECT_NEAR(at[0], once[0], 3e-14 * one.limit()) << "n = " << one.n;
    EXPECT_NEAR(at[1], once[1], 3e-14 * (once[1] + one.hysteretic() * one.limit() * one.limit())) << "n = " << one.n;
  }
}

TEST(DegradingBoucWen, HasTheTangentThatBelongsToItsForce) {
  std::mt19937 generator(3);
  for (int i = 0; i < 60; ++i) {
    const BaberWen one = random_element(generator);
    const auto law = one.law();
    const State start = random_start(one, generator);
    const double travel = std::uniform_real_distribution(0.1, 2.0)(generator) * (i % 2 ? 1 : -1) * one.limit() / one.a;
    const double step = 1e-6 * one.limit();
    State z{};
    const double after = law->advance({}, start.data(), {travel + step, 0.0}, z.data()).force;
    const double before = law->advance({}, start.data(), {travel - step, 0.0}, z.data()).force;
    EXPECT_NEAR(law->advance({}, start.data(), {travel, 0.0}, z.data()).by_u, (after - before) / (2.0 * step),
                1e-6 * one.k * one.a)
        << "n = " << one.n;
  }
}

TEST(DegradingBoucWen, IsTheElementThatDoesNotWhereNothingDegrades) {
  const std::vector<double> values{3.0, 0.1, 1.2, 0.6, 0.3, 2.0};
  std::vector<double> hardly = values;
  for (int i = 0; i < 3; ++i) hardly.push_back(1e-13);
  const auto as_new = make(values), degrading = make(hardly);
  double z = 0.0, z_next = 0.0, u = 0.0, expected_loss = 0.0, loss = 0.0;
  State at{}, next{};
  for (const double turn : {0.4, 2.0, 1.5, -3.0, -2.9, 0.1}) {
    const double start = u;
    for (int part = 1; part <= 100; ++part) {
      const double to = start + 0.01 * part * (turn - start);
      const double expected = as_new->advance({u}, &z, {to}, &z_next).force;
      EXPECT_NEAR(degrading->advance({u}, at.data(), {to}, next.data()).force, expected, 1e-11);
      EXPECT_NEAR(degrading->stored_energy(to, next.data()), as_new->stored_energy(to, &z_next), 1e-11);
      expected_loss += as_new->dissipated({u}, &z, {to}, &z_next);
      loss += degrading->dissipated({u}, at.data(), {to}, next.data());
      u = to;
      z = z_next;
      at = next;
    }
  }
  EXPECT_NEAR(loss, expected_loss, 1e-8 * loss);  // whose quadrature does not see where z passes zero
}

// Second law: of what is stored and what is dissipated the one comes back, and the other never.
TEST(DegradingBoucWen, NeverGivesBackWhatItHasDissipated) {
  std::mt19937 generator(4);
  for (int i = 0; i < 30; ++i) {
    const BaberWen one = random_element(generator);
    const auto law = one.law();
    const double reach = 2.0 * one.limit() / one.a;
    State at{}, next{};
    double u = 0.0, work = 0.0, dissipated = 0.0;
    const int steps = 2000;
    for (int step = 1; step <= 3 * steps; ++step) {
      const double to = reach * std::sin(2.0 * M_PI * step / steps) * (1.0 - 0.3 * std::sin(0.003 * step));
      const double before = one.force(u, at[0]), after = law->advance({u}, at.data(), {to}, next.data()).force;
      work += 0.5 * (before + after) * (to - u);
      const double lost = law->dissipated({u}, at.data(), {to}, next.data());
      EXPECT_GE(lost, -1e-13 * (dissipated + work)) << "n = " << one.n << ", step " << step;
      dissipated += lost;
      u = to;
      at = next;
    }
    EXPECT_NEAR(work, law->stored_energy(u, at.data()) + dissipated, 1e-4 * dissipated);
  }
}

TEST(DegradingBoucWen, StoresWhatAnUnloadingWithoutLossGivesBack) {
  // Where gamma = beta it unloads elastically, as steeply as it is degraded then.
  const BaberWen one{4.0, 0.0, 1.0, 0.5, 0.5, 2.0, 0.05, 0.1, 0.2};
  const auto law = one.law();
  State at{}, loaded{}, unloaded{};
  law->advance({0.0}, at.data(), {3.0}, loaded.data());
  const double stored = law->stored_energy(3.0, loaded.data());
  double low = 0.0, high = 3.0;  // where z is zero
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    law->advance({3.0}, loaded.data(), {middle}, unloaded.data());
    (unloaded[0] > 0.0 ? high : low) = middle;
  }
  law->advance({3.0}, loaded.data(), {low}, unloaded.data());
  EXPECT_NEAR(loaded[1] - unloaded[1], stored, 1e-12);
  EXPECT_GT(stored, 1.02 * 0.5 * 4.0 * loaded[0] * loaded[0]);  // more than that of the spring that it was
}

TEST(DegradingBoucWen, IsSpentWhereAIsUsedUp) {
  const BaberWen one{1.0, 0.0, 1.0, 0.5, 0.5, 2.0, 0.2, 0.0, 0.0};
  const auto law = one.law();
  State at{}, next{};
  law->advance({0.0}, at.data(), {400.0}, next.data());
  EXPECT_GE(next[0], 0.0);
  EXPECT_LT(next[0], 0.01);
  EXPECT_GT(next[1], 5.0);
  at = next;
  law->advance({400.0}, at.data(), {0.0}, next.data());
  EXPECT_LT(std::abs(next[0]), 0.01);
  EXPECT_TRUE(std::isfinite(law->stored_energy(0.0, next.data())));
}

TEST(DegradingBoucWen, RefusesToHeal) {
  EXPECT_THROW(make({1.0, 0.0, 1.0, 0.5, 0.5, 1.0, 0.0, -0.1, 0.0}), InvalidInput);
  EXPECT_EQ(make({1.0, 0.0, 1.0, 0.5, 0.5, 1.0, 0.0, 0.0, 0.0})->memory_size(), 1);
}

}  // namespace
}  // namespace rubato::model
