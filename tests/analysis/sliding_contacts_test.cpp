#include <rubato/core/error.hpp>

#include <support/ran_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// Contacts whose second end moves on steadily, as a belt or a disc does.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::run_study;
using testing::value_of;

struct Pad {
  double mu = 0.3, velocity = 0.1;
  std::string tangential = "{ x = 1.0 }";
};

/// The pad of the brake, [[11, -4], [-4, 5]], pressed by 1 N on a belt.
std::string on_belt(const Pad& pad, const std::string& analyses) {
  return fmt::format(R"(
[parameters]
Omega = 1.0
[[coordinate]]
name = "x"
mass = 1.0
[[coordinate]]
name = "y"
mass = 1.0
[[coordinate]]
name = "z"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 7.0
[[spring]]
between = ["y", "ground"]
stiffness = 3.0
[[spring]]
between = ["z", "ground"]
stiffness = 1.0
[[spring]]
between = ["x", "z"]
stiffness = 4.0
[[damper]]
between = ["x", "ground"]
damping = 0.02
[[damper]]
between = ["z", "ground"]
damping = 0.02
[[contact]]
name = "pad"
tangential = {}
normal = {{ z = 1.0 }}
tangential_stiffness = 50.0
normal_stiffness = 10.0
friction_coefficient = {}
normal_load = 1.0
sliding_velocity = {}
)",
                     pad.tangential, pad.mu, pad.velocity) +
         analyses;
}

std::string transient(const std::string& keys) {
  return "[[analysis]]\nname = \"motion\"\ntype = \"transient\"\nduration = 10.0\noutput = { times = [2.0, 5.0, 10.0] "
         "}\n" +
         keys;
}

/// At 2, 5 and 10 s: x, z, T.
using Reference = std::array<std::array<double, 3>, 3>;

// By an integration apart from this one: DOP853 at 1e-12 between transitions found as roots, in Python.
constexpr Reference sticks_and_slips{{{-0.0026996144, -0.0252984235, 0.2241047296},
                                      {-0.0505195262, -0.0930099548, -0.0209701357},
                                      {-0.0374643978, -0.0741086035, 0.0776741896}}};
constexpr Reference lifts_off{{{-0.0096456561, -0.0153190610, 0.5080856339},
                               {-0.0686132064, -0.1463395017, 0.0},
                               {-0.0778884701, -0.1580632425, 0.0}}};

double error_of(const testing::MemorySink& sink, const Reference& reference, double sign = 1.0,
                const std::string& number = "") {
  double error = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double place[] = {value_of(sink, "motion", "position", "x", i), value_of(sink, "motion", "position", "z", i),
                            sign * value_of(sink, "motion", "tangential_force" + number, "pad", i)};
    for (std::size_t k = 0; k < 3; ++k) error = std::max(error, std::abs(place[k] - reference[i][k]));
  }
  return error;
}

