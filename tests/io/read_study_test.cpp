#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

namespace rubato::testing {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

std::string verdict_on(const std::filesystem::path& path) {
  try {
    (void)io::read_study(path);
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

TEST(StudyFile, BecomesADescriptionWithThePlaceOfEveryValue) {
  const auto study = io::read_study_text(study_text, "study.toml");
  EXPECT_EQ(study.title, "A blade");
  EXPECT_EQ(study.text, study_text);
  ASSERT_EQ(study.model.coordinates.size(), 2u);
  EXPECT_EQ(study.model.coordinates[1].name, "blade");
  EXPECT_EQ(study.model.coordinates[1].mass.value, 1.0);
  EXPECT_EQ(study.model.coordinates[1].mass.where.line, 12);
  EXPECT_EQ(study.model.coordinates[1].mass.where.column, 8);
  ASSERT_EQ(study.model.sliders.size(), 1u);
  EXPECT_EQ(study.model.sliders[0].between[1], "ground");
  EXPECT_EQ(study.model.sliders[0].normal_load.expression, "N0");
  const auto& transient = std::get<model::TransientDescription>(study.analyses.at(0).task);
  EXPECT_EQ(transient.method.name, "generalized_alpha");
  EXPECT_EQ(transient.step->value, 0.005);
  EXPECT_TRUE(transient.energy);
  EXPECT_EQ(verdict(study_text), "accepted");
}

TEST(StudyFile, WithoutATitleIsCalledAsItsFile) {
  EXPECT_EQ(io::read_study_text(edited("title = \"A blade\"", ""), "runs/study.toml").title, "study");
}

TEST(StudyFile, MayComeFromAnotherSystem) {
  std::string with_returns;
  for (const char c : study_text) with_returns += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(verdict(with_returns), "accepted");
  EXPECT_EQ(verdict("\xef\xbb\xbf" + study_text), "accepted");
}

TEST(StudyFile, ParametersFollowTheOrderOfTheFile) {
  const auto study = io::read_study_text(edited("N0 = 10.0", "b = 2\na = \"3 * b\""), "study.toml");
  const auto values = model::evaluate_parameters(study.parameters);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].first, "b");
  EXPECT_EQ(values[1].second, 6.0);
}

TEST(StudyFileError, IsSaidOfAnEmptyFile) {
  const std::string message = "study.toml: error: the file is empty; `rubato example` shows what a study looks like";
  EXPECT_EQ(verdict(""), message);
  EXPECT_EQ(verdict(" \n\t\r\n"), message);
  EXPECT_EQ(
      verdict("# only words\n"),
      "study.toml:1:1: error: the study has no [[coordinate]], no [[node]] and no [matrices]; it needs one of them");
}

TEST(StudyFileError, IsSaidOfABinaryFile) {
  EXPECT_EQ(verdict(std::string("\x7f"
                                "ELF\x02\x01\x01\0\0",
                                9)),
            "study.toml: error: the file is binary (byte 8 is zero); a study is a TOML text");
}

TEST(StudyFileError, IsSaidOfAFileOf100MegabytesBeforeItIsRead) {
  const ScratchFolder folder("large-study");
  const auto path = folder.path() / "large.toml";
  folder.write("large.toml", "");
  std::filesystem::resize_file(path, std::uintmax_t{100} << 20);  // sparse: takes no room on the disk
  EXPECT_EQ(
      verdict_on(path),
      "error: the study \"" + path.string() +
          "\" has 100 MB, more than the 16 MB that are read; give large models as [matrices] and long loads as tables");
}

TEST(StudyFileError, IsSaidOfAMissingFileAndOfAFolder) {
  const ScratchFolder folder("no-study");
  EXPECT_EQ(verdict_on("no/such.toml"), "error: the study \"no/such.toml\" does not exist");
  EXPECT_EQ(verdict_on(folder.path()), "error: the study \"" + folder.path().string() + "\" is a folder, not a file");
}

// What toml++ says is left to toml++; the place and the beginning are ours.
TEST(StudyFileError, IsSaidOfTextThatIsNoToml) {
  EXPECT_THAT(verdict_with("mass = 1.0", "mass = = 1.0"), StartsWith("study.toml:12:8: error: this is no TOML: "));
  EXPECT_THAT(verdict_with("name = \"blade\"", "name = \"blade"),
              StartsWith("study.toml:11:14: error: this is no TOML: "));
  EXPECT_THAT(verdict_with("name = \"blade\"", "name = \"blade"), EndsWith(" (is the closing quote missing?)"));
  EXPECT_THAT(verdict_with("mass = 1.0", "mass = 1.0\nmass = 2.0"),
              StartsWith("study.toml:13:8: error: this is no TOML: "));
  EXPECT_THAT(verdict_with("A blade", "A \xff"), StartsWith("study.toml:1:"));
  EXPECT_THAT(verdict_with("A blade", "A \xff"),
              EndsWith("error: this is no TOML: Encountered invalid utf-8 sequence"));
  EXPECT_THAT(verdict_with("mass = 1.0", "mass = 1e999"), StartsWith("study.toml:12:13: error: this is no TOML: "));
  EXPECT_THAT(verdict("a = " + std::string(100'000, '[')), StartsWith("study.toml:1:"));
}

// What people write who know other formats.
TEST(StudyFileError, TellsOfMissingQuotesDecimalCommasAndHugeNumbers) {
  EXPECT_THAT(verdict_with("on = \"blade\"", "on = blade"),
              EndsWith("; texts and formulas stand in quotes: \"blade\""));
  EXPECT_THAT(verdict_with("amplitude = 20.0", "expression = sin(2*t)  # [N]"),
              EndsWith("; texts and formulas stand in quotes: \"sin(2*t)\""));
  EXPECT_THAT(verdict_with("mass = 1.0", "mass = 1,5"), EndsWith("; decimals are written with a point, 1.5"));
  EXPECT_THAT(verdict_with("mass = 1.0", "mass = 1e400"), EndsWith("; numbers go up to 1.8e308"));
}

// TOML's trap: keys after a header belong to it.
TEST(KeyError, TellsOfInlineTablesBelowAHeader) {
  const std::string below =
      "[damping]\nmodal_ratio = 0.02\ncoordinate = [{ name = \"m\", mass = 1.0 }]\n"
      "spring = [{ between = [\"m\", \"ground\"], stiffness = 1.0 }]\n";
  const std::string told =
      " has no key \"coordinate\": in TOML the keys after a line in brackets belong to it, up to the next such line; "
      "write \"coordinate = ...\" above the first of them, or under a line [[coordinate]]";
  EXPECT_EQ(verdict(below), "study.toml:3:1: error: [damping]" + told);
  EXPECT_EQ(verdict("[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = 1.0\nstep = 0.1\n" +
                    below.substr(below.find("coordinate"))),
            "study.toml:6:1: error: analysis \"run\"" + told);
}

TEST(KeyError, QuotesTheBeginningOfALongText) {
  const std::string long_text(1000000, 'x');
  EXPECT_LT(verdict_with("mass = 1.0", "mass = \"" + long_text + "\"").size(), 500u);
  EXPECT_LT(verdict_with("step = 0.005", "step = [\"" + long_text + "\"]").size(), 500u);
  EXPECT_LT(verdict_with("[\"blade\", \"ground\"]", "[\"" + long_text + "\", \"ground\"]").size(), 7000u);
}

TEST(KeyError, NamesAnUnknownKeyAndTheNearestKnownOne) {
  EXPECT_EQ(
      verdict_with("mass = 10.0", "mass = 10.0\npositon = 1.0"),
      "study.toml:9:1: error: coordinate \"disk\" has no key \"positon\"; did you mean \"position\"? (known: name, "
      "mass, position, velocity)");
  EXPECT_EQ(
      verdict_with("title", "titel"),
      "study.toml:1:1: error: the study has no key \"titel\"; did you mean \"title\"? (known: "
      "title, parameters, coordinate, matrices, model, reduction, cyclic, spring, damper, damping, slider, stop, "
      "bouc_wen, "
      "cable, dahl, iwan, lugre, nonlinear_spring, smooth_friction, "
      "contact, "
      "force, "
      "distributed_force, "
      "displacement, base_motion, node, material, section, beam, truss, nodes, beams, mass, support, gravity, body, "
      "joint, gear, bushing, analysis)");
}

TEST(KeyError, PointsAtTheMisspellingOfARequiredKey) {
  EXPECT_EQ(verdict_with("stiffness = 10.0", "stifness = 10.0"),
            "study.toml:28:1: error: slider \"contact\" has no key \"stifness\"; did you mean \"stiffness\"?");
  EXPECT_EQ(verdict_with("amplitude = 20.0", "amplitud = 20.0"),
            "study.toml:34:1: error: the force on \"blade\" has no key \"amplitud\"; did you mean \"amplitude\"?");
  EXPECT_EQ(verdict_with("angular_frequency", "angular_freqency"),
            "study.toml:35:1: error: the force on \"blade\" has no key \"angular_freqency\"; did you mean "
            "\"angular_frequency\"?");
  EXPECT_EQ(verdict_with("modal_ratio", "modal_ration"),
            "study.toml:23:1: error: [damping] has no key \"modal_ration\"; did you mean \"modal_ratio\"?");
}

TEST(KeyError, NamesAnUnknownTable) {
  EXPECT_EQ(
      verdict_with("[[spring]]", "[[sprig]]"),
      "study.toml:14:3: error: the study has no key \"sprig\"; did you mean \"spring\"? (known: "
      "title, parameters, coordinate, matrices, model, reduction, cyclic, spring, damper, damping, slider, stop, "
      "bouc_wen, "
      "cable, dahl, iwan, lugre, nonlinear_spring, smooth_friction, "
      "contact, "
      "force, "
      "distributed_force, "
      "displacement, base_motion, node, material, section, beam, truss, nodes, beams, mass, support, gravity, body, "
      "joint, gear, bushing, analysis)");
}

TEST(KeyError, NamesAMissingKeyAtItsTable) {
  EXPECT_EQ(verdict_with("mass = 1.0\n", ""), "study.toml:10:1: error: coordinate \"blade\" lacks the key \"mass\"");
  EXPECT_EQ(verdict_with("normal_load = \"N0\"\n", ""),
            "study.toml:25:1: error: slider \"contact\" lacks the key \"normal_load\"");
  EXPECT_EQ(
      verdict_with("between = [\"blade\", \"ground\"]\nstiffness = 10.0", "shares = { blade = 1 }\nstiffness = 10.0"),
      "study.toml:27:10: error: slider \"contact\": \"shares\" are not taken here, whose u is the difference of two "
      "coordinates: take between, or a [[contact]] with tangential and normal shares and a constant normal_load");
  EXPECT_EQ(verdict_with("name = \"disk\"\n", ""), "study.toml:6:1: error: [[coordinate]] lacks the key \"name\"");
  EXPECT_EQ(verdict_with("angular_frequency = 7.0\n", ""),
            "study.toml:32:1: error: the force on \"blade\" lacks \"angular_frequency\" [rad/s] or \"frequency\" [Hz]");
  EXPECT_EQ(
      verdict_with("amplitude = 20.0\n", ""),
      "study.toml:32:1: error: the force on \"blade\" needs exactly one of \"amplitude\" (harmonic), \"expression\" "
      "(of t) and \"table\" (a CSV file), got 0");
}

TEST(KeyError, RefusesKeysThatExcludeEachOther) {
  EXPECT_EQ(
      verdict_with("amplitude = 20.0", "amplitude = 20.0\nexpression = \"t\""),
      "study.toml:32:1: error: the force on \"blade\" needs exactly one of \"amplitude\" (harmonic), \"expression\" "
      "(of t) and \"table\" (a CSV file), got 2");
  EXPECT_EQ(
      verdict_with("amplitude = 20.0", "expression = \"t\""),
      "study.toml:35:1: error: the force on \"blade\": \"angular_frequency\" does not go with \"expression\"; keep "
      "one of them");
  EXPECT_EQ(
      verdict_with("angular_frequency = 7.0", "angular_frequency = 7.0\nbeyond = \"zero\""),
      "study.toml:36:1: error: the force on \"blade\": \"beyond\" does not go with \"amplitude\"; keep one of them");
  EXPECT_EQ(
      verdict_with("angular_frequency = 7.0", "angular_frequency = 7.0\nfrequency = 1.0"),
      "study.toml:36:13: error: the force on \"blade\" has both \"angular_frequency\" [rad/s] and \"frequency\" [Hz]; "
      "keep one");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "modal_ratio = 0.02\nrayleigh = { mass = 1.0 }"),
            "study.toml:22:1: error: [damping] has both \"modal_ratio\" and \"rayleigh\"; keep one");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "rayleigh = { mass = 1.0 }\nmodes = 2"),
            "study.toml:24:1: error: [damping]: \"modes\" does not go with \"rayleigh\"; keep one of them");
}

TEST(TypeError, NamesTheValueFoundAndWhatIsWanted) {
  EXPECT_EQ(verdict_with("mass = 1.0", "mass = true"),
            "study.toml:12:8: error: coordinate \"blade\": mass must be a number or an expression in quotes, got true");
  EXPECT_EQ(
      verdict_with("mass = 1.0", "mass = 2026-01-01"),
      "study.toml:12:8: error: coordinate \"blade\": mass must be a number or an expression in quotes, got a date");
  EXPECT_EQ(verdict_with("name = \"blade\"", "name = 3"),
            "study.toml:11:8: error: [[coordinate]]: name must be a text in quotes, got the number 3");
  EXPECT_EQ(verdict_with("[\"blade\", \"ground\"]", "\"blade\""),
            "study.toml:27:11: error: slider \"contact\": between must be a list of two names, such as [\"blade1\", "
            "\"ground\"], got the text \"blade\"");
  EXPECT_EQ(verdict_with("[\"blade\", \"ground\"]", "[\"blade\"]"),
            "study.toml:27:11: error: slider \"contact\": between must be a list of two names, such as [\"blade1\", "
            "\"ground\"], got a list of 1");
  EXPECT_EQ(verdict_with("modal_ratio = 0.02", "modal_ratio = []"),
            "study.toml:23:15: error: [damping]: modal_ratio must be a list of numbers, got an empty list");
  EXPECT_EQ(verdict_with("duration = 60.0", "duration = 60.0\nallow_unstable = 1"),
            "study.toml:42:18: error: analysis \"response\": allow_unstable must be true or false, got the number 1");
}

TEST(TypeError, SaysHowATableIsWritten) {
  EXPECT_EQ(verdict_with("[[slider]]", "[slider]"),
            "study.toml:25:1: error: \"slider\" must be written as [[slider]], a table for each");
  EXPECT_EQ(verdict_with("[[force]]", "[[base_motion]]\namplitude = 1\nfrequency = 1\n\n[[force]]"),
            "study.toml:32:1: error: \"base_motion\" must be written as [base_motion], once");
}

TEST(Numbers, MayBeWholeNumbersAndExpressions) {
  const auto study =
      io::read_study_text(edited("mass = 1.0", "mass = 2", edited("mass = 10.0", "mass = \"N0 / 4\"")), "s");
  const auto built = model::build(study.model, model::evaluate_parameters(study.parameters));
  EXPECT_EQ(built.mass[0], 2.5);
  EXPECT_EQ(built.mass[1], 2.0);
}

}  // namespace
}  // namespace rubato::testing
