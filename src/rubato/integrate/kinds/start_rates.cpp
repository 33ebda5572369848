#include <rubato/integrate/kinds/start_rates.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

using Dense = Eigen::MatrixXd;

/// Rows A v = wanted: constraints, then rates of joints.
struct Rows {
  Dense a;
  Vector wanted;
};

Rows rows_of(system::MechanismEquations& equations, const system::State& state) {
  const system::Mechanism& mechanism = equations.mechanism();
  const auto& rates = mechanism.model().start_rates;
  const Index n = mechanism.size(), c = mechanism.constraint_count();
  Rows rows{Dense::Zero(c + std::ssize(rates), n), Vector::Zero(c + std::ssize(rates))};
  Vector force(n), gap(c), by_time(c), column(c);
  equations.go_to(state, model::Side::right);
  equations.linearise({}, state.multiplier, force, gap);
  equations.constraint_rate(Vector::Zero(n), by_time);
  rows.wanted.head(c) = -by_time;
  Vector unit = Vector::Zero(n);
  for (Index i = 0; i < n; ++i) {
    unit[i] = 1.0;
    equations.constraint_rate(unit, column);
    rows.a.col(i).head(c) = column - by_time;
    unit[i] = 0.0;
  }
  std::vector<double> slope(model::FreeCoordinate::most_places);
  for (std::size_t j = 0; j < rates.size(); ++j) {
    const std::vector<Index> places = rates[j].s.places();
    rates[j].s.slope(state.q.data(), slope.data());
    const Index row = c + static_cast<Index>(j);
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k] >= 0) rows.a(row, places[k]) += slope[k];
    rows.wanted[row] = rates[j].rate;
  }
  return rows;
}

/// The rows that a velocity misses, and by how much.
struct Miss {
  Index worst = -1;  ///< -1: none beyond round-off
  double by = 0.0;
};

Miss miss_of(const Rows& rows, const Vector& v) {
  constexpr double round_off = 1e-9;
  Miss miss;
  double most = 1.0;
  for (Index i = 0; i < rows.a.rows(); ++i) {
    const double gap = rows.wanted[i] - rows.a.row(i).dot(v);
    const double known =
        round_off * (std::abs(rows.wanted[i]) + rows.a.row(i).cwiseAbs().dot(v.cwiseAbs()) + round_off);
    if (!(std::abs(gap) > most * known)) continue;
    most = std::abs(gap) / known;
    miss = {i, gap};
  }
  return miss;
}

/// Moves the velocities that may change onto the rows, by the least kinetic energy of the change, as nearly as they
/// can.
void move_onto(const Rows& rows, const Eigen::SparseMatrix<double>& mass, const std::vector<Index>& movable,
               Vector& v) {
  const auto count = static_cast<Index>(movable.size());
  if (count == 0) return;
  std::vector<Index> place(static_cast<std::size_t>(v.size()), -1);
  for (Index i = 0; i < count; ++i) place[static_cast<std::size_t>(movable[static_cast<std::size_t>(i)])] = i;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index column = 0; column < mass.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(mass, column); entry; ++entry) {
      const Index row = place[static_cast<std::size_t>(entry.row())], other = place[static_cast<std::size_t>(column)];
      if (row >= 0 && other >= 0) entries.emplace_back(static_cast<int>(row), static_cast<int>(other), entry.value());
    }
  Eigen::SparseMatrix<double> inertia(count, count);
  inertia.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(inertia);
  Dense a(rows.a.rows(), count);
  for (Index i = 0; i < count; ++i) a.col(i) = rows.a.col(movable[static_cast<std::size_t>(i)]);
  Dense by_impulse = factor.solve(a.transpose());  // M^-1 A^T
  Vector size = (a * by_impulse).diagonal().cwiseSqrt();
  for (Index i = 0; i < size.size(); ++i) size[i] = size[i] > 0.0 ? 1.0 / size[i] : 0.0;
  a = size.asDiagonal() * a;
  by_impulse = by_impulse * size.asDiagonal();
  const Eigen::CompleteOrthogonalDecomposition<Dense> mobility(a * by_impulse);
  for (int round = 0; round < 2; ++round) {
    const Vector gap = size.asDiagonal() * (rows.wanted - rows.a * v);
    const Vector change = by_impulse * mobility.solve(gap);
    for (Index i = 0; i < count; ++i) v[movable[static_cast<std::size_t>(i)]] += change[i];
  }
}

/// The coordinates whose velocities are not given.
std::vector<Index> left_out(const model::Mechanism& model) {
  std::vector<Index> coordinates;
  for (const auto& node : model.nodes)
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (node.place[axis] != ground && !node.has_velocity[axis]) coordinates.push_back(node.place[axis]);
  return coordinates;
}

[[noreturn]] void refuse(const system::Mechanism& mechanism, const Rows& rows, const Vector& v, const Miss& miss) {
  const auto& rates = mechanism.model().start_rates;
  const Index c = mechanism.constraint_count();
  std::vector<std::string> names;
  for (const auto& rate : rates) names.push_back(fmt::format("\"{}\"", rate.name));
  std::size_t worst = 0;
  for (std::size_t j = 1; j < rates.size(); ++j) {
    const auto off = [&](std::size_t i) {
      const Index row = c + static_cast<Index>(i);
      return std::abs(rows.wanted[row] - rows.a.row(row).dot(v));
    };
    if (off(j) > off(worst)) worst = j;
  }
  const Index row = c + static_cast<Index>(worst);
  throw InvalidInput(
      rates[worst].where,
      fmt::format(
          "the rates of {} at the start contradict each other, the joints or the drives: \"{}\" would come apart "
          "at {:.4g} {}/s where joint \"{}\" has the rate {:.6g}; leave it out, or let it say what the others "
          "make of it",
          fmt::join(names, ", "),
          miss.worst < c ? mechanism.rows()[static_cast<std::size_t>(miss.worst)]
                         : rates[static_cast<std::size_t>(miss.worst - c)].name,
          std::abs(miss.by), rates[worst].s.is_angle() ? "rad" : "m", rates[worst].name, rows.wanted[row]));
}

}  // namespace

void set_start_rates(system::MechanismEquations& equations, system::State& state, std::vector<std::string>& warnings) {
  const system::Mechanism& mechanism = equations.mechanism();
  const auto& locks = mechanism.model().locks;
  system::State free = state;
  for (std::size_t i = 0; i < locks.size(); ++i)
    if (!locks[i].is_latch) free.phase[i] = model::lock_open;
  const Rows rows = rows_of(equations, free);
  Vector v = state.v;
  move_onto(rows, mechanism.mass(), left_out(mechanism.model()), v);
  if (miss_of(rows, v).worst >= 0) {
    std::vector<Index> all(static_cast<std::size_t>(v.size()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    v = state.v;
    move_onto(rows, mechanism.mass(), all, v);
    if (const Miss miss = miss_of(rows, v); miss.worst >= 0) refuse(mechanism, rows, v, miss);
    Vector change = v - state.v;
    for (const Index i : left_out(mechanism.model())) change[i] = 0.0;
    Index most = 0;
    const double by = change.cwiseAbs().maxCoeff(&most);
    warnings.push_back(fmt::format(
        "the velocities given do not go with the rates of the joints; they were changed, \"{}\" most, by {:.4g} {}/s",
        mechanism.coordinates()[static_cast<std::size_t>(most)], by, mechanism.is_rotation(most) ? "rad" : "m"));
  }
  state.v = v;
}

}  // namespace rubato::integrate
