#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/description.hpp>

#include <span>
#include <vector>

namespace rubato::analysis {

/// How a parameter is distributed.
///
///   normal: first + second z   uniform: first + (second - first) u   lognormal: first exp(second z)
///
/// with u uniform in (0, 1) and z its standard normal quantile.
struct Distribution {
  model::DistributionDescription::Kind kind;
  double first, second;

  /// The value below which the share `u` of all samples lies, 0 < u < 1.
  double quantile(double u) const;
};

/// The x with P(z < x) = p of the standard normal distribution, 0 < p < 1, to a few units of round-off.
double normal_quantile(double p);

/// Largest number of parameters that Sobol points cover.
inline constexpr int most_sobol_dimensions = 64;

/// Points in the unit cube (0, 1)^d, one a column [d x count]; the same for the same seed on every machine.
///
/// random: 64-bit Mersenne twister. latin_hypercube: each of `count` equal slices of every axis holds one point, at a
/// random place in it (McKay, Beckman and Conover 1979). sobol: the sequence with the direction numbers of Joe and Kuo
/// (2008) and a random digital shift, from its first point on; d <= most_sobol_dimensions.
Matrix unit_samples(model::RandomSweepDescription::Sampling sampling, Index dimensions, Index count, long seed);

/// The value below which a share lies: between neighbours of the sorted sample, linearly (Hyndman and Fan 1996, type
/// 7). `values` is reordered; NaN if it is empty.
double percentile(std::span<double> values, double share);

}  // namespace rubato::analysis
