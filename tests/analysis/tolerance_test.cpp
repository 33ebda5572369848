#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include "support/exact_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

namespace rubato::analysis {
namespace {

using integrate::find_equilibrium;
using integrate::StaticOutcome;

struct Structure {
  const char* name;
  const char* example;
  std::size_t held;         // displacements that are held in the static start
  double duration;          // [s]
  double least;             // tolerance
  double largest_in_slope;  // tolerance
};

std::ostream& operator<<(std::ostream& out, const Structure& row) { return out << row.name; }

class ToleranceOfStructures : public ::testing::TestWithParam<Structure> {};

// docs/theory/automatic-steps.md: the largest error of a march, relative to the response, is proportional to the
// tolerance over six decades (three for the building, to save time) and within a factor of ten of it. The steps of the
// building end at the rows of its ground motion, so that loose tolerances are met by far: the slope is taken below
// them.
TEST_P(ToleranceOfStructures, IsTheirLargestErrorWithinAFactorOfTen) {
  const Structure row = GetParam();
  const auto study = io::read_study(std::filesystem::path(RUBATO_EXAMPLES) / row.example / "study.toml");
  numerics::Parameters settings;
  if (std::string(row.example) == "building") settings = {{"slip_force", 0.0}};
  const auto system =
      system::assemble(model::build(study.model, model::evaluate_parameters(study.parameters, settings)));
  const auto equilibrium = find_equilibrium(system, {system.held_displacements().data(), row.held});
  ASSERT_EQ(equilibrium.outcome, StaticOutcome::found);
  const system::State start = integrate::consistent_start(system, equilibrium.state);
  const integrate::Method method = integrate::make_method("generalized_alpha");
  double sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
  for (double tolerance = 1e-2; tolerance > 0.5 * row.least; tolerance *= 0.1) {
    const auto stepper = integrate::make_stepper(method, system);
    const auto estimator =
        integrate::make_estimator(integrate::LocalError{tolerance}, method, system, *stepper, row.duration);
    testing::ExactErrors errors(system, start);
    system::State state = start;
    const auto report = march(*stepper, *estimator, {}, system, state, row.duration, &errors);
    ASSERT_EQ(report.march.end, integrate::MarchEnd::reached);
    errors.finish();
    EXPECT_GT(errors.relative(), 0.1 * tolerance) << tolerance;
    EXPECT_LT(errors.relative(), 10.0 * tolerance) << tolerance;
    if (tolerance > 1.1 * row.largest_in_slope) continue;
    const double x = std::log10(tolerance), y = std::log10(errors.relative());
    sx += x, sy += y, sxx += x * x, sxy += x * y, n += 1;
  }
  EXPECT_NEAR((n * sxy - sx * sy) / (n * sxx - sx * sx), 1.0, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Examples, ToleranceOfStructures,
                         ::testing::Values(Structure{"FramePMB", "frame", 1, 0.12, 1e-8, 1e-2},
                                           Structure{"FramePMM", "frame", 2, 0.02, 1e-8, 1e-2},
                                           Structure{"Building", "building", 0, 20.0, 1e-5, 1e-3}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace rubato::analysis
