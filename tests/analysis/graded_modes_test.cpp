#include <rubato/analysis/modes.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include <support/mechanism_study.hpp>
#include <support/prepared_study.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>

// Modes of models in which something is light and very stiff, as users make links that are to be rigid.
namespace rubato::analysis {
namespace {

struct Recorded {
  testing::MemorySink sink;
  RunReport report;
  double at(std::size_t row, const std::string& variable) const {
    const auto& table = sink.tables.at("modes");
    return table.rows.at(row).at(table.column(variable, ""));
  }
};

Recorded run(const std::string& text) {
  const testing::PreparedStudy study(text + "\n[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n");
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{result.sink, progress, stop};
  const integrate::StructureKind kind(study.system);
  result.report = run_modes("modes", plan_modes("modes", {}, {}, kind, study.parameters), kind, context);
  return result;
}

/// A portal of two columns of 3 m and a beam of 3.4 m, joined by links of 0.3 m.
std::string portal(const std::string& young, const std::string& density) {
  return R"(
node = [{ name = "A", position = [0.0, 0.0] }, { name = "B", position = [0.0, 3.0] },
        { name = "b", position = [0.3, 3.0] }, { name = "c", position = [3.7, 3.0] },
        { name = "C", position = [4.0, 3.0] }, { name = "D", position = [4.0, 0.0] }]
material = [{ name = "steel", young = 2.1e11, poisson = 0.3, density = 7800.0 },
            { name = "link", young = )" +
         young + ", poisson = 0.3, density = " + density + R"( }]
section = [{ name = "tube", area = 3.2e-4, inertia = 1.707e-8, shear_factor = 0.83 }]
beam = [{ name = "left", nodes = ["A", "B"], section = "tube", material = "steel", elements = 4 },
        { name = "near", nodes = ["B", "b"], section = "tube", material = "link", elements = 2 },
        { name = "top", nodes = ["b", "c"], section = "tube", material = "steel", elements = 4 },
        { name = "far", nodes = ["c", "C"], section = "tube", material = "link", elements = 2 },
        { name = "right", nodes = ["C", "D"], section = "tube", material = "steel", elements = 4 }]
support = [{ node = "A", fix = ["x", "y", "rz"] }, { node = "D", fix = ["x", "y", "rz"] }]
)";
}

// The mass of links of 1 kg/m3, 2e-4 kg of 26, lowers frequencies by about 1e-5, and at that density all solvers agree.
// Links ten thousand times as stiff as steel are rigid to that as well.
TEST(GradedModes, OfAFrameWithLightStiffLinksAreThoseOfRigidLinks) {
  const Recorded heavier = run(portal("2.1e13", "1.0"));
  for (const char* young : {"2.1e13", "2.1e15", "2.1e17"}) {
    const Recorded light = run(portal(young, "1e-6"));
    ASSERT_EQ(light.report.status, RunStatus::done) << light.report.message;
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR(light.at(i, "frequency") / heavier.at(i, "frequency"), 1.0,
                  std::string(young) == "2.1e13" ? 3e-5 : 2e-3);
  }
}

TEST(GradedModes, AtZeroAreToldAsRigidMotions) {
  const Recorded free = run(R"(
coordinate = [{ name = "a", mass = 1.0 }, { name = "b", mass = 2.0 }]
spring = [{ between = ["a", "b"], stiffness = 100.0 }])");
  EXPECT_EQ(free.at(0, "frequency"), 0.0);
  EXPECT_EQ(free.report.findings, std::vector<std::string>{"mode 1 is at 0 Hz: a rigid motion"});
  EXPECT_TRUE(free.report.warnings.empty());
}

// 1e18 N/m rounds to 128 N/m: the spring of 1 N/m that holds the pair is lost when K is assembled.
TEST(GradedModes, BelowRoundOffAreToldAsThat) {
  const Recorded hidden = run(R"(
coordinate = [{ name = "a", mass = 1.0 }, { name = "b", mass = 1.0 }, { name = "c", mass = 1.0 }]
spring = [{ between = ["a", "ground"], stiffness = 1.0 }, { between = ["a", "b"], stiffness = 1e18 },
          { between = ["c", "ground"], stiffness = 25.0 }])");
  EXPECT_EQ(hidden.at(0, "frequency"), 0.0);
  EXPECT_NEAR(hidden.at(1, "angular_frequency"), 5.0, 1e-12);
  ASSERT_EQ(hidden.report.warnings.size(), 1u);
  EXPECT_EQ(hidden.report.warnings[0].find("mode 1 is at 0 Hz: below the round-off of the stiffness; it is rigid, or "
                                           "anywhere up to "),
            0u)
      << hidden.report.warnings[0];
}

TEST(GradedModes, KnownToAFewDigitsAreToldSo) {
  const Recorded poor = run(R"(
coordinate = [{ name = "a", mass = 1.0 }, { name = "b", mass = 1.0 }]
spring = [{ between = ["a", "ground"], stiffness = 50.0 }, { between = ["a", "b"], stiffness = 1e16 }])");
  EXPECT_NEAR(poor.at(0, "angular_frequency"), 5.0, 0.1);  // 50 rounds to the next even number beside 1e16
  ASSERT_EQ(poor.report.warnings.size(), 1u);
  EXPECT_EQ(poor.report.warnings[0].find("mode 1 is known to "), 0u) << poor.report.warnings[0];
}

// Damping by modes is made of their frequencies and shapes; those of a chain are sines, whatever shakes beside it.
TEST(GradedModes, AreDampedByTheRatioThatIsGiven) {
  constexpr int count = 300;
  std::string study =
      "[damping]\nmodal_ratio = 0.02\n[[coordinate]]\nname = \"light\"\nmass = 1e-6\n"
      "[[spring]]\nbetween = [\"light\", \"ground\"]\nstiffness = 1e16\n";
  for (int i = 1; i <= count; ++i) {
    const std::string before = i == 1 ? "ground" : "m" + std::to_string(i - 1), name = "m" + std::to_string(i);
    study += "[[coordinate]]\nname = \"" + name + "\"\nmass = 1.0\n[[spring]]\nbetween = [\"" + before + "\", \"" +
             name + "\"]\nstiffness = 1e4\n";
  }
  study += "[[spring]]\nbetween = [\"light\", \"m4\"]\nstiffness = 10.0\n";
  const Recorded damped = run(study);
  ASSERT_EQ(damped.report.status, RunStatus::done) << damped.report.message;
  for (std::size_t i = 0; i < 5; ++i) {
    // The 10 N/m to the fourth mass raise omega^2 of the lowest by 10 phi^2 = 3e-5, and it is 0.27.
    const double omega = 200.0 * std::sin(0.5 * std::acos(-1.0) * double(2 * i + 1) / double(2 * count + 1));
    EXPECT_NEAR(damped.at(i, "angular_frequency"), omega, 1e-3 * omega);
    EXPECT_NEAR(damped.at(i, "damping_ratio"), 0.02, 1e-9);
  }
}

// The pendulum stands on its head and falls as exp(sqrt(g/l) t), whatever rides on a stiff spring beside it.
TEST(GradedModes, OfAMechanismTellOfWhatFallsBesideAStiffPart) {
  const std::string study = R"(
node = [{ name = "bob", position = [0.0, 1.0] }]
mass = [{ node = "bob", mass = 1.0 }]
body = [{ name = "slide", mass = 1e-6, inertia = 1e-6, position = [2.0, 0.0] }]
gravity = { acceleration = [0.0, -9.81] }
analysis = [{ name = "modes", type = "modes" }]

[[joint]]
name = "link"
type = "distance"
between = ["ground", "bob"]
at = [0.0, 0.0]

[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "slide"]
at = [2.0, 0.0]
axis = [1.0, 0.0]
stiffness = 1e16
)";
  const auto falls = testing::run_mechanism_study(study);
  EXPECT_EQ(falls.report.status, RunStatus::failed);
  EXPECT_NE(falls.report.message.find("exp(3.132/s t)"), std::string::npos) << falls.report.message;
  const auto hangs = testing::run_mechanism_study(testing::replaced(study, "[0.0, 1.0]", "[0.0, -1.0]"));
  EXPECT_EQ(hangs.report.status, RunStatus::done) << hangs.report.message;
}

}  // namespace
}  // namespace rubato::analysis
