#pragma once

#include <rubato/numerics/formula.hpp>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace rubato::numerics {

/// From a time to another a step may be this long [s].
struct StepBound {
  double from = 0.0, to = 0.0, step = 0.0;
};

/// How long steps may be that are to see how a formula swings: of a sine a sixth of its period.
struct Swings {
  std::vector<StepBound> bounds;  ///< rising, apart; elsewhere nothing bounds a step
  bool are_known = true;          ///< false: the search for them, or for the switches of the formula, was given up
};

/// The times in (from, to) at which a branch of a formula changes, rising (Formula::switches); none where there are
/// more than 262,144, or where the search for them would take longer than about a second.
std::optional<std::vector<double>> find_switches(const Formula& formula, double from, double to);

/// The swings of a formula, or of its derivative of order 1 or 2, in (from, to).
///
/// The interval is divided until enclosures of value and fourth derivative (FormulaEnclosure) tell that the cubic
/// through the ends of each part is off by less than 2.5e-5 of the range, so that nothing hides between samples.
/// An arc is what lies between two changes of the sign of the second derivative, its height s the largest distance
/// from its chord. Arcs that are higher than 1e-4 of the range bound the steps by
///
///   h = pi/3 sqrt(s/|f''|)
///
/// which for a sine, whose s/|f''| is 1/omega^2 where it turns, is a sixth of its period, and for a pulse
/// exp(-(t/tau)^2) is half of tau. A bound holds for 2 h before and after its place too.
///
/// Of a formula of further values (Formula) each part that depends on t alone counts, and the whole with constants
/// in their place. Given up after about a second, as for a sine of more than 15,000 periods.
Swings swings(const Formula& formula, int order, double from, double to);

/// The smaller of two bounds at each time; those not below `longest` are left out.
std::vector<StepBound> join(const std::vector<StepBound>& a, const std::vector<StepBound>& b,
                            double longest = HUGE_VAL);

}  // namespace rubato::numerics
