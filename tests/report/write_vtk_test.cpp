#include <rubato/core/error.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/report/write_vtk.hpp>

#include "report/sample_results.hpp"
#include "report/sample_scene.hpp"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

class WriteVtk : public testing::Test {
 protected:
  WriteVtk() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    io::NetcdfSink sink(folder_ / "results.nc", {});
    test::add_scene(sink);
    test::add_table(sink,
                    {"plain", "", "time", {{"time", "s", "", "", {}}, {"position", "m", "", "coordinate", {"b"}}}, {}},
                    {{0.0, 0.0}});
  }
  ~WriteVtk() override { std::filesystem::remove_all(folder_); }

  std::string text_of(const std::string& file) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    return text.str();
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      ("vtk_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(WriteVtk, ListsTheFramesWithTheirTimes) {
  EXPECT_EQ(write_vtk(folder_ / "results.nc", folder_ / "vtk"), 1);
  const std::string list = text_of("vtk/shaken.pvd");
  EXPECT_THAT(list, HasSubstr(R"(<DataSet timestep="0.5" file="shaken/0005.vtp"/>)"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "vtk/plain.pvd"));
}

TEST_F(WriteVtk, MovesTheNodesAndKeepsTheLines) {
  write_vtk(folder_ / "results.nc", folder_ / "vtk");
  const std::string frame = text_of("vtk/shaken/0005.vtp");
  EXPECT_THAT(frame, HasSubstr("NumberOfPoints=\"3\" NumberOfLines=\"2\""));
  EXPECT_THAT(frame, HasSubstr("\n0 0 0\n0.1 1 0\n1.1 1 0\n"));    // where the nodes are
  EXPECT_THAT(frame, HasSubstr("\n0 0 0\n0.1 0 0\n0.1 0 0\n"));    // how far they have gone
  EXPECT_THAT(frame, HasSubstr("\n0 0 0\n0 0 -0.1\n0 0 0.05\n"));  // and turned
  EXPECT_THAT(frame, HasSubstr("\n0 1\n1 2\n"));
}

// A unit of a mode's size is drawn: a body 1 m from its pin turns by 2 about it, so that it rises by 2, and the pin
// stays.
TEST_F(WriteVtk, MovesABodyAboutItsPinInAMode) {
  {
    io::NetcdfSink sink(folder_ / "modes.nc", {});
    test::add_mechanism_modes(sink);
  }
  write_vtk(folder_ / "modes.nc", folder_ / "vtk");
  EXPECT_THAT(text_of("vtk/swinging/0000.vtp"), HasSubstr("\n1 2 0\n0 0 0\n"));
}

TEST_F(WriteVtk, NamesAFolderThatCannotBeMade) {
  std::ofstream(folder_ / "vtk") << "a file";
  try {
    write_vtk(folder_ / "results.nc", folder_ / "vtk");
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder_ / "vtk" / "shaken").string()));
  }
}

}  // namespace
}  // namespace rubato::report
