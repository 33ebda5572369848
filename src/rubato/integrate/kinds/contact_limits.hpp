#pragma once

#include <rubato/integrate/equilibrium/free_motions.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// What contacts, sliders, stops and other laws do to small motions in one set of modes:
///
///   open          contacts apart, sliders and laws that stick removed
///   stuck         contacts closed and stuck, T = kT u, N = kn d; sliders and laws that stick are springs kT
///   frictionless  contacts closed, N = kn d and T = 0; sliders and laws that stick removed
///   static        contacts and stops open or closed as they are in the static state; what is closed sticks, and other
///                 laws act by their slopes there
///   sliding       the contacts that are named slide steadily in one direction, dT = +-mu dN; all others are stuck
///
/// But for `static`, stops are open and other laws act by their slopes where nothing has moved.
struct ContactLimit {
  using Kind = model::ContactLimitDescription::Kind;
  Kind kind = Kind::stuck;
  std::string name;         ///< "stuck"; of several that slide "sliding", "sliding2", ...
  std::vector<int> slides;  ///< of each block: the sign in which it slides, 0: it does not

  bool needs_static_state() const { return kind == Kind::static_state; }
};

/// Evaluates the limits that modes ask for. Throws InvalidInput, at its place, for a mechanism, a contact that does not
/// exist or does not rub in one direction, a sign that is not 1 or -1, and for contacts that slide in models of more
/// than 400 coordinates.
std::vector<ContactLimit> contact_limits(const ModesRequest& request, const SystemKind& kind);

/// K and C of small motions in a limit. Contacts that slide make K unsymmetric.
struct LimitMatrices {
  SparseMatrix stiffness, damping;
  bool is_symmetric = true;
};

/// @param at  the static state, for the limit of that name
LimitMatrices matrices_in(const ContactLimit& limit, const system::LocallyNonlinear& system, const system::State& at);

/// The lowest modes in a limit. Those of contacts that slide may grow (flutter), with a negative damping ratio.
/// @param kind  of a structure
FreeMotions free_motions_in(const ContactLimit& limit, const SystemKind& kind, const system::State& at, Index count);

}  // namespace rubato::integrate
