#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <support/laws.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rubato::model {
namespace {

using rubato::testing::made;

// s0, s1, s2, Fc, Fs, vs
const std::vector<double> values{50.0, 0.8, 0.3, 1.0, 1.6, 0.2};

double g(double v) { return values[3] + (values[4] - values[3]) * std::exp(-v * v / (values[5] * values[5])); }
double rate_of(double z, double v) { return v - values[0] * std::abs(v) * z / g(v); }
double force_of(double z, double v) { return values[0] * z + values[1] * rate_of(z, v) + values[2] * v; }

/// The bristles under a speed that is told, in small steps of Runge's and Kutta's method.
template <class Speed>
double bristles(double z, double duration, Speed speed) {
  constexpr int steps = 20000;
  const double h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = h * i;
    const double k1 = rate_of(z, speed(t)), k2 = rate_of(z + 0.5 * h * k1, speed(t + 0.5 * h));
    const double k3 = rate_of(z + 0.5 * h * k2, speed(t + 0.5 * h)), k4 = rate_of(z + h * k3, speed(t + h));
    z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return z;
}

TEST(LuGre, IsExactForAConstantSpeed) {
  const auto law = made("lugre", values);
  for (const double v : {-1.0, -0.1, 0.03, 0.4})
    for (const double z0 : {-0.025, 0.0, 0.018}) {
      double z = 0.0;
      const LawAnswer answer = law->advance({0.3, v, 1.0}, &z0, {0.3 + 0.2 * v, v, 1.2}, &z);
      EXPECT_NEAR(z, bristles(z0, 0.2, [&](double) { return v; }), 1e-11) << v << " " << z0;
      EXPECT_NEAR(answer.force, force_of(z, v), 1e-14);
    }
}

// However long a step, it ends on g(v) + s2 v of steady sliding.
TEST(LuGre, ComesToSteadySlidingInOneLongStep) {
  const auto law = made("lugre", values);
  for (const double v : {-2.0, 0.01, 0.3}) {
    const double start = -0.9 * values[3] / values[0];
    double z = 0.0;
    const LawAnswer answer = law->advance({0.0, v, 0.0}, &start, {1e6 * v, v, 1e6}, &z);
    EXPECT_NEAR(answer.force, std::copysign(g(v), v) + values[2] * v, 1e-13);
  }
}

TEST(LuGre, IsOfSecondOrderWhereTheSpeedChanges) {
  const auto law = made("lugre", values);
  const auto speed = [](double t) { return 0.3 * std::sin(3.0 * t); };
  const auto way = [](double t) { return 0.1 * (1.0 - std::cos(3.0 * t)); };
  const double exact = bristles(0.0, 2.0, speed);
  std::vector<double> errors;
  for (const int steps : {400, 800, 1600}) {
    double z = 0.0, next = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double t0 = 2.0 * i / steps, t1 = 2.0 * (i + 1) / steps;
      law->advance({way(t0), speed(t0), t0}, &z, {way(t1), speed(t1), t1}, &next);
      z = next;
    }
    errors.push_back(std::abs(z - exact));
  }
  EXPECT_NEAR(errors[0] / errors[1], 4.0, 0.3);
  EXPECT_NEAR(errors[1] / errors[2], 4.0, 0.3);
}

// Slow loading, as static states take it: Dahl's equation with the force of slow sliding.
TEST(LuGre, IsADahlElementWithoutTime) {
  const auto lugre = made("lugre", values), dahl = made("dahl", {values[0], values[4]});
  double z = 0.0, f = 0.0, u = 0.0;
  for (const double to : {0.01, 0.2, 0.15, -0.3}) {
    double z1 = 0.0, f1 = 0.0;
    const LawAnswer a = lugre->advance({u}, &z, {to}, &z1), b = dahl->advance({u}, &f, {to}, &f1);
    EXPECT_NEAR(a.force, b.force, 1e-14);
    EXPECT_NEAR(a.by_u, b.by_u, 1e-12);
    u = to;
    z = z1;
    f = f1;
  }
}

