#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::benchmarks {

struct PetscRun {
  double cpu = 0.0;  ///< of the march [s]
  long solves = 0;
  Vector q;  ///< at the end
};

/// PETSc's TSALPHA2 (generalized-alpha) with rho_inf = 0.9 and equal steps on M a + C v + K q = 0 from a state, its
/// linear systems by a direct solver. Throws std::runtime_error where PETSc reports an error.
PetscRun petsc_alpha2(const system::LocallyNonlinear& system, const system::State& start, double h, int steps);

}  // namespace rubato::benchmarks
