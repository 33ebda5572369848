#include <rubato/analysis/run_study.hpp>

#include "support/ran_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Contacts with a dashpot across them, normal_damping.
namespace rubato::testing {
namespace {

using ::testing::HasSubstr;

constexpr double kn = 4000.0, cn = 40.0, mu = 0.3, speed = 2.0;

std::string contact(const std::string& keys) {
  return "[[contact]]\nname = \"floor\"\ntangential = { x = 1.0 }\nnormal = { y = 1.0 }\ntangential_stiffness = 1e5\n"
         "friction_coefficient = 0.3\nnormal_stiffness = 4000.0\n" +
         keys;
}
/// 1 kg that comes to a plane 0.1 m away at 2 m/s, and slides along it at 5 m/s.
const std::string thrown =
    "[[coordinate]]\nname = \"x\"\nmass = 1.0\nvelocity = 5.0\n[[coordinate]]\nname = \"y\"\nmass = 1.0\nvelocity = "
    "2.0\n" +
    contact("gap = 0.1\nnormal_damping = 40.0\n");
std::string transient(const std::string& step) {
  return "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 0.2\nstep = " + step + "\n";
}

/// How the mass leaves: closed it is an oscillator, p = v0/wd exp(-d t) sin(wd t), until kn p + cn p' = 0.
struct Rebound {
  double t, depth, velocity;
};
Rebound rebound() {
  const double d = 0.5 * cn, wd = std::sqrt(kn - d * d);
  const auto p = [&](double t) { return speed / wd * std::exp(-d * t) * std::sin(wd * t); };
  const auto v = [&](double t) { return speed * std::exp(-d * t) * (std::cos(wd * t) - d / wd * std::sin(wd * t)); };
  double low = 0.25 * M_PI / wd, high = M_PI / wd;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (kn * p(middle) + cn * v(middle) > 0.0 ? low : high) = middle;
  }
  return {0.05 + low, p(low), v(low)};
}

double last(const MemorySink& sink, const std::string& variable, const std::string& label) {
  const auto& table = sink.tables.at("run");
  return table.rows.back().at(table.column(variable, label));
}

TEST(DampedContact, LetsGoWhereItsForceComesToZeroAndNeverPulls) {
  const Rebound exact = rebound();
  EXPECT_GT(exact.depth, 0.002);  // it is compressed still
  const MemorySink sink = run_study(thrown + transient("{ tolerance = 1e-6 }"));
  EXPECT_NEAR(last(sink, "velocity", "y"), exact.velocity, 2e-4);
  EXPECT_NEAR(last(sink, "position", "y"), 0.1 + exact.depth + exact.velocity * (0.2 - exact.t), 1e-4);
  // The impulse of friction is mu times that of N, less half of mu cn v0 over the 48 us until it slips.
  EXPECT_NEAR(last(sink, "velocity", "x"), 5.0 - mu * (speed - exact.velocity) + 0.5 * mu * cn * speed * 48e-6, 1e-5);
  const auto& table = sink.tables.at("run");
  double largest = 0.0;
  for (const auto& row : table.rows) {
    EXPECT_GE(row.at(table.column("normal_force", "floor")), 0.0);
    largest = std::max(largest, row.at(table.column("normal_force", "floor")));
  }
  EXPECT_GT(largest, cn * speed);
  const auto& events = sink.tables.at("run.events");
  ASSERT_GE(events.rows.size(), 2u);
  EXPECT_NEAR(events.rows.front()[0], 0.05, 1e-6);
  EXPECT_NEAR(events.rows.back()[0], exact.t, 1e-5);
}

TEST(DampedContact, ConvergesByEqualSteps) {
  const Rebound exact = rebound();
  const auto error = [&](const std::string& step) {
    const MemorySink sink = run_study(thrown + transient(step));
    return std::abs(last(sink, "velocity", "y") - exact.velocity) +
           std::abs(last(sink, "velocity", "x") - (5.0 - mu * (speed - exact.velocity)));
  };
  // The impulse of the step in which the ends meet is of first order.
  EXPECT_LT(error("1e-4"), 1.5e-2);
  EXPECT_LT(error("1e-5"), 1.5e-3);
}

TEST(DampedContact, BooksWhatItsDashpotTakes) {
  const Rebound exact = rebound();
  const MemorySink sink = run_study(thrown + transient("{ tolerance = 1e-6 }"));
  const auto& ledger = sink.tables.at("run.energy");
  const auto& row = ledger.rows.back();
  const double vx = 5.0 - mu * (speed - exact.velocity);
  EXPECT_NEAR(row.at(ledger.column("law_dissipated")),
              0.5 * (25.0 - vx * vx) + 0.5 * (speed * speed - exact.velocity * exact.velocity), 4e-3);
  EXPECT_LT(std::abs(row.at(ledger.column("residue"))), 2e-3);
}

TEST(DampedContact, DampsModesWhereItIsClosedAndNoStaticState) {
  const std::string pressed =
      "[[coordinate]]\nname = \"x\"\nmass = 1.0\n[[coordinate]]\nname = \"y\"\nmass = 1.0\n"
      "[[spring]]\nbetween = [\"x\", \"ground\"]\nstiffness = 100.0\n" +
      contact("normal_load = 80.0\nnormal_damping = 40.0\n") +
      "[[force]]\non = \"y\"\nheld = 20.0\n[[analysis]]\nname = \"rest\"\ntype = \"static\"\n"
      "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n"
      "[[analysis]]\nname = \"limits\"\ntype = \"modes\"\ncontacts = [\"stuck\", \"open\"]\n";
  const MemorySink sink = run_study(pressed);
  EXPECT_NEAR(value_of(sink, "rest", "position", "y"), (20.0 - 80.0) / kn, 1e-12);
  const double ratio = cn / (2.0 * std::sqrt(kn));
  EXPECT_NEAR(value_of(sink, "modes", "damping_ratio", "", 1), ratio, 1e-9);  // free: x alone is undamped
  EXPECT_NEAR(value_of(sink, "modes", "damping_ratio", "", 2), ratio, 1e-9);  // stuck
  EXPECT_NEAR(value_of(sink, "limits", "damping_ratio", "", 0), ratio, 1e-9);
  EXPECT_NEAR(value_of(sink, "limits", "damping_ratio", "", 3), 0.0, 1e-12);  // open
}

TEST(DampedContact, IsRefusedByFrequencyResponses) {
  const std::string study = "[parameters]\nOmega = 3.0\n" + thrown +
                            "[[spring]]\nbetween = [\"x\", \"ground\"]\nstiffness = 1.0\n[[spring]]\nbetween = [\"y\", "
                            "\"ground\"]\nstiffness = "
                            "1.0\n[[force]]\non = \"y\"\namplitude = 2.0\nangular_frequency = \"Omega\"\n"
                            "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = { from = "
                            "1.0, to = 8.0, points = "
                            "5 }\n";
  for (const char* solver : {"", "solver = \"harmonic_balance\"\n", "solver = \"time_marching\"\n"}) {
    try {
      run_study(study + solver);
      FAIL() << solver;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.message(),
                  HasSubstr("the contact \"floor\" has a normal_damping, which steady responses do not "
                            "carry yet; run a transient"));
    }
  }
}

}  // namespace
}  // namespace rubato::testing
