#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Rates of joints at the start. Bodies of Laid::body() have 2 kg.
namespace rubato {
namespace {

using testing::bar_on_pin;
using testing::block_in_guide;
using ::testing::HasSubstr;
using testing::in_plane;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

constexpr double mass = 2.0, inertia = 0.1;
const std::string short_run = transient("0.001", 0.01);

class StartRates : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, StartRates, ::testing::Values(testing::in_plane, testing::in_space),
                         testing::name_of_laid<::testing::TestParamInfo<Laid>>);

void expect_quiet(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_TRUE(ran.report.warnings.empty()) << ran.report.warnings.front();
}

/// A second bar, which hangs on the tip of bar_on_pin(), 1 m from its pin, with its centre 0.3 m further on.
std::string second_bar(const Laid& laid, const std::string& joint_keys, const std::string& body_keys = "") {
  return "[[body]]\nname = \"tail\"\n" + laid.body(inertia, 1.3, 0.0) + body_keys +
         "[[joint]]\nname = \"knee\"\ntype = \"revolute\"\nbetween = [\"bar\", \"tail\"]\nat = " +
         laid.point(1.0, 0.0) + "\n" + laid.hinge_axis() + joint_keys + "\n";
}

/// Twice the kinetic energy of both bars: of spins [rad/s], the tail's centre moves with the knee and its own spin.
double twice_the_energy(double spin, double other) {
  const double tip = 1.0 * spin + 0.3 * other;
  return (inertia + mass * 0.25) * spin * spin + inertia * other * other + mass * tip * tip;
}

TEST_P(StartRates, MoveAChainOfBars) {
  const double first = 1.7, second = -4.2;
  const MechanismStudy ran(bar_on_pin(GetParam(), "rate = 1.7") + second_bar(GetParam(), "angle = 0.4\nrate = -4.2") +
                           short_run);
  expect_quiet(ran);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "pin"), first, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "knee"), second, 1e-12);
  EXPECT_NEAR(2.0 * ran.at(0, "run.energy", "kinetic"), twice_the_energy(first, first + second), 1e-11);
  EXPECT_NEAR(ran.at(0, "run", "angle", "knee"), 0.4, 1e-12);
}

// What nothing gives a rate moves as by a blow on the pin: d(energy)/d(spin of the tail) = 0.
TEST_P(StartRates, MoveTheRestAsABlowWould) {
  const double first = 1.7, other = -mass * 0.3 * first / (inertia + mass * 0.09);
  const MechanismStudy ran(bar_on_pin(GetParam(), "rate = 1.7") + second_bar(GetParam(), "") + short_run);
  expect_quiet(ran);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "knee"), other - first, 1e-12);
  EXPECT_NEAR(2.0 * ran.at(0, "run.energy", "kinetic"), twice_the_energy(first, other), 1e-11);
}

TEST_P(StartRates, GoWithADrive) {
  const MechanismStudy ran(bar_on_pin(GetParam(), "drive = \"2.5*t + t^2\"") + second_bar(GetParam(), "rate = 1.25") +
                           short_run);
  expect_quiet(ran);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "pin"), 2.5, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "knee"), 1.25, 1e-12);
}

// A bar that flies with given velocities keeps them, and its tail follows.
TEST_P(StartRates, KeepTheVelocitiesThatAreGiven) {
  const std::string spin = GetParam().in_space ? "angular_velocity = [0.0, 0.0, 0.9]\n" : "angular_velocity = 0.9\n";
  const MechanismStudy ran("[[body]]\nname = \"bar\"\n" + GetParam().body(inertia, 0.5, 0.0) +
                           "velocity = " + GetParam().direction(0.3, -0.7) + "\n" + spin +
                           second_bar(GetParam(), "rate = -2.0") + short_run);
  expect_quiet(ran);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "knee"), -2.0, 1e-12);
  const double other = 0.9 - 2.0, across = -0.7 + 0.5 * 0.9 + 0.3 * other;
  const double bar = mass * (0.3 * 0.3 + 0.7 * 0.7) + inertia * 0.9 * 0.9;
  const double tail = mass * (0.3 * 0.3 + across * across) + inertia * other * other;
  EXPECT_NEAR(2.0 * ran.at(0, "run.energy", "kinetic"), bar + tail, 1e-11);
}

// Where both cannot be, the joint has its rate, and what became of the velocity is told.
TEST_P(StartRates, TellAboutVelocitiesThatContradictThem) {
  const MechanismStudy ran(block_in_guide(GetParam(), 0.0, "rate = 1.5", 0.5) + short_run);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_THAT(ran.report.warnings.front(), HasSubstr("the velocities given do not go with the rates of the joints"));
  EXPECT_NEAR(ran.at(0, "run.energy", "kinetic"), 0.5 * mass * 1.5 * 1.5, 1e-12);
}

/// A study without a line.
std::string without(const std::string& study, const std::string& line) {
  const std::size_t at = study.find(line);
  return study.substr(0, at) + study.substr(study.find('\n', at) + 1);
}

