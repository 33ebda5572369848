#include <rubato/core/error.hpp>
#include <rubato/integrate/mechanism/law_about_rest.hpp>
#include <rubato/integrate/mechanism/motions_left.hpp>
#include <rubato/integrate/mechanism/small_motions.hpp>
#include <rubato/model/laws/jenkins.hpp>
#include <rubato/numerics/rotations.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

/// ds/dz of a coordinate s of a mechanism [r].
template <class Coordinate>
Vector share_of(const Coordinate& s, const Vector& q, const Matrix& basis) {
  const std::vector<Index> places = s.places();
  Vector slope(static_cast<Index>(places.size())), share = Vector::Zero(basis.cols());
  s.slope(q.data(), slope.data());
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i] != ground) share += slope[static_cast<Index>(i)] * basis.row(places[i]).transpose();
  return share;
}

/// Takes one from another. What the difference leaves of an entry by round-off is nothing: a motion that laws alone
/// hold must not seem to have a stiffness.
/// @param terms  what each entry taken is the sum of
void take(const Matrix& taken, const Matrix& terms, const Matrix& round_off, Matrix& matrix) {
  matrix -= taken;
  for (Index i = 0; i < matrix.size(); ++i)
    if (std::abs(matrix.data()[i]) <= round_off.data()[i] + 8.0 * eps * terms.data()[i]) matrix.data()[i] = 0.0;
}

/// Takes slope (ds/dz)^T (ds/dz) from a matrix.
void take_slope(double slope, const Vector& share, const Matrix& round_off, Matrix& matrix) {
  const Matrix taken = slope * share * share.transpose();
  take(taken, taken.cwiseAbs(), round_off, matrix);
}

/// A law that acts by itself: its slopes leave K and C, and what its force makes of the curvature of u stays.
struct LawAtRest {
  const std::string& name;
  const std::string& kind;
  const std::shared_ptr<const model::Law>& law;
  double u = 0.0;
  Vector share;  ///< du/dz [r]
  const double* memory = nullptr;
  double normal = 0.0;
};

void take_law(const LawAtRest& one, SmallMotions& motions) {
  model::LawBetween between;
  between.name = one.name;
  between.kind = one.kind;
  between.law = law_about_rest(one.law, one.u, one.memory, one.normal);
  between.normal.value = one.normal;
  for (Index i = 0; i < one.share.size(); ++i)
    if (one.share[i] != 0.0) between.shares.push_back({i, one.share[i]});
  motions.parts.laws.push_back(std::move(between));
}

void take_laws(const system::Mechanism& mechanism, const system::State& rest, MotionsLeft& left,
               SmallMotions& motions) {
  const Matrix of_stiffness = eps * left.terms, of_damping = 8.0 * eps * left.damping.cwiseAbs();
  for (const model::MechanismLaw& law : mechanism.model().laws) {
    const double u = std::visit([&](const auto& of) { return of.value(rest.q.data()); }, law.u);
    const Vector share = std::visit([&](const auto& of) { return share_of(of, rest.q, left.basis); }, law.u);
    const double* const memory = rest.memory.data() + law.memory;
    const double normal = law.normal.value;
    const model::LawAnswer slopes = law.law->at({u, 0.0, rest.t, model::Side::right, normal}, memory);
    if (!std::isfinite(slopes.by_u) || !std::isfinite(slopes.by_rate))
      throw InvalidInput(
          fmt::format("the slope of the {} \"{}\" is not finite at the equilibrium: no small motion "
                      "about it is linear; give the law a finite slope there",
                      law.kind, law.name));
    if (slopes.by_u != 0.0) take_slope(slopes.by_u, share, of_stiffness, left.stiffness);
    if (slopes.by_rate != 0.0) take_slope(slopes.by_rate, share, of_damping, left.damping);
    take_law({law.name, law.kind, law.law, u, share, memory, normal}, motions);
  }
}

