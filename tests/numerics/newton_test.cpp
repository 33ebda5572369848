#include <rubato/numerics/newton.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace rubato::numerics {
namespace {

/// One equation r(x) = 0. Remembers what the iteration did.
template <class Residual, class Slope>
struct Scalar : NewtonProblem {
  Scalar(double start, Residual r, Slope s, double tolerance_)
      : x(start), from(start), residual_of(r), slope_of(s), tolerance(tolerance_) {}

  double evaluate(bool) {
    ++evaluations;
    residual = residual_of(x);
    return std::abs(residual);
  }
  bool factorise() {
    ++factorisations;
    slope = slope_of(x);
    return slope != 0.0;
  }
  double correct() {
    from = x;
    correction = -residual / slope;
    sizes.push_back(std::abs(correction));
    return std::abs(correction);
  }
  void move(double part) { x = from + part * correction; }
  bool is_solved(double size) { return tests_residual && size <= tolerance; }
  NewtonVerdict judge(const NewtonIteration& iteration) {
    seen.push_back(iteration);
    parts.push_back((x - from) / correction);
    if (stops_after >= 0 && iteration.number >= stops_after) return NewtonVerdict::stop;
    const bool is_near =
        !tests_residual && iteration.contraction * error_before(iteration.size, iteration.contraction) <= tolerance;
    return is_near ? NewtonVerdict::converged : NewtonVerdict::go_on;
  }

