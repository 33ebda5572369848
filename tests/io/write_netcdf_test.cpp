#include <rubato/core/error.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/tee_sink.hpp>
#include <rubato/io/write_csv.hpp>
#include <rubato/io/write_netcdf.hpp>

#include <gmock/gmock.h>
#include <netcdf.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "io/sink_samples.hpp"

namespace rubato::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Reads with the C library alone, so that nothing of ours can agree with itself.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) { status_ = nc_open(path.c_str(), NC_NOWRITE, &file_); }
  ~Reader() {
    if (is_readable()) nc_close(file_);
  }
  bool is_readable() const { return status_ == NC_NOERR; }
  int root() const { return file_; }
  int group(const std::string& path) const {
    int id = -1;
    EXPECT_EQ(nc_inq_grp_full_ncid(file_, path.c_str(), &id), NC_NOERR) << path;
    return id;
  }
  static int variable(int group, const std::string& name) {
    int id = -1;
    EXPECT_EQ(nc_inq_varid(group, name.c_str(), &id), NC_NOERR) << name;
    return id;
  }
  static std::string attribute(int group, int variable, const std::string& name) {
    std::size_t length = 0;
    EXPECT_EQ(nc_inq_attlen(group, variable, name.c_str(), &length), NC_NOERR) << name;
    std::string text(length, '\0');
    nc_get_att_text(group, variable, name.c_str(), text.data());
    return text;
  }
  static std::size_t length(int group, const std::string& dimension) {
    int id = -1;
    std::size_t length = 0;
    EXPECT_EQ(nc_inq_dimid(group, dimension.c_str(), &id), NC_NOERR) << dimension;
    nc_inq_dimlen(group, id, &length);
    return length;
  }
  static std::vector<double> values(int group, const std::string& name, std::size_t count) {
    std::vector<double> out(count);
    EXPECT_EQ(nc_get_var_double(group, variable(group, name), out.data()), NC_NOERR) << name;
    return out;
  }
  static std::vector<std::string> dimensions(int group, const std::string& name) {
    int count = 0, ids[NC_MAX_VAR_DIMS] = {};
    nc_inq_varndims(group, variable(group, name), &count);
    nc_inq_vardimid(group, variable(group, name), ids);
    std::vector<std::string> out;
    for (int i = 0; i < count; ++i) {
      char dimension[NC_MAX_NAME + 1] = {};
      nc_inq_dimname(group, ids[i], dimension);
      out.emplace_back(dimension);
    }
    return out;
  }

 private:
  int file_ = -1, status_ = NC_NOERR;
};

class WriteNetcdf : public testing::SinkTest {
 protected:
  std::filesystem::path path() const { return folder_ / "results.nc"; }
  Provenance provenance() const {
    return {"A title", "study.toml", "title = \"A title\"\n", "rubato run study.toml", "2026-01-31T12:00:00Z"};
  }
};

const double first_row[] = {0.5, 1, 2, 10, 20, -3}, second_row[] = {1.5, 3, 4, 30, 40, -6};

TEST_F(WriteNetcdf, TheFileSaysWhereItComesFrom) {
  NetcdfSink(path(), provenance()).close();
  const Reader file(path());
  EXPECT_EQ(Reader::attribute(file.root(), NC_GLOBAL, "title"), "A title");
  EXPECT_EQ(Reader::attribute(file.root(), NC_GLOBAL, "history"), "2026-01-31T12:00:00Z rubato run study.toml");
  EXPECT_EQ(Reader::attribute(file.root(), NC_GLOBAL, "study"), "title = \"A title\"\n");
  EXPECT_EQ(Reader::attribute(file.root(), NC_GLOBAL, "Conventions"), "CF-1.8");
  EXPECT_THAT(Reader::attribute(file.root(), NC_GLOBAL, "source"), HasSubstr("rubato "));
}

