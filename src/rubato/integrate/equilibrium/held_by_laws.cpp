#include <rubato/integrate/equilibrium/easiest_motion.hpp>
#include <rubato/integrate/equilibrium/held_by_laws.hpp>

namespace rubato::integrate {
namespace {

/// The coordinates of the motion that a stiffness does not resist; empty where it resists all.
std::vector<Index> floating(const SparseMatrix& given) {
  SparseMatrix diagonal(given.rows(), given.cols());
  diagonal.setIdentity();
  const SparseMatrix stiffness = given + 0.0 * diagonal;  // all of its diagonal is there
  numerics::OrderedFactor factor;
  factor.analyse(stiffness);
  int factorisations = 0;
  std::vector<Index> moving;
  factorise_resisting(stiffness, numerics::Pivots::positive, factor, factorisations, moving);
  return moving;
}

}  // namespace

std::vector<Index> held_by_laws_alone(const system::LocallyNonlinear& system) {
  if (!system.has_laws() || system.size() == 0) return {};
  std::vector<Index> moving = floating(system.stiffness());
  if (moving.empty() || !floating(system.free_stiffness()).empty()) return {};
  return moving;
}

}  // namespace rubato::integrate
