#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubato::numerics {

/// How an iteration of Newton's method ended.
enum class NewtonOutcome {
  converged,
  diverged,    ///< corrections grow, or no part of a correction lowers the residual enough
  not_finite,  ///< a residual or a correction is no number
  singular,    ///< the tangent has no factors
  limit,       ///< of iterations or of evaluations
  stopped      ///< the problem asked for it
};

/// What is known of a correction once it was made.
struct NewtonIteration {
  int number = 0;            ///< 0: the first correction
  double size = 0.0;         ///< of the correction, as the problem measures it
  double last = 0.0;         ///< of the correction before; 0 where there is none
  double contraction = 1.0;  ///< size/last; of the first correction what the problem expects [-]
  bool is_fresh = true;      ///< the factors are those of the iterate that was corrected
};

/// What a convergence test says to a correction.
enum class NewtonVerdict { go_on, converged, stop };

struct NewtonRules {
  int most_iterations = 20;                                ///< corrections
  int most_evaluations = std::numeric_limits<int>::max();  ///< of the residual, where these are what costs
  /// Factors are kept while corrections shrink at least by this; 0: each iteration has its own.
  double keep_below = 0.0;
  /// A correction that grows by more than this with the factors of its own iterate ends the iteration.
  double diverged_above = std::numeric_limits<double>::infinity();
  /// 0: steps are taken as long as `longest_part` says. Else a step is halved until the residual falls enough.
  int most_halvings = 0;
  /// Residuals of which the largest must be undercut: 1 asks for a fall in each step, more let the residual pass a
  /// kink upwards (Grippo, Lampariello and Lucidi 1986). At most 8.
  int memory = 1;
};

struct NewtonReport {
  NewtonOutcome outcome = NewtonOutcome::limit;
  int iterations = 0;        ///< corrections that were begun
  int evaluations = 0;       ///< of the residual
  double residual = 0.0;     ///< size at the last iterate that was evaluated and accepted
  double contraction = 1.0;  ///< of the last correction
  bool has_converged() const { return outcome == NewtonOutcome::converged; }
};

/// The functions of a problem that have a usual answer. A problem derives from this and hides what it answers
/// otherwise.
struct NewtonProblem {
  /// The convergence test by the residual, before a correction is made.
  bool is_solved(double /*residual*/) { return false; }
  /// The share of its first correction that is expected to be left as error [-].
  double expected_contraction(double /*size*/) { return 1.0; }
  /// Asked after each correction: ends the iteration before the step is taken.
  bool stops() { return false; }
  /// The part of the correction that is taken or tried first.
  double longest_part() { return 1.0; }
  /// Whether a part of a correction lowers the residual enough (Armijo's rule).
  /// @param before  the largest of the residuals that are remembered
  bool is_lower(double residual, double before, double part) { return residual < (1.0 - 0.1 * part) * before; }
  /// Whether half of a part that is not lower may do better.
  bool may_be_halved(double /*before*/) { return true; }
  /// The iterate tried last is the one from which the next correction is made.
  void accept(double /*residual*/) {}
  /// The convergence test by the correction, after the step.
  NewtonVerdict judge(const NewtonIteration&) { return NewtonVerdict::go_on; }
};

/// The error of an iterate before a correction was made, if each correction is `contraction` times the last: the sum
/// of the geometric series. Times the contraction it is the error that the correction leaves (Hairer and Wanner 1996,
/// IV.8). HUGE_VAL where corrections do not shrink.
inline double error_before(double size, double contraction) {
  return contraction < 1.0 ? size / (1.0 - contraction) : HUGE_VAL;
}

