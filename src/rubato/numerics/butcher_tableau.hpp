#pragma once

#include <array>
#include <string_view>

namespace rubato::numerics {

/// Explicit Runge-Kutta tableau of at most seven stages: k_i = F(t + c_i h, y + h sum_j a_ij k_j), y1 = y + h sum b_i
/// k_i. `embedded` holds the weights of the second solution of a pair, all zero where there is none.
struct ButcherTableau {
  static constexpr int max_stages = 7;
  int stages = 1;
  int order = 1;
  std::array<std::array<double, max_stages>, max_stages> a{};
  std::array<double, max_stages> b{}, c{}, embedded{};
  int embedded_order = 0;
};

ButcherTableau explicit_euler();
ButcherTableau heun();              ///< trapezoidal predictor-corrector, order 2
ButcherTableau midpoint();          ///< order 2
ButcherTableau ralston();           ///< order 2 with the least bound of the error, Ralston 1962
ButcherTableau rk3();               ///< Kutta 1901, order 3
ButcherTableau rk4();               ///< Kutta 1901, order 4
ButcherTableau bogacki_shampine();  ///< 3(2), Bogacki and Shampine 1989
ButcherTableau dormand_prince();    ///< 5(4), Dormand and Prince 1980

}  // namespace rubato::numerics
