#include <rubato/core/error.hpp>

#include <support/ran_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

// Modes in limits of contacts that the study asks for: open, stuck, frictionless, as in the static state, and sliding
// steadily, where friction makes the stiffness unsymmetric and two modes may flutter.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::run_study;
using testing::value_of;
using Complex = std::complex<double>;

/// Mass 1 on x and z, K = [[11, -4], [-4, 5]], a contact of kn = 10 that slides along x and presses along z.
std::string brake(double mu, double damping, const std::string& contacts, const std::string& more = "") {
  return "[parameters]\nmu = " + std::to_string(mu) + "\nc = " + std::to_string(damping) + R"(
[[coordinate]]
name = "x"
mass = 1.0
[[coordinate]]
name = "z"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 7.0
[[spring]]
between = ["z", "ground"]
stiffness = 1.0
[[spring]]
between = ["x", "z"]
stiffness = 4.0
[[damper]]
between = ["x", "ground"]
damping = "c"
[[damper]]
between = ["z", "ground"]
damping = "c"
[[contact]]
name = "pad"
tangential = { x = 1.0 }
normal = { z = 1.0 }
tangential_stiffness = 50.0
normal_stiffness = 10.0
friction_coefficient = "mu"
[[analysis]]
name = "modes"
type = "modes"
contacts = )" +
         contacts + "\n" + more;
}

Complex eigenvalue(const testing::MemorySink& sink, std::size_t row) {
  return {value_of(sink, "modes", "eigenvalue_real", "", row),
          value_of(sink, "modes", "eigenvalue_imaginary", "", row)};
}

std::string refusal(const std::string& text) {
  try {
    (void)run_study(text);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "accepted";
}

std::vector<std::string> warnings_of(const std::string& text) {
  const testing::PreparedStudy prepared(text);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  return analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context).warnings;
}

// Friction-family reference, problem F: eigenvalues at mu = 0.3 and 0.6, to their digits.
TEST(ContactLimits, OfASlidingPadAreThoseOfModeCoupling) {
  const auto at3 = run_study(brake(0.3, 0.02, "[{ sliding = { pad = 1 } }]"));
  EXPECT_NEAR(std::abs(eigenvalue(at3, 0) - Complex(-0.01, 3.18927466)), 0.0, 6e-9);
  EXPECT_NEAR(std::abs(eigenvalue(at3, 1) - Complex(-0.01, 3.97848302)), 0.0, 6e-9);
  const auto at6 = run_study(brake(0.6, 0.02, "[{ sliding = { pad = 1 } }]"));
  EXPECT_NEAR(std::abs(eigenvalue(at6, 0) - Complex(0.26653897, 3.61612691)), 0.0, 8e-9);
  EXPECT_NEAR(std::abs(eigenvalue(at6, 1) - Complex(-0.28653897, 3.61612691)), 0.0, 8e-9);
  EXPECT_LT(value_of(at6, "modes", "damping_ratio", "", 0), 0.0);
}

// det(K - l) = 0 with l = 13 -+ sqrt(20 - 40 mu); with C = c I, s^2 + c s + l = 0, which grows where Im(l)^2 > c^2
// Re(l): from mu = 1/2 + 13 c^2/40 on.
TEST(ContactLimits, ModesThatMeetFlutterFromTheClosedFormThresholdOn) {
  for (const double c : {0.0, 0.02, 0.4}) {
    const double threshold = 0.5 + 13.0 * c * c / 40.0;
    for (const double mu : {0.1, threshold - 1e-4, threshold + 1e-4, 1.2}) {
      SCOPED_TRACE(::testing::Message() << "c = " << c << ", mu = " << mu);
      const std::string study = brake(mu, c, "[{ sliding = { pad = 1 } }]");
      const Complex root = std::sqrt(Complex(20.0 - 40.0 * mu));
      double growth = -1.0;
      for (const Complex& l : {13.0 - root, 13.0 + root})
        for (const double sign : {-1.0, 1.0})
          growth = std::max(growth, (-0.5 * c + sign * std::sqrt(Complex(0.25 * c * c) - l)).real());
      const auto sink = run_study(study);
      const double found = std::max(eigenvalue(sink, 0).real(), eigenvalue(sink, 1).real());
      EXPECT_NEAR(found, growth, 1e-9);
      EXPECT_EQ(found > 1e-9, mu > threshold);
      const std::vector<std::string> warnings = warnings_of(study);
      ASSERT_EQ(warnings.size(), mu > threshold ? 1u : 0u);
      if (mu < threshold) continue;
      EXPECT_THAT(warnings.front(), ::testing::AllOf(HasSubstr("limit sliding: mode "),
                                                     HasSubstr("flutters, its frequency having met that of mode "),
                                                     HasSubstr("negative damping ratio")));
    }
  }
}

