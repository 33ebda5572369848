#include <rubato/io/write_netcdf.hpp>
#include <rubato/report/scene_json.hpp>

#include "report/sample_results.hpp"
#include "report/sample_scene.hpp"

#include <functional>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

/// The scene of the first analysis of a file that `fill` writes.
std::string scene_of(const std::function<void(results::Sink&)>& fill, const SceneExtent& extent = {}) {
  const auto folder = std::filesystem::path(testing::TempDir()) /
                      ("scene_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::filesystem::create_directories(folder);
  {
    io::NetcdfSink sink(folder / "results.nc", {});
    fill(sink);
  }
  const ResultsTables results(folder / "results.nc");
  const std::string scene = scene_json(read_scene(results.analyses().front(), extent));
  std::filesystem::remove_all(folder);
  return scene;
}

TEST(SceneJson, TellsWhereNodesAreAndWhatJoinsThem) {
  const std::string scene = scene_of(test::add_scene);
  EXPECT_THAT(scene, HasSubstr(R"("names":["a","b","c"],"position":[[0,0,1],[0,1,1],[0,0,0]])"));
  EXPECT_THAT(scene, HasSubstr(R"("support":["clamped","free","free"],"lines":[[0,1],[1,2]],"kinds":[])"));
  EXPECT_THAT(
      scene,
      HasSubstr(
          R"("is_absolute":false,"carrier":[],"offset":[[],[],[]],"rotation":[[],[],[]],"places":[[1,1,2,2,1,2],[0,1,0,1,5,5]])"));
}

TEST(SceneJson, HoldsTheMotionOfEveryPlaceInEachFrame) {
  const std::string scene = scene_of(test::add_scene);
  EXPECT_THAT(scene, HasSubstr(R"("rows":[0,1,2,3,4,5,6,7,8,9,10])"));
  EXPECT_THAT(scene, HasSubstr("[0.1,0,0.1,0,-0.1,0.05]"));  // at half the time
}

TEST(SceneJson, ChoosesFramesEvenlyInTime) {
  EXPECT_THAT(scene_of(test::add_scene, {3, 1000}), HasSubstr(R"("rows":[0,5,10],"coordinate":[0,0.5,1])"));
}

TEST(SceneJson, HoldsShapesAboutAConfigurationWithTheAxesOfItsNodes) {
  const std::string scene = scene_of(test::add_mechanism_modes);
  EXPECT_THAT(scene, HasSubstr(R"("kinds":["body"],"is_absolute":false,"carrier":[0,0])"));
  EXPECT_THAT(scene, HasSubstr(R"("rotation":[[0,0],[0,0],[1.5,1.5]])"));
  EXPECT_THAT(scene, HasSubstr(R"("values":[[0,2,2],[0,1,0]],"imaginary":[[0,0,0],[1,0,0]])"));
}

TEST(SceneJson, HoldsTheJointsAndTheShapesOfAMechanism) {
  const std::string scene = scene_of(test::add_mechanism);
  EXPECT_THAT(scene, HasSubstr(R"("joints":{"names":["hinge_pin"],"types":["revolute"],"first":[3],"second":[2],)"
                               R"("axis":[[0],[0],[0]],"laws":["none"],"limits":["stop"]})"));
  EXPECT_THAT(scene, HasSubstr(R"("shapes":{"nodes":[0],"kinds":["box"],"size":[[1],[0.2],[0.1]]})"));
}

TEST(SceneJson, DrawsNothingWhereADegreeOfFreedomWasNotKept) {
  const auto without_rotations = [](results::Sink& sink) {
    test::add_table(sink,
                    {"run", "", "time", {{"time", "s", "", "", {}}, {"position", "m", "", "coordinate", {"b.x"}}}, {}},
                    {{0.0, 0.0}, {1.0, 0.1}});
    const std::vector<std::string> nodes{"a", "b"};
    test::add_table(
        sink,
        {"run",
         "nodes",
         "node",
         {{"node", "1", "", "", {}, nodes}, {"x", "m", "", "", {}}, {"y", "m", "", "", {}}, {"z", "m", "", "", {}}},
         {{"degrees_of_freedom", "2"}}},
        {{0, 0, 0, 0}, {1, 1, 0, 0}});
    test::add_table(sink,
                    {"run",
                     "lines",
                     "line",
                     {{"line", "1", "", "", {}}, {"first", "1", "", "", {}, nodes}, {"second", "1", "", "", {}, nodes}},
                     {}},
                    {{1, 0, 1}});
  };
  EXPECT_EQ(scene_of(without_rotations), "null");
}

TEST(SceneJson, IsNullForAnalysesOfCoordinates) {
  EXPECT_EQ(scene_of([](results::Sink& sink) {
              test::add_table(
                  sink,
                  {"run", "", "time", {{"time", "s", "", "", {}}, {"position", "m", "", "coordinate", {"b"}}}, {}},
                  {{0.0, 0.0}});
            }),
            "null");
}

}  // namespace
}  // namespace rubato::report
