#include <rubato/core/error.hpp>
#include <rubato/io/write_csv.hpp>

#include <gmock/gmock.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "io/sink_samples.hpp"

namespace rubato::io {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

class WriteCsv : public testing::SinkTest {};

TEST_F(WriteCsv, BlocksOverTheSameLabelsAreInterleavedByLabel) {
  CsvSink sink(folder_);
  const double row[] = {0.5, 1, 2, 10, 20, -3};
  sink.open(testing::transient_layout())->append(row);
  EXPECT_EQ(
      text("response.csv"),
      "time [s],disk.position [m],disk.velocity [m/s],\"blade, left.position [m]\",\"blade, left.velocity [m/s]\","
      "contact.force [N]\n"
      "0.5,1,10,2,20,-3\n");
}

TEST_F(WriteCsv, BlocksOverOtherLabelsOfTheSameDimensionStayApart) {
  CsvSink sink(folder_);
  results::TableLayout layout = testing::transient_layout();
  layout.blocks = {
      {"time", "s", "", "", {}}, {"a", "", "", "coordinate", {"x", "y"}}, {"b", "", "", "coordinate", {"x"}}};
  const double row[] = {0, 1, 2, 3};
  sink.open(layout)->append(row);
  EXPECT_EQ(text("response.csv"), "time [s],x.a,y.a,x.b\n0,1,2,3\n");
}

TEST_F(WriteCsv, ANamedTableHasItsFileAndWordsAreWrittenAsWords) {
  CsvSink sink(folder_);
  const double first[] = {1, 2.5, 0}, second[] = {0, std::nan(""), 1}, third[] = {0, HUGE_VAL, std::nan("")};
  {
    const auto rows = sink.open(testing::word_layout());
    rows->append(first);
    rows->append(second);
    rows->append(third);
  }
  // What is not there is an empty field; a resonance without damping is infinite.
  EXPECT_EQ(text("study.orders.csv"), "method,ratio,status\nrk 4,2.5,done\nheun,,\"not, \"\"yet\"\"\"\nheun,inf,\n");
}

TEST_F(WriteCsv, NumbersReadBackToTheSameBitsAndAreShort) {
  std::mt19937_64 random(7);
  std::vector<double> values{0.1, 1e300, 5e-324, -0.0, 1.0 / 3.0, std::numeric_limits<double>::max()};
  while (values.size() < 2000) {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (std::isfinite(value)) values.push_back(value);
  }
  CsvSink sink(folder_);
  {
    const auto rows = sink.open({"a", "", "time", {{"x", "", "", "", {}}}, {}});
    for (const double value : values) rows->append({&value, 1});
  }
  std::istringstream lines(text("a.csv"));
  std::string line;
  std::getline(lines, line);
  for (const double value : values) {
    ASSERT_TRUE(std::getline(lines, line));
    double read = 0.0;
    std::from_chars(line.data(), line.data() + line.size(), read);
    EXPECT_EQ(std::signbit(read), std::signbit(value));
    EXPECT_EQ(read, value) << line;
  }
  EXPECT_THAT(text("a.csv"), HasSubstr("x\n0.1\n1e+300\n5e-324\n-0\n0.3333333333333333\n"));
}

TEST_F(WriteCsv, FlushedRowsAreThereWhileTheTableIsOpen) {
  CsvSink sink(folder_);
  const auto rows = sink.open(testing::transient_layout());
  const double row[] = {0.5, 1, 2, 10, 20, -3};
  rows->append(row);
  rows->flush();
  EXPECT_THAT(text("response.csv"), EndsWith("\n0.5,1,10,2,20,-3\n"));
}

TEST_F(WriteCsv, RowsThatComeSlowlyReachTheFileWithinASecond) {
  CsvSink sink(folder_);
  const auto rows = sink.open(testing::transient_layout());
  const double row[] = {0.5, 1, 2, 10, 20, -3};
  rows->append(row);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  for (int i = 0; i < 2; ++i) rows->append(row);  // the first may still count as fast
  EXPECT_THAT(text("response.csv"), HasSubstr("\n0.5,1,10,2,20,-3\n"));
}

TEST_F(WriteCsv, AFileThatMayNotGrowKeepsItsWholeRowsAndSaysWhy) {
  CsvSink sink(folder_);
  std::string message;
  {
    const testing::FileSizeLimit limit(100'000);
    const auto rows = sink.open(testing::transient_layout());
    const double row[] = {0.1234567890123, 1, 2, 10, 20, -3};
    try {
      for (int i = 0; i < 100'000; ++i) rows->append(row);
    } catch (const OutputError& fault) {
      message = fault.what();
    }
  }
  EXPECT_EQ(message, (folder_ / "response.csv").string() + ": File too large; write elsewhere (-o DIR)");
  const std::string written = text("response.csv");
  const std::string line = "0.1234567890123,1,10,2,20,-3\n";
  EXPECT_GT(written.size(), 100'000 - line.size());
  EXPECT_THAT(written, EndsWith("\n" + line));
}

TEST_F(WriteCsv, AFormerTableStaysUntilRowsOfTheNewOneAreWritten) {
  std::ofstream(folder_ / "response.csv") << "former";
  CsvSink sink(folder_);
  const double row[] = {0.5, 1, 2, 10, 20, -3};
  {
    const testing::FileSizeLimit limit(10);
    const auto rows = sink.open(testing::transient_layout());
    rows->append(row);
    EXPECT_THROW(rows->flush(), OutputError);
  }
  EXPECT_EQ(text("response.csv"), "former");
  const auto rows = sink.open(testing::transient_layout());
  rows->append(row);
  EXPECT_EQ(text("response.csv"), "former");
  rows->flush();
  EXPECT_THAT(text("response.csv"), EndsWith("\n0.5,1,10,2,20,-3\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "response.csv.partial"));
}

TEST_F(WriteCsv, TablesWaitForWhoeverSaysThatTheyMayReplaceFormerOnes) {
  const double row[] = {0.5, 1, 2, 10, 20, -3};
  for (const bool may_at_last : {false, true}) {
    std::ofstream(folder_ / "response.csv") << "former";
    bool may = false;
    CsvSink sink(folder_, [&] { return may; });
    sink.open(testing::transient_layout())->append(row);
    EXPECT_EQ(text("response.csv"), "former");
    may = may_at_last;
    sink.close();
    EXPECT_EQ(sink.written().contains("response.csv"), may_at_last);
    EXPECT_EQ(text("response.csv") == "former", !may_at_last);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "response.csv.partial"));
}

TEST_F(WriteCsv, AFullDiskIsCalledFull) {
  std::filesystem::create_symlink("/dev/full", folder_ / "response.csv");
  CsvSink sink(folder_);
  const auto rows = sink.open(testing::transient_layout());
  try {
    rows->flush();
    FAIL() << "the header was written to a full device";
  } catch (const OutputError& fault) {
    EXPECT_EQ(fault.what(),
              (folder_ / "response.csv").string() + ": the disk is full; free some space or write elsewhere (-o DIR)");
  }
}

TEST_F(WriteCsv, AMissingFolderIsSaidByName) {
  CsvSink sink(folder_ / "nowhere");
  EXPECT_THROW(sink.open(testing::transient_layout()), OutputError);
}

}  // namespace
}  // namespace rubato::io