// Against the rotation the coupling is -4 - 10 mu on one side: the modes part, and none grows.
TEST(ContactLimits, TheDirectionOfSlidingDecidesWhetherModesMeet) {
  const double mu = 0.6;
  const auto sink = run_study(brake(mu, 0.0, "[{ sliding = { pad = \"-1\" } }, { sliding = { pad = 1 } }]"));
  const double root = std::sqrt(20.0 + 40.0 * mu);
  EXPECT_NEAR(std::abs(eigenvalue(sink, 0) - Complex(0.0, std::sqrt(13.0 - root))), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(eigenvalue(sink, 1) - Complex(0.0, std::sqrt(13.0 + root))), 0.0, 1e-12);
  const auto& table = sink.tables.at("modes");
  EXPECT_EQ(table.layout.blocks.front().categories, (std::vector<std::string>{"sliding", "sliding2"}));
  EXPECT_EQ(value_of(sink, "modes", "limit", "", 2), 1.0);
}

TEST(ContactLimits, OfAPadHaveItsSpringsAndNoFrictionInTheOtherLimits) {
  const auto sink = run_study(brake(0.6, 0.0, R"(["open", "frictionless", "stuck"])"));
  const double expected[][3] = {{11.0, 5.0, -4.0}, {11.0, 15.0, -4.0}, {61.0, 15.0, -4.0}};
  for (std::size_t limit = 0; limit < 3; ++limit) {
    const auto [a, b, coupling] = expected[limit];
    const double middle = 0.5 * (a + b), root = std::hypot(0.5 * (a - b), coupling);
    EXPECT_NEAR(eigenvalue(sink, 2 * limit).imag(), std::sqrt(middle - root), 1e-13);
    EXPECT_NEAR(eigenvalue(sink, 2 * limit + 1).imag(), std::sqrt(middle + root), 1e-13);
  }
}

// Nothing is above mu N in modes: a contact that is pressed in the static state is stuck, and one that gapes is open; a
// stop that rests is a spring; a cubic spring has its slope there.
TEST(ContactLimits, AsInTheStaticStateFollowTheLoads) {
  for (const double load : {2.0, -2.0}) {
    const auto sink = run_study(R"(
[[coordinate]]
name = "x"
mass = 1.0
[[coordinate]]
name = "z"
mass = 1.0
[[coordinate]]
name = "y"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 1.0
[[spring]]
between = ["z", "ground"]
stiffness = 2.0
[[nonlinear_spring]]
between = ["y", "ground"]
force = "u + u^3"
[[stop]]
between = ["y", "ground"]
gap = 0.5
stiffness = 3.0
[[contact]]
name = "pad"
tangential = { x = 1.0 }
normal = { z = 1.0 }
tangential_stiffness = 5.0
normal_stiffness = 7.0
friction_coefficient = 0.4
[[force]]
on = "z"
expression = ")" + std::to_string(load) +
                                R"("
[[force]]
on = "y"
expression = ")" + std::to_string(load) +
                                R"("
[[analysis]]
name = "modes"
type = "modes"
contacts = ["static"]
)");
    // y + y^3 (+ 3 (y - 0.5)) = load
    double y = load;
    for (int i = 0; i < 60; ++i) {
      const double closed = y > 0.5 ? 3.0 : 0.0;
      y -= (y + y * y * y + closed * (y - 0.5) - load) / (1.0 + 3.0 * y * y + closed);
    }
    std::vector<double> squares{load > 0.0 ? 6.0 : 1.0, load > 0.0 ? 9.0 : 2.0,
                                1.0 + 3.0 * y * y + (y > 0.5 ? 3.0 : 0.0)};
    std::sort(squares.begin(), squares.end());
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(std::pow(value_of(sink, "modes", "angular_frequency", "", i), 2), squares[i], 1e-12) << load;
  }
}

