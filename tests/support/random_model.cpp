#include <support/models.hpp>
#include <support/random_model.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace rubato::testing {
namespace {

Vector natural_frequencies(const Matrix& stiffness, const Vector& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(stiffness, mass.asDiagonal().toDenseMatrix(),
                                                          Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseMax(0.0)
      .cwiseSqrt();
}

// factor * b b^T for b = e_first - e_second
void add_link(Matrix& matrix, Index first, Index second, double factor) {
  if (first != ground) matrix(first, first) += factor;
  if (second != ground) matrix(second, second) += factor;
  if (first == ground || second == ground) return;
  matrix(first, second) -= factor;
  matrix(second, first) -= factor;
}

}  // namespace

double RandomNumbers::decades(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

system::LocallyNonlinear random_model(std::uint64_t seed, const RandomModelBounds& bounds) {
  RandomNumbers random(seed);
  const auto n = std::min(bounds.most_coordinates,
                          static_cast<Index>(random.decades(static_cast<double>(bounds.least_coordinates),
                                                            static_cast<double>(bounds.most_coordinates) + 1.0)));
  const Index m = 1 + random.below(bounds.most_sliders);
  const double unit_of_mass = random.decades(0.1, 10.0), unit_of_time = random.decades(0.1, 10.0);
  const double spring = unit_of_mass / (unit_of_time * unit_of_time);

  Vector mass(n);
  for (double& x : mass) x = unit_of_mass * random.uniform(0.5, 2.5);
  Matrix stiffness = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    if (i == 0 || random.chance(1.0 / 3.0)) add_link(stiffness, i, ground, spring * random.uniform(0.3, 1.5));
    if (i > 0) add_link(stiffness, i, i - 1, spring * random.uniform(0.5, 3.5));
    if (i > 1 && random.chance(0.1)) add_link(stiffness, i, random.below(i), spring * random.uniform(0.1, 1.0));
  }
  const Vector free = natural_frequencies(stiffness, mass);
  const double damping_ratio = random.decades(0.002, 0.05), share = random.uniform();
  Matrix damping = (2.0 * damping_ratio * share / free[0]) * stiffness;
  damping.diagonal() += (2.0 * damping_ratio * (1.0 - share) * free[0]) * mass;
  if (random.chance(0.5))
    for (Index i = 0; i < 1 + n / 4; ++i) {
      const Index first = random.below(n), second = random.chance(0.5) ? ground : random.below(n);
      if (first != second) add_link(damping, first, second, random.decades(0.002, 0.2) * spring / free[0]);
    }

  // Loads: orders and sizes first, the frequency when the sliders are known.
  const double load = spring * random.decades(1e-3, 1e3);
  struct Force {
    Index row;
    double amplitude, phase;
    int order;
  };
  std::vector<Force> forces;
  const Index count = 1 + random.below(4);
  for (Index i = 0; i < count; ++i)
    forces.push_back({random.below(n), load * (i == 0 ? 1.0 : random.decades(0.01, 1.0)),
                      random.uniform(0.0, 2.0 * std::numbers::pi),
                      i == 0 || random.chance(0.4) ? 1 : 1 + static_cast<int>(random.below(5))});

  system::LocallyNonlinear::Parts parts;
  Matrix stuck = stiffness;
  for (Index i = 0; i < m; ++i) {
    const Index first = random.below(n), second = random.chance(0.4) ? ground : random.below(n);
    const double kt = spring * random.decades(0.1, 10.0);
    double limit = load * random.decades(0.01, 10.0);
    if (random.chance(0.05)) limit = 0.0;
    if (random.chance(0.1)) limit = 1e4 * load;
    parts.sliders.push_back({"s" + std::to_string(i + 1), first, first == second ? ground : second, kt, limit});
    add_link(stuck, parts.sliders.back().first, parts.sliders.back().second, kt);
  }

  double omega = random.decades(free[0] / 3.0, 1.2 * free[n - 1]);
  if (random.chance(0.5)) {
    const Vector frequencies = random.chance(0.5) ? free : natural_frequencies(stuck, mass);
    const Index mode = random.below(std::min<Index>(n, 5));
    const auto& force = forces[static_cast<std::size_t>(random.below(count))];
    omega = frequencies[mode] * random.uniform(0.9, 1.1) / force.order;
  }
  std::vector<system::LoadTerm> terms;
  for (const Force& f : forces) terms.push_back(harmonic(f.row, f.amplitude, f.order * omega, f.phase));
  if (random.chance(1.0 / 3.0)) terms.push_back(harmonic(random.below(n), load * random.decades(0.01, 100.0), 0.0));

  parts.mass = sparse(mass.asDiagonal().toDenseMatrix());
  parts.damping = sparse(damping);
  parts.stiffness = sparse(stiffness);
  parts.loads = system::Loads(std::move(terms));
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i + 1));
  return system::LocallyNonlinear(std::move(parts));
}

steady::SteadyRequest random_request(std::uint64_t seed, Index coordinates) {
  RandomNumbers random(~seed);
  steady::SteadyRequest request;
  for (Index i = 0, count = 1 + random.below(3); i < count; ++i) {
    const Index first = random.below(coordinates), second = random.chance(0.3) ? random.below(coordinates) : ground;
    request.observed.push_back({first, first == second ? ground : second});
  }
  return request;
}

}  // namespace rubato::testing
