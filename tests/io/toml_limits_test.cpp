#include "io/study_text.hpp"

#include <gtest/gtest.h>

namespace rubato::testing {
namespace {

std::string dotted(std::size_t parts, const std::string& part = "a") {
  std::string key = part;
  for (std::size_t i = 1; i < parts; ++i) key += "." + part;
  return key;
}

const std::string refusal =
    "error: a key of more than 32 parts with dots between them; no key of a study has more than three";

// 40,000 parts made as many tables within one another, whose destructors overflowed the stack.
TEST(TomlLimits, RefuseAKeyOfManyPartsWhereverItStands) {
  EXPECT_EQ(verdict(dotted(40000) + " = 1\n" + study_text), "study.toml:1:1: " + refusal);
  EXPECT_EQ(verdict(study_text + "[" + dotted(40000) + "]\n"), "study.toml:42:2: " + refusal);
  EXPECT_EQ(verdict(study_text + "[[" + dotted(40000) + "]]\n"), "study.toml:42:3: " + refusal);
  EXPECT_EQ(verdict(study_text + "x = { y = [1.5, {" + dotted(40000, "\"b\"") + " = 1 }] }\n"),
            "study.toml:42:18: " + refusal);
}

TEST(TomlLimits, LeaveStringsAndCommentsAlone) {
  const std::string dots(1000, '.');
  for (const std::string& quoted :
       {"\"" + dots + "\\\"" + dots + "\"", "'" + dots + "'", "'" + dots + "\"'",
        "\"\"\"" + dots + "\n\"" + dots + "\"\"" + dots + "\"\"\"\"\"", "'''" + dots + "\n''" + dots + "'''''"})
    EXPECT_EQ(verdict("title = " + quoted + " # " + dots + "\n" + study_text.substr(study_text.find("[parameters]"))),
              "accepted")
        << quoted.substr(0, 4);
  // Behind a string of two lines the place is still right.
  EXPECT_EQ(verdict("title = '''" + dots + "\n'''\n" + dotted(33) + " = 1\n"), "study.toml:3:1: " + refusal);
  EXPECT_EQ(verdict(dotted(32) + " = 1\n" + study_text).find("study.toml:1:1: error: the study has no key \"a\""), 0u);
}

TEST(TomlLimits, LeaveQuotesThatAreNotClosedToToml) {
  for (const std::string text : {"title = \"", "title = '''", "title = \"\"\"\\", "title = \"a\nb = 1\n"})
    EXPECT_EQ(verdict(text).find("study.toml:1"), 0u) << text << ": " << verdict(text);
}

TEST(TomlLimits, DeepListsAndTablesAreRefusedByToml) {
  const std::string deep = "x = " + std::string(100000, '[') + std::string(100000, ']') + "\n";
  EXPECT_EQ(verdict(deep + study_text)
                .find("study.toml:1:261: error: this is no TOML: Error while parsing value: "
                      "exceeded maximum nested value depth of 256"),
            0u);
}

}  // namespace
}  // namespace rubato::testing
