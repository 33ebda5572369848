#include <rubato/numerics/butcher_tableau.hpp>

#include <initializer_list>

namespace rubato::numerics {
namespace {

using Row = std::initializer_list<double>;

// c_i is the sum of row i, as in every method of the catalogue.
ButcherTableau tableau(int order, std::initializer_list<Row> a, Row b, int embedded_order = 0, Row embedded = {}) {
  ButcherTableau t;
  t.order = order;
  t.embedded_order = embedded_order;
  t.stages = static_cast<int>(b.size());
  std::size_t i = 1;  // the first stage has no row
  for (const Row& row : a) {
    std::size_t j = 0;
    for (const double entry : row) {
      t.a[i][j++] = entry;
      t.c[i] += entry;
    }
    ++i;
  }
  i = 0;
  for (const double weight : b) t.b[i++] = weight;
  i = 0;
  for (const double weight : embedded) t.embedded[i++] = weight;
  return t;
}

}  // namespace

ButcherTableau explicit_euler() { return tableau(1, {}, {1.0}); }
ButcherTableau heun() { return tableau(2, {{1.0}}, {0.5, 0.5}); }
ButcherTableau midpoint() { return tableau(2, {{0.5}}, {0.0, 1.0}); }
ButcherTableau ralston() { return tableau(2, {{0.75}}, {1.0 / 3.0, 2.0 / 3.0}); }
ButcherTableau rk3() { return tableau(3, {{0.5}, {-1.0, 2.0}}, {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}); }
ButcherTableau rk4() {
  return tableau(4, {{0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}}, {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0});
}
ButcherTableau bogacki_shampine() {
  return tableau(3, {{0.5}, {0.0, 0.75}, {2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0}}, {2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0}, 2,
                 {7.0 / 24.0, 0.25, 1.0 / 3.0, 0.125});
}
ButcherTableau dormand_prince() {
  return tableau(
      5,
      {{1.0 / 5.0},
       {3.0 / 40.0, 9.0 / 40.0},
       {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
       {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
       {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
       {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}},
      {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0, 0.0}, 4,
      {5179.0 / 57600.0, 0.0, 7571.0 / 16695.0, 393.0 / 640.0, -92097.0 / 339200.0, 187.0 / 2100.0, 1.0 / 40.0});
}

}  // namespace rubato::numerics
