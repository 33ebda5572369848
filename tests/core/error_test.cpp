#include <rubato/core/error.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rubato {
namespace {

TEST(InvalidInput, NamesFileLineAndColumn) {
  const InvalidInput fault({"study.toml", 31, 12}, "slider \"contact1\" joins nothing");
  EXPECT_STREQ(fault.what(), "study.toml:31:12: error: slider \"contact1\" joins nothing");
  EXPECT_STREQ(InvalidInput("no such file").what(), "error: no such file");
}

TEST(NearestName, FindsATypingSlipAndNothingFarAway) {
  const std::vector<std::string> known{"disk1", "blade1", "disk2", "blade2", "damper"};
  EXPECT_EQ(nearest_name("balde2", known), "blade2");
  EXPECT_EQ(nearest_name("demper", known), "damper");
  EXPECT_EQ(nearest_name("turbine", known), "");
}

TEST(Suggestion, ListsAtMostEightNames) {
  const std::vector<std::string> known{"a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "a9"};
  EXPECT_EQ(suggestion("zzzz", known), "; known: a1, a2, a3, a4, a5, a6, a7, a8, ...");
  EXPECT_EQ(suggestion("dampr", std::vector<std::string>{"damper"}), "; did you mean \"damper\"? (known: damper)");
}

}  // namespace
}  // namespace rubato
