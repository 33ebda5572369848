#include <rubato/analysis/run_study.hpp>

#include "support/mechanism_study.hpp"
#include "support/ran_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Sliders whose coefficient of friction depends on the speed.
namespace rubato::testing {
namespace {

using ::testing::HasSubstr;

/// 1 kg on a belt, seen from the belt: a spring of 20 N/m is pulled at 20 mm/s.
std::string mass_on_belt(const std::string& coefficient) {
  return "[[coordinate]]\nname = \"x\"\nmass = 1.0\n[[spring]]\nbetween = [\"x\", \"ground\"]\nstiffness = 20.0\n"
         "[[damper]]\nbetween = [\"x\", \"ground\"]\ndamping = 8.0\n[[force]]\non = \"x\"\nexpression = \"0.4*t\"\n"
         "[[slider]]\nname = \"rub\"\nbetween = [\"x\", \"ground\"]\nstiffness = 400.0\nnormal_load = 10.0\n"
         "friction_coefficient = \"" +
         coefficient + "\"\n";
}
const std::string falling = "0.3 + 0.2*exp(-abs(rate)/0.05)";
std::string transient(const std::string& step, double duration = 24.0) {
  return "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = " + std::to_string(duration) +
         "\noutput = { interval = 4.0 }\nstep = " + step + "\n";
}

// By DOP853 of SciPy between events, tolerance 1e-12: |f| = mu(0) N, and the slip rate du/dt - f'/kT = 0.
struct Reference {
  double t, x, force;
};
const Reference references[] = {{12.0, 0.0114104308, 4.56417234},
                                {16.0, 0.1021468812, 4.34926740},
                                {20.0, 0.1928788305, 4.13256625},
                                {24.0, 0.2836257438, 3.92185076}};
const double slips[] = {13.144047619, 17.707732910, 22.271418015},
             sticks[] = {13.955456355, 18.519141514, 23.082826619};

double error_of(const MemorySink& sink) {
  const auto& table = sink.tables.at("run");
  double largest = 0.0;
  std::size_t row = 0;
  for (const Reference& reference : references) {
    while (row + 1 < table.rows.size() && table.rows[row][0] < reference.t - 1e-9) ++row;
    largest = std::max(largest, std::abs(table.rows[row].at(table.column("position", "x")) - reference.x));
    EXPECT_NEAR(table.rows[row].at(table.column("force", "rub")), reference.force, 0.1);
  }
  return largest;
}

TEST(FrictionOfSpeed, SticksAndSlipsAsByAnotherIntegrator) {
  const auto error = [](const std::string& step) {
    return error_of(run_study(mass_on_belt(falling) + transient(step)));
  };
  const double fine = error("0.0005");
  EXPECT_LT(fine, 2e-5);
  EXPECT_GT(error("0.008") + error("0.005"), 10.0 * fine);  // steps that meet events anywhere scatter
  EXPECT_LT(error("{ tolerance = 1e-4 }"), 1e-3);
  EXPECT_LT(error("{ tolerance = 1e-5 }"), 1e-4);
  EXPECT_LT(error("{ tolerance = 1e-6, events = \"locate\" }"), 2e-5);
}

TEST(FrictionOfSpeed, TellsWhenItSlipsAndSticks) {
  const MemorySink sink = run_study(mass_on_belt(falling) + transient("{ tolerance = 1e-6, events = \"locate\" }"));
  const auto& events = sink.tables.at("run.events");
  ASSERT_EQ(events.rows.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(events.rows[2 * i][0], slips[i], 5e-4);
    // The end of a slip is located where the ends rest, and the slip rate vanishes a little before.
    EXPECT_NEAR(events.rows[2 * i + 1][0], sticks[i], 2e-3);
  }
}

// The work of friction is that of the force over the slip: while it slips (mu0 + mu1 exp(-v/v0)) N v.
TEST(FrictionOfSpeed, DissipatesItsForceTimesTheSlip) {
  const MemorySink sink = run_study(mass_on_belt(falling) +
                                    "[[analysis]]\nname = \"run\"\ntype = \"transient\"\n"
                                    "duration = 24.0\nstep = 0.0005\n");
  const auto& table = sink.tables.at("run");
  const std::size_t f = table.column("force", "rub"), slip = table.column("slip", "rub");
  double work = 0.0;
  for (std::size_t i = 1; i < table.rows.size(); ++i)
    work += 0.5 * (table.rows[i][f] + table.rows[i - 1][f]) * (table.rows[i][slip] - table.rows[i - 1][slip]);
  EXPECT_NEAR(table.rows.back().at(table.column("dissipated", "rub")), work, 1e-4 * work);
  const auto& ledger = sink.tables.at("run.energy");
  for (const auto& row : ledger.rows) EXPECT_LT(std::abs(row.at(ledger.column("residue"))), 1e-4);
}

// Sliding on at V: the spring holds mu(V) N and the damper nothing more than c V.
TEST(FrictionOfSpeed, SlidesOnSteadilyWhereItGrowsWithTheSpeed) {
  const MemorySink sink = run_study(mass_on_belt("0.2 + 3*abs(rate)") + transient("{ tolerance = 1e-6 }"));
  const auto& table = sink.tables.at("run");
  EXPECT_NEAR(table.rows.back().at(table.column("force", "rub")), 10.0 * (0.2 + 3.0 * 0.02),
              1e-4);  // within exp(-19/1.9) of the start
  EXPECT_NEAR(table.rows.back().at(table.column("velocity", "x")), 0.02, 1e-6);
}

TEST(FrictionOfSpeed, IsThatOfASliderWhereItDoesNotDependOnIt) {
  const auto end = [](const std::string& coefficient) {
    const MemorySink sink = run_study(mass_on_belt(coefficient) + transient("0.01"));
    return value_of(sink, "run", "position", "x", sink.tables.at("run").rows.size() - 1);
  };
  EXPECT_NEAR(end("0.4 + 0*rate"), end("0.4"), 1e-12);
}

// In static states nothing moves: mu is that at rest, here 0.5.
TEST(FrictionOfSpeed, HoldsAsAtRestInStaticStatesAndModes) {
  const MemorySink sink =
      run_study(mass_on_belt(falling) +
                "[[force]]\non = \"x\"\nheld = 25.0\n[[analysis]]\nname = \"rest\"\ntype = \"static\"\n"
                "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n");
  EXPECT_NEAR(value_of(sink, "rest", "position", "x"), (25.0 - 5.0) / 20.0, 1e-12);
  EXPECT_NEAR(value_of(sink, "modes", "angular_frequency"), std::sqrt(20.0), 1e-9);
  EXPECT_NEAR(value_of(sink, "modes", "angular_frequency", "", 1), std::sqrt(420.0), 1e-9);
}

// A stop presses, and friction is that of the moment.
TEST(FrictionOfSpeed, IsPressedByAStop) {
  const std::string pressed =
      "[[coordinate]]\nname = \"x\"\nmass = 1.0\n[[coordinate]]\nname = \"y\"\nmass = 1.0\n"
      "[[stop]]\nname = \"floor\"\nbetween = [\"y\", \"ground\"]\ngap = 0.0\nstiffness = 500.0\ndamping = 20.0\n"
      "[[force]]\non = \"y\"\nexpression = \"10 + 2*sin(t)\"\n[[force]]\non = \"x\"\nexpression = \"8\"\n"
      "[[slider]]\nname = \"rub\"\nbetween = [\"x\", \"ground\"]\nstiffness = 400.0\n"
      "normal_load = { law = \"floor\" }\nfriction_coefficient = \"" +
      falling + "\"\n";
  const MemorySink sink = run_study(pressed + transient("{ tolerance = 1e-5 }", 8.0));
  const auto& table = sink.tables.at("run");
  const auto& row = table.rows.back();
  const double v = row.at(table.column("velocity", "x"));
  EXPECT_GT(v, 1.0);
  EXPECT_NEAR(row.at(table.column("force", "rub")),
              (0.3 + 0.2 * std::exp(-v / 0.05)) * row.at(table.column("force", "floor")), 1e-9);
}

TEST(FrictionOfSpeed, OfAMechanismIsThatOfAStructure) {
  const std::string body =
      "[[body]]\nname = \"block\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\n"
      "[[spring]]\nbetween = [\"block.x\", \"ground\"]\nstiffness = 20.0\n"
      "[[damper]]\nbetween = [\"block.x\", \"ground\"]\ndamping = 8.0\n"
      "[[force]]\non = \"block.x\"\nexpression = \"0.4*t\"\n"
      "[[slider]]\nname = \"rub\"\nbetween = [\"block.x\", \"ground\"]\nstiffness = 400.0\nnormal_load = 10.0\n"
      "friction_coefficient = \"" +
      falling + "\"\n";
  const MechanismStudy mechanism(body + transient("{ tolerance = 1e-6 }"));
  ASSERT_EQ(mechanism.report.status, analysis::RunStatus::done) << mechanism.report.message;
  EXPECT_NEAR(mechanism.last("run", "position", "block.x"), references[3].x, 1e-4);
}

std::string refusal(const std::string& study) {
  try {
    run_study(study);
  } catch (const InvalidInput& error) {
    return error.message();
  }
  return "it ran";
}

TEST(FrictionOfSpeed, IsRefusedWhereItIsNotCarried) {
  std::string swinging = mass_on_belt(falling);
  swinging.replace(swinging.find("expression = \"0.4*t\""), 20, "amplitude = 2.0\nangular_frequency = \"Omega\"");
  swinging += "[parameters]\nOmega = 3.0\nk = 1.0\n[[spring]]\nbetween = [\"x\", \"ground\"]\nstiffness = \"k\"\n";
  const std::string response =
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = { from = 1.0, to = 8.0, points "
      "= "
      "5 }\n";
  const auto refused = HasSubstr(
      "the slider \"rub\" has a friction_coefficient that depends on the rate, which steady responses do not carry; "
      "run a "
      "transient, or take a [[lugre]]");
  for (const char* solver : {"", "solver = \"harmonic_balance\"\n", "solver = \"time_marching\"\n"})
    EXPECT_THAT(refusal(swinging + response + solver), refused) << solver;
  EXPECT_THAT(refusal(swinging + response + "solver = \"periodic\"\n"), HasSubstr("\"rub\""));
  EXPECT_THAT(refusal(swinging +
                      "[[analysis]]\nname = \"curve\"\ntype = \"damper_curve\"\nparameter = \"k\"\nrange = [1.0, 8.0]\n"
                      "angular_frequency = { from = 1.0, to = 8.0 }\nobserve = [\"x\"]\n"),
              refused);
  EXPECT_THAT(refusal(mass_on_belt(falling) +
                      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nmethod = \"exact\"\nduration = 1.0\n"),
              HasSubstr("\"rub\""));
}

TEST(FrictionOfSpeed, RefusesFormulasThatAreNoFriction) {
  EXPECT_THAT(refusal(mass_on_belt("0.5 - rate") + transient("0.01")),
              ::testing::AllOf(HasSubstr("friction_coefficient is -"), HasSubstr("must not be negative at any")));
  EXPECT_THAT(refusal(mass_on_belt("0.5*rate + velocity") + transient("0.01")), HasSubstr("velocity"));
  EXPECT_THAT(refusal("coordinate = [{ name = \"x\", mass = 1.0 }, { name = \"y\", mass = 1.0 }]\n[[contact]]\nname = "
                      "\"c\"\ntangential = { x = 1.0 }\nnormal = { y = 1.0 }\ntangential_stiffness = 1.0\n"
                      "normal_stiffness = 1.0\nfriction_coefficient = \"" +
                      falling + "\"\n" + transient("0.01")),
              HasSubstr("contact \"c\": friction_coefficient depends on the rate, which contacts do not take; take a "
                        "[[slider]]"));
}

TEST(FrictionOfSpeed, IsRefusedUnderAReaction) {
  const std::string study =
      "[[body]]\nname = \"b\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\n[[joint]]\nname = \"rail\"\n"
      "type = \"prismatic\"\nbetween = [\"ground\", \"b\"]\nat = [0.0, 0.0]\naxis = [1.0, 0.0]\n[[slider]]\n"
      "joint = \"rail\"\nstiffness = 1.0\nnormal_load = \"reaction\"\nfriction_coefficient = \"" +
      falling + "\"\n" + transient("0.01");
  try {
    const MechanismStudy mechanism(study);
    FAIL() << "it ran";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.message(), HasSubstr("friction_coefficient depends on the rate, and normal_load is a reaction"));
  }
}

}  // namespace
}  // namespace rubato::testing