/// The slopes of a contact at its limit are not symmetric, and leave K as they are.
void take_contacts(const system::Mechanism& mechanism, const system::State& rest, MotionsLeft& left,
                   SmallMotions& motions) {
  const Matrix of_stiffness = eps * left.terms, of_damping = 8.0 * eps * left.damping.cwiseAbs();
  for (const model::MechanismContact& contact : mechanism.model().contacts) {
    const auto d = static_cast<Index>(contact.numbers.size());
    const double* const memory = rest.memory.data() + contact.memory;
    model::BlockPoint point;
    model::BlockBetween between;
    Matrix shares(left.freedoms(), d), stiffness(d, d), damping(d, d);
    for (Index i = 0; i < d; ++i) {
      const model::ContactNumber& number = contact.numbers[static_cast<std::size_t>(i)];
      point.u[i] = number.value(rest.q.data());
      shares.col(i) = share_of(number, rest.q, left.basis);
      for (Index z = 0; z < shares.rows(); ++z)
        if (shares(z, i) != 0.0) between.columns[static_cast<std::size_t>(i)].push_back({z, shares(z, i)});
    }
    const model::BlockAnswer answer = contact.law->at(point, memory);
    for (Index i = 0; i < d; ++i)
      for (Index j = 0; j < d; ++j) {
        stiffness(i, j) = answer.by_u[i][j];
        damping(i, j) = answer.by_rate[i][j];
      }
    const Matrix sizes = shares.cwiseAbs();
    take(shares * stiffness * shares.transpose(), sizes * stiffness.cwiseAbs() * sizes.transpose(), of_stiffness,
         left.stiffness);
    take(shares * damping * shares.transpose(), sizes * damping.cwiseAbs() * sizes.transpose(), of_damping,
         left.damping);
    between.name = contact.name;
    between.kind = "contact";
    between.law = law_about_rest(contact.law, point, memory);
    motions.parts.blocks.push_back(std::move(between));
  }
}

std::vector<std::string> rigid_stops(const system::Mechanism& mechanism, const system::State& rest) {
  std::vector<std::string> names;
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i)
    if (rest.phase[i] != model::lock_open && !locks[i].is_latch && locks[i].is_rigid()) names.push_back(locks[i].name);
  return names;
}

/// A stop that is a spring acts by itself, open or held. What damps only while it holds is a spring and a damper while
/// the motion does not leave it.
void take_locks(const system::Mechanism& mechanism, const system::State& rest, MotionsLeft& left,
                SmallMotions& motions) {
  static const std::string kind = "stop";
  const Matrix of_stiffness = eps * left.terms;
  const auto& locks = mechanism.model().locks;
  motions.rigid_stops = rigid_stops(mechanism, rest);
  for (std::size_t i = 0; i < locks.size(); ++i) {
    const model::Lock& lock = locks[i];
    const bool is_held = rest.phase[i] != model::lock_open;
    if (is_held && lock.is_latch) continue;
    if (is_held && lock.is_rigid()) continue;
    const Vector share = share_of(lock.s, rest.q, left.basis);
    const double beyond = lock.sign * (lock.s.value(rest.q.data()) - lock.at);
    if (lock.is_spring()) {
      if (is_held) take_slope(lock.stiffness, share, of_stiffness, left.stiffness);
      const double u = is_held ? std::max(0.0, beyond) : std::min(0.0, beyond);
      take_law({lock.name, kind, model::make_one_sided_spring(lock.stiffness, 0.0), u, lock.sign * share}, motions);
      continue;
    }
    SmallMotions::Watched watched;
    watched.name = lock.name;
    watched.is_held = is_held;
    watched.is_angle = lock.s.is_angle();
    watched.is_damped_spring = !lock.is_latch && !lock.is_rigid();
    watched.share = share;
    watched.sign = is_held ? -lock.sign : lock.sign;
    watched.room = std::max(0.0, is_held ? beyond : -beyond);
    motions.locks.push_back(std::move(watched));
  }
}

