#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/io/checksum.hpp>
#include <rubato/io/journal_file.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

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
  for (int cut = 1; cut <= 40; ++cut) {  // two numbers with number, count and checksum before them take 40 bytes
    std::filesystem::resize_file(path(), std::filesystem::file_size(path()) - static_cast<std::uintmax_t>(cut));
    JournalFile journal(path(), "abc", true);
    EXPECT_EQ(journal.finished(), 1) << cut;
    EXPECT_EQ(journal.damage(), cut == 40 ? ""
                                          : path().string() +
                                                ": piece 2 is cut short; the 1 before it are kept, and "
                                                "the rest (" +
                                                std::to_string(40 - cut) + " bytes) is computed again");
    EXPECT_EQ(journal.read(0), piece);
    journal.keep(piece);
  }
  JournalFile journal(path(), "abc", true);
  EXPECT_EQ(journal.finished(), 2);
}

/// A journal of ten pieces of different lengths, as bytes.
class DamagedJournal : public Journal {
 protected:
  DamagedJournal() {
    for (int i = 0; i < 10; ++i) {
      std::vector<double> piece(static_cast<std::size_t>(3 + i % 4));
      for (std::size_t k = 0; k < piece.size(); ++k) piece[k] = 0.1 * (i + 1) + static_cast<double>(k);
      pieces_.push_back(piece);
    }
    JournalFile journal(path(), "abc", false);
    for (const auto& piece : pieces_) {
      places_.push_back(places_.empty() ? 0 : places_.back() + 24 + 8 * pieces_[places_.size() - 1].size());
      journal.keep(piece);
    }
    journal.flush();
    std::ifstream stream(path(), std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
    head_ = bytes_.find('\n') + 1;
    for (std::size_t& place : places_) place += head_;
  }

  /// What is found in a damaged journal: pieces that are right, fewer than there were only with a word of it. Returns
  /// how many; -1: refused with a reason.
  long finished_of(const std::string& bytes) {
    std::ofstream(path(), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      JournalFile journal(path(), "abc", true);
      EXPECT_LE(journal.finished(), 10);
      for (long i = 0; i < journal.finished(); ++i) EXPECT_EQ(journal.read(i), pieces_[static_cast<std::size_t>(i)]);
      damage_ = journal.damage();
      return journal.finished();
    } catch (const InvalidInput& fault) {
      damage_ = fault.message();
      return -1;
    }
  }

  std::vector<std::vector<double>> pieces_;
  std::vector<std::size_t> places_;  ///< where each piece begins
  std::string bytes_, damage_;
  std::size_t head_ = 0;
};

TEST_F(DamagedJournal, KeepsWhatIsBeforeAFlippedBit) {
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    std::string bytes = bytes_;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    const long piece = std::upper_bound(places_.begin(), places_.end(), at) - places_.begin() - 1;
    EXPECT_EQ(finished_of(bytes), at < head_ ? -1 : piece) << at;
    EXPECT_FALSE(damage_.empty()) << at;
  }
}

TEST_F(DamagedJournal, TakesNoPieceTwiceNorInAnotherPlace) {
  const std::string third = bytes_.substr(places_[2], places_[3] - places_[2]);
  std::string bytes = bytes_;
  EXPECT_EQ(finished_of(bytes.insert(places_[3], third)), 3);
  EXPECT_EQ(damage_, path().string() + ": piece 4 is damaged; the 3 before it are kept, and the rest (" +
                         std::to_string(bytes.size() - places_[3]) + " bytes) is computed again");
  bytes = bytes_;
  EXPECT_EQ(finished_of(bytes.erase(places_[2], third.size())), 2);
  EXPECT_FALSE(damage_.empty());
}

TEST_F(DamagedJournal, TakesNoPieceOfAnotherAnalysis) {
  std::string other;
  {
    const auto elsewhere = path().string() + ".other";
    JournalFile journal(elsewhere, "xyz", false);
    for (const auto& piece : pieces_) journal.keep(piece);
    journal.flush();
    std::ifstream stream(elsewhere, std::ios::binary);
    other.assign(std::istreambuf_iterator<char>(stream), {});
  }
  ASSERT_EQ(other.size(), bytes_.size());
  EXPECT_EQ(finished_of(bytes_.substr(0, places_[4]) + other.substr(places_[4])), 4);
  EXPECT_FALSE(damage_.empty());
}

TEST_F(DamagedJournal, IsCutWhereATailOfZerosBegins) {
  for (const std::size_t zeros : {1u, 24u, 4096u}) {
    EXPECT_EQ(finished_of(bytes_ + std::string(zeros, '\0')), 10);
    EXPECT_FALSE(damage_.empty());
    EXPECT_EQ(finished_of(bytes_.substr(0, head_) + std::string(zeros, '\0')), 0);
    EXPECT_FALSE(damage_.empty());
  }
  EXPECT_EQ(finished_of(std::string(bytes_.size(), '\0')), -1);
  EXPECT_EQ(damage_, "--resume: " + path().string() +
                         " does not begin as a journal does: it is damaged, or something else; run without --resume to "
                         "begin afresh");
}

