#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rubato::model {
namespace {

std::shared_ptr<const Law> make(const char* table, std::vector<Quantity> values,
                                const numerics::Parameters& parameters = {}) {
  LawDescription description;
  description.kind = table;
  description.name = "law";
  description.values = std::move(values);
  return law_kind(table).make(description, parameters, std::string(table) + " \"law\"");
}

struct Wen {
  double k, alpha, a, beta, gamma, n;

  std::shared_ptr<const Law> law() const { return make("bouc_wen", {k, alpha, a, beta, gamma, n}); }
  double force(double u, double z) const { return alpha * k * u + (1.0 - alpha) * k * z; }
  /// The equation as it is published, in small steps of Runge's and Kutta's method.
  double march(double z, double travel) const {
    const auto rate = [&](double at) {
      const double sign = at * travel > 0.0 ? 1.0 : at * travel < 0.0 ? -1.0 : 0.0;
      return a - std::pow(std::abs(at), n) * (gamma + beta * sign);
    };
    const int steps = 4000;
    const double h = travel / steps;
    for (int i = 0; i < steps; ++i) {
      const double k1 = rate(z), k2 = rate(z + 0.5 * h * k1), k3 = rate(z + 0.5 * h * k2), k4 = rate(z + h * k3);
      z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return z;
  }
};

Wen random_wen(std::mt19937& generator) {
  const auto from = [&](double low, double high) { return std::uniform_real_distribution(low, high)(generator); };
  const double n = std::array{1.0, 2.0, 1.5, 3.0, 5.3}[std::uniform_int_distribution(0, 4)(generator)];
  const double beta = from(0.1, 2.0);
  return {from(0.5, 20.0), from(0.0, 0.9), from(0.3, 3.0), beta, from(-0.9 * beta, 2.0), n};
}

TEST(BoucWen, FollowsItsEquationBetweenTurns) {
  std::mt19937 generator(1);
  for (int i = 0; i < 200; ++i) {
    const Wen wen = random_wen(generator);
    const auto law = wen.law();
    const double limit = std::pow(wen.a / (wen.beta + wen.gamma), 1.0 / wen.n);
    const double z0 = std::uniform_real_distribution(-0.99, 0.99)(generator) * limit;
    const double travel = std::uniform_real_distribution(-3.0, 3.0)(generator) * limit, u0 = 0.3;
    SCOPED_TRACE(testing::Message() << "n = " << wen.n << ", beta = " << wen.beta << ", gamma = " << wen.gamma
                                    << ", z from " << z0 << " over " << travel);
    double z1 = 0.0;
    const LawAnswer answer = law->advance({u0, 0.0}, &z0, {u0 + travel, 1.0}, &z1);
    const double expected = wen.march(z0, travel);
    // The reference loses digits where z passes zero and |z|^n has no third derivative there.
    EXPECT_NEAR(z1, expected, 2e-8 * limit);
    EXPECT_NEAR(answer.force, wen.force(u0 + travel, expected), 1e-7 * wen.k * limit);
  }
}

TEST(BoucWen, DoesNotMindInHowManyPartsAMotionIsMade) {
  std::mt19937 generator(2);
  for (int i = 0; i < 200; ++i) {
    const Wen wen = random_wen(generator);
    const auto law = wen.law();
    const double limit = std::pow(wen.a / (wen.beta + wen.gamma), 1.0 / wen.n);
    const double z0 = std::uniform_real_distribution(-0.99, 0.99)(generator) * limit;
    const double travel = std::uniform_real_distribution(-3.0, 3.0)(generator) * limit;
    double once = 0.0, z = z0, next = 0.0;
    law->advance({0.0, 0.0}, &z0, {travel, 0.0}, &once);
    double u = 0.0;
    for (const double share : {0.13, 0.5, 0.77, 1.0}) {
      law->advance({u, 0.0}, &z, {share * travel, 0.0}, &next);
      u = share * travel;
      z = next;
    }
    EXPECT_NEAR(z, once, 3e-14 * limit) << "n = " << wen.n;
  }
}

TEST(BoucWen, HasTheTangentThatBelongsToItsForce) {
  std::mt19937 generator(3);
  for (int i = 0; i < 200; ++i) {
    const Wen wen = random_wen(generator);
    const auto law = wen.law();
    const double limit = std::pow(wen.a / (wen.beta + wen.gamma), 1.0 / wen.n);
    const double z0 = std::uniform_real_distribution(-0.9, 0.9)(generator) * limit;
    const double travel = std::uniform_real_distribution(0.1, 2.0)(generator) * (i % 2 ? limit : -limit);
    const double step = 1e-6 * limit;
    double z = 0.0;
    const double after = law->advance({}, &z0, {travel + step, 0.0}, &z).force;
    const double before = law->advance({}, &z0, {travel - step, 0.0}, &z).force;
    EXPECT_NEAR(law->advance({}, &z0, {travel, 0.0}, &z).by_u, (after - before) / (2.0 * step), 1e-7 * wen.k * wen.a)
        << "n = " << wen.n;
  }
}

// The first loop of n = 1 by hand: z = z_max (1 - exp(-u / z_max)) with A = 1, z_max = 1 / (beta + gamma).
TEST(BoucWen, LoadsAsTheExponentialOfTheFirstOrder) {
  const auto law = Wen{2.0, 0.0, 1.0, 0.5, 0.5, 1.0}.law();
  const double z0 = 0.0;
  double z = 0.0;
  EXPECT_NEAR(law->advance({}, &z0, {0.7, 1.0}, &z).force, 2.0 * (1.0 - std::exp(-0.7)), 1e-15);
}

TEST(BoucWen, DissipatesWhatItsLoopEncloses) {
  std::mt19937 generator(4);
  for (int i = 0; i < 50; ++i) {
    const Wen wen = random_wen(generator);
    const auto law = wen.law();
    const double limit = std::pow(wen.a / (wen.beta + wen.gamma), 1.0 / wen.n), reach = 1.7 * limit;
    double z = 0.0, work = 0.0, dissipated = 0.0, u = 0.0;
    const int steps = 4000;
    for (int step = 1; step <= 3 * steps; ++step) {
      const double to = reach * std::sin(2.0 * M_PI * step / steps);
      double next = 0.0;
      const double before = wen.force(u, z), after = law->advance({u, 0.0}, &z, {to, 0.0}, &next).force;
      work += 0.5 * (before + after) * (to - u);
      dissipated += law->dissipated({u, 0.0}, &z, {to, 0.0}, &next);
      u = to;
      z = next;
    }
    const double stored = law->stored_energy(u, &z);
    EXPECT_GT(dissipated, 0.0);
    EXPECT_NEAR(work, stored + dissipated, 1e-5 * dissipated);
  }
}

// With a post_yield_ratio of 1 z has no force. Steady responses waited for it to repeat, and called what repeats
// quasi-periodic.
TEST(BoucWen, RemembersNothingWhereItDoesNotYield) {
  const auto law = make("bouc_wen", {3.0, 1.0, 1.0, 0.3, 0.8, 2.0});
  EXPECT_EQ(law->memory_size(), 0);
  const LawAnswer answer = law->advance({0.1, 0.0}, nullptr, {-0.4, 1.0}, nullptr);
  EXPECT_DOUBLE_EQ(answer.force, -1.2);
  EXPECT_EQ(answer.by_u, 3.0);
  EXPECT_EQ(law->at({0.5, 0.0}, nullptr).force, 1.5);
  EXPECT_EQ(law->stored_energy(2.0, nullptr), 6.0);
  EXPECT_EQ(law->dissipated({0.0, 0.0}, nullptr, {1.0, 0.0}, nullptr), 0.0);
  EXPECT_EQ(law->largest_stiffness(), 3.0);
}

TEST(BoucWen, RefusesWhatItCannotBe) {
  EXPECT_THROW(make("bouc_wen", {0.0, 0.0, 1.0, 0.5, 0.5, 1.0}), InvalidInput);
  EXPECT_THROW(make("bouc_wen", {1.0, 1.5, 1.0, 0.5, 0.5, 1.0}), InvalidInput);
  EXPECT_THROW(make("bouc_wen", {1.0, 0.0, 1.0, 0.5, -0.6, 1.0}), InvalidInput);
  EXPECT_THROW(make("bouc_wen", {1.0, 0.0, 1.0, 0.5, 0.5, 0.5}), InvalidInput);
}

TEST(BoucWen, DoubtsLoopsThatMakeEnergy) {
  LawDescription description = law_description(law_kind("bouc_wen"));
  EXPECT_EQ(law_kind("bouc_wen").doubt(description, {}), "");
  description.values[4] = 0.7;
  EXPECT_NE(law_kind("bouc_wen").doubt(description, {}).find("gamma is 0.7 and beta 0.5"), std::string::npos);
}

TEST(NonlinearSpring, IsItsFormulaWithExactSlopes) {
  const auto law = make("nonlinear_spring", {Quantity("k*u + c*rate + k3*u^3")}, {{"k", 2.0}, {"c", 0.3}, {"k3", 5.0}});
  const LawAnswer answer = law->at({0.7, -1.1, 0.0, Side::right}, nullptr);
  EXPECT_NEAR(answer.force, 2.0 * 0.7 - 0.3 * 1.1 + 5.0 * 0.343, 1e-15);
  EXPECT_NEAR(answer.by_u, 2.0 + 15.0 * 0.49, 1e-14);
  EXPECT_NEAR(answer.by_rate, 0.3, 1e-15);
  EXPECT_TRUE(law->depends_on_rate());
  EXPECT_FALSE(law->depends_on_time());
  EXPECT_TRUE(law->is_odd());
  EXPECT_FALSE(make("nonlinear_spring", {Quantity("u + u^2")})->is_odd());
  // Not where it is so only between a few points.
  EXPECT_FALSE(make("nonlinear_spring", {Quantity("u + 50*max(0, u - 0.3)*(u < 0.5)")})->is_odd());
  EXPECT_NEAR(law->stored_energy(0.7, nullptr), 0.49 + 1.25 * 0.2401, 1e-14);
}

TEST(NonlinearSpring, StoresWhatAFormulaWithAKinkHolds) {
  const auto law = make("nonlinear_spring", {Quantity("max(0, u - 0.3)")});
  EXPECT_NEAR(law->stored_energy(1.0, nullptr), 0.245, 1e-12);
  EXPECT_EQ(law->stored_energy(0.2, nullptr), 0.0);
}

TEST(NonlinearSpring, NamesAFaultOfItsFormula) {
  try {
    make("nonlinear_spring", {Quantity("k*uu")}, {{"k", 1.0}});
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("nonlinear_spring \"law\": force:"), std::string::npos) << fault.what();
    EXPECT_NE(std::string(fault.what()).find("uu"), std::string::npos) << fault.what();
  }
}

}  // namespace
}  // namespace rubato::model
