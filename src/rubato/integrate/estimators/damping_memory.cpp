#include <rubato/integrate/estimators/damping_memory.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>

namespace rubato::integrate {

struct DampingMemory::Factors {
  numerics::OrderedFactor damped, creeping;
  bool is_damped = false, creeps = false;
  Vector force, response;
};

void DampingMemory::factorise() {
  const double d = 1.0 / duration_;
  factors_ = std::make_shared<Factors>();
  Factors& f = *factors_;
  const SparseMatrix damped = system_.damping() + 2.0 * d * system_.mass();
  const SparseMatrix creeping = SparseMatrix(system_.stiffness() + d * system_.damping()) + d * d * system_.mass();
  f.damped.analyse(damped, {});
  f.is_damped = f.damped.factorise(damped);
  f.creeping.analyse(creeping, {});
  f.creeps = f.creeping.factorise(creeping);
  f.force.resize(system_.size());
  f.response.resize(system_.size());
}

double DampingMemory::decaying_squared(const Vector& x) {
  if (!factors_) factorise();
  Factors& f = *factors_;
  if (!f.is_damped) return duration_ * duration_ * norm_.squared(x);  // a dashpot that drives: nothing is forgotten
  f.force = 2.0 * norm_.times(x);
  f.damped.solve(f.force, f.response);
  return norm_.squared(f.response);
}

double DampingMemory::squared(const Vector& x) {
  const double decaying = decaying_squared(x);
  Factors& f = *factors_;
  if (!f.is_damped || !f.creeps) return decaying;
  f.force.noalias() = system_.damping() * x;
  f.creeping.solve(f.force, f.response);
  return std::max(decaying, norm_.squared(f.response));
}

}  // namespace rubato::integrate
