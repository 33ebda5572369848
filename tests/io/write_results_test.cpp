#include <rubato/core/error.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/tee_sink.hpp>
#include <rubato/io/write_csv.hpp>
#include <rubato/io/write_netcdf.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <unistd.h>

namespace rubato::io {
namespace {

namespace fs = std::filesystem;

class WriteResults : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rubato-write-" + std::to_string(::getpid()) + "-" +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string text(const std::string& name) const {
    std::ifstream stream(folder_ / name);
    std::ostringstream out;
    out << stream.rdbuf();
    return out.str();
  }

  results::TableLayout layout() const {
    return {"response",
            "",
            "time",
            {{"time", "s", "time", "", {}},
             {"position", "m", "displacement", "coordinate", {"a", "b, \"c\""}},
             {"velocity", "m/s", "velocity", "coordinate", {"a", "b, \"c\""}},
             {"force", "N", "slider force", "slider", {"s"}},
             {"status", "", "what became of it", "", {}, {"done", "not converged"}}},
            {{"method", "exact"}}};
  }

  fs::path folder_;
};

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

TEST_F(WriteResults, CsvInterleavesWhatSharesLabelsAndReadsBackToTheSameBits) {
  CsvSink sink(folder_);
  const auto rows = sink.open(layout());
  rows->append(std::vector<double>{0.1, 1.0 / 3.0, 2, 3, 4, 5, 0});
  rows->append(std::vector<double>{0.2, -0.0, 2e-300, missing, 4, 5, 1});
  rows->flush();
  EXPECT_EQ(text("response.csv"),
            "time [s],a.position [m],a.velocity [m/s],\"b, \"\"c\"\".position [m]\",\"b, \"\"c\"\".velocity [m/s]\","
            "s.force [N],status\n"
            "0.1,0.3333333333333333,3,2,4,5,done\n"
            "0.2,-0,,2e-300,4,5,not converged\n");
}

TEST_F(WriteResults, NetcdfKeepsNamesUnitsWordsAndWhatIsMissing) {
  const fs::path path = folder_ / "results.nc";
  {
    NetcdfSink sink(path,
                    {"Title", "study.toml", "text of the study", "rubato run study.toml", "2026-01-31T12:00:00Z"});
    const auto rows = sink.open(layout());
    for (int i = 0; i < 10000; ++i)
      rows->append(std::vector<double>{0.1 * i, 1.0 * i, 2, i == 7 ? missing : 3, 4, 5, static_cast<double>(i % 2)});
    sink.conclude("response", "failed", "why", {{"steps", "10000"}});
  }
  int file = 0, group = 0, variable = 0, dimension = 0;
  ASSERT_EQ(nc_open(path.c_str(), NC_NOWRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_grp_ncid(file, "response", &group), NC_NOERR);
  std::size_t length = 0;
  ASSERT_EQ(nc_inq_dimid(group, "time", &dimension), NC_NOERR);
  ASSERT_EQ(nc_inq_dimlen(group, dimension, &length), NC_NOERR);
  EXPECT_EQ(length, 10000u);
  ASSERT_EQ(nc_inq_varid(group, "velocity", &variable), NC_NOERR);
  double value = 0.0;
  const std::size_t at[2] = {7, 0}, next[2] = {8, 0};
  ASSERT_EQ(nc_get_var1_double(group, variable, at, &value), NC_NOERR);
  EXPECT_EQ(value, NC_FILL_DOUBLE);
  ASSERT_EQ(nc_get_var1_double(group, variable, next, &value), NC_NOERR);
  EXPECT_EQ(value, 3.0);
  char unit[16] = {};
  ASSERT_EQ(nc_get_att_text(group, variable, "units", unit), NC_NOERR);
  EXPECT_STREQ(unit, "m/s");
  ASSERT_EQ(nc_inq_varid(group, "coordinate", &variable), NC_NOERR);
  char* names[2] = {};
  ASSERT_EQ(nc_get_var_string(group, variable, names), NC_NOERR);
  EXPECT_STREQ(names[1], "b, \"c\"");
  nc_free_string(2, names);
  ASSERT_EQ(nc_inq_varid(group, "status", &variable), NC_NOERR);
  char meanings[64] = {};
  ASSERT_EQ(nc_get_att_text(group, variable, "flag_meanings", meanings), NC_NOERR);
  EXPECT_STREQ(meanings, "done not_converged");
  char status[16] = {};
  ASSERT_EQ(nc_get_att_text(group, NC_GLOBAL, "status", status), NC_NOERR);
  EXPECT_STREQ(status, "failed");
  nc_close(file);
}

// A reader that opens the file while the run goes on, or after it was killed, finds what was flushed.
TEST_F(WriteResults, WhatIsFlushedIsReadableWhileTheFileIsOpen) {
  CsvSink csv(folder_);
  NetcdfSink netcdf(folder_ / "results.nc", {});
  TeeSink sink({&netcdf, &csv});
  const auto rows = sink.open(layout());
  rows->append(std::vector<double>{0.1, 1, 2, 3, 4, 5, 0});
  rows->flush();
  EXPECT_THAT(text("response.csv"), ::testing::HasSubstr("0.1,1,3,2,4,5,done\n"));
  fs::copy(folder_ / "results.nc", folder_ / "copy.nc");
  int file = 0;
  EXPECT_EQ(nc_open((folder_ / "copy.nc").c_str(), NC_NOWRITE, &file), NC_NOERR);
  nc_close(file);
}

TEST_F(WriteResults, SaysThatTheDiskIsFull) {
  fs::create_symlink("/dev/full", folder_ / "response.csv");
  CsvSink sink(folder_);
  const auto rows = sink.open(layout());
  rows->append(std::vector<double>{0.1, 1, 2, 3, 4, 5, 0});
  try {
    rows->flush();
    FAIL() << "wrote to a full disk";
  } catch (const OutputError& fault) {
    EXPECT_EQ(fault.what(),
              (folder_ / "response.csv").string() + ": the disk is full; free some space or write elsewhere (-o DIR)");
  }
}

TEST_F(WriteResults, RefusesAFolderThatIsAFileOrCannotHoldTheResults) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(prepare_output_folder(folder_ / "file", 0.0), OutputError);
  EXPECT_THROW(prepare_output_folder(folder_ / "file" / "inside", 0.0), OutputError);
  EXPECT_THROW(prepare_output_folder(folder_ / "new", 1e18), OutputError);
  EXPECT_NO_THROW(prepare_output_folder(folder_ / "new", 1e3));
  EXPECT_TRUE(fs::is_empty(folder_ / "new"));
}

}  // namespace
}  // namespace rubato::io
