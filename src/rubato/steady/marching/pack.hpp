#pragma once

#include <cstddef>

namespace rubato::steady {

// The functions of a pack are all inlined: how it would be passed to others does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

/// N doubles that move together, one point of a study in each lane. Every operation is lane by lane and rounds as that
/// of a double does, so that a kernel written for `double` gives the same bits in a lane. A vector of the compiler,
/// which becomes as many registers of the processor as it takes.
template <std::size_t N>
struct alignas(N * sizeof(double)) Pack {
  typedef double Lanes __attribute__((vector_size(N * sizeof(double))));
  Lanes lanes{};

  Pack() = default;
  [[gnu::always_inline]] Pack(double value) { lanes = value - lanes; }  // implicit: constants broadcast, as in 0.5 * x

  [[gnu::always_inline]] friend Pack operator+(Pack a, const Pack& b) {
    a.lanes = a.lanes + b.lanes;
    return a;
  }
  [[gnu::always_inline]] friend Pack operator-(Pack a, const Pack& b) {
    a.lanes = a.lanes - b.lanes;
    return a;
  }
  [[gnu::always_inline]] friend Pack operator*(Pack a, const Pack& b) {
    a.lanes = a.lanes * b.lanes;
    return a;
  }
  [[gnu::always_inline]] Pack& operator+=(const Pack& other) { return *this = *this + other; }
  /// x cut at +-limit
  [[gnu::always_inline]] friend Pack cut(Pack x, const Pack& limit) {
    x.lanes = x.lanes < -limit.lanes ? -limit.lanes : x.lanes;
    x.lanes = limit.lanes < x.lanes ? limit.lanes : x.lanes;
    return x;
  }
};

#pragma GCC diagnostic pop

[[gnu::always_inline]] inline double cut(double x, double limit) {
  const double low = x < -limit ? -limit : x;
  return limit < low ? limit : low;
}

}  // namespace rubato::steady
