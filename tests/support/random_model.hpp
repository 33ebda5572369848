#pragma once

#include <rubato/steady/steady_solver.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <cstdint>
#include <random>

namespace rubato::testing {

/// Numbers that are the same on every machine (the distributions of the standard library are not).
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : generator_(seed) {}
  double uniform(double low = 0.0, double high = 1.0) {
    return low + (high - low) * (static_cast<double>(generator_() >> 11) * 0x1p-53);
  }
  /// Uniform in its logarithm.
  double decades(double low, double high);
  bool chance(double probability) { return uniform() < probability; }
  Index below(Index count) { return static_cast<Index>(uniform() * static_cast<double>(count)); }

 private:
  std::mt19937_64 generator_;
};

/// Bounds of what random_model draws.
struct RandomModelBounds {
  Index least_coordinates = 2, most_coordinates = 40;
  Index most_sliders = 12;
};

/// A random linear structure with sliders under periodic loads, by its seed alone.
///
/// Structure: a chain of unequal masses and springs, every third spring on the average tied to the ground, with some
/// links across; its units of mass and time lie anywhere within two decades. Damping: Rayleigh, 0.2 to 5 % in the
/// lowest mode, half of the time with dashpots that couple the modes.
/// Sliders: 1 to 12, to the ground or between any two coordinates, which they share; kT from a tenth to ten times the
/// springs. Limits over three decades around the loads; one in twenty is zero, one in ten never slips.
/// Loads: one to four harmonic forces of orders 1 to 5 and any phase, their sizes over two decades; every third model
/// also has a static one, whose size has no bearing on theirs.
/// Frequency: half of the time within 10 % of a natural frequency (sliders free or stuck) that one of the orders meets,
/// else anywhere from a third of the lowest to a little beyond the highest.
system::LocallyNonlinear random_model(std::uint64_t seed, const RandomModelBounds& bounds = {});

/// One to three coordinates of it, or differences of two.
steady::SteadyRequest random_request(std::uint64_t seed, Index coordinates);

}  // namespace rubato::testing
