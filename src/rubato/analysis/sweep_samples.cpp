#include <rubato/analysis/sobol_directions.hpp>
#include <rubato/analysis/sweep_samples.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rubato::analysis {
namespace {

using Sampling = model::RandomSweepDescription::Sampling;
using Generator = std::mt19937_64;  // its numbers are fixed by the standard; those of std::..._distribution are not

constexpr int bits = 52;  // so that a point plus half a unit is exact, and never 0 or 1

double in_unit_interval(std::uint64_t integer) { return (static_cast<double>(integer) + 0.5) * std::exp2(-bits); }
double uniform(Generator& generator) { return in_unit_interval(generator() >> (64 - bits)); }

// A whole number below `end`, all equally likely.
std::uint64_t below(std::uint64_t end, Generator& generator) {
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max() / end * end;
  std::uint64_t number = generator();
  while (number >= most) number = generator();
  return number % end;
}

Matrix latin_hypercube(Index dimensions, Index count, Generator& generator) {
  Matrix points(dimensions, count);
  std::vector<Index> slice(static_cast<std::size_t>(count));
  for (Index axis = 0; axis < dimensions; ++axis) {
    for (Index i = 0; i < count; ++i) slice[static_cast<std::size_t>(i)] = i;
    for (std::size_t i = slice.size(); i > 1; --i) std::swap(slice[i - 1], slice[below(i, generator)]);
    for (Index i = 0; i < count; ++i)
      points(axis, i) =
          (static_cast<double>(slice[static_cast<std::size_t>(i)]) + uniform(generator)) / static_cast<double>(count);
  }
  return points;
}

/// The direction numbers of an axis, shifted to the top of `bits` bits.
std::array<std::uint64_t, bits> directions_of(Index axis) {
  std::array<std::uint64_t, bits> directions{};
  if (axis == 0) {
    directions.fill(1);
  } else {
    const SobolAxis& numbers = sobol_axes[static_cast<std::size_t>(axis - 1)];
    const int degree = std::bit_width(numbers.polynomial) - 1;
    for (int j = 0; j < bits; ++j) {
      const auto place = static_cast<std::size_t>(j);
      if (j < degree) {
        directions[place] = numbers.start[place];
        continue;
      }
      directions[place] = directions[place - static_cast<std::size_t>(degree)];
      for (int k = 0; k < degree; ++k)
        if ((numbers.polynomial >> k) & 1u)
          directions[place] ^= directions[place - static_cast<std::size_t>(degree - k)] << (degree - k);
    }
  }
  for (int j = 0; j < bits; ++j) directions[static_cast<std::size_t>(j)] <<= bits - 1 - j;
  return directions;
}

Matrix sobol(Index dimensions, Index count, Generator& generator) {
  Matrix points(dimensions, count);
  for (Index axis = 0; axis < dimensions; ++axis) {
    const auto directions = directions_of(axis);
    std::uint64_t point = generator() >> (64 - bits);  // the digital shift
    for (Index i = 0; i < count; ++i) {
      points(axis, i) = in_unit_interval(point);
      point ^= directions[static_cast<std::size_t>(std::countr_one(static_cast<std::uint64_t>(i)))];
    }
  }
  return points;
}

}  // namespace

double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1.0 - p);
  // Abramowitz and Stegun, 26.2.23 (error below 4.5e-4), then Halley's iteration, which cubes the error.
  const double t = std::sqrt(-2.0 * std::log(p));
  double x = -t + (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  for (int i = 0; i < 3; ++i) {
    const double excess = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
    const double step = excess * std::sqrt(2.0 * std::numbers::pi) * std::exp(0.5 * x * x);
    x -= step / (1.0 + 0.5 * x * step);
  }
  return x;
}

double Distribution::quantile(double u) const {
  switch (kind) {
    case model::DistributionDescription::Kind::normal:
      return first + second * normal_quantile(u);
    case model::DistributionDescription::Kind::uniform:
      return first + (second - first) * u;
    case model::DistributionDescription::Kind::lognormal:
      return first * std::exp(second * normal_quantile(u));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

Matrix unit_samples(Sampling sampling, Index dimensions, Index count, long seed) {
  Generator generator(static_cast<std::uint64_t>(seed));
  if (sampling == Sampling::latin_hypercube) return latin_hypercube(dimensions, count, generator);
  if (sampling == Sampling::sobol) return sobol(dimensions, count, generator);
  Matrix points(dimensions, count);
  for (Index i = 0; i < count; ++i)
    for (Index axis = 0; axis < dimensions; ++axis) points(axis, i) = uniform(generator);
  return points;
}

double percentile(std::span<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below_it = static_cast<std::ptrdiff_t>(std::floor(place));
  std::nth_element(values.begin(), values.begin() + below_it, values.end());
  const double low = values[static_cast<std::size_t>(below_it)], part = place - static_cast<double>(below_it);
  if (part == 0.0) return low;
  const double high = *std::min_element(values.begin() + below_it + 1, values.end());
  return low == high ? low : low + part * (high - low);
}

}  // namespace rubato::analysis
