#include <rubato/core/error.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/report/write_report.hpp>

#include "report/sample_results.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

class WriteReport : public testing::Test {
 protected:
  WriteReport() {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("report_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~WriteReport() override { std::filesystem::remove_all(folder_); }

  static std::string text_of(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }

  std::filesystem::path folder_;
};

TEST_F(WriteReport, ShowsTitleStudyAndTablesOfTheResults) {
  {
    io::NetcdfSink sink(folder_ / "results.nc", {"One <mass>", "", "[[coordinate]]\nname = \"</script>\"\n", "", ""});
    test::add_table(sink,
                    {"run", "", "time", {{"time", "s", "", "", {}}, {"position", "m", "", "coordinate", {"mass"}}}, {}},
                    {{0.0, 1.0}, {0.1, std::nan("")}, {0.2, 0.25}});
    sink.conclude("run", "failed", "at t = 0.2 s", {});
  }
  write_report(folder_ / "results.nc", folder_ / "report.html");
  const std::string page = text_of(folder_ / "report.html");
  EXPECT_THAT(page, HasSubstr("<title>One &lt;mass&gt;</title>"));
  EXPECT_THAT(page, HasSubstr(R"(name = \"\u003c/script\u003e\")"));
  EXPECT_THAT(page, HasSubstr(R"("overview":[[[0,0.1,0.2]],[[1,null,0.25]]])"));
  EXPECT_THAT(page, HasSubstr(R"("labels":["mass"])"));
  EXPECT_THAT(page, HasSubstr(R"("status":"failed","message":"at t = 0.2 s")"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html.partial"));
}

TEST_F(WriteReport, KeepsTheNamesOfASubtableApartFromThoseOfItsParent) {
  {
    io::NetcdfSink sink(folder_ / "results.nc", {});
    results::TableLayout main{"study", "", "method", {{"method", "1", "", "", {}, {"heun", "rk4"}}}, {}};
    test::add_table(sink, main, {{0.0}, {1.0}});
    results::TableLayout ladder{"study", "ladder", "step", {{"step", "s", "", "", {}}}, {}};
    ladder.blocks.push_back({"error", "1", "", "method", {"heun", "rk4", "exact"}});
    test::add_table(sink, ladder, {{0.5, 1e-2, 1e-4, 0.0}});
  }
  write_report(folder_ / "results.nc", folder_ / "report.html");
  const std::string page = text_of(folder_ / "report.html");
  EXPECT_THAT(page, HasSubstr(R"("categories":["heun","rk4"])"));
  EXPECT_THAT(page, HasSubstr(R"("labels":["heun","rk4","exact"])"));
  EXPECT_THAT(page, HasSubstr(R"("overview":[[[0.5]],[[0.01],[0.0001],[0]]])"));
}

TEST_F(WriteReport, ReplacesAnOlderPage) {
  io::NetcdfSink(folder_ / "results.nc", {}).close();
  std::ofstream(folder_ / "report.html") << "older";
  write_report(folder_ / "results.nc", folder_ / "report.html");
  EXPECT_THAT(text_of(folder_ / "report.html"), HasSubstr(R"("analyses":[)"));
}

TEST_F(WriteReport, NamesResultsThatCannotBeRead) {
  std::ofstream(folder_ / "results.nc") << "not netCDF";
  try {
    write_report(folder_ / "results.nc", folder_ / "report.html");
    FAIL() << "no error";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder_ / "results.nc").string()));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
}

TEST_F(WriteReport, SaysWhyThePageCannotBeWritten) {
  io::NetcdfSink(folder_ / "results.nc", {}).close();
  try {
    write_report(folder_ / "results.nc", folder_ / "missing" / "report.html");
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

TEST_F(WriteReport, KeepsTheOlderPageOnAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  io::NetcdfSink(folder_ / "results.nc", {}).close();
  std::ofstream(folder_ / "report.html") << "older";
  std::filesystem::create_symlink("/dev/full", folder_ / "report.html.partial");
  EXPECT_THROW(write_report(folder_ / "results.nc", folder_ / "report.html"), OutputError);
  EXPECT_EQ(text_of(folder_ / "report.html"), "older");
}

}  // namespace
}  // namespace rubato::report
