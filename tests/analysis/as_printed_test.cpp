#include <rubato/analysis/as_printed.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <memory>

namespace rubato::analysis {
namespace {

std::unique_ptr<const integrate::SystemKind> kind_of(const system::LocallyNonlinear& system) {
  return integrate::StructureKind(system).for_thread();
}

struct Printed {
  const char* title;
  const char* method;
  double first, indicator;
  bool in_percent;
};

// Tables 2.2 to 2.4 of the thesis, as it prints them.
const Printed thesis[] = {
    {"Explicit Euler", "explicit_euler", 0.496577062986900, 0.155825462554500, false},
    {"Runge-Kutta 3", "rk3", 3.33618998200748e-05, 0.0950286327386840, false},
    {"Runge-Kutta 4", "rk4", 3.33618998200748e-05, 0.0950278042413737, false},
    {"Central difference", "central_difference", 0.337795508343150, 0.0108389543480367, true},
    {"Fox-Goodwin", "fox_goodwin", 0.167239420905934, 0.0112241322129539, true},
    {"Linear acceleration", "linear_acceleration", 0.00331383811901593, 0.0157695782252880, true},
    {"Trapezoid", "average_acceleration", 0.173864268802085, 0.0221104353803482, true},
    {"Linear acceleration II", "linear_acceleration", 0.344411871213617, 0.0287000192395950, true},
    {"Constant mean acceleration", "average_acceleration", 0.685498591503419, 0.0420788539145178, true},
    {"Galerkin", "galerkin", 2.90413438661185, 13.2156978423172, true},
    {"Backward difference", "backward_difference", 3.71445719083257, 13.2064785366307, true},
    {"Damped Newmark", "damped_newmark", 0.280694193836027, 1.32347442541348, true},
    {"Wilson-theta", "wilson_theta", 0.00329521130941751, 0.0641153235971903, true}};

// Nine digits, but for first-step errors of order 1e-5 (as fractions): they are relative to x(h) = 5e-5, which the
// closed form, here as in the thesis, leaves over from terms of 0.1 with round-off of 1e-17. That is 2e-13 of the
// error, and of 3.3e-5 the ninth digit: eight are asked.
TEST(AsPrinted, GivesEveryFigureOfTheThesis) {
  const auto rows = tables_as_printed(*kind_of(testing::single_mass()), 0.01);
  ASSERT_EQ(rows.size(), std::size(thesis));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Printed& expected = thesis[i];
    EXPECT_EQ(rows[i].title, expected.title);
    EXPECT_EQ(rows[i].method, expected.method);
    EXPECT_EQ(rows[i].in_percent, expected.in_percent);
    const bool is_tiny = expected.first < (expected.in_percent ? 1e-2 : 1e-4);
    EXPECT_NEAR(rows[i].first_step_error, expected.first, (is_tiny ? 1e-8 : 1e-9) * expected.first) << expected.title;
    EXPECT_NEAR(rows[i].indicator, expected.indicator, 1e-9 * expected.indicator) << expected.title;
  }
}

struct Correct {
  const char* title;
  double first;  // a fraction
};

// First-step errors of the methods that the rows are named after: the reference page's second table, seven digits, and
// round-off of x(h) as above.
TEST(AsPrinted, PutsTheMethodThatWasMeantBeside) {
  const Correct expected[] = {{"Explicit Euler", 1.0},
                              {"Runge-Kutta 3", 8.375339e-8},
                              {"Runge-Kutta 4", 1.392559e-10},
                              {"Central difference", 3.377955e-3},
                              {"Fox-Goodwin", 1.672394e-3},
                              {"Linear acceleration", 3.313838e-5},
                              {"Trapezoid", 1.738643e-3},
                              {"Linear acceleration II", 3.313838e-5},
                              {"Constant mean acceleration", 1.738643e-3},
                              {"Galerkin", 1.283297e-2},
                              {"Backward difference", 1.688530e-2},
                              {"Damped Newmark", 2.806942e-3},
                              {"Wilson-theta", 3.295211e-5}};
  const auto rows = tables_as_printed(*kind_of(testing::single_mass()), 0.01);
  ASSERT_EQ(rows.size(), std::size(expected));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double unit = rows[i].in_percent ? 100.0 : 1.0;
    EXPECT_EQ(rows[i].title, expected[i].title);
    EXPECT_NEAR(rows[i].correct_first_step_error / unit, expected[i].first, 6e-7 * expected[i].first + 1e-12)
        << rows[i].title;
  }
}

// A row without a convention is the method as it should be, run twice: the same figures, bit for bit. A row with one is
// not.
TEST(AsPrinted, DiffersFromTheMethodThatWasMeantWhereAConventionSaysSo) {
  for (const PrintedRow& row : tables_as_printed(*kind_of(testing::single_mass()), 0.01)) {
    if (row.convention.empty()) {
      EXPECT_EQ(row.first_step_error, row.correct_first_step_error) << row.title;
      EXPECT_EQ(row.indicator, row.correct_indicator) << row.title;
    } else {
      EXPECT_GT(std::abs(row.first_step_error / row.correct_first_step_error - 1.0), 0.1) << row.title;
      // The one sample that explicit Euler lacks moves its mean by 1/30001 of 1 only.
      EXPECT_GT(std::abs(row.indicator / row.correct_indicator - 1.0), 1e-4) << row.title;
    }
  }
}

TEST(AsPrinted, RefusesAnyOtherKindOfModel) {
  EXPECT_THROW(require_model_as_printed(*kind_of(testing::damper_model())), InvalidInput);
  EXPECT_THROW(require_model_as_printed(*kind_of(testing::single_mass(0.15))), InvalidInput);
  EXPECT_THROW(require_model_as_printed(*kind_of(testing::single_mass(0.0, 2.0, 2.0))),
               InvalidInput);  // critically damped
  EXPECT_NO_THROW(require_model_as_printed(*kind_of(testing::single_mass())));
}

}  // namespace
}  // namespace rubato::analysis
