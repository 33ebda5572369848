#include "study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

// [[contact]]: the keys that it takes, what is said of others, and which analyses refuse it.
namespace rubato {
namespace {

using rubato::testing::edited;
using rubato::testing::study_text;
using rubato::testing::verdict;
using ::testing::HasSubstr;

const std::string shares = "tangential = { disk = 1.0 }\nnormal = { blade = 1.0 }\n";
const std::string rubs = "tangential_stiffness = 1.0\nfriction_coefficient = 0.3\n";
const std::string presses = "normal_stiffness = 2.0\n";

std::string verdict_on(const std::string& keys, const std::string& study = study_text) {
  return verdict(study + "[[contact]]\nname = \"c\"\n" + keys);
}

TEST(ReadContact, TakesOneOrTwoDirections) {
  EXPECT_EQ(verdict_on(shares + rubs + presses), "accepted");
  EXPECT_EQ(verdict_on("tangential = [{ disk = 1.0 }]\nnormal = { blade = \"N0/3\" }\n" + rubs + presses), "accepted");
  EXPECT_EQ(verdict_on("tangential = [{ disk = 1.0 }, { disk = 0.5, blade = 1.0 }]\nnormal = { blade = 1.0 }\n" + rubs +
                       presses),
            "accepted");
  EXPECT_EQ(verdict_on("normal = { blade = 1.0 }\ngap = 0.1\n" + presses), "accepted");  // frictionless
}

TEST(ReadContact, RefusesKeysThatDoNotGoTogether) {
  EXPECT_THAT(verdict_on(shares + rubs), HasSubstr("lacks the key \"normal_stiffness\""));
  EXPECT_THAT(verdict_on(rubs + presses), HasSubstr("lacks the key \"between\""));
  EXPECT_THAT(verdict_on("between = [\"disk\", \"ground\"]\n" + rubs + presses),
              HasSubstr("lacks the key \"normal_direction\""));
  EXPECT_THAT(verdict_on("between = [\"disk\", \"ground\"]\nnormal_direction = [0, 1]\n" + shares + rubs + presses),
              HasSubstr("\"tangential\" does not go with \"between\""));
  EXPECT_THAT(verdict_on(shares + rubs + presses + "gap = 0.0\nnormal_load = 1.0\n"),
              HasSubstr("\"normal_load\" does not go with \"gap\""));
  EXPECT_THAT(verdict_on(shares + presses + "friction_coefficient = 0.3\n"),
              HasSubstr("lacks the key \"tangential_stiffness\""));
  EXPECT_THAT(verdict_on(shares + presses + "tangential_stiffness = 0.3\n"),
              HasSubstr("lacks the key \"friction_coefficient\""));
  EXPECT_THAT(verdict_on("normal = { blade = 1.0 }\n" + rubs + presses), HasSubstr("lacks the key \"tangential\""));
  EXPECT_THAT(
      verdict_on("tangential = [{ disk = 1 }, { disk = 1 }, { disk = 1 }]\nnormal = { blade = 1 }\n" + rubs + presses),
      HasSubstr("got a list of 3"));
  EXPECT_THAT(verdict_on(shares + rubs + presses + "tangential_damping = 1.0\n"),
              HasSubstr("no key \"tangential_damping\""));
}

TEST(ReadContact, IsRefusedByAnalysesThatDoNotKnowIt) {
  const auto with = [](const std::string& analysis) {
    std::string study = edited("N0 = 10.0", "N0 = 10.0\nOmega = 7.0",
                               edited("angular_frequency = 7.0", "angular_frequency = \"Omega\""));
    study.replace(study.find("type = \"transient\""), std::string::npos, analysis);
    return verdict_on(shares + rubs + presses, study);
  };
  const std::string response = "type = \"frequency_response\"\nangular_frequency = [6.0, 7.0]\n";
  EXPECT_THAT(with("type = \"transient\"\nmethod = \"exact\"\nduration = 1.0\n"), HasSubstr("\"c\""));
  EXPECT_THAT(with(response + "solver = \"periodic\"\n"),
              HasSubstr("the contact \"c\"; take solver = \"harmonic_balance\" or \"time_marching\""));
  for (const char* solver : {"", "solver = \"harmonic_balance\"\n", "solver = \"time_marching\"\n"})
    EXPECT_EQ(with(response + solver), "accepted") << solver;
  EXPECT_THAT(with("type = \"transient\"\nmethod = \"dormand_prince\"\nstep = { tolerance = 1e-4 }\nduration = 1.0\n"),
              HasSubstr("\"c\" slips, opens and closes"));
  EXPECT_EQ(with("type = \"modes\"\n"), "accepted");
  EXPECT_EQ(with("type = \"static\"\n"), "accepted");
}

}  // namespace
}  // namespace rubato