  double x, from, residual = 0.0, slope = 0.0, correction = 0.0;
  Residual residual_of;
  Slope slope_of;
  double tolerance;
  bool tests_residual = true;
  int stops_after = -1, evaluations = 0, factorisations = 0;
  std::vector<double> sizes, parts;
  std::vector<NewtonIteration> seen;
};

auto square_root_of_two(double start, double tolerance) {
  return Scalar(
      start, [](double x) { return x * x - 2.0; }, [](double x) { return 2.0 * x; }, tolerance);
}

auto arctangent(double start, double tolerance) {
  return Scalar(
      start, [](double x) { return std::atan(x); }, [](double x) { return 1.0 / (1.0 + x * x); }, tolerance);
}

TEST(Newton, SquaresTheErrorWithTheTangentOfEachIterate) {
  auto problem = square_root_of_two(2.0, 1e-15);
  const NewtonReport report = newton(problem, {});
  EXPECT_TRUE(report.has_converged());
  EXPECT_NEAR(problem.x, std::sqrt(2.0), 1e-15);
  EXPECT_EQ(problem.factorisations, report.iterations);
  // e1 = e0^2/(2 x0): corrections follow by d1 = d0^2/(2 x1) exactly.
  for (std::size_t i = 1; i < 4; ++i) {
    const double x = i == 1 ? 1.5 : i == 2 ? 17.0 / 12.0 : 577.0 / 408.0;
    EXPECT_NEAR(problem.sizes[i], problem.sizes[i - 1] * problem.sizes[i - 1] / (2.0 * x), 1e-15);
  }
}

TEST(Newton, ContractsWithFactorsThatAreKeptByWhatTheTangentHasChanged) {
  auto problem = square_root_of_two(1.5, 1e-13);
  problem.tests_residual = false;
  NewtonRules rules;
  rules.keep_below = 0.1;
  const NewtonReport report = newton(problem, rules);
  EXPECT_TRUE(report.has_converged());
  EXPECT_EQ(problem.factorisations, 1);
  EXPECT_NEAR(problem.x, std::sqrt(2.0), 1e-13);
  // x <- x - (x^2 - 2)/3 leaves 1 - 2 sqrt(2)/3 of the error.
  EXPECT_NEAR(problem.seen[3].contraction, 1.0 - 2.0 * std::sqrt(2.0) / 3.0, 1e-3);
  EXPECT_NEAR(report.contraction, 1.0 - 2.0 * std::sqrt(2.0) / 3.0, 1e-3);
  EXPECT_TRUE(problem.seen[0].is_fresh);
  EXPECT_FALSE(problem.seen[1].is_fresh);
}

TEST(Newton, RenewsFactorsThatContractTooLittle) {
  auto problem = square_root_of_two(3.0, 1e-14);
  problem.tests_residual = false;
  NewtonRules rules;
  rules.keep_below = 0.1;  // the factors of x = 3 leave a third and more of the error
  const NewtonReport report = newton(problem, rules);
  EXPECT_TRUE(report.has_converged());
  EXPECT_GT(problem.factorisations, 1);
  EXPECT_LT(problem.factorisations, report.iterations);
  EXPECT_NEAR(problem.x, std::sqrt(2.0), 1e-14);
}

TEST(Newton, TellsASingularTangent) {
  auto problem = square_root_of_two(0.0, 1e-12);
  const NewtonReport report = newton(problem, {});
  EXPECT_EQ(report.outcome, NewtonOutcome::singular);
  EXPECT_EQ(problem.x, 0.0);
}

TEST(Newton, TellsAResidualThatIsNoNumber) {
  Scalar problem(
      -1.0, [](double x) { return std::log(x); }, [](double x) { return 1.0 / x; }, 1e-12);
  EXPECT_EQ(newton(problem, {}).outcome, NewtonOutcome::not_finite);
  EXPECT_EQ(problem.factorisations, 0);
  EXPECT_EQ(problem.x, -1.0);
}

TEST(Newton, TellsACorrectionThatIsNoNumber) {
  Scalar problem(
      1.0, [](double x) { return x; }, [](double) { return std::numeric_limits<double>::quiet_NaN(); }, 0.0);
  EXPECT_EQ(newton(problem, {}).outcome, NewtonOutcome::not_finite);
  EXPECT_EQ(problem.x, 1.0);
}

TEST(Newton, DivergesOnTheArctangentFromFarAway) {
  auto problem = arctangent(3.0, 1e-12);  // full steps lead outwards from 1.39 on
  NewtonRules rules;
  rules.diverged_above = 2.0;
  const NewtonReport report = newton(problem, rules);
  EXPECT_EQ(report.outcome, NewtonOutcome::diverged);
  EXPECT_GT(report.contraction, 2.0);
}

TEST(Newton, FindsTheRootOfTheArctangentFromFarAwayByHalving) {
  auto problem = arctangent(100.0, 1e-15);
  NewtonRules rules;
  rules.most_halvings = 20;
  const NewtonReport report = newton(problem, rules);
  EXPECT_TRUE(report.has_converged());
  EXPECT_NEAR(problem.x, 0.0, 1e-15);
  EXPECT_LT(problem.parts.front(), 1.0);
  EXPECT_EQ(problem.parts.back(), 1.0);
}

TEST(Newton, StandsWhereItStoodIfNoPartOfACorrectionIsLower) {
  // The slope has the wrong sign: each part leads uphill.
  Scalar problem(
      1.0, [](double x) { return x; }, [](double) { return -1.0; }, 1e-12);
  NewtonRules rules;
  rules.most_halvings = 5;
  const NewtonReport report = newton(problem, rules);
  EXPECT_EQ(report.outcome, NewtonOutcome::diverged);
  EXPECT_EQ(problem.x, 1.0);
  EXPECT_EQ(report.residual, 1.0);
  EXPECT_EQ(problem.evaluations, 1 + 6);
}

TEST(Newton, PassesAKinkUpwardsWhereItRemembersLargerResiduals) {
  // Slopes 7/15 from 3 on, 1/10 between 1 and 3, 1/2 below: from 8 a full step leads to 1.5, and from there, by the
  // small slope, past the root to -4, where the residual 2 lies between the first, 3.03, and the second, 0.55.
  const auto residual = [](double x) {
    return x < 1.0 ? 0.5 * x : x < 3.0 ? 0.4 + 0.1 * x : 0.7 + 7.0 / 15.0 * (x - 3.0);
  };
  const auto slope = [](double x) { return x < 1.0 ? 0.5 : x < 3.0 ? 0.1 : 7.0 / 15.0; };
  for (const int memory : {1, 4}) {
    Scalar problem(8.0, residual, slope, 1e-14);
    NewtonRules rules;
    rules.most_halvings = 7;
    rules.memory = memory;
    EXPECT_TRUE(newton(problem, rules).has_converged());
    EXPECT_EQ(problem.parts[0], 1.0);
    if (memory == 1)
      EXPECT_LT(problem.parts[1], 1.0);
    else
      EXPECT_EQ(problem.parts, std::vector<double>(3, 1.0));
  }
}

TEST(Newton, ForgetsResidualsOlderThanItsMemory) {
  struct Circling : NewtonProblem {  // 100, 50, and then 60 for good
    double evaluate(bool) { return evaluations == 0 ? 100.0 : evaluations == 1 ? 50.0 : 60.0; }
    bool factorise() { return true; }
    double correct() { return 1.0; }
    void move(double part) { evaluations += part == 1.0 ? 1 : 0; }
    int evaluations = 0;
  } problem;
  NewtonRules rules;
  rules.most_halvings = 3;
  rules.memory = 2;
  const NewtonReport report = newton(problem, rules);
  EXPECT_EQ(report.outcome, NewtonOutcome::diverged);
  EXPECT_EQ(report.iterations, 3);  // 60 is less than nine tenths of 100, not of 60
}

TEST(Newton, EndsAtTheLimitOfIterationsWithoutAnEvaluationMore) {
  auto problem = square_root_of_two(1e6, 1e-12);
  NewtonRules rules;
  rules.most_iterations = 4;
  const NewtonReport report = newton(problem, rules);
  EXPECT_EQ(report.outcome, NewtonOutcome::limit);
  EXPECT_EQ(report.iterations, 4);
  EXPECT_EQ(problem.evaluations, 4);
}

TEST(Newton, EndsAtTheLimitOfEvaluations) {
  auto problem = arctangent(100.0, 1e-15);
  NewtonRules rules;
  rules.most_halvings = 20;
  rules.most_evaluations = 5;
  const NewtonReport report = newton(problem, rules);
  EXPECT_EQ(report.outcome, NewtonOutcome::limit);
  EXPECT_EQ(report.evaluations, 5);
  EXPECT_EQ(problem.evaluations, 5);
}

TEST(Newton, StopsWhereTheProblemAsks) {
  auto problem = square_root_of_two(5.0, 1e-12);
  problem.stops_after = 1;
  const NewtonReport report = newton(problem, {});
  EXPECT_EQ(report.outcome, NewtonOutcome::stopped);
  EXPECT_EQ(report.iterations, 2);
}

TEST(Newton, RepeatsItsBits) {
  double first = 0.0;
  for (int run = 0; run < 2; ++run) {
    auto problem = square_root_of_two(3.0, 1e-14);
    problem.tests_residual = false;
    NewtonRules rules;
    rules.keep_below = 0.5;
    newton(problem, rules);
    if (run == 0)
      first = problem.x;
    else
      EXPECT_EQ(problem.x, first);
  }
}

TEST(Newton, KnowsTheErrorOfAGeometricSeries) {
  EXPECT_DOUBLE_EQ(error_before(1.0, 0.5), 2.0);  // 1 + 1/2 + 1/4 + ...
  EXPECT_TRUE(std::isinf(error_before(1.0, 1.0)));
  EXPECT_TRUE(std::isinf(error_before(1.0, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace rubato::numerics
