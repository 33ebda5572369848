#pragma once

#include <string>

namespace rubato::report {

/// What the figures of stability regions draw, from the catalogue of methods, as a JSON object:
///
///   {"runge_kutta": [{"names": [...], "coefficients": [r0, r1, ...]}, ...],  R(z) = sum r_k z^k, r_k = b^T A^(k-1) 1
///    "newmark": [{"names": [...], "beta", "gamma"}, ...]}
///
/// Methods with one stability function, or one pair of numbers, share an entry.
std::string theory_json();

}  // namespace rubato::report