// Upward from the equilibrium on a spring: s = sag + (rate/frequency) sin.
TEST_P(StartRates, BeginAtAnEquilibrium) {
  const MechanismStudy ran(without(block_in_guide(GetParam(), 0.3, "rate = 0.8\nstiffness = 50.0"), "velocity = ") +
                           GetParam().gravity() +
                           "[[analysis]]\nname = \"run\"\ntype = \"transient\"\ninitial = \"static\"\nstep = 0.0005\n"
                           "duration = 0.2\n");
  expect_quiet(ran);
  const double frequency = std::sqrt(50.0 / mass), sag = -mass * 9.81 * std::sin(0.3) / 50.0;
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), sag + 0.8 / frequency * std::sin(frequency * 0.2), 1e-7);
}

// The piston of a crank of 0.5 m and a rod of 1.3 m: its speed is the slope of r cos + sqrt(l^2 - r^2 sin^2).
TEST(StartRatesOfLoops, MoveASliderCrank) {
  const double r = 0.5, l = 1.3, angle = 0.7, rate = -3.3;
  const double c = std::cos(angle), s = std::sin(angle), root = std::sqrt(l * l - r * r * s * s);
  const auto pair = [](double x, double y) { return fmt::format("[{:.17g}, {:.17g}]", x, y); };
  const std::string crank = pair(r * c, r * s), piston = pair(r * c + root, 0.0);
  const auto body = [&](const std::string& name, const std::string& at) {
    return "[[body]]\nname = \"" + name + "\"\nmass = 0.7\ninertia = 0.02\nposition = " + at + "\n";
  };
  const auto joint = [](const std::string& name, const std::string& type, const std::string& first,
                        const std::string& second, const std::string& rest) {
    return "[[joint]]\nname = \"" + name + "\"\ntype = \"" + type + "\"\nbetween = [\"" + first + "\", \"" + second +
           "\"]\n" + rest + "\n";
  };
  const std::string study = body("crank", pair(0.5 * r * c, 0.5 * r * s)) +
                            body("rod", pair(r * c + 0.5 * root, 0.5 * r * s)) + body("piston", piston) +
                            joint("main", "revolute", "ground", "crank", "at = [0.0, 0.0]\nangle = 0.7\nrate = -3.3") +
                            joint("pin", "revolute", "crank", "rod", "at = " + crank) +
                            joint("gudgeon", "revolute", "rod", "piston", "at = " + piston);
  const std::string guide = "at = " + piston + "\naxis = [1.0, 0.0]\n";
  const MechanismStudy ran(study + joint("guide", "prismatic", "ground", "piston", guide) + short_run);
  expect_quiet(ran);
  const double slope = -r * s - r * r * s * c / root;
  EXPECT_NEAR(ran.at(0, "run", "velocity", "piston.x"), slope * rate, 1e-11);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "main"), rate, 1e-12);
  // One rate more than there are freedoms: refused unless it says the same.
  EXPECT_EQ(
      verdict(study +
              joint("guide", "prismatic", "ground", "piston", guide + fmt::format("rate = {:.17g}", slope * rate)) +
              short_run),
      "no complaint");
  EXPECT_THAT(
      verdict(study + joint("guide", "prismatic", "ground", "piston", guide + "rate = 0.1") + short_run),
      HasSubstr("the rates of \"main\", \"guide\" at the start contradict each other, the joints or the drives"));
}

TEST(StartRatesOfLoops, LengthenAStrut) {
  const MechanismStudy ran(
      "[[body]]\nname = \"ball\"\nmass = 3.0\ninertia = 0.1\nposition = [3.0, 4.0]\n[[joint]]\nname = \"rod\"\ntype = "
      "\"strut\"\nbetween = [\"ground\", \"ball\"]\nat = [0.0, 0.0]\nto = [3.0, 4.0]\nrate = 2.5\n" +
      short_run);
  expect_quiet(ran);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "ball.x"), 1.5, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "ball.y"), 2.0, 1e-12);
}

TEST(StartRatesFault, NamesWhatTakesNone) {
  EXPECT_THAT(verdict(bar_on_pin(in_plane, "drive = \"2*t\"\nrate = 2.0") + short_run),
              HasSubstr("joint \"pin\" has a drive and a rate"));
  const std::string rigid = second_bar(in_plane, "rate = 1.0");
  const std::size_t type = rigid.find("revolute");
  EXPECT_THAT(verdict(bar_on_pin(in_plane, "") + std::string(rigid).replace(type, 8, "rigid") + short_run),
              HasSubstr("rate"));
}

// A velocity of zero that is given counts as one that is not zero: the other node moves along the strut, by 1 m/s more.
TEST(StartRatesOfNodes, KeepTheZeroThatIsGiven) {
  const auto node = [](const char* name, const char* keys) {
    return std::string("[[node]]\nname = \"") + name + "\"\n" + keys + "\n[[mass]]\nnode = \"" + name +
           "\"\nmass = 1.0\n";
  };
  const MechanismStudy ran(
      node("n", "position = [0.0, 0.0]\nvelocity = [0.0, 1.0]") + node("m", "position = [1.0, 1.0]") +
      "[[joint]]\nname = \"strut\"\ntype = \"strut\"\nbetween = [\"n\", \"m\"]\nrate = 1.0\n" + short_run);
  expect_quiet(ran);
  const double along = 1.0 + std::sqrt(0.5);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "n.x"), 0.0, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "n.y"), 1.0, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "m.x"), along * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "m.y"), along * std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace rubato
