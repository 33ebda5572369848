#include <gtest/gtest.h>

#include "io/study_text.hpp"

// What is wrong with a study only once its names are looked up and its numbers evaluated.
namespace rubato::testing {
namespace {

TEST(NameError, NamesThePartTheNameAndTheNearestCoordinate) {
  EXPECT_EQ(
      verdict_with("[\"blade\", \"ground\"]", "[\"blabe\", \"ground\"]"),
      "study.toml:27:12: error: slider \"contact\" joins \"blabe\", which is no coordinate; did you mean \"blade\"? "
      "(known: disk, blade)");
  EXPECT_EQ(
      verdict_with("[\"disk\", \"blade\"]", "[\"disk\", \"shroud\"]"),
      "study.toml:19:20: error: the spring between \"disk\" and \"shroud\" joins \"shroud\", which is no coordinate; "
      "known: disk, blade");
  EXPECT_EQ(verdict_with("on = \"blade\"", "on = \"bladee\""),
            "study.toml:33:6: error: a force is on \"bladee\", which is no coordinate; did you mean \"blade\"? (known: "
            "disk, blade)");
  EXPECT_EQ(
      verdict_with("[[force]]", "[base_motion]\namplitude = 1\nfrequency = 1\ndirection = { blde = 1.0 }\n\n[[force]]"),
      "study.toml:35:22: error: [base_motion]: direction names \"blde\", which is no coordinate; did you mean "
      "\"blade\"? (known: disk, blade)");
}

TEST(NameError, RefusesDuplicates) {
  EXPECT_EQ(verdict_with("name = \"blade\"", "name = \"disk\""),
            "study.toml:11:8: error: two coordinates are called \"disk\"");
  EXPECT_EQ(verdict_with("[[force]]",
                         "[[slider]]\nname = \"contact\"\nbetween = [\"disk\", \"ground\"]\nstiffness = 1\n"
                         "friction_coefficient = 1\nnormal_load = 1\n\n[[force]]"),
            "study.toml:33:8: error: two sliders are called \"contact\"");
  EXPECT_EQ(verdict_with("name = \"contact\"", "name = \"blade\""),
            "study.toml:26:8: error: slider \"blade\" has the name of a coordinate; results would mix them up");
  EXPECT_EQ(
      verdict_with("[[analysis]]",
                   "[[analysis]]\nname = \"response\"\ntype = \"transient\"\nstep = 1\nduration = 10\n\n[[analysis]]"),
      "study.toml:44:8: error: two analyses are called \"response\"; the first is on line 37");
  EXPECT_EQ(
      verdict_with("[[analysis]]",
                   "[[analysis]]\nname = \"Response\"\ntype = \"transient\"\nstep = 1\nduration = 10\n\n[[analysis]]"),
      "study.toml:44:8: error: the analyses \"Response\" (line 37) and \"response\" differ in case alone, and some "
      "file "
      "systems would take their files for the same; rename one");
}

TEST(NameError, RefusesNamesThatMeanSomethingElse) {
  EXPECT_EQ(verdict_with("name = \"blade\"", "name = \"ground\""),
            "study.toml:11:8: error: the name \"ground\" is taken: it stands for what does not move");
  EXPECT_EQ(verdict_with("name = \"blade\"", "name = \"\""), "study.toml:11:8: error: a coordinate needs a name");
  EXPECT_EQ(
      verdict_with("name = \"blade\"", "name = \"a\\nb\""),
      "study.toml:11:8: error: the name \"a?b\" cannot head a column of results: no comma, semicolon, quote, slash, "
      "control character, \" - \", or space at its ends");
  const std::string rules =
      "\" becomes the name of files and of a netCDF group: it begins with a letter, a digit or an underscore, has at "
      "most "
      "200 bytes, holds no slash, dot, control character or separate accent, does not end with a blank, and is not "
      "\"results\"";
  for (const std::string name : {"a/b", "a.b", "", "-o", "(a)", "{}", " a", "a ", "results", "+", "cafe\xcc\x81"})
    EXPECT_EQ(verdict_with("name = \"response\"", "name = \"" + name + "\""),
              "study.toml:38:8: error: the analysis name \"" + name + rules);
  EXPECT_EQ(verdict_with("name = \"response\"", "name = \"" + std::string(257, 'a') + "\""),
            "study.toml:38:8: error: the analysis name \"" + std::string(60, 'a') + "..." + rules);
  for (const std::string name : {"a b-c (d)", "_a", "1",
                                 "\xc3\x9c"
                                 "bergang",
                                 "caf\xc3\xa9"})
    EXPECT_EQ(verdict_with("name = \"response\"", "name = \"" + name + "\""), "accepted");
  EXPECT_EQ(verdict_with("N0 = 10.0", "N0 = 10.0\nt = 1"),
            "study.toml:5:5: error: parameter \"t\": the name is taken (the time); choose another");
  EXPECT_EQ(verdict_with("N0 = 10.0", "N0 = 10.0\nsin = 1"),
            "study.toml:5:7: error: parameter \"sin\": the name is taken (the function sin); choose another");
  EXPECT_EQ(
      verdict_with("N0 = 10.0", "N0 = 10.0\n\"N 1\" = 1"),
      "study.toml:5:9: error: parameter \"N 1\": a name is letters, digits and underscores, and does not begin with a "
      "digit");
}

TEST(ElementError, RefusesToJoinACoordinateWithItself) {
  EXPECT_EQ(verdict_with("[\"blade\", \"ground\"]", "[\"blade\", \"blade\"]"),
            "study.toml:27:21: error: slider \"contact\" joins \"blade\" with itself");
  EXPECT_EQ(verdict_with("[\"blade\", \"ground\"]", "[\"ground\", \"ground\"]"),
            "study.toml:27:22: error: slider \"contact\" joins \"ground\" with itself");
}

TEST(ValueError, RefusesAMassThatIsNotPositive) {
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = -1.0"),
            "study.toml:12:8: error: coordinate \"blade\": mass must be positive, got -1");
  EXPECT_EQ(
      verdict_with("mass = 1.0", "mass = 0"),
      "study.toml:12:8: error: coordinate \"blade\": mass is 0, which makes the mass matrix singular; give it a mass, "
      "or remove the coordinate and join its springs in series");
}

TEST(ValueError, RefusesWhatIsNotFinite) {
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = nan"),
            "study.toml:12:8: error: coordinate \"blade\": mass is nan; give a finite number");
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = \"1/0\""),
            "study.toml:12:8: error: coordinate \"blade\": mass is inf (from \"1/0\"); give a finite number");
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = \"sqrt(-N0)\""),
            "study.toml:12:8: error: coordinate \"blade\": mass is nan (from \"sqrt(-N0)\"); give a finite number");
  EXPECT_EQ(verdict_with("duration = 60.0", "duration = inf"),
            "study.toml:41:12: error: analysis \"response\": duration is inf; give a finite number");
  EXPECT_EQ(verdict_with("N0 = 10.0", "N0 = nan"),
            "study.toml:4:6: error: parameter \"N0\" is nan; give a finite number");
  EXPECT_EQ(
      verdict_with("amplitude = 20.0\nangular_frequency = 7.0", "expression = \"1/t\""),
      "study.toml:34:14: error: the force on \"blade\": \"1/t\" is inf at t = 0; give a formula that is finite at all "
      "times");
}