TEST_F(DamagedJournal, GivesRightPiecesOrAWordWhateverIsDoneToIt) {
  std::mt19937_64 random(15);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = bytes_;
    for (std::size_t times = 1 + below(3); times > 0 && !bytes.empty(); --times) {
      const std::size_t at = below(bytes.size()), length = 1 + below(std::min<std::size_t>(bytes.size() - at, 200));
      switch (below(7)) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.resize(at);
          break;
        case 2:
          bytes.erase(at, length);
          break;
        case 3:
          bytes.insert(at, bytes.substr(at, length));
          break;
        case 4:
          bytes.replace(at, length, std::string(length, '\0'));
          break;
        case 5:
          bytes.append(1 + below(300), '\0');
          break;
        default:
          std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                       bytes.begin() + static_cast<std::ptrdiff_t>(at + length));
      }
    }
    const long finished = finished_of(bytes);
    // Nothing is said where whole pieces are missing at the end: so does a run leave it that is killed in time.
    const bool is_a_beginning = bytes.size() <= bytes_.size() && bytes_.starts_with(bytes);
    EXPECT_EQ(damage_.empty(), (is_a_beginning && (bytes.size() <= head_ || bytes.size() == bytes_.size() ||
                                                   std::count(places_.begin(), places_.end(), bytes.size()) > 0)) ||
                                   bytes == bytes_)
        << i << ": " << finished << " " << damage_;
  }
}

TEST_F(Journal, RefusesThatOfAnEarlierVersion) {
  std::ofstream(path(), std::ios::binary) << "rubato journal 1 abc\n" << std::string(64, '\0');
  try {
    JournalFile(path(), "abc", true);
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_EQ(fault.what(), "error: --resume: " + path().string() +
                                " was left by an earlier Rubato, whose journals cannot be verified; run without "
                                "--resume to begin afresh");
  }
}

TEST(Checksum, IsThatOfTheCatalogue) {
  io::Checksum checksum;
  checksum.take("123456789", 9);
  EXPECT_EQ(checksum.value(), 0x995dc9bbdf1939fau);  // CRC-64/XZ, check value of the reveng catalogue
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
    EXPECT_EQ(fault.what(),
              "error: --resume: " + path().string() +
                  " was left by another study, other files that it names, other values of --set or another "
                  "version; run without --resume to begin afresh");
  }
}

std::string fingerprint(const std::string& text, const ScratchFolder& folder, const std::string& name = "study.toml",
                        const numerics::Parameters& overrides = {}, const std::string& analysis = "frf") {
  io::SourceFiles files;
  const auto study = io::read_study_text(text, name, folder.path(), &files);
  return io::fingerprint_of(study, files, overrides, analysis);
}

TEST(Fingerprint, ChangesWithTheTextItsFilesAndTheSettings) {
  const ScratchFolder folder("fingerprint");
  folder.write("load.csv", "0,1\n1,2\n");
  const std::string text = edited("amplitude = 20.0\nangular_frequency = 7.0", "table = \"load.csv\"");
  const std::string mark = fingerprint(text, folder);
  EXPECT_EQ(fingerprint(text, folder, "elsewhere.toml"), mark);
  EXPECT_NE(fingerprint(text, folder, "study.toml", {{"N0", 1.0}}), mark);
  EXPECT_NE(fingerprint(text, folder, "study.toml", {}, "other"), mark);
  EXPECT_NE(fingerprint(text + "\n", folder), mark);
  folder.write("load.csv", "0,1\n1,2.5\n");
  EXPECT_NE(fingerprint(text, folder), mark);
}

TEST(Fingerprint, ChangesWithEachFileOfAMesh) {
  const ScratchFolder folder("fingerprint-mesh");
  const std::string text =
      "[nodes]\nfile = \"nodes.csv\"\n[beams]\nfile = \"beams.csv\"\nsection = \"tube\"\nmaterial = \"steel\"\n";
  const auto write = [&](const std::string& height, const std::string& second) {
    folder.write("nodes.csv", "name,x,y\n1,0,0\n2,0," + height + "\n3,2,1.5\n");
    folder.write("beams.csv", "first,second\n1,2\n2," + second + "\n");
  };
  write("1.5", "3");
  const std::string mark = fingerprint(text, folder);
  EXPECT_EQ(fingerprint(text, folder), mark);
  write("1.6", "3");
  EXPECT_NE(fingerprint(text, folder), mark);
  write("1.5", "1");
  EXPECT_NE(fingerprint(text, folder), mark);
  write("1.5", "3");
  EXPECT_EQ(fingerprint(text, folder), mark);
}

}  // namespace
}  // namespace rubato::testing
