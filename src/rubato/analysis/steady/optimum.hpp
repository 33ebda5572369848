#pragma once

#include <rubato/analysis/steady/peaks.hpp>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Curves over x that depend on a parameter p, and their highest peak F(p).
class PeakFamily {
 public:
  virtual ~PeakFamily() = default;
  /// All peaks at a parameter, the highest first; empty where there are none.
  virtual std::vector<Peak> peaks(double parameter) = 0;
  /// What a peak has become at a nearby parameter.
  virtual std::optional<Peak> follow(double parameter, const Peak& known) = 0;
};

/// The parameter with the lowest (or highest) F, and what certifies it. Where an active peak lies at an end of the
/// range of x, the certificate is that of F over this range: its slope over x does not vanish (Peak::kind says so).
struct Optimum {
  enum class Kind {
    smooth,       ///< one peak, whose derivatives to x and to p vanish
    kink,         ///< two peaks are equal; one falls with p, the other rises
    corner,       ///< one peak, which falls on one side of p and rises on the other
    bound,        ///< an end of the range of p, beyond which F would go on
    flat,         ///< F does not change with p
    uncertified,  ///< the best that was found; none of the above could be shown
  };
  Kind kind = Kind::smooth;
  double parameter = 0.0;
  std::vector<Peak> active;               ///< one peak, or the two of a kink; that of a corner twice
  std::array<double, 2> derivative{};     ///< dF/dp of each active peak
  std::array<double, 2> multiplier{1.0};  ///< >= 0, sum 1: sum of multiplier * derivative is 0 at a kink or corner
  double curvature = 0.0;                 ///< d2F/dp2 of a smooth one
};

/// Refines the best sample of F to the precision of the curves: a bracket, Brent's method, and then Newton's method on
/// the derivative of the active peak, or on the difference of two where they cross.
/// @param samples  rising values of p, at least 2   @param values  F there; NaN where there is none
/// @param sign     +1: the lowest F; -1: the highest   @param noise  of F, relative; more makes for longer differences
/// Nothing where no sample has a value.
std::optional<Optimum> find_optimum(PeakFamily& family, const std::vector<double>& samples,
                                    const std::vector<double>& values, double sign, double noise = 1e-13);

std::string optimum_kind(Optimum::Kind kind);

}  // namespace rubato::analysis
