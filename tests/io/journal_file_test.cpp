#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/io/journal_file.hpp>

#include <cmath>

namespace rubato::testing {
namespace {

using io::JournalFile;
using ::testing::ElementsAre;

class Journal : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "frf.resume"; }
  ScratchFolder folder_{"journal"};
};

TEST_F(Journal, GivesBackWhatItKept) {
  const std::vector<double> first{1.0, 0.1, HUGE_VAL}, second{-0.0};
  {
    JournalFile journal(path(), "abc", false);
    EXPECT_EQ(journal.finished(), 0);
    journal.keep(first);
    journal.keep(second);
  }
  JournalFile journal(path(), "abc", true);
  ASSERT_EQ(journal.finished(), 2);
  EXPECT_EQ(journal.read(0), first);
  EXPECT_EQ(journal.read(1), second);
  journal.keep(first);
  EXPECT_EQ(journal.finished(), 3);
}

TEST_F(Journal, ForgetsAPieceThatWasCutShort) {
  const std::vector<double> piece{1.0, 2.0};
  {
    JournalFile journal(path(), "abc", false);
    journal.keep(piece);
    journal.keep(piece);
  }
  for (int cut = 1; cut <= 32; ++cut) {  // two numbers with their count on either side take 32 bytes
    std::filesystem::resize_file(path(), std::filesystem::file_size(path()) - static_cast<std::uintmax_t>(cut));
    JournalFile journal(path(), "abc", true);
    EXPECT_EQ(journal.finished(), 1) << cut;
    EXPECT_EQ(journal.read(0), piece);
    journal.keep(piece);
  }
  JournalFile journal(path(), "abc", true);
  EXPECT_EQ(journal.finished(), 2);
}

TEST_F(Journal, BeginsAfreshWhereThereIsNoneOrItIsNotWanted) {
  EXPECT_EQ(JournalFile(path(), "abc", true).finished(), 0);
  const std::vector<double> piece{1.0};
  JournalFile(path(), "abc", true).keep(piece);
  EXPECT_EQ(JournalFile(path(), "abc", true).finished(), 1);
  EXPECT_EQ(JournalFile(path(), "xyz", false).finished(), 0);
}

TEST_F(Journal, RefusesAnotherStudy) {
  JournalFile(path(), "abc", false).flush();
  try {
    JournalFile(path(), "abd", true);
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_EQ(fault.what(), "error: --resume: " + path().string() +
                                " was left by another study, other values of --set or another version; run without "
                                "--resume to begin afresh");
  }
}

TEST(Fingerprint, ChangesWithTheTextItsFilesAndTheSettings) {
  const ScratchFolder folder("fingerprint");
  folder.write("load.csv", "0,1\n1,2\n");
  const std::string text = edited("amplitude = 20.0\nangular_frequency = 7.0", "table = \"load.csv\"");
  const auto study = io::read_study_text(text, "study.toml", folder.path());
  const std::string mark = io::fingerprint_of(study, {}, "frf");
  EXPECT_EQ(io::fingerprint_of(io::read_study_text(text, "elsewhere.toml", folder.path()), {}, "frf"), mark);
  EXPECT_NE(io::fingerprint_of(study, {{"N0", 1.0}}, "frf"), mark);
  EXPECT_NE(io::fingerprint_of(study, {}, "other"), mark);
  EXPECT_NE(io::fingerprint_of(io::read_study_text(text + "\n", "study.toml", folder.path()), {}, "frf"), mark);
  folder.write("load.csv", "0,1\n1,2.5\n");
  EXPECT_NE(io::fingerprint_of(io::read_study_text(text, "study.toml", folder.path()), {}, "frf"), mark);
}

}  // namespace
}  // namespace rubato::testing
