#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/steady/status_counts.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <utility>

// Frequency responses of structures that nothing but friction holds, or nothing at all.
namespace rubato::testing {
namespace {

// Three masses that float, with a slider between the outer ones, under a static push on each end.
std::string floating(double push, double other, const std::string& solver, double drag = 0.0) {
  std::string text =
      fmt::format("[parameters]\nOmega = 1.0\n[damping]\nrayleigh = {{ mass = {}, stiffness = 0.01 }}\n", drag);
  for (const char* name : {"a", "b", "c"}) text += fmt::format("[[coordinate]]\nname = \"{}\"\nmass = 1.0\n", name);
  for (const auto& [one, two] : {std::pair{"a", "b"}, {"b", "c"}})
    text += fmt::format("[[spring]]\nbetween = [\"{}\", \"{}\"]\nstiffness = {}\n", one, two,
                        one == std::string("a") ? 19.47971 : 21.3333);
  text +=
      "[[slider]]\nname = \"rub\"\nbetween = [\"a\", \"c\"]\nstiffness = 10.0\nfriction_coefficient = 0.5\n"
      "normal_load = 1.0\n[[force]]\non = \"a\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n";
  for (const auto& [on, force] : {std::pair{"a", push}, {"c", other}})
    if (force != 0.0) text += fmt::format("[[force]]\non = \"{}\"\nexpression = \"{}\"\n", on, force);
  return text + fmt::format(
                    "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [1.0, 3.0, 5.0]\n"
                    "observe = [\"a - b\", \"c\"]\nsolver = \"{}\"\n",
                    solver);
}

auto answer(const std::string& text) {
  const PreparedStudy prepared(text);
  MemorySink sink;
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  (void)analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context);
  return std::move(sink.tables.at("frf"));
}

// What nothing holds gains speed for ever under a mean force: no row may look like an answer.
TEST(FrequencyResponse, OfWhatFloatsUnderAStaticPushIsUnbounded) {
  for (const std::string solver : {"periodic", "harmonic_balance", "time_marching"})
    for (const double drag : {0.0, 0.02}) {
      const auto pushed = answer(floating(0.1, 0.0, solver, drag));
      ASSERT_EQ(pushed.rows.size(), 3u);
      const auto wanted = solver == "time_marching" && drag == 0.0 ? analysis::PointStatus::impossible
                                                                   : analysis::PointStatus::unbounded;
      for (const auto& row : pushed.rows)
        EXPECT_EQ(row[pushed.column("status")], static_cast<double>(wanted)) << solver << drag;
    }
  // Pushes that balance only stretch it.
  const auto exact = answer(floating(0.1, -0.1, "periodic")), series = answer(floating(0.1, -0.1, "harmonic_balance"));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(exact.rows[i][exact.column("status")], 0.0);
    EXPECT_LT(exact.rows[i][exact.column("residual")], 1e-9);
    const double size = exact.rows[i][exact.column("amplitude", "c")];
    EXPECT_NEAR(series.rows[i][series.column("amplitude", "c")], size, 1e-2 * size);
  }
}

// A mass on a slider, under two orders: periodic finds what sticks; a march extrapolated to 600 km and called it
// walking.
TEST(FrequencyResponse, OfAMassThatSticksIsNotLedFarAway) {
  const std::string text =
      "[parameters]\nOmega = 1200.0\n[[coordinate]]\nname = \"m\"\nmass = 1.45238\n[[slider]]\nname = \"rub\"\n"
      "between = [\"m\", \"ground\"]\nstiffness = 57124.7\nfriction_coefficient = 0.5\nnormal_load = 0.793226\n"
      "[[force]]\non = \"m\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n[[force]]\non = \"m\"\namplitude = "
      "0.756142\nphase = 1.39445\nangular_frequency = \"2*Omega\"\n[[analysis]]\nname = \"frf\"\ntype = "
      "\"frequency_response\"\nangular_frequency = [226.34617317069927, 1203.5939257464092, 1209.3656911793153]\n"
      "excitation = \"Omega\"\nsolver = \"";
  const auto exact = answer(text + "periodic\"\n"), marched = answer(text + "time_marching\"\n");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(exact.rows[i][exact.column("status")],
              static_cast<double>(i == 0 ? analysis::PointStatus::drifting : analysis::PointStatus::converged));
    if (marched.rows[i][marched.column("status")] == static_cast<double>(analysis::PointStatus::not_converged))
      continue;
    const double size = exact.rows[i][exact.column("amplitude", "m")];
    EXPECT_NEAR(marched.rows[i][marched.column("amplitude", "m")], size, 1e-2 * size);
  }
}

}  // namespace
}  // namespace rubato::testing