TEST(ValueError, RefusesCoefficientsOfTheWrongSign) {
  EXPECT_EQ(
      verdict_with("stiffness = 50.0", "stiffness = -50.0"),
      "study.toml:20:13: error: the spring between \"disk\" and \"blade\": stiffness must not be negative, got -50");
  EXPECT_EQ(verdict_with("stiffness = 10.0", "stiffness = 0"),
            "study.toml:28:13: error: slider \"contact\": stiffness must be positive, got 0");
  EXPECT_EQ(verdict_with("friction_coefficient = 0.5", "friction_coefficient = -0.5"),
            "study.toml:29:24: error: slider \"contact\": friction_coefficient must not be negative, got -0.5");
  EXPECT_EQ(
      verdict_with("normal_load = \"N0\"", "normal_load = \"-N0\""),
      "study.toml:30:15: error: slider \"contact\": normal_load must not be negative, got -10; a slider cannot be "
      "pulled, its least load is 0");
  EXPECT_EQ(verdict_with("angular_frequency = 7.0", "angular_frequency = -7.0"),
            "study.toml:35:21: error: the force on \"blade\": angular_frequency must not be negative, got -7");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "modal_ratio = -0.02"),
            "study.toml:23:15: error: modal_ratio must not be negative, got -0.02");
}

