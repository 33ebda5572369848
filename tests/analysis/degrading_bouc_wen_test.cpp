#include <rubato/analysis/run_study.hpp>

#include "support/mechanism_study.hpp"
#include "support/ran_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

// Bouc-Wen elements that degrade (Baber and Wen 1981), in studies.
namespace rubato::testing {
namespace {

using ::testing::HasSubstr;

const std::string element =
    "[[bouc_wen]]\nname = \"foot\"\nbetween = [\"x\", \"ground\"]\nstiffness = 40.0\npost_yield_ratio = 0.1\n"
    "beta = 0.6\ngamma = 0.3\nn = 2\ndegradation = { A = 0.01, nu = 0.05, eta = 0.02 }\n";
const std::string mass =
    "[[coordinate]]\nname = \"x\"\nmass = 1.0\nvelocity = 0.2\n"
    "[[damper]]\nbetween = [\"x\", \"ground\"]\ndamping = 0.3\n";
const std::string load =
    "[[force]]\non = \"x\"\namplitude = 9.0\nphase = \"-pi/2\"\nangular_frequency = \"Omega\"\n[parameters]\nOmega = "
    "5.0\nk = 3.0\n";

std::string transient(const std::string& step) {
  return "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 8.0\noutput = { times = [1.0, 2.0, 4.0, 8.0] "
         "}\nstep = " +
         step + "\n";
}

// Of the equations as they are published, by DOP853 of SciPy with steps of 0.2 ms and a tolerance of 1e-12: t, x and e.
// At the end A is 0.48, nu 3.6 and eta 2.0.
struct Reference {
  double t, x, e;
};
const Reference references[] = {{1.0, -0.527541326, 5.168136428},
                                {2.0, 0.322095030, 7.237299634},
                                {4.0, -1.459433847, 45.385400521},
                                {8.0, -0.178271245, 51.882433511}};

double error_of(const std::string& step) {
  const MemorySink sink = run_study(mass + element + load + transient(step));
  const auto& table = sink.tables.at("run");
  double largest = 0.0;
  std::size_t row = 0;
  for (const Reference& reference : references) {
    while (row < table.rows.size() && table.rows[row][0] < reference.t - 1e-9) ++row;
    largest = std::max(largest, std::abs(table.rows.at(row).at(table.column("position", "x")) - reference.x));
  }
  return largest;
}

TEST(DegradingBoucWenInATransient, MovesAsByAnotherIntegrator) {
  EXPECT_LT(error_of("0.0005"), 3e-5);
  EXPECT_GT(error_of("0.004"), 20.0 * error_of("0.0005"));  // a trend of the second order over an eighth of the step
  for (const char* tolerance : {"1e-3", "1e-4", "1e-5"})
    EXPECT_LT(error_of(std::string("{ tolerance = ") + tolerance + " }"), 40.0 * std::stod(tolerance)) << tolerance;
}

// A pair of high order ends its steps where the motion turns and where z passes zero.
TEST(DegradingBoucWenInATransient, MovesAsByAnotherIntegratorToManyDigitsByAPair) {
  const MemorySink sink = run_study(mass + element + load +
                                    "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 8.0\n"
                                    "method = \"dormand_prince\"\nstep = { tolerance = 1e-9 }\n");
  const auto& table = sink.tables.at("run");
  EXPECT_NEAR(table.rows.back().at(table.column("position", "x")), references[3].x, 3e-7);
}

// e is what is stored and dissipated of the hysteretic part, by the ledger's own formulas.
TEST(DegradingBoucWenInATransient, BooksTheWorkThatDegradesIt) {
  const MemorySink sink = run_study(mass + element + load + transient("{ tolerance = 1e-6 }"));
  const auto& ledger = sink.tables.at("run.energy");
  const auto& last = ledger.rows.back();
  EXPECT_LT(std::abs(last.at(ledger.column("residue"))), 2e-3);
  const auto& table = sink.tables.at("run");
  const double u = table.rows.back().at(table.column("displacement", "foot"));
  EXPECT_NEAR(last.at(ledger.column("law_stored")) + last.at(ledger.column("law_dissipated")) - 0.5 * 4.0 * u * u,
              references[3].e, 2e-3);
}

TEST(DegradingBoucWen, IsASpringInModesAndLoadsFromZeroInStaticStates) {
  const MemorySink sink =
      run_study(mass + element +
                "[[force]]\non = \"x\"\nheld = 20.0\n[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n"
                "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  EXPECT_NEAR(value_of(sink, "modes", "angular_frequency"), std::sqrt(40.0), 1e-9);
  // The equations from zero: dz/du and de/du by Runge's and Kutta's method until the force is met.
  double u = 0.0, z = 0.0, e = 0.0;
  const double h = 1e-5;
  const auto rate = [](double at, double work) {
    return (1.0 - 0.01 * work - (1.0 + 0.05 * work) * at * at * 0.9) / (1.0 + 0.02 * work);
  };
  while (4.0 * u + 36.0 * z < 20.0) {
    const double half = z + 0.5 * h * rate(z, e), e_half = e + 0.5 * h * 36.0 * z;
    z += h * rate(half, e_half);
    e += h * 36.0 * half;
    u += h;
  }
  EXPECT_NEAR(value_of(sink, "rest", "position", "x"), u, 2e-5);
}

TEST(DegradingBoucWen, IsRefusedWhereMotionsMustRepeat) {
  const auto refusal = [](const std::string& study) {
    try {
      run_study(study);
    } catch (const InvalidInput& error) {
      return error.message();
    }
    return std::string("it ran");
  };
  const std::string response =
      "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = { from = 1.0, to = 8.0, points "
      "= 5 }\n";
  for (const char* solver : {"", "solver = \"harmonic_balance\"\n", "solver = \"time_marching\"\n"})
    EXPECT_THAT(
        refusal(mass + element + load + response + solver),
        HasSubstr("the bouc_wen \"foot\" degrades with all that is done on it (degradation), so that no motion of "
                  "it repeats; run a transient, or leave degradation out"))
        << solver;
  EXPECT_THAT(refusal(mass + element + load + response + "solver = \"periodic\"\n"), HasSubstr("foot"));
  EXPECT_THAT(refusal(mass + element + load +
                      "[[spring]]\nbetween = [\"x\", \"ground\"]\nstiffness = \"k\"\n"
                      "[[analysis]]\nname = \"curve\"\ntype = \"damper_curve\"\nparameter = \"k\"\nrange = [1.0, 8.0]\n"
                      "angular_frequency = { from = 1.0, to = 8.0 }\nobserve = [\"x\"]\n"),
              HasSubstr("degrades with all that is done on it"));
}

}  // namespace
}  // namespace rubato::testing
