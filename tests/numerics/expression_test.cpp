#include <rubato/core/error.hpp>
#include <rubato/numerics/bound_formula.hpp>
#include <rubato/numerics/expression.hpp>
#include <rubato/numerics/time_formula.hpp>

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
    const Expression expression(text, parameters, of_time);
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
}

TEST(Expression, EvaluatesFormulasOfParametersAndPi) {
  EXPECT_EQ(Expression("2 * N0 + Omega^2", parameters)(), 24.0);
  EXPECT_EQ(Expression("2 * pi", parameters)(), 2.0 * std::numbers::pi);
  EXPECT_EQ(Expression("N0 == 10 ? 1 : 0", parameters)(), 1.0);
  EXPECT_EQ(Expression("(N0 != 10) + (N0 <= 10) + (N0 >= 11)", parameters)(), 1.0);
}

// muParser refuses the second of two signs before a value.
TEST(Expression, TakesSeveralSignsInARow) {
  const Parameters of_a{{"a", 2.0}};
  const std::vector<std::pair<std::string, double>> said{
      {"- -3", 3.0},           {"--3", 3.0},     {"---3", -3.0},       {"- +3", -3.0},
      {"+-3", -3.0},           {"3---a", 1.0},   {"3 - - -a", 1.0},    {"3 -- a", 5.0},
      {"2*--a", 4.0},          {"2^- -a", 4.0},  {"2^--+-1", 0.5},     {"--a^2", 4.0},
      {"-(--a)", -2.0},        {"1e-1--1", 1.1}, {"1 ? --2 : 3", 2.0}, {"2>--1", 1.0},
      {"max(--1, - -a)", 2.0}, {"2*-3", -6.0},   {"-(-a)", 2.0},       {"a^-2", 0.25},
      {"a^-2^2", 0.0625},      {"-a^2", -4.0}};
  for (const auto& [text, value] : said) {
    EXPECT_DOUBLE_EQ(Expression(text, of_a)(), value) << text;
    EXPECT_DOUBLE_EQ(BoundFormula(text, of_a, &of_a.front().second)(), value) << text;
    EXPECT_DOUBLE_EQ(TimeFormula(text, of_a)(0.0).value, value) << text;
  }
  EXPECT_DOUBLE_EQ(TimeFormula(std::string(10001, '-') + "a", of_a)(0.0).value, -2.0);
}

TEST(Expression, FollowsTime) {
  const Expression force("N0 * cos(Omega * t)", parameters, true);
  EXPECT_EQ(force(0.0), 10.0);
  // Both sides round the same product once and call the same cosine.
  EXPECT_DOUBLE_EQ(force(0.7), 10.0 * std::cos(2.0 * 0.7));
}

TEST(Expression, CopiesDoNotShareTheirTime) {
  const Expression first("t", {}, true);
  const Expression second = first;
  EXPECT_EQ(first(1.0), 1.0);
  EXPECT_EQ(second(2.0), 2.0);
  EXPECT_EQ(first(3.0), 3.0);
}

TEST(Expression, MayBeNonFiniteForItsCallerToJudge) {
  EXPECT_TRUE(std::isinf(Expression("1/0", {})()));
  EXPECT_TRUE(std::isnan(Expression("0/0", {})()));
}

TEST(ExpressionFault, NamesAnUnknownNameItsPlaceAndTheNearest) {
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

TEST(ExpressionFault, CountsCharactersFromOneAndSaysTheEnd) {
  EXPECT_EQ(fault_of("sin(2 N0)"),
            "in the expression \"sin(2 N0)\": unexpected value \"N0\" at character 7; a product is written with "
            "\"*\"");
  EXPECT_EQ(fault_of("2 * (N0 + 1"), "in the expression \"2 * (N0 + 1\": missing parenthesis at its end");
  EXPECT_EQ(fault_of("2 *"), "in the expression \"2 *\": unexpected end of expression at its end");
}

// As other languages write it.
TEST(ExpressionFault, SaysHowItIsWrittenHere) {
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

TEST(ExpressionFault, SaysHowSymbolsAndOperatorsOfOtherLanguagesAreWrittenHere) {
  EXPECT_EQ(fault_of("N0 % 3"),
            "in the expression \"N0 % 3\": unexpected \"%\" at character 4; write \"a - b*rint(a/b - 0.5)\" for a "
            "remainder");
  EXPECT_EQ(fault_of("t > 1 and t < 2", true),
            "in the expression \"t > 1 and t < 2\": unknown name \"and\" at character 7; write \"a && b\"");
  EXPECT_EQ(fault_of("t >= 1 & t < 2", true),
            "in the expression \"t >= 1 & t < 2\": unexpected \"&\" at character 8; write \"a && b\"");
  EXPECT_EQ(fault_of("t => 1", true),
            "in the expression \"t => 1\": unexpected operator \">\" at character 4; write \">=\"");
  EXPECT_EQ(fault_of("sin N0"),
            "in the expression \"sin N0\": unknown name \"sin\" at character 1; arguments of a function stand in "
            "parentheses: \"sin(a)\"");
  EXPECT_EQ(fault_of("(N0)(2)"),
            "in the expression \"(N0)(2)\": unexpected parenthesis \"(\" at character 5; a product is written with "
            "\"*\"");
  EXPECT_EQ(fault_of("round(N0)"),
            "in the expression \"round(N0)\": unknown name \"round\" at character 1; the nearest whole number is "
            "\"rint(a)\"");
}

// Texts that are copied from a page hold a minus sign that is no hyphen; characters are counted, not bytes.
TEST(ExpressionFault, CountsCharactersOfMoreThanOneByte) {
  EXPECT_EQ(fault_of("−2 × 3"),
            "in the expression \"−2 × 3\": unexpected \"−\" at character 1; a minus is written \"-\"");
  EXPECT_EQ(fault_of("2 × 3 × 4"),
            "in the expression \"2 × 3 × 4\": unexpected \"×\" at character 3; a product is written with \"*\"");
}

// The place of what follows a number tells of a missing product only where a value begins there.
TEST(ExpressionFault, DoesNotAskForAProductBeforeAParenthesisThatCloses) {
  EXPECT_EQ(fault_of("atan2(1)"),
            "in the expression \"atan2(1)\": too few parameters for function \"atan2\" at character 8");
}

TEST(ExpressionFault, QuotesTheBeginningOfALongFormula) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "N0+";
  EXPECT_EQ(fault_of(text + "M0"), "in the expression \"" + text.substr(0, 80) +
                                       "... (3002 characters)\": unknown name \"M0\" at character 3001; did you mean "
                                       "\"N0\"? (known: pi, N0, Omega)");
  EXPECT_LT(fault_of(std::string(1000000, '(')).size(), 400u);
}

// muParser alone would take the last of a list: 1,5 would be 5.
TEST(ExpressionFault, RefusesADecimalComma) {
  EXPECT_EQ(fault_of("1,5"),
            "in the expression \"1,5\": 2 values with commas between them; give one, with a point for its decimals");
}

// muParser alone would set the time to 3.
TEST(ExpressionFault, RefusesAnAssignment) {
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
