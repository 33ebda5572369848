#include <rubato/report/step_distribution.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rubato::report {
namespace {

/// A table of steps; every third try is rejected, with a length of 100 s.
class Steps : public TableSource {
 public:
  explicit Steps(std::vector<double> lengths, std::string type = "steps")
      : lengths_(std::move(lengths)), attributes_{{"type", std::move(type)}} {
    for (const char* name : {"time", "step", "error", "accepted"}) {
      variables_.emplace_back();
      variables_.back().name = name;
    }
  }
  const std::string& name() const override { return name_; }
  const std::string& row_dimension() const override { return row_dimension_; }
  const Attributes& attributes() const override { return attributes_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  std::size_t rows() const override { return lengths_.size() + lengths_.size() / 2; }
  void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t,
            std::span<double> values) const override {
    for (std::size_t i = 0; i < rows; ++i) {
      const std::size_t row = first_row + i;
      const bool is_rejected = row % 3 == 2;
      values[i] = variable == 1 ? (is_rejected ? 100.0 : lengths_[row - row / 3]) : is_rejected ? 0.0 : 1.0;
    }
  }

 private:
  std::vector<double> lengths_;
  std::string name_ = "steps", row_dimension_ = "time";
  Attributes attributes_;
  std::vector<Variable> variables_;
};

/// The numbers of a list in the JSON.
std::vector<double> list(const std::string& json, const std::string& key) {
  std::vector<double> values;
  std::size_t at = json.find("\"" + key + "\":[") + key.size() + 4;
  for (; json[at] != ']'; at = json[at] == ',' ? at + 1 : at) {
    std::size_t length = 0;
    values.push_back(std::stod(json.substr(at), &length));
    at += length;
  }
  return values;
}

// 10,000 rows of which two thirds are accepted are read in two pieces.
TEST(StepDistribution, CountsEveryAcceptedStepInBinsOfEqualRatio) {
  std::vector<double> lengths;
  for (int i = 0; i < 10000; ++i) lengths.push_back(i % 4 == 0 ? 1e-3 : i % 4 == 1 ? 1e-2 : 1e-1);
  const std::string json = step_distribution_json(Steps(lengths));
  const std::vector<double> edges = list(json, "edges"), counts = list(json, "counts");
  ASSERT_EQ(counts.size(), 17u);  // eight a decade, and what rounding adds
  ASSERT_EQ(edges.size(), 18u);
  EXPECT_EQ(counts.front(), 2500.0);
  EXPECT_EQ(counts[8], 2500.0);
  EXPECT_EQ(counts.back(), 5000.0);
  EXPECT_LT(edges.front(), 1e-3);
  EXPECT_GT(edges.back(), 1e-1);
  for (std::size_t i = 2; i < edges.size(); ++i)  // to the digits of the page
    EXPECT_NEAR(edges[i] / edges[i - 1], edges[1] / edges[0], 1e-5);
}

TEST(StepDistribution, GivesEqualStepsOneBin) {
  const std::vector<double> counts = list(step_distribution_json(Steps({0.25, 0.25, 0.25, 0.25})), "counts");
  EXPECT_EQ(*std::max_element(counts.begin(), counts.end()), 4.0);
}

TEST(StepDistribution, IsOfTablesOfStepsAlone) {
  EXPECT_EQ(step_distribution_json(Steps({0.1, 0.2}, "energy")), "null");
  EXPECT_EQ(step_distribution_json(Steps({})), "null");
}

}  // namespace
}  // namespace rubato::report