std::string refusal(const std::string& text) {
  try {
    (void)run_study(text);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "accepted";
}

TEST(SlidingContact, DragsAPadAsAnIndependentIntegrationHasIt) {
  const Pad slow{}, fast{0.6, 0.5};
  EXPECT_LT(error_of(run_study(on_belt(slow, transient("step = { tolerance = 1e-6 }"))), sticks_and_slips), 5e-7);
  EXPECT_LT(error_of(run_study(on_belt(fast, transient("step = { tolerance = 1e-6 }"))), lifts_off), 5e-7);
}

// Second order, also over transitions, whose errors come with the square of the step: a sixteenth of the step, 1/256 of
// the error, within the factor by which transitions in the middle of steps scatter it.
TEST(SlidingContact, ErrorsFallWithTheSquareOfTheStep) {
  for (const char* method : {"generalized_alpha", "rk4", "central_difference"}) {
    SCOPED_TRACE(method);
    const auto error = [&](double step) {
      return error_of(run_study(on_belt({}, transient(fmt::format("step = {}\nmethod = \"{}\"\n", step, method)))),
                      sticks_and_slips);
    };
    const double coarse = error(0.016), fine = error(0.001);
    EXPECT_LT(fine, 2e-5);
    EXPECT_GT(coarse / fine, 64.0);
  }
}

// What moves the belt does the work V T; it feeds what the contact dissipates and what the pad does.
TEST(SlidingContact, TheLedgerClosesWithTheWorkOfWhatMovesIt) {
  for (const Pad& pad : {Pad{}, Pad{0.6, 0.5}}) {
    const auto sink = run_study(on_belt(pad, transient("step = { tolerance = 1e-6 }")));
    const auto& energy = sink.tables.at("motion.energy");
    const auto last = energy.rows.back();
    const double work = last.at(energy.column("sliding_work", ""));
    EXPECT_GT(work, 0.05);
    EXPECT_LT(std::abs(last.at(energy.column("residue", ""))), 1e-6 * work);
  }
}

TEST(SlidingContact, TheOtherWayRoundItIsTheSame) {
  const std::string step = transient("step = { tolerance = 1e-6 }");
  EXPECT_LT(error_of(run_study(on_belt({0.3, -0.1, "{ x = -1.0 }"}, step)), sticks_and_slips, -1.0), 5e-7);
  EXPECT_LT(error_of(run_study(on_belt({0.3, 0.1, "[{ x = 1.0 }, { y = 1.0 }]"}, step)), sticks_and_slips, 1.0, "_1"),
            5e-7);
}

// 11 x - 4 z = -mu N, -4 x + 5 z = -N, N = 1 + 10 z
TEST(SlidingContact, AtRestInTheStaticStateItSlipsAndStaysSo) {
  for (const double velocity : {0.1, -0.1}) {
    const auto sink = run_study(on_belt({0.3, velocity}, "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n" +
                                                             transient("initial = \"static\"\nstep = 0.01\n")));
    const double mu = velocity > 0.0 ? 0.3 : -0.3;
    const double det = 11.0 * 15.0 - (-4.0 + 10.0 * mu) * -4.0;
    const double x = (-mu * 15.0 + (-4.0 + 10.0 * mu)) / det, z = (-11.0 - 4.0 * mu) / det;
    EXPECT_NEAR(value_of(sink, "rest", "position", "x"), x, 1e-14);
    EXPECT_NEAR(value_of(sink, "rest", "position", "z"), z, 1e-14);
    EXPECT_NEAR(value_of(sink, "rest", "tangential_force", "pad"), mu * (1.0 + 10.0 * z), 1e-14);
    EXPECT_NEAR(value_of(sink, "motion", "position", "x", 2), x, 1e-12);
    EXPECT_NEAR(value_of(sink, "motion", "slip", "pad", 2), x + velocity * 10.0 - mu * (1.0 + 10.0 * z) / 50.0, 1e-12);
  }
}

// About the static state of a pad that slides, modes are those that flutter; and the motion beside it grows as they
// say.
TEST(SlidingContact, AboutItsStaticStateModesGrowAsTheMotionDoes) {
  const auto sink =
      run_study(on_belt({0.6, 5.0}, "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\ncontacts = [\"static\"]\n"));
  double growth = -1.0;
  for (std::size_t i = 0; i < 3; ++i) growth = std::max(growth, value_of(sink, "modes", "eigenvalue_real", "", i));
  EXPECT_NEAR(growth, 0.26653897, 1e-8);
}

TEST(SlidingContact, IsRefusedWhereItIsNotCarried) {
  const std::string response =
      "[[force]]\non = \"x\"\namplitude = 0.1\nangular_frequency = \"Omega\"\n[[analysis]]\nname = \"f\"\n"
      "type = \"frequency_response\"\nangular_frequency = [1.0]\n";
  for (const char* solver : {"harmonic_balance", "time_marching"})
    EXPECT_THAT(
        refusal(on_belt({}, response + "solver = \"" + solver + "\"\n")),
        HasSubstr("the contact \"pad\" slides on with its sliding_velocity, which steady responses do not carry "
                  "yet; leave it out, or run a transient"));
  std::string bare = on_belt({}, "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  for (const std::string& key :
       {std::string("tangential = { x = 1.0 }\n"), std::string("tangential_stiffness = 50.0\n"),
        std::string("friction_coefficient = 0.3\n")})
    bare.erase(bare.find(key), key.size());
  EXPECT_THAT(refusal(bare), HasSubstr("lacks the key \"friction_coefficient\""));
}

}  // namespace
}  // namespace rubato
