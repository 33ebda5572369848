#include <rubato/core/error.hpp>

#include <support/laid_studies.hpp>
#include <support/mechanism_study.hpp>
#include <support/ran_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Contacts of mechanisms at rest, and what is refused.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using Table = testing::MemorySink::Table;

std::string block_on_four_feet(double mu) {
  std::string study = fmt::format(R"toml(
[parameters]
mu = {}
[gravity]
acceleration = [3.0, 1.0, -9.0]
[[body]]
name = "block"
position = [0.0, 0.0, 0.1]
mass = 2.0
inertia = [0.02, 0.03, 0.04]
)toml",
                                  mu);
  int name = 0;
  for (const char* at : {"0.2, 0.1", "-0.2, 0.1", "0.2, -0.1", "-0.2, -0.1"})
    study += fmt::format(R"toml(
[[contact]]
name = "foot{}"
between = ["block", "ground"]
at = [{}, 0.0]
normal_direction = [0.0, 0.0, 1.0]
normal_stiffness = 1e5
tangential_stiffness = 5e4
friction_coefficient = "mu"
normal_load = 4.5
)toml",
                         ++name, at);
  return study;
}

TEST(ContactOfAMechanism, CarriesStaticLoadsAndModesWhileItSticks) {
  const MechanismStudy rest(block_on_four_feet(0.6) + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  ASSERT_EQ(rest.report.status, analysis::RunStatus::done) << rest.report.message;
  double along = 0.0, across = 0.0, normal = 0.0;
  for (const char* foot : {"foot1", "foot2", "foot3", "foot4"}) {
    along += rest.last("rest", "tangential_force_1", foot);
    across += rest.last("rest", "tangential_force_2", foot);
    normal += rest.last("rest", "normal_force", foot);
  }
  // t1 is the axis least along the normal, x; t2 = n x t1 is y.
  EXPECT_NEAR(along, 6.0, 1e-6);
  EXPECT_NEAR(across, 2.0, 1e-6);
  EXPECT_NEAR(normal, 18.0, 1e-6);
  const MechanismStudy modes(block_on_four_feet(0.6) + "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n");
  ASSERT_EQ(modes.report.status, analysis::RunStatus::done) << modes.report.message;
  const Table& table = modes.table("modes");
  std::vector<double> squared;
  for (const auto& row : table.rows) squared.push_back(std::pow(row[table.column("angular_frequency", "")], 2));
  const auto has = [&](double wanted) {
    return std::any_of(squared.begin(), squared.end(), [&](double one) { return std::abs(one / wanted - 1.0) < 1e-6; });
  };
  EXPECT_TRUE(has(4.0 * 1e5 / 2.0));                             // up and down
  EXPECT_TRUE(has(4.0 * 5e4 * (0.2 * 0.2 + 0.1 * 0.1) / 0.04));  // about the vertical
  const MechanismStudy lost(block_on_four_feet(0.3) + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  EXPECT_NE(lost.report.status, analysis::RunStatus::done);  // 0.3 of 18 N is less than sqrt(40) N
}

TEST(ContactOfAMechanism, RefusesWhatItDoesNotCarry) {
  const std::string transient = "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 0.1\nstep = 0.01\n";
  const std::string body = R"toml(
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 1.0
inertia = 1.0
[[node]]
name = "point"
position = [1.0, 0.0]
[[mass]]
node = "point"
mass = 1.0
)toml";
  const auto contact = [&](const std::string& keys) {
    return testing::verdict(body + "[[contact]]\nname = \"touch\"\nnormal_stiffness = 1e4\n" + keys + transient);
  };
  const std::string block = "between = [\"block\", \"ground\"]\nnormal_direction = [0.0, 1.0]\n";
  const std::string rubs = "tangential_stiffness = 1e4\nfriction_coefficient = 0.3\n";
  EXPECT_EQ(contact(block + rubs), "no complaint");
  EXPECT_THAT(contact("normal = { \"block.y\" = -1.0 }\n"), HasSubstr("take between, a normal_direction and `at`"));
  EXPECT_THAT(contact(block + rubs + "sliding_velocity = 1.0\n"), HasSubstr("a body that a joint with a drive moves"));
  EXPECT_THAT(contact("between = [\"blok\", \"ground\"]\nnormal_direction = [0.0, 1.0]\n"),
              HasSubstr("joins \"blok\", which is no node and no body; did you mean \"block\"?"));
  EXPECT_THAT(contact("between = [\"ground\", \"block\"]\nnormal_direction = [0.0, 1.0]\n"),
              HasSubstr("needs \"at\", the point of the ground"));
  EXPECT_THAT(contact("between = [\"point\", \"ground\"]\nnormal_direction = [0.0, 1.0]\nat = [1.0, 0.5]\n"),
              HasSubstr("which has no axes that could carry a point"));
  EXPECT_THAT(contact(block + "to = [0.0, 0.0]\ngap = 0.1\n"), HasSubstr("gap"));
  EXPECT_THAT(contact(block + "radius = 0.0\n"), HasSubstr("radius must be positive"));
  EXPECT_THAT(testing::verdict(block_on_four_feet(0.3) +
                               "[[contact]]\nname = \"foot1\"\nbetween = [\"block\", \"ground\"]\n"
                               "normal_direction = [0.0, 0.0, 1.0]\nnormal_stiffness = 1.0\n" +
                               transient),
              HasSubstr("two contacts, sliders or laws are called \"foot1\""));
  std::string ball = block_on_four_feet(0.3);
  ball.insert(ball.find("at = ["), "radius = 0.1\n");
  EXPECT_THAT(testing::verdict(ball + transient), HasSubstr("a sphere in space touches without friction"));
  const std::string structure =
      "[[node]]\nname = \"n\"\nposition = [0.0, 0.0]\n[[mass]]\nnode = \"n\"\nmass = 1.0\n[[contact]]\nname = "
      "\"c\"\nbetween = [\"n\", \"ground\"]\nnormal_direction = [0, 1]\nnormal_stiffness = 1.0\n";
  for (const char* key : {"at = [0.0, 0.1]\n", "to = [0.0, 0.1]\n", "radius = 0.1\n"})
    EXPECT_THAT([&] { testing::run_study(structure + key + transient); },
                ::testing::ThrowsMessage<InvalidInput>(HasSubstr("goes with bodies and joints")))
        << key;
}

TEST(ContactOfAMechanism, RefusesResponsesAndModesThatItDoesNotCarry) {
  const std::string swing = "[[force]]\non = \"block.x\"\namplitude = 0.1\nangular_frequency = \"Omega\"\n";
  std::string driven = block_on_four_feet(0.6) + swing;
  driven.insert(driven.find("mu ="), "Omega = 1.0\n");
  EXPECT_THAT(testing::verdict(driven + "[[analysis]]\nname = \"response\"\ntype = \"frequency_response\"\nabout = "
                                        "\"static\"\nangular_frequency = [1.0]\nsolver = \"periodic\"\n"),
              HasSubstr("contact"));
  EXPECT_THAT(testing::verdict(block_on_four_feet(0.6) + "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\ncontacts = "
                                                         "[\"open\"]\n"),
              HasSubstr("contacts"));
}

}  // namespace
}  // namespace rubato
