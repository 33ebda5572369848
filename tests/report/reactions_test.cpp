#include <rubato/report/reactions.hpp>

#include <cmath>
#include <string>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

/// Rows in memory: a column a variable and label.
class Rows : public TableSource {
 public:
  Rows(std::vector<Variable> variables, std::vector<std::vector<double>> rows)
      : variables_(std::move(variables)), rows_(std::move(rows)) {}
  const std::string& name() const override { return name_; }
  const std::string& row_dimension() const override { return row_dimension_; }
  const Attributes& attributes() const override { return attributes_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  std::size_t rows() const override { return rows_.size(); }
  void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t labels,
            std::span<double> values) const override {
    std::size_t column = 0;
    for (std::size_t v = 0; v < variable; ++v) column += variables_[v].width();
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t label = 0; label < labels; ++label)
        values[row * labels + label] = rows_[first_row + row][column + label];
  }

 private:
  std::vector<Variable> variables_;
  std::vector<std::vector<double>> rows_;
  std::string name_, row_dimension_ = "time";
  Attributes attributes_;
};

Variable time() { return {"time", "s", "", "", {}, {}}; }
Variable reaction(const std::string& component, const std::vector<std::string>& joints) {
  return {"reaction_" + component, "", "", "reaction_" + component + "_joint", joints, {}};
}

// At t = 1 both components are 4: more than the largest of each, 5, at other times.
TEST(Reactions, AreNormsOfTheirComponentsAtTheSameTime) {
  const Rows table({time(), reaction("x", {"pin"}), reaction("y", {"pin"})}, {{0, 5, 0}, {1, 4, -4}, {2, 0, 5}});
  const auto largest = largest_reactions(table);
  ASSERT_EQ(largest.size(), 1u);
  EXPECT_DOUBLE_EQ(largest[0].force, std::sqrt(32.0));
  EXPECT_EQ(largest[0].force_time, 1.0);
  EXPECT_TRUE(std::isnan(largest[0].moment));
}

TEST(Reactions, TellMomentsApartFromForcesAndLocksFromTheirJoints) {
  const Rows table({time(), reaction("x", {"weld", "hinge"}), reaction("moment", {"weld"}),
                    reaction("lock_moment", {"hinge"}), reaction("tension", {"link"})},
                   {{0, 1, 2, -7, 0, -3}, {1, -1.5, 1, 6, 9, 2}});
  const auto largest = largest_reactions(table);
  ASSERT_EQ(largest.size(), 4u);
  EXPECT_EQ(largest[0].joint, "link");  // those of the largest forces first
  EXPECT_EQ(largest[0].force, 3.0);
  EXPECT_EQ(largest[1].joint, "hinge");
  EXPECT_FALSE(largest[1].is_of_lock);
  EXPECT_EQ(largest[2].joint, "weld");
  EXPECT_EQ(largest[2].force, 1.5);
  EXPECT_EQ(largest[2].force_time, 1.0);
  EXPECT_EQ(largest[2].moment, 7.0);
  EXPECT_EQ(largest[2].moment_time, 0.0);
  EXPECT_EQ(largest[3].joint, "hinge");  // without a force last
  EXPECT_TRUE(largest[3].is_of_lock);
  EXPECT_EQ(largest[3].moment, 9.0);
}

TEST(Reactions, OfALongRunCountEveryRow) {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 20'001; ++i) rows.push_back({0.1 * i, i == 12'345 ? -3.0 : 1.0});
  const auto largest = largest_reactions(Rows({time(), reaction("x", {"pin"})}, rows));
  EXPECT_EQ(largest[0].force, 3.0);
  EXPECT_EQ(largest[0].force_time, rows[12'345][0]);
}

TEST(Reactions, AreCountedWhereTheyAreTooManyToShow) {
  const Rows table({time(), reaction("x", {"a", "b", "c"})}, {{0, 1, 3, 2}});
  EXPECT_THAT(
      reactions_json(table, 2),
      HasSubstr(R"({"count":3,"joints":[{"name":"b","is_of_lock":false,"force":3,"force_time":0,"moment":null,)"));
  EXPECT_THAT(reactions_json(table, 2), Not(HasSubstr(R"("name":"a")")));
  EXPECT_EQ(reactions_json(Rows({time()}, {{0}})), "null");
}

}  // namespace
}  // namespace rubato::report
