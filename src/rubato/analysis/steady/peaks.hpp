#pragma once

#include <rubato/core/types.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace rubato::analysis {

/// Some curves over x: writes their values at x [c]; false where there are none.
using Curves = std::function<bool(double x, Vector& values)>;

/// A local maximum of one of them, or its value at an end of the range that it falls off from.
struct Peak {
  enum class Kind { interior, lower_end, upper_end };
  Index curve = 0;
  double at = 0.0, value = 0.0;
  double slope = 0.0;  ///< of the curve there: round-off where it is interior, NaN at a corner
  Kind kind = Kind::interior;
  bool is_closed = true;  ///< false: places beside it have no value, and the curve may be higher there
};

/// Where peaks are looked for.
struct PeakRange {
  double from = 0.0, to = 0.0;
  int samples = 33;             ///< equally spaced, at least 3
  std::vector<double> besides;  ///< where a narrow peak may be: other samples
  double noise = 1e-13;         ///< of the curves, relative: what differences have to bear
};

/// Where some curves have local extremes, for PeakRange::besides: with them as samples, a maximum and its neighbours
/// stand alone in a bracket. Distances of samples are halved once, and on wherever the cubic through four of them
/// misses the value between by a hundredth of the largest of the five, five times in all at most. For curves that cost
/// little and resemble those in question.
/// @param sought  how many of the values, the first, are those curves. Whatever follows, of one unit, is looked at for
///                bends only: a peak between two samples that one curve shows by chance no trace of, another does.
std::vector<double> find_extremes(const Curves& curves, const PeakRange& range, Index sought);

/// All local maxima between the samples, each where its slope vanishes: bracketed by the samples, approached by
/// parabolas (Brent 1973), and finished by Newton's method on central differences of 3e-6 x, which place the maximum of
/// curves exact to 1e-13 within 1e-9 x; of more noise with its cube root and that squared. Where points on the way have
/// no value the best that has one stands for the maximum, which is not closed. The highest first.
std::vector<Peak> find_peaks(const Curves& curves, const PeakRange& range);

/// The maximum that a known one has become after a small change of the curves; nothing if it is gone.
std::optional<Peak> follow_peak(const Curves& curves, const PeakRange& range, const Peak& known);

}  // namespace rubato::analysis