/// Newton's method for r(x) = 0. It knows neither x nor time, and holds no memory: what x is, how its tangent is
/// factorised and when it is near enough belong to the problem. The cut is that of SUNDIALS' nonlinear solvers: system
/// function, setup, solve and convergence test are handed in. A problem is a NewtonProblem with
///
///   double evaluate(bool with_tangent)  The residual of the iterate; returns its size (0 where only corrections are
///                                       judged). With what factorise() needs, where both together cost less.
///   bool factorise()                    The tangent of the iterate evaluated last; false where it is singular.
///   double correct()                    Solves for the correction with the factors at hand; returns its size.
///   void move(double part)              Puts the iterate where part of the correction leads from the iterate that was
///                                       accepted last.
///
/// Order of the calls: evaluate, is_solved, factorise, correct, stops, move, judge, and again. With halvings a step is
/// evaluated (without tangent) as it is tried, and accept precedes judge. Where no part of a correction is lower, the
/// iterate is moved back. Nothing is allocated, and no call is virtual.
///
/// Factors live no longer than the call, unless the problem holds others from a state that is part of its own memory: a
/// call repeats its bits.
template <class Problem>
NewtonReport newton(Problem& problem, const NewtonRules& rules) {
  NewtonReport report;
  const auto end = [&report](NewtonOutcome outcome) {
    report.outcome = outcome;
    return report;
  };
  std::array<double, 8> recent{};
  const std::size_t memory = std::clamp<std::size_t>(static_cast<std::size_t>(rules.memory), 1, recent.size());
  const bool has_halvings = rules.most_halvings > 0;
  bool needs_factors = true;
  double last = 0.0;
  report.residual = problem.evaluate(true);
  report.evaluations = 1;
  recent.fill(report.residual);
  for (;;) {
    if (problem.is_solved(report.residual)) return end(NewtonOutcome::converged);
    if (!std::isfinite(report.residual)) return end(NewtonOutcome::not_finite);
    if (report.iterations >= rules.most_iterations) return end(NewtonOutcome::limit);
    NewtonIteration iteration{report.iterations++, 0.0, last, 1.0, needs_factors};
    if (needs_factors && !problem.factorise()) return end(NewtonOutcome::singular);
    iteration.size = problem.correct();
    if (problem.stops()) return end(NewtonOutcome::stopped);
    if (!std::isfinite(iteration.size)) return end(NewtonOutcome::not_finite);
    iteration.contraction = iteration.number > 0 ? iteration.size / last : problem.expected_contraction(iteration.size);
    report.contraction = iteration.contraction;

    double part = problem.longest_part();
    if (has_halvings) {
      const double before = *std::max_element(recent.begin(), recent.begin() + static_cast<std::ptrdiff_t>(memory));
      double residual = 0.0;
      for (int halving = 0;; ++halving, part *= 0.5) {
        if (report.evaluations >= rules.most_evaluations) return end(NewtonOutcome::limit);
        problem.move(part);
        residual = problem.evaluate(false);
        ++report.evaluations;
        if (problem.is_lower(residual, before, part)) break;
        if (halving < rules.most_halvings && problem.may_be_halved(before)) continue;
        problem.move(0.0);
        return end(NewtonOutcome::diverged);
      }
      problem.accept(residual);
      report.residual = residual;
      recent[static_cast<std::size_t>(report.iterations) % memory] = residual;
    } else {
      problem.move(part);
    }

    const NewtonVerdict verdict = problem.judge(iteration);
    if (verdict == NewtonVerdict::converged) return end(NewtonOutcome::converged);
    if (verdict == NewtonVerdict::stop) return end(NewtonOutcome::stopped);
    const bool is_measured = iteration.number > 0;
    if (is_measured && iteration.is_fresh && iteration.contraction > rules.diverged_above)
      return end(NewtonOutcome::diverged);
    // The first correction says nothing of what the factors do to the second.
    needs_factors = !(rules.keep_below > 0.0) || (is_measured && iteration.contraction > rules.keep_below);
    last = iteration.size;
    if (has_halvings) continue;
    if (report.iterations >= rules.most_iterations || report.evaluations >= rules.most_evaluations)
      return end(NewtonOutcome::limit);
    report.residual = problem.evaluate(needs_factors);
    ++report.evaluations;
  }
}

}  // namespace rubato::numerics
