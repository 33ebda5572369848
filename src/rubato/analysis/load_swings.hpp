#pragma once

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/time_law.hpp>
#include <rubato/numerics/formula_swings.hpp>

#include <string>
#include <utility>
#include <vector>

namespace rubato::analysis {

/// How loads, prescribed motions and laws that depend on time swing in a run that starts at t = 0: formulas and
/// harmonic laws. Of tables nothing need be known, since steps end at their rows.
class LoadSwings {
 public:
  LoadSwings(const integrate::SystemKind& kind, double duration);

  /// What harmonic laws allow: a sixth of the shortest period [s]; HUGE_VAL where there are none.
  double harmonic_limit() const;
  /// Makes automatic steps as short as what swings asks for, where that is shorter than the plan's largest step.
  void bound(integrate::StepPlan& plan) const;
  /// How many steps at least a plan takes.
  double least_steps(const integrate::StepPlan& plan) const;

  /// Tells of formulas whose swings were not found, and asks for `largest`.
  void warn_of_unknown(std::vector<std::string>& warnings) const;
  /// Tells of what swings faster than equal steps follow: with less than three steps a period.
  void warn_of_long_steps(double step, std::vector<std::string>& warnings) const;

 private:
  struct Load {
    std::string name;  // "the formula \"sin(t)\""
    bool is_harmonic = false;
    numerics::Swings swings;
  };
  void take(const model::TimeLaw& law);
  void take(const numerics::Formula& formula, int order);

  double duration_;
  std::vector<Load> loads_;
  std::vector<std::pair<std::string, int>> known_;  // formulas and the order of their derivative
};

}  // namespace rubato::analysis