/// What results show of small motions: translations and angles of the plane are the tangent coordinates themselves, of
/// turns in space the rotation vector moves by T^-1 of the turn about the axes of the node.
void take_coordinates(const system::Mechanism& mechanism, const system::State& rest, SmallMotions& motions) {
  mechanism.coordinate_values(rest.q, motions.place);
  motions.shares = motions.basis;
  if (mechanism.model().dimension != 3) return;
  for (const model::MechanismNode& node : mechanism.model().nodes) {
    std::array<Index, 3> place{node.place[3], node.place[4], node.place[5]};
    if (place == std::array<Index, 3>{ground, ground, ground}) continue;
    numerics::Vector3 vector = numerics::Vector3::Zero();
    Matrix turn = Matrix::Zero(3, motions.basis.cols());
    for (Index axis = 0; axis < 3; ++axis) {
      const Index at = place[static_cast<std::size_t>(axis)];
      if (at == ground) continue;
      vector[axis] = motions.place[at];
      turn.row(axis) = motions.basis.row(at);
    }
    const Matrix moved = numerics::inverse_tangent_of(vector) * turn;
    for (Index axis = 0; axis < 3; ++axis)
      if (const Index at = place[static_cast<std::size_t>(axis)]; at != ground)
        motions.shares.row(at) = moved.row(axis);
  }
}

/// The largest entry of the skew part of a matrix that is more than round-off, over the size of the matrix.
double skew_beyond(const Matrix& matrix, const Matrix& round_off) {
  const Matrix skew = 0.5 * (matrix - matrix.transpose()).cwiseAbs();
  double most = 0.0;
  for (Index i = 0; i < skew.size(); ++i)
    if (skew.data()[i] > round_off.data()[i]) most = std::max(most, skew.data()[i]);
  return most > 0.0 ? most / std::max(matrix.cwiseAbs().maxCoeff(), 1e-300) : 0.0;
}

/// What is left of equilibrium, in z [r]: the stiffness of turns in space is skew by it.
double left_over(system::MechanismEquations& equations, const system::State& rest, const Matrix& basis) {
  Vector force(equations.mechanism().size()), gap(equations.mechanism().constraint_count());
  equations.go_to(rest, model::Side::right);
  equations.residual(force, gap);
  equations.add_constraint_force(rest.multiplier, 1.0, force);
  return (basis.cwiseAbs().transpose() * force.cwiseAbs()).maxCoeff() * basis.cwiseAbs().maxCoeff();
}

SparseMatrix even(const Matrix& matrix) {
  return SparseMatrix((0.5 * (matrix + matrix.transpose())).sparseView(0.0, 0.0));
}

}  // namespace

SmallMotions small_motions(system::MechanismEquations& equations, const system::State& rest) {
  const system::Mechanism& mechanism = equations.mechanism();
  MotionsLeft left = motions_left(equations, rest);
  SmallMotions motions;
  motions.basis = left.basis;
  const Index r = left.freedoms();
  if (r == 0) {
    motions.rigid_stops = rigid_stops(mechanism, rest);
    return motions;
  }
  const Matrix of_rest = Matrix::Constant(r, r, 4.0 * left_over(equations, rest, left.basis));
  take_contacts(mechanism, rest, left, motions);
  motions.skew = skew_beyond(left.stiffness, 16.0 * eps * left.terms + left.noise + of_rest);
  take_laws(mechanism, rest, left, motions);
  take_locks(mechanism, rest, left, motions);
  take_coordinates(mechanism, rest, motions);
  motions.parts.mass = even(left.mass);
  motions.parts.damping = even(left.damping);
  motions.parts.stiffness = even(left.stiffness);
  motions.parts.reference = mechanism.reference();
  for (Index i = 0; i < r; ++i) motions.parts.coordinates.push_back(fmt::format("motion {} of the joints", i + 1));
  return motions;
}

system::AssembledModel under_loads(SmallMotions& motions, std::vector<system::ModelLoad> loads) {
  std::vector<system::LoadTerm> terms;
  for (const system::ModelLoad& load : loads) terms.push_back(load.term);
  system::LocallyNonlinear::Parts parts = std::move(motions.parts);
  motions.parts = {};
  parts.loads = system::Loads(std::move(terms));
  return {system::LocallyNonlinear(std::move(parts)), std::move(loads)};
}

}  // namespace rubato::integrate