// The same pad, its coordinates, springs and words in another order.
TEST(ContactLimits, DoNotDependOnTheOrderOfParts) {
  const auto one = run_study(brake(0.6, 0.02, "[{ sliding = { pad = 1 } }]"));
  const auto other = run_study(R"(
[[contact]]
name = "pad"
tangential = { x = -1.0 }
normal = { z = 1.0 }
tangential_stiffness = 50.0
normal_stiffness = 10.0
friction_coefficient = 0.6
[[spring]]
between = ["x", "z"]
stiffness = 4.0
[[damper]]
between = ["ground", "z"]
damping = 0.02
[[damper]]
between = ["ground", "x"]
damping = 0.02
[[spring]]
between = ["ground", "z"]
stiffness = 1.0
[[spring]]
between = ["ground", "x"]
stiffness = 7.0
[[coordinate]]
name = "z"
mass = 1.0
[[coordinate]]
name = "x"
mass = 1.0
[[analysis]]
name = "modes"
type = "modes"
contacts = ["stuck", { sliding = { pad = -1 } }]
)");
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(std::abs(eigenvalue(one, i) - eigenvalue(other, 2 + i)), 0.0, 1e-13);
}

TEST(ContactLimits, OfASweepHeadTheirColumns) {
  const auto sink =
      run_study(brake(0.3, 0.02, R"(["stuck", { sliding = { pad = 1 } }])", "sweep = { mu = [0.3, 0.6] }"));
  EXPECT_NEAR(value_of(sink, "modes", "damping_ratio", "sliding.mode1", 0), 0.01 / std::hypot(0.01, 3.18927466), 1e-9);
  EXPECT_NEAR(value_of(sink, "modes", "damping_ratio", "sliding.mode1", 1),
              -0.26653897 / std::hypot(0.26653897, 3.61612691), 1e-9);
}

TEST(ContactLimits, AreRefusedWhereTheyHaveNoMeaning) {
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[{ sliding = { pat = 1 } }]")),
              HasSubstr("\"pat\" is no [[contact]] of this study; did you mean \"pad\"?"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[{ sliding = { pad = 0.5 } }]")),
              HasSubstr("slides in the direction 1 or -1 of its u, got 0.5"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[{ sliding = {} }]")), HasSubstr("lacks the key \"sliding\""));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[\"slidin\"]")), HasSubstr("takes no \"slidin\""));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[\"sliding\"]")), HasSubstr("write { sliding = { NAME = 1 } }"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "\"stuck\"")), HasSubstr("a list such as"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[\"stuck\", \"stuck\"]")), HasSubstr("names \"stuck\" twice"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[{ sliding = { pad = 1, at = 2 } }]")), HasSubstr("\"at\" is no [[contact]]"));
  EXPECT_THAT(refusal(brake(0.3, 0.0, "[{ slide = 1 }]")), HasSubstr("lacks the key \"sliding\": { NAME = 1 }"));
  std::string two = brake(0.3, 0.0, "[{ sliding = { pad = 1 } }]");
  two.replace(two.find("{ x = 1.0 }"), 11, "[{ x = 1.0 }, { x = 0.5, z = 0.5 }]");
  EXPECT_THAT(refusal(two), HasSubstr("slides, and rubs in two directions"));
}

}  // namespace
}  // namespace rubato
