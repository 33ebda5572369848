#include <rubato/report/curves.hpp>
#include <rubato/report/curves_json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Columns given by functions of the row; the last, `amplitude`, for two labels.
class Sweep : public TableSource {
 public:
  using Column = std::function<double(std::size_t row)>;

  Sweep(std::size_t rows, const std::vector<std::pair<std::string, Column>>& columns) : rows_(rows) {
    for (const auto& [name, column] : columns) {
      Variable variable;
      variable.name = name;
      if (name == "amplitude") {
        variable.dimension = "observed";
        variable.labels = {"blade", "disk"};
      }
      if (name == "status") variable.categories = {"converged", "not_converged"};
      variables_.push_back(variable);
      columns_.push_back(column);
    }
  }
  const std::string& name() const override { return name_; }
  const std::string& row_dimension() const override { return row_dimension_; }
  const Attributes& attributes() const override { return attributes_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  std::size_t rows() const override { return rows_; }
  void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t labels,
            std::span<double> values) const override {
    largest_piece_ = std::max(largest_piece_, values.size());
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t label = 0; label < labels; ++label)
        values[row * labels + label] = columns_[variable](first_row + row) * (label == 0 ? 1.0 : 0.5);
  }
  std::size_t largest_piece() const { return largest_piece_; }

 private:
  std::size_t rows_;
  std::string name_, row_dimension_ = "point";
  Attributes attributes_;
  std::vector<Variable> variables_;
  std::vector<Column> columns_;
  mutable std::size_t largest_piece_ = 0;
};

const Attributes response{{"type", "frequency_response"}, {"swept_parameters", "N0, mu"}};

/// `points` frequencies for each preload; the amplitude is the frequency, but for one peak a curve.
Sweep preload_sweep(std::size_t preloads, std::size_t points, std::size_t peak_at = 0) {
  const auto frequency = [points](std::size_t row) { return static_cast<double>(row % points); };
  return {preloads * points,
          {{"N0", [points](std::size_t row) { return 10.0 * static_cast<double>(row / points); }},
           {"angular_frequency", frequency},
           {"amplitude",
            [=](std::size_t row) {
              return peak_at > 0 && row % points == peak_at ? 1e6 + static_cast<double>(row / points)
                                                            : frequency(row) / 1024.0;
            }},
           {"status", [points](std::size_t row) { return row % points == 1 ? 1.0 : 0.0; }}}};
}

std::vector<std::size_t> first_rows(const std::vector<CurveRows>& curves) {
  std::vector<std::size_t> out;
  for (const CurveRows& curve : curves) out.push_back(curve.first_row);
  return out;
}

TEST(CurveLayout, OfAResponseIsOverItsFrequencyWithTheSweptParametersAsKeys) {
  const auto layout = curve_layout(preload_sweep(2, 3), response);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->abscissa, 1u);
  EXPECT_THAT(layout->keys, ElementsAre(0u));
}

TEST(CurveLayout, OfWaveformsIsOverTimeAndTellsFrequenciesApart) {
  const auto zero = [](std::size_t) { return 0.0; };
  const auto layout = curve_layout(Sweep(1, {{"N0", zero}, {"angular_frequency", zero}, {"time", zero}}), response);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->abscissa, 2u);
  EXPECT_THAT(layout->keys, ElementsAre(0u, 1u));
}

TEST(CurveLayout, OfADamperCurveIsOverItsParameter) {
  const auto zero = [](std::size_t) { return 0.0; };
  const auto layout = curve_layout(Sweep(1, {{"N0", zero}, {"angular_frequency", zero}, {"amplitude", zero}}),
                                   {{"type", "damper_curve"}, {"parameter", "N0"}});
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->abscissa, 0u);
  EXPECT_TRUE(layout->keys.empty());
}

TEST(CurveLayout, IsNotOfOtherAnalyses) { EXPECT_FALSE(curve_layout(preload_sweep(2, 3), {{"type", "transient"}})); }

