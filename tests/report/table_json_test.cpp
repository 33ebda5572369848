#include <rubato/report/table_json.hpp>

#include <cmath>
#include <string>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

/// position(time, coordinate) = time (label + 1), t = row / 2.
class Ramp : public TableSource {
 public:
  Ramp(std::size_t rows, std::size_t labels) : Ramp(rows, std::vector<std::string>{}) {
    for (std::size_t label = 0; label < labels; ++label) variables_[1].labels.push_back("q" + std::to_string(label));
  }
  Ramp(std::size_t rows, const std::vector<std::string>& labels) : rows_(rows) {
    variables_.resize(2);
    variables_[0].name = "time";
    variables_[0].unit = "s";
    variables_[1].name = "position";
    variables_[1].unit = "m";
    variables_[1].dimension = "coordinate";
    variables_[1].labels = labels;
  }
  const std::string& name() const override { return name_; }
  const std::string& row_dimension() const override { return row_dimension_; }
  const Attributes& attributes() const override { return attributes_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  std::size_t rows() const override { return rows_; }
  void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t labels,
            std::span<double> values) const override {
    ASSERT_LE(first_row + rows, rows_);
    ASSERT_EQ(values.size(), rows * labels);
    for (std::size_t row = 0; row < rows; ++row) {
      const double t = 0.5 * static_cast<double>(first_row + row);
      for (std::size_t label = 0; label < labels; ++label) {
        values[row * labels + label] = variable == 0 ? t : t * static_cast<double>(label + 1);
      }
    }
  }

 private:
  std::size_t rows_;
  std::string name_, row_dimension_ = "time";
  Attributes attributes_{{"method", "a \"quoted\" name"}};
  std::vector<Variable> variables_;
};

TEST(TableJson, ShowsAShortTableWhole) {
  const std::string json = table_json(Ramp(3, 2));
  EXPECT_THAT(json, HasSubstr(R"("rows":3)"));
  EXPECT_THAT(json, HasSubstr(R"("overview":[[[0,0.5,1]],[[0,0.5,1],[0,1,2]]],"is_envelope":false,"window":null)"));
  EXPECT_THAT(json, HasSubstr(R"("attributes":{"method":"a \"quoted\" name"})"));
}

TEST(TableJson, ShowsALongTableByItsEnvelopeAndItsLastRows) {
  const std::string json = table_json(Ramp(8, 1), {.whole_up_to = 4, .buckets = 2, .window_rows = 3});
  EXPECT_THAT(json, HasSubstr(R"("overview":[[[0,1.5,2,3.5]],[[0,1.5,2,3.5]]],"is_envelope":true)"));
  EXPECT_THAT(json, HasSubstr(R"("window":[[[2.5,3,3.5]],[[2.5,3,3.5]]],"window_first_row":5)"));
}

TEST(TableJson, GivesKeyNumbersOverAllRows) {
  // t from 0 to 10: rms = 10 / sqrt 3 with the trapezoidal excess 1 + h^2 / (2 T^2) inside, h = 1/2; the last tenth
  // spans 9 to 10.
  const std::string json = table_json(Ramp(21, 1));
  const double rms = std::sqrt(100.0 / 3.0 * (1.0 + 0.25 / 200.0));
  EXPECT_THAT(json, HasSubstr(R"("key_numbers":[null,[[10,)" + std::to_string(rms).substr(0, 7)));
  EXPECT_THAT(json, HasSubstr(",0.5,10,10]]]"));  // the largest and the last come at t = 10
}

TEST(TableJson, LeavesOutNodesInsideBeamsFirstThenOtherNodes) {
  const Ramp few(2, std::vector<std::string>{"a.x", "rod:1.x", "rod:2.x", "hinge", "b.x"});
  EXPECT_THAT(table_json(few, {.labels = 5}), HasSubstr(R"("labels":["a.x","rod:1.x","rod:2.x","hinge","b.x"])"));
  EXPECT_THAT(table_json(few, {.labels = 3}), HasSubstr(R"("labels":["a.x","hinge","b.x"],"label_count":5)"));
  // Values are of the labels that are shown: t (label + 1) at t = 1/2.
  EXPECT_THAT(table_json(few, {.labels = 3}), HasSubstr("[[0,0.5],[0,2],[0,2.5]]"));
  EXPECT_THAT(table_json(few, {.labels = 1}), HasSubstr(R"("labels":["hinge"])"));
}

TEST(TableJson, HasASizeThatDoesNotGrowWithTheResults) {
  const std::size_t at_10000 = table_json(Ramp(10'000, 30)).size();
  const std::size_t at_200000 = table_json(Ramp(200'000, 3000)).size();
  // Only the digits of the numbers may grow.
  EXPECT_LT(static_cast<double>(at_200000), 1.5 * static_cast<double>(at_10000));
  EXPECT_THAT(table_json(Ramp(4, 3000)), HasSubstr(R"("label_count":3000)"));
}

TEST(AttributesJson, CutsLongValues) {
  EXPECT_EQ(attributes_json({{"a", "1, 2, 3, 4"}, {"b", "1"}}, 4), R"({"a":"1, 2...","b":"1"})");
}

TEST(TableJson, OfNoRowsIsStillATable) {
  EXPECT_THAT(table_json(Ramp(0, 2)), HasSubstr(R"("rows":0)"));
  EXPECT_THAT(table_json(Ramp(0, 2)), HasSubstr(R"("overview":[[[]],[[],[]]])"));
}

}  // namespace
}  // namespace rubato::report
