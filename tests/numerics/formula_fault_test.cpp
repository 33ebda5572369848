#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {
namespace {

const Parameters parameters{{"N0", 10.0}, {"Omega", 2.0}};

std::string fault_of(const std::string& text, bool of_time = false) {
  try {
    const Formula formula(text, parameters, of_time);
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
}

TEST(Formula, EvaluatesFormulasOfParametersAndPi) {
  EXPECT_EQ(Formula("2 * N0 + Omega^2", parameters)(), 24.0);
  EXPECT_EQ(Formula("2 * pi", parameters)(), 2.0 * std::numbers::pi);
  EXPECT_EQ(Formula("N0 == 10 ? 1 : 0", parameters)(), 1.0);
  EXPECT_EQ(Formula("(N0 != 10) + (N0 <= 10) + (N0 >= 11)", parameters)(), 1.0);
}

TEST(Formula, FollowsTime) {
  const Formula force("N0 * cos(Omega * t)", parameters, true);
  EXPECT_EQ(force(0.0), 10.0);
  // Both sides round the same product once and call the same cosine.
  EXPECT_DOUBLE_EQ(force(0.7), 10.0 * std::cos(2.0 * 0.7));
}

TEST(Formula, MayBeNonFiniteForItsCallerToJudge) {
  EXPECT_TRUE(std::isinf(Formula("1/0", {})()));
  EXPECT_TRUE(std::isnan(Formula("0/0", {})()));
}

TEST(FormulaFault, NamesAnUnknownNameItsPlaceAndTheNearest) {
  EXPECT_EQ(
      fault_of("3 * Omga"),
      "in the expression \"3 * Omga\": unknown name \"Omga\" at character 5; did you mean \"Omega\"? (known: pi, N0, "
      "Omega)");
  EXPECT_EQ(fault_of("3 * t"), "in the expression \"3 * t\": unknown name \"t\" at character 5; known: pi, N0, Omega");
  EXPECT_EQ(fault_of("3 * t", true), "accepted");
  EXPECT_EQ(fault_of("5 s"),
            "in the expression \"5 s\": unknown name \"s\" at character 3; units are implied (m, kg, s, N, rad): write "
            "the number alone");
  EXPECT_EQ(fault_of("1.5e3N"),
            "in the expression \"1.5e3N\": unknown name \"N\" at character 6; units are implied (m, kg, s, N, rad): "
            "write the number alone");
  EXPECT_EQ(fault_of("_pi"),
            "in the expression \"_pi\": unknown name \"_pi\" at character 1; did you mean \"pi\"? (known: "
            "pi, N0, Omega)");
}

TEST(FormulaFault, CountsCharactersFromOneAndSaysTheEnd) {
  EXPECT_EQ(fault_of("sin(2 N0)"),
            "in the expression \"sin(2 N0)\": unexpected value \"N0\" at character 7; a product is written with "
            "\"*\"");
  EXPECT_EQ(fault_of("2 * (N0 + 1"), "in the expression \"2 * (N0 + 1\": missing parenthesis at its end");
  EXPECT_EQ(fault_of("2 *"), "in the expression \"2 *\": unexpected end of expression at its end");
}

// As other languages write it.
TEST(FormulaFault, SaysHowItIsWrittenHere) {
  EXPECT_EQ(fault_of("1.1pi"),
            "in the expression \"1.1pi\": unexpected value \"pi\" at character 4; a product is "
            "written with \"*\"");
  EXPECT_EQ(fault_of("t**2", true),
            "in the expression \"t**2\": unexpected operator \"*\" at character 3; a power is "
            "written \"a^b\"");
  EXPECT_EQ(fault_of("2*PI"), "in the expression \"2*PI\": unknown name \"PI\" at character 3; did you mean \"pi\"?");
  EXPECT_EQ(fault_of("2*Sin(N0)"),
            "in the expression \"2*Sin(N0)\": unknown name \"Sin\" at character 3; did you mean "
            "\"sin\"?");
  EXPECT_EQ(
      fault_of("if(t > 1, 2, 3)", true),
      "in the expression \"if(t > 1, 2, 3)\": unknown name \"if\" at character 1; a choice is written \"condition ? "
      "this : else that\"");
  EXPECT_EQ(fault_of("pow(t, 2)", true),
            "in the expression \"pow(t, 2)\": unknown name \"pow\" at character 1; a power is written \"a^b\"");
  EXPECT_EQ(fault_of("floor(t)", true),
            "in the expression \"floor(t)\": unknown name \"floor\" at character 1; write \"rint(a - 0.5)\"");
  EXPECT_EQ(fault_of("1e400"),
            "in the expression \"1e400\": unknown name \"1e400\" at character 1; as a number it is "
            "beyond what can be computed with (1.8e308)");
  // What is near to a name of the study is that.
  EXPECT_NE(fault_of("Omeg").find("did you mean \"Omega\"?"), std::string::npos);
}

TEST(FormulaFault, QuotesTheBeginningOfALongFormula) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "N0+";
  EXPECT_EQ(fault_of(text + "M0"), "in the expression \"" + text.substr(0, 80) +
                                       "... (3002 characters)\": unknown name \"M0\" at character 3001; did you mean "
                                       "\"N0\"? (known: pi, N0, Omega)");
  EXPECT_LT(fault_of(std::string(1000000, '(')).size(), 400u);
}

TEST(FormulaFault, SaysWhatStandsWhereItCannot) {
  EXPECT_EQ(fault_of("N0)"), "in the expression \"N0)\": unexpected parenthesis \")\" at character 3");
  EXPECT_EQ(fault_of("N0 ? 1"), "in the expression \"N0 ? 1\": missing \":\" of a choice \"a ? b : c\" at its end");
  EXPECT_EQ(
      fault_of("sin(1, 2, 3)"),
      "in the expression \"sin(1, 2, 3)\": the function \"sin\" takes one argument and is given 3 at character 1");
  EXPECT_EQ(fault_of("  "), "in the expression \"  \": nothing to compute at its end");
}

// The stack of the program is not to overflow, nor that of the machine.
TEST(FormulaFault, RefusesWhatIsNestedWithoutEnd) {
  const auto nested = [](int depth) { return std::string(depth, '(') + "N0" + std::string(depth, ')'); };
  EXPECT_EQ(fault_of(nested(200)), "accepted");
  EXPECT_NE(fault_of(nested(100000)).find("more than 256 levels of brackets"), std::string::npos);
  std::string powers = "2";
  for (int i = 0; i < 100000; ++i) powers += "^1";
  EXPECT_NE(fault_of(powers).find("more than 256 levels"), std::string::npos);
}

TEST(FormulaFault, RefusesADecimalComma) {
  EXPECT_EQ(fault_of("1,5"),
            "in the expression \"1,5\": 2 values with commas between them; give one, with a point for its decimals");
}

TEST(FormulaFault, RefusesAnAssignment) {
  EXPECT_EQ(fault_of("1 + (t = 3)", true),
            "in the expression \"1 + (t = 3)\": \"=\" at character 8 assigns, which a formula cannot; a comparison is "
            "written "
            "\"==\"");
}

TEST(Function, NamesAreKnown) {
  EXPECT_TRUE(is_function("sin"));
  EXPECT_TRUE(is_function("max"));
  EXPECT_FALSE(is_function("Omega"));
}

}  // namespace
}  // namespace rubato::numerics