TEST(FindCurves, StartsANewCurveWhereAKeyChangesOrTheFrequencyTurns) {
  const Sweep up_and_down(6, {{"N0", [](std::size_t) { return 1.0; }},
                              {"angular_frequency", [](std::size_t row) { return row < 3 ? 1.0 * row : 4.0 - row; }}});
  EXPECT_THAT(first_rows(find_curves(up_and_down, {1, {0}})), ElementsAre(0u, 3u));
  EXPECT_THAT(first_rows(find_curves(preload_sweep(3, 5), {1, {0}})), ElementsAre(0u, 5u, 10u));
}

TEST(FindCurves, OfOneFrequencyRunOverTheParameterInstead) {
  const Sweep one(
      50, {{"N0", [](std::size_t row) { return 1.0 * row; }}, {"angular_frequency", [](std::size_t) { return 7.0; }}});
  std::vector<CurveRows> curves;
  const CurveLayout layout = longest_curves(one, {1, {0}}, curves);
  EXPECT_EQ(layout.abscissa, 0u);
  EXPECT_THAT(layout.keys, ElementsAre(1u));
  EXPECT_THAT(first_rows(curves), ElementsAre(0u));
}

TEST(Spread, KeepsTheFirstAndTheLast) {
  EXPECT_THAT(spread(9, 3), ElementsAre(0u, 4u, 8u));
  EXPECT_THAT(spread(2, 3), ElementsAre(0u, 1u));
}

TEST(CurvesJson, ShowsAShortSweepWhole) {
  const std::string json = curves_json(preload_sweep(2, 2), {1, {0}});
  EXPECT_THAT(json, HasSubstr(R"("overview":[[[0,0,10,10]],[[0,1,0,1]],)"));
  EXPECT_THAT(json, HasSubstr(R"("curves":{"abscissa":1,"keys":[0],"count":2,"starts":[0,2,4],"ordinals":[0,1]})"));
  EXPECT_THAT(json, HasSubstr(R"("is_envelope":false)"));
}

TEST(CurvesJson, CountsStatusesAndGivesTheRowsThatDidNotConverge) {
  const std::string json = curves_json(preload_sweep(3, 4), {1, {0}}, {.flagged = 2});
  EXPECT_THAT(json, HasSubstr(R"("statuses":{"variable":3,"counts":[9,3],"columns":[[[0,10]],[[1,1]],)"));
}

TEST(CurvesJson, NamesTheLargestAmplitudeOfEachCurveWithItsFrequency) {
  const std::string json = curves_json(preload_sweep(3, 8, 5), {1, {0}});
  EXPECT_THAT(json,
              HasSubstr(R"("peaks":{"variable":2,"keys":[[0,10,20]],"abscissa":[[5,5,5],[5,5,5]],"value":[[1000000,)"
                        R"(1000001,1000002],[500000,500000.5,500001]]})"));
}

TEST(CurvesJson, KeepsEveryPeakOfLongCurves) {
  // 5 of 20 curves in 2 buckets of 500 rows each: the peak of row 777 is an extreme of the second.
  const CurveExtent extent{.whole_up_to = 100, .numbers = 10, .curves = 5, .least_buckets = 2};
  const std::string json = curves_json(preload_sweep(20, 1000, 777), {1, {0}}, extent);
  EXPECT_THAT(json, HasSubstr(R"("starts":[0,4,8,12,16,20],"ordinals":[0,4,9,14,19])"));
  EXPECT_THAT(json, HasSubstr(R"([[0,499,500,999,0,499,)"));
  EXPECT_THAT(json, HasSubstr("1000019"));
}

TEST(CurvesJson, HasASizeThatDoesNotGrowWithASweepOfAMillionPoints) {
  const Sweep million = preload_sweep(1000, 1000, 500);
  const std::string json = curves_json(million, {1, {0}});
  EXPECT_LT(json.size(), 8u << 20);
  EXPECT_THAT(json, HasSubstr(R"("rows":1000000)"));
  EXPECT_LE(million.largest_piece(), 2u * 8192u);  // memory: a piece of a variable at a time
  EXPECT_LT(curves_json(preload_sweep(100, 10'000, 500), {1, {0}}).size(), 8u << 20);
}

}  // namespace
}  // namespace rubato::report