TEST(LuGre, HasTheSlopesThatBelongToItsForce) {
  const auto law = made("lugre", values);
  const auto* own = dynamic_cast<const LawSlopes*>(law.get());
  ASSERT_NE(own, nullptr);
  struct Motion {
    double u1, rate1, u0, rate0, z;
  };
  const auto end = [&](const Motion& m, double& z) {
    return law->advance({m.u0, m.rate0, 0.5}, &m.z, {m.u1, m.rate1, 0.6}, &z);
  };
  for (const Motion& m : {Motion{0.02, 0.25, 0.0, 0.15, 0.01},
                          {-0.03, -0.4, 0.01, -0.3, 0.012},
                          {0.004, 0.02, 0.0, 0.06, -0.02},
                          {0.05, -0.1, 0.0, 0.4, 0.0}}) {
    double slopes[10] = {}, z = 0.0;
    own->slopes({m.u0, m.rate0, 0.5}, &m.z, {m.u1, m.rate1, 0.6}, slopes);
    const LawAnswer answer = end(m, z);
    EXPECT_EQ(answer.by_u, slopes[0]);
    EXPECT_EQ(answer.by_rate, slopes[1]);
    constexpr double h = 1e-6;
    double Motion::*const quantities[] = {&Motion::u1, &Motion::rate1, &Motion::u0, &Motion::rate0, &Motion::z};
    for (std::size_t i = 0; i < 5; ++i) {
      Motion after = m, before = m;
      after.*quantities[i] += h;
      before.*quantities[i] -= h;
      double z_after = 0.0, z_before = 0.0;
      const double change = end(after, z_after).force - end(before, z_before).force;
      EXPECT_NEAR(slopes[i], change / (2.0 * h), 1e-6 * (1.0 + std::abs(slopes[i]))) << i;
      EXPECT_NEAR(slopes[5 + i], (z_after - z_before) / (2.0 * h), 1e-7) << i;
    }
  }
}

TEST(LuGre, IsASpringWithADamperForSmallMotionsFromRest) {
  const auto law = made("lugre", values);
  const double z = 0.011;
  const LawAnswer answer = law->at({0.3, 0.0, 0.0}, &z);
  EXPECT_EQ(answer.force, values[0] * z);
  EXPECT_EQ(answer.by_u, values[0]);
  EXPECT_DOUBLE_EQ(answer.by_rate, values[1] + values[2]);
}

TEST(LuGre, StoresAndDissipatesItsWork) {
  const auto law = made("lugre", values);
  const auto speed = [](double t) { return 0.3 * std::sin(3.0 * t) + 0.1; };
  const auto way = [](double t) { return -0.1 * std::cos(3.0 * t) + 0.1 * t; };
  constexpr int steps = 4000;
  double z = 0.0, next = 0.0, work = 0.0, lost = 0.0, force = force_of(0.0, speed(0.0));
  for (int i = 0; i < steps; ++i) {
    const double t0 = 3.0 * i / steps, t1 = 3.0 * (i + 1) / steps;
    const LawPoint from{way(t0), speed(t0), t0}, to{way(t1), speed(t1), t1};
    const double after = law->advance(from, &z, to, &next).force, step = law->dissipated(from, &z, to, &next);
    EXPECT_GT(step, -1e-9);
    work += 0.5 * (force + after) * (to.u - from.u);
    lost += step;
    force = after;
    z = next;
  }
  EXPECT_NEAR(work, law->stored_energy(0.0, &z) + lost, 1e-5 * lost);
}

TEST(LuGre, RefusesWhatItCannotBe) {
  for (std::size_t key = 0; key < values.size(); ++key)
    for (const double bad : {-1.0, std::nan("")}) {
      std::vector<double> wrong = values;
      wrong[key] = bad;
      EXPECT_THROW(made("lugre", wrong), InvalidInput) << key;
    }
  for (const std::size_t key : {0u, 3u, 4u, 5u}) {
    std::vector<double> wrong = values;
    wrong[key] = 0.0;
    EXPECT_THROW(made("lugre", wrong), InvalidInput) << key;
  }
  std::vector<double> weak = values;
  weak[4] = 0.9;
  try {
    made("lugre", weak);
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("static_force is 0.9 and coulomb_force 1"), std::string::npos);
  }
}

}  // namespace
}  // namespace rubato::model