TEST(ValueError, RefusesDampingThatDoesNotFitTheModes) {
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "modal_ratio = [0.02, 0.02, 0.02]"),
            "study.toml:23:15: error: modal_ratio lists 3 ratios for 2 modes; give one for all, or one a mode");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "modal_ratio = 0.02\nmodes = 3"),
            "study.toml:24:9: error: modes must be a whole number from 1 to 2, got 3");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "rayleigh = {}"),
            "study.toml:23:12: error: [damping]: rayleigh needs \"mass\" [1/s], \"stiffness\" [s] or both");
}

TEST(ExpressionError, GivesThePlaceInTheFileAndInTheExpression) {
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = \"2 * N1\""),
            "study.toml:12:8: error: coordinate \"blade\": mass: in the expression \"2 * N1\": unknown name \"N1\" at "
            "character 5; did you mean \"N0\"? (known: pi, N0)");
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = \"2 * (N0 + \""),
            "study.toml:12:8: error: coordinate \"blade\": mass: in the expression \"2 * (N0 + \": unexpected end of "
            "expression at its end");
  EXPECT_EQ(
      verdict_with("mass = 1.0", "mass = \"1,5\""),
      "study.toml:12:8: error: coordinate \"blade\": mass: in the expression \"1,5\": 2 values with commas between "
      "them; give one, with a point for its decimals");
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = \" \""),
            "study.toml:12:8: error: coordinate \"blade\": mass is an empty expression; give a number or a formula");
  EXPECT_EQ(verdict_with("amplitude = 20.0\nangular_frequency = 7.0", "expression = \"sin(omega * t)\""),
            "study.toml:34:14: error: the force on \"blade\": in the expression \"sin(omega * t)\": unknown name "
            "\"omega\" at "
            "character 5; known: pi, t, N0");
  EXPECT_EQ(verdict_with("N0 = 10.0", "N0 = \"2 * N1\"\nN1 = 1.0"),
            "study.toml:4:6: error: parameter \"N0\": in the expression \"2 * N1\": unknown name \"N1\" at character "
            "5; known: "
            "pi");
}

// It was read as if it were not there: all coordinates were moved.
TEST(BaseMotionError, RefusesADirectionThatNamesNothing) {
  EXPECT_EQ(
      verdict_with("[[force]]", "[base_motion]\namplitude = 1\nfrequency = 1\ndirection = {}\n\n[[force]]"),
      "study.toml:35:13: error: [base_motion]: direction names nothing that the ground moves; leave it out where it "
      "moves all coordinates alike");
}

TEST(BaseMotionError, RefusesWhatHasNoKnownAcceleration) {
  EXPECT_EQ(verdict_with("[[force]]", "[base_motion]\nexpression = \"t\"\nof = \"displacement\"\n\n[[force]]"),
            "study.toml:34:6: error: [base_motion]: of = \"displacement\" is for harmonic motion, whose acceleration "
            "is known; "
            "give the acceleration");
  EXPECT_EQ(
      verdict_with("[[force]]", "[base_motion]\namplitude = 1\nfrequency = 1\nof = \"speed\"\n\n[[force]]"),
      "study.toml:35:6: error: [base_motion]: of cannot be \"speed\"; known: acceleration, velocity, displacement");
}

}  // namespace
}  // namespace rubato::testing
