#include <gtest/gtest.h>

#include <rubato/analysis/sobol_directions.hpp>
#include <rubato/analysis/sweep_samples.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

namespace rubato::analysis {
namespace {

using Sampling = model::RandomSweepDescription::Sampling;

TEST(NormalQuantile, InvertsTheNormalDistribution) {
  // Wichura (1988), table of test values: 0.25 -> -0.674489750196082, 0.001 -> -3.090232306167814,
  // 1e-20 -> -9.262340089798408. Round-off of erfc is a few units.
  EXPECT_NEAR(normal_quantile(0.25), -0.6744897501960817, 4e-16);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167814, 2e-15);
  EXPECT_NEAR(normal_quantile(1e-20), -9.262340089798408, 1e-14);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-16);
  EXPECT_EQ(normal_quantile(0.75), -normal_quantile(0.25));
}

TEST(Percentile, LiesBetweenNeighboursOfTheSortedSample) {
  std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(percentile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(percentile(values, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(percentile(values, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(percentile(values, 1.0), 4.0);
  std::vector<double> none;
  EXPECT_TRUE(std::isnan(percentile(none, 0.5)));
}

TEST(UnitSamples, PutOnePointIntoEverySliceOfALatinHypercube) {
  const Index count = 97;
  const Matrix points = unit_samples(Sampling::latin_hypercube, 3, count, 5);
  for (Index axis = 0; axis < 3; ++axis) {
    std::set<Index> slices;
    for (Index i = 0; i < count; ++i) slices.insert(static_cast<Index>(points(axis, i) * static_cast<double>(count)));
    EXPECT_EQ(slices.size(), 97u);
  }
}

TEST(UnitSamples, AreTheSameForTheSameSeedOnly) {
  for (const Sampling sampling : {Sampling::random, Sampling::latin_hypercube, Sampling::sobol}) {
    EXPECT_EQ(unit_samples(sampling, 2, 16, 5), unit_samples(sampling, 2, 16, 5));
    EXPECT_NE(unit_samples(sampling, 2, 16, 5), unit_samples(sampling, 2, 16, 6));
  }
}

TEST(UnitSamples, OfSobolFillEveryElementaryIntervalOfTheFirstTwoAxes) {
  // The first two axes are a (0, m, 2) net in base 2: each box of 2^-a by 2^-(m-a) holds one of 2^m points. A digital
  // shift moves boxes onto boxes.
  const int m = 8;
  const Matrix points = unit_samples(Sampling::sobol, 2, 1 << m, 3);
  for (int a = 0; a <= m; ++a) {
    std::set<std::pair<int, int>> boxes;
    for (Index i = 0; i < points.cols(); ++i)
      boxes.emplace(static_cast<int>(points(0, i) * std::exp2(a)), static_cast<int>(points(1, i) * std::exp2(m - a)));
    EXPECT_EQ(boxes.size(), 256u) << a;
  }
}

TEST(UnitSamples, OfSobolStratifyEveryAxis) {
  const Matrix points = unit_samples(Sampling::sobol, most_sobol_dimensions, 512, 3);
  for (Index axis = 0; axis < most_sobol_dimensions; ++axis) {
    std::set<int> slices;
    for (Index i = 0; i < points.cols(); ++i) slices.insert(static_cast<int>(points(axis, i) * 512.0));
    EXPECT_EQ(slices.size(), 512u) << axis;
  }
}

/// x^exponent modulo a polynomial over the field of two elements.
std::uint32_t power_of_x(std::uint64_t exponent, std::uint32_t polynomial) {
  const int degree = std::bit_width(polynomial) - 1;
  const auto times = [&](std::uint32_t a, std::uint32_t b) {
    std::uint32_t product = 0;
    for (; b != 0; b >>= 1) {
      if (b & 1u) product ^= a;
      a <<= 1;
      if (a >> degree & 1u) a ^= polynomial;
    }
    return product;
  };
  std::uint32_t result = 1, base = degree == 1 ? 1u : 2u;
  for (; exponent != 0; exponent >>= 1) {
    if (exponent & 1u) result = times(result, base);
    base = times(base, base);
  }
  return result;
}

TEST(SobolDirections, ComeFromPrimitivePolynomialsInOrderWithOddNumbersBelowTheirPower) {
  // The sequence of Sobol needs primitive polynomials: x has the order 2^degree - 1.
  std::uint32_t before = 2;
  for (const SobolAxis& axis : sobol_axes) {
    EXPECT_GT(axis.polynomial, before);
    before = axis.polynomial;
    const int degree = std::bit_width(axis.polynomial) - 1;
    const std::uint64_t order = (std::uint64_t{1} << degree) - 1;
    EXPECT_EQ(power_of_x(order, axis.polynomial), 1u);
    for (std::uint64_t prime = 2; prime <= order; ++prime) {
      bool is_prime = true;
      for (std::uint64_t d = 2; d * d <= prime; ++d) is_prime = is_prime && prime % d != 0;
      if (is_prime && order % prime == 0) EXPECT_NE(power_of_x(order / prime, axis.polynomial), 1u) << axis.polynomial;
    }
    for (int j = 0; j < degree; ++j) {
      EXPECT_EQ(axis.start[static_cast<std::size_t>(j)] % 2u, 1u);
      EXPECT_LT(axis.start[static_cast<std::size_t>(j)], 2u << j);
    }
  }
}

TEST(Distribution, HasTheMeanAndDeviationThatItSays) {
  // A Latin hypercube of n points integrates smooth functions of one variable to about 1/n.
  using Kind = model::DistributionDescription::Kind;
  const Matrix u = unit_samples(Sampling::latin_hypercube, 1, 20000, 1);
  const auto moments = [&](const Distribution& distribution) {
    double sum = 0.0, squares = 0.0;
    for (Index i = 0; i < u.cols(); ++i) {
      const double x = distribution.quantile(u(0, i));
      sum += x;
      squares += x * x;
    }
    const double n = static_cast<double>(u.cols()), mean = sum / n;
    return std::pair(mean, std::sqrt(squares / n - mean * mean));
  };
  const auto [normal_mean, normal_deviation] = moments({Kind::normal, 3.0, 0.5});
  EXPECT_NEAR(normal_mean, 3.0, 1e-4);
  EXPECT_NEAR(normal_deviation, 0.5, 1e-3);
  const auto [uniform_mean, uniform_deviation] = moments({Kind::uniform, 2.0, 6.0});
  EXPECT_NEAR(uniform_mean, 4.0, 1e-4);
  EXPECT_NEAR(uniform_deviation, 4.0 / std::sqrt(12.0), 1e-4);
  // exp(m + s z): mean median exp(s^2 / 2).
  EXPECT_NEAR(moments({Kind::lognormal, 2.0, 0.3}).first, 2.0 * std::exp(0.045), 1e-3);
}

}  // namespace
}  // namespace rubato::analysis
