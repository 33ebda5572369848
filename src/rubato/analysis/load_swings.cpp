#include <rubato/analysis/load_swings.hpp>
#include <rubato/core/excerpt.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {

LoadSwings::LoadSwings(const integrate::SystemKind& kind, double duration) : duration_(duration) {
  kind.for_each_time_law([this](const model::TimeLaw& law) { take(law); });
}

void LoadSwings::take(const model::TimeLaw& law) {
  if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&law)) {
    const double omega = std::abs(harmonic->angular_frequency);
    if (omega == 0.0) return;
    loads_.push_back({fmt::format("the harmonic load of {:.6g} rad/s", omega),
                      true,
                      {{{0.0, duration_, std::numbers::pi / 3.0 / omega}}, true}});
  } else if (const auto* derivative = std::get_if<model::FormulaDerivative>(&law)) {
    take(derivative->formula, derivative->order);
  } else if (const auto* formula = std::get_if<model::FormulaLaw>(&law)) {
    take(formula->formula, 0);
  }
}

void LoadSwings::take(const numerics::Formula& formula, int order) {
  const std::pair<std::string, int> key(formula.text(), order);
  if (std::find(known_.begin(), known_.end(), key) != known_.end()) return;
  known_.push_back(key);
  loads_.push_back({fmt::format("the formula \"{}\"", excerpt(formula.text())), false,
                    numerics::swings(formula, order, 0.0, duration_)});
}

double LoadSwings::harmonic_limit() const {
  double shortest = HUGE_VAL;
  for (const Load& load : loads_)
    if (load.is_harmonic)
      for (const auto& bound : load.swings.bounds) shortest = std::min(shortest, bound.step);
  return shortest;
}

void LoadSwings::bound(integrate::StepPlan& plan) const {
  for (const Load& load : loads_)
    if (!load.is_harmonic) plan.bounds = numerics::join(plan.bounds, load.swings.bounds, plan.largest);
}

double LoadSwings::least_steps(const integrate::StepPlan& plan) const {
  double steps = duration_ / plan.largest;
  for (const auto& bound : plan.bounds) steps += (bound.to - bound.from) * (1.0 / bound.step - 1.0 / plan.largest);
  return std::ceil(steps);
}

void LoadSwings::warn_of_unknown(std::vector<std::string>& warnings) const {
  std::string last;
  for (const Load& load : loads_) {
    if (load.swings.are_known || load.name == last) continue;
    last = load.name;
    warnings.push_back(
        fmt::format("{} swings or switches too often for all of it to be found: steps may pass what it "
                    "does; give step = {{ largest = ... }}, a sixth of its period or less",
                    load.name));
  }
}

void LoadSwings::warn_of_long_steps(double step, std::vector<std::string>& warnings) const {
  constexpr double too_long = 2.0;  // of a sixth of a period
  std::string last;
  for (const Load& load : loads_) {
    const auto fastest = std::min_element(load.swings.bounds.begin(), load.swings.bounds.end(),
                                          [](const auto& a, const auto& b) { return a.step < b.step; });
    if (fastest == load.swings.bounds.end() || !(fastest->step * too_long < step) || load.name == last) continue;
    last = load.name;
    const bool is_from_the_start = fastest->from < 1e-9 * duration_;
    const std::string when = is_from_the_start ? "" : fmt::format(" from t = {:.6g} s on", fastest->from);
    warnings.push_back(fmt::format("{} swings{} faster than steps of {:.6g} s can follow; take {:.3g} s or less",
                                   load.name, when, step, fastest->step));
  }
  for (const Load& load : loads_) {
    if (load.swings.are_known || load.name == last) continue;
    last = load.name;
    warnings.push_back(
        fmt::format("{} swings or switches too often for all of it to be found: look whether steps of "
                    "{:.6g} s follow it",
                    load.name, step));
  }
}

}  // namespace rubato::analysis