TEST_F(WriteNetcdf, RowsLieAlongTheirDimensionAndLabelsBearItsName) {
  NetcdfSink sink(path(), provenance());
  {
    const auto rows = sink.open(testing::transient_layout());
    rows->append(first_row);
    rows->append(second_row);
  }
  sink.conclude("response", "done", "", {{"steps", "2"}});
  sink.close();
  const Reader file(path());
  const int group = file.group("/response");
  EXPECT_EQ(Reader::length(group, "time"), 2u);
  EXPECT_THAT(Reader::dimensions(group, "time"), ElementsAre("time"));
  EXPECT_THAT(Reader::dimensions(group, "velocity"), ElementsAre("time", "coordinate"));
  EXPECT_THAT(Reader::values(group, "time", 2), ElementsAre(0.5, 1.5));
  EXPECT_THAT(Reader::values(group, "position", 4), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(Reader::values(group, "velocity", 4), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(Reader::values(group, "force", 2), ElementsAre(-3, -6));
  EXPECT_EQ(Reader::attribute(group, Reader::variable(group, "velocity"), "units"), "m/s");
  EXPECT_EQ(Reader::attribute(group, Reader::variable(group, "velocity"), "long_name"), "velocity");
  EXPECT_EQ(Reader::attribute(group, NC_GLOBAL, "method"), "newmark");
  EXPECT_EQ(Reader::attribute(group, NC_GLOBAL, "status"), "done");
  EXPECT_EQ(Reader::attribute(group, NC_GLOBAL, "steps"), "2");
  char* labels[2] = {};
  ASSERT_EQ(nc_get_var_string(group, Reader::variable(group, "coordinate"), labels), NC_NOERR);
  EXPECT_STREQ(labels[0], "disk");
  EXPECT_STREQ(labels[1], "blade, left");
  nc_free_string(2, labels);
}

TEST_F(WriteNetcdf, WordsAreFlagsAndWhatIsNotThereIsMissing) {
  NetcdfSink sink(path(), provenance());
  const double first[] = {1, 2.5, 0}, second[] = {0, std::nan(""), std::nan("")}, third[] = {0, HUGE_VAL, 1};
  {
    const auto rows = sink.open(testing::word_layout());
    rows->append(first);
    rows->append(second);
    rows->append(third);
  }
  sink.close();
  const Reader file(path());
  const int group = file.group("/study/orders");
  const int method = Reader::variable(group, "method");
  nc_type type = NC_NAT;
  nc_inq_vartype(group, method, &type);
  EXPECT_EQ(type, NC_INT);
  EXPECT_EQ(Reader::attribute(group, method, "flag_meanings"), "heun rk_4");
  int flags[2] = {-1, -1};
  nc_get_att_int(group, method, "flag_values", flags);
  EXPECT_THAT(flags, ElementsAre(0, 1));
  EXPECT_THAT(Reader::values(group, "method", 3), ElementsAre(1, 0, 0));
  EXPECT_THAT(Reader::values(group, "ratio", 3), ElementsAre(2.5, NC_FILL_DOUBLE, HUGE_VAL));
  EXPECT_THAT(Reader::values(group, "status", 3), ElementsAre(0, NC_FILL_INT, 1));
}

TEST_F(WriteNetcdf, ManyRowsInterruptedByFlushesArriveInOrder) {
  constexpr std::size_t count = 10'000;
  NetcdfSink sink(path(), provenance());
  {
    const auto rows = sink.open(testing::transient_layout());
    for (std::size_t i = 0; i < count; ++i) {
      const double x = static_cast<double>(i), row[] = {x, 2 * x, 3 * x, 4 * x, 5 * x, 6 * x};
      rows->append(row);
      if (i % 777 == 0) rows->flush();
    }
  }
  sink.close();
  const Reader file(path());
  const int group = file.group("/response");
  ASSERT_EQ(Reader::length(group, "time"), count);
  const auto velocity = Reader::values(group, "velocity", 2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(velocity[2 * i], 4.0 * static_cast<double>(i));
    ASSERT_EQ(velocity[2 * i + 1], 5.0 * static_cast<double>(i));
  }
}

TEST_F(WriteNetcdf, AWideTableAndATableWithoutLabelsAreWritten) {
  constexpr std::size_t width = 100'000;
  results::TableLayout wide{
      "wide", "", "time", {{"time", "s", "", "", {}}, {"position", "m", "", "coordinate", {}}}, {}};
  results::TableLayout bare = wide;
  bare.analysis = "bare";
  for (std::size_t i = 0; i < width; ++i) wide.blocks[1].labels.push_back("x" + std::to_string(i));
  NetcdfSink sink(path(), provenance());
  {
    const auto rows = sink.open(wide), few = sink.open(bare);
    std::vector<double> row(width + 1);
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<double>(i);
    for (int i = 0; i < 3; ++i) rows->append(row);
    few->append({row.data(), 1});
  }
  sink.close();
  const Reader file(path());
  EXPECT_EQ(Reader::length(file.group("/bare"), "time"), 1u);
  const auto position = Reader::values(file.group("/wide"), "position", 3 * width);
  EXPECT_EQ(position[0], 1.0);
  EXPECT_EQ(position[3 * width - 1], static_cast<double>(width));
}

// What a killed process leaves: nothing is closed, only what was synchronised counts.
TEST_F(WriteNetcdf, FlushedRowsAreReadableInACopyWhileTheFileIsOpen) {
  NetcdfSink sink(path(), provenance());
  const auto rows = sink.open(testing::transient_layout());
  rows->append(first_row);
  rows->flush();
  std::filesystem::copy(path(), folder_ / "copy.nc");
  const Reader file(folder_ / "copy.nc");
  ASSERT_TRUE(file.is_readable());
  EXPECT_THAT(Reader::values(file.group("/response"), "position", 2), ElementsAre(1, 2));
}

TEST_F(WriteNetcdf, RowsThatComeSlowlyReachTheFileWithinASecond) {
  NetcdfSink sink(path(), provenance());
  const auto rows = sink.open(testing::transient_layout());
  rows->append(first_row);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  for (int i = 0; i < 2; ++i) rows->append(second_row);  // the first may still count as fast
  std::filesystem::copy(path(), folder_ / "copy.nc");
  const Reader file(folder_ / "copy.nc");
  ASSERT_TRUE(file.is_readable());
  EXPECT_GE(Reader::length(file.group("/response"), "time"), 2u);
}

TEST_F(WriteNetcdf, AFileThatMayNotGrowStaysReadableAndCanBeConcluded) {
  for (const rlim_t bytes : {600'000, 1'000'000, 3'000'000}) {
    std::string message;
    {
      const testing::FileSizeLimit limit(bytes);
      NetcdfSink sink(path(), provenance());
      {
        const auto rows = sink.open(testing::transient_layout());
        try {
          for (int i = 0; i < 1'000'000; ++i) rows->append(first_row);
        } catch (const OutputError& fault) {
          message = fault.what();
        }
      }
      EXPECT_FALSE(sink.has_failed());
      sink.conclude("response", "failed", message, {});
      sink.close();
    }
    EXPECT_EQ(message, path().string() + ": File too large; write elsewhere (-o DIR)");
    const Reader file(path());
    ASSERT_TRUE(file.is_readable());
    const int group = file.group("/response");
    EXPECT_EQ(Reader::attribute(group, NC_GLOBAL, "status"), "failed");
    // A row takes 48 bytes; what is kept free for closing, and a chunk of 1024 rows, may be missing.
    const std::size_t rows = Reader::length(group, "time");
    EXPECT_GT(rows * 48 + 1024 * 48 + 300'000, bytes);
    const auto force = Reader::values(group, "force", rows);
    EXPECT_EQ(std::count(force.begin(), force.end(), -3.0), static_cast<std::ptrdiff_t>(rows));
  }
}

TEST_F(WriteNetcdf, APlaceThatCannotBeWrittenIsSaidByName) {
  std::filesystem::create_directory(path());
  try {
    NetcdfSink sink(path(), provenance());
    FAIL() << "a folder was opened as a file";
  } catch (const OutputError& fault) {
    EXPECT_THAT(fault.what(), HasSubstr(path().string() + ": "));
  }
}

TEST_F(WriteNetcdf, TwoThreadsMayWriteATableEach) {
  constexpr std::size_t count = 50'000;
  NetcdfSink sink(path(), provenance());
  const auto write = [&](const std::string& analysis, double sign) {
    results::TableLayout layout = testing::transient_layout();
    layout.analysis = analysis;
    const auto rows = sink.open(layout);
    for (std::size_t i = 0; i < count; ++i) {
      const double row[] = {static_cast<double>(i), sign, sign, sign, sign, sign};
      rows->append(row);
    }
  };
  std::thread other(write, "a", 1.0);
  write("b", -1.0);
  other.join();
  sink.close();
  const Reader file(path());
  for (const auto& [name, sign] : {std::pair{"/a", 1.0}, std::pair{"/b", -1.0}}) {
    const int group = file.group(name);
    ASSERT_EQ(Reader::length(group, "time"), count);
    const auto force = Reader::values(group, "force", count);
    EXPECT_EQ(std::count(force.begin(), force.end(), sign), static_cast<std::ptrdiff_t>(count));
  }
}

TEST_F(WriteNetcdf, ATeeSendsTheSameRowsToBothKindsOfFile) {
  NetcdfSink netcdf(path(), provenance());
  CsvSink csv(folder_);
  TeeSink tee({&netcdf, &csv});
  tee.open(testing::transient_layout())->append(first_row);
  tee.conclude("response", "interrupted", "at t = 0.5 s", {});
  netcdf.close();
  EXPECT_THAT(text("response.csv"), HasSubstr("0.5,1,10,2,20,-3\n"));
  const Reader file(path());
  EXPECT_THAT(Reader::values(file.group("/response"), "time", 1), ElementsAre(0.5));
  EXPECT_EQ(Reader::attribute(file.group("/response"), NC_GLOBAL, "message"), "at t = 0.5 s");
}

TEST_F(WriteNetcdf, AFormerFileStaysUntilRowsOfTheNewOneAreWritten) {
  std::ofstream(path()) << "former";
  {
    NetcdfSink sink(path(), provenance());
    sink.expect("response");
    EXPECT_THROW(sink.expect("-o"), OutputError);  // netCDF knows no such name
  }
  EXPECT_EQ(text("results.nc"), "former");
  NetcdfSink sink(path(), provenance());
  const auto rows = sink.open(testing::transient_layout());
  rows->append(first_row);
  EXPECT_EQ(text("results.nc"), "former");
  EXPECT_TRUE(sink.is_there());
  rows->flush();
  EXPECT_NE(text("results.nc"), "former");
  EXPECT_TRUE(sink.is_there());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results.nc.partial"));
  std::filesystem::remove(path());
  EXPECT_FALSE(sink.is_there());
}

TEST_F(WriteNetcdf, AFolderWithoutRoomForTheResultsIsRefusedAtOnce) {
  make_output_folder(folder_ / "new" / "folder");
  EXPECT_NO_THROW(require_disk_space(folder_ / "new" / "folder", 1000.0));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "new" / "folder"));
  const double available = static_cast<double>(std::filesystem::space(folder_).available);
  try {
    require_disk_space(folder_, 2.0 * available + 1e9);
    FAIL() << "twice the free space was accepted";
  } catch (const OutputError& fault) {
    EXPECT_THAT(fault.what(), HasSubstr("the results may take"));
  }
  EXPECT_TRUE(has_disk_space(path(), 0.0));
  EXPECT_FALSE(has_disk_space(path(), 2.0 * available + 1e9));
}

}  // namespace
}  // namespace rubato::io
