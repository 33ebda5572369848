#include <rubato/report/json.hpp>
#include <rubato/report/page.hpp>

#include <limits>

#include <gtest/gtest.h>

namespace rubato::report {
namespace {

TEST(JsonString, EscapesQuotesBackslashesAndControlCharacters) {
  EXPECT_EQ(json_string("a\"b\\c\n\t\x01"), R"("a\"b\\c\n\t\u0001")");
}

TEST(JsonString, CannotEndTheScriptItStandsIn) {
  EXPECT_EQ(json_string("</script><!--&"), R"("\u003c/script\u003e\u003c!--\u0026")");
}

TEST(JsonString, KeepsUnicodeExceptTheLineSeparatorsOfScripts) {
  EXPECT_EQ(json_string("\xCE\xA9\xE2\x82\xAC\xF0\x9D\x84\x9E"), "\"\xCE\xA9\xE2\x82\xAC\xF0\x9D\x84\x9E\"");
  EXPECT_EQ(json_string("\xE2\x80\xA8\xE2\x80\xA9"), R"("\u2028\u2029")");
}

TEST(JsonString, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(json_string("a\xFFz"), R"("a\ufffdz")");
  EXPECT_EQ(json_string("\xC0\x80"), R"("\ufffd\ufffd")") << "overlong";
  EXPECT_EQ(json_string("\xED\xA0\x80"), R"("\ufffd\ufffd\ufffd")") << "surrogate";
  EXPECT_EQ(json_string("\xE2\x82"), R"("\ufffd\ufffd")") << "cut off";
}

TEST(JsonNumber, IsNullForWhatJsonLacks) {
  EXPECT_EQ(json_number(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(json_number(-std::numeric_limits<double>::infinity()), "null");
  const double values[] = {1.0, -0.5, 1e-300, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(json_numbers(values), "[1,-0.5,1e-300,null]");
}

TEST(JsonNumber, HasTheDigitsAskedFor) { EXPECT_EQ(json_number(2.0 / 3.0, 4), "0.6667"); }

TEST(HtmlText, IsNeverMarkup) {
  EXPECT_EQ(html_text("<b a='x' b=\"y\">&"), "&lt;b a=&#39;x&#39; b=&quot;y&quot;&gt;&amp;");
}

TEST(InlineScript, HidesTheEndOfTheScriptInStrings) {
  EXPECT_EQ(inline_script("f('</script>', \"</SCRIPT\", 1 </x/)"), "f('<\\/script>', \"<\\/SCRIPT\", 1 </x/)");
}

TEST(HtmlPage, EndsNoScriptBeforeItsEnd) {
  const std::string page = html_page("A & B", "{\"a\":\"\\u003c/script\\u003e\"}");
  std::size_t closed = 0;
  for (std::size_t at = 0; (at = page.find("</script", at)) != std::string::npos; ++at) ++closed;
  EXPECT_EQ(closed, 3u) << "data, plotting library, page";
  EXPECT_NE(page.find("<title>A &amp; B</title>"), std::string::npos);
}

}  // namespace
}  // namespace rubato::report
