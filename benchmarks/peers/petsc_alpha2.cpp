#include "petsc_alpha2.hpp"

#include "measure.hpp"

#include <petscts.h>

#include <stdexcept>
#include <vector>

namespace rubato::benchmarks {
namespace {

void require(PetscErrorCode code) {
  if (code != 0) throw std::runtime_error("PETSc reports an error");
}

/// M, C and K with the pattern of their sum, so that the Jacobian is a sum of values.
struct Structure {
  Mat mass = nullptr, damping = nullptr, stiffness = nullptr;
};

Mat matrix_of(const SparseMatrix& values, const SparseMatrix& pattern) {
  const auto n = static_cast<PetscInt>(pattern.rows());
  std::vector<PetscInt> counts(static_cast<std::size_t>(n));
  for (PetscInt i = 0; i < n; ++i)
    counts[static_cast<std::size_t>(i)] = pattern.outerIndexPtr()[i + 1] - pattern.outerIndexPtr()[i];
  Mat matrix = nullptr;
  require(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, counts.data(), &matrix));
  for (Index column = 0; column < pattern.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(pattern, column); entry; ++entry) {
      // symmetric: rows are columns
      require(MatSetValue(matrix, static_cast<PetscInt>(column), static_cast<PetscInt>(entry.row()),
                          values.coeff(entry.row(), column), INSERT_VALUES));
    }
  require(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return matrix;
}

Vec vector_of(const Vector& values) {
  Vec vector = nullptr;
  require(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(values.size()), &vector));
  double* data = nullptr;
  require(VecGetArray(vector, &data));
  for (Index i = 0; i < values.size(); ++i) data[i] = values[i];
  require(VecRestoreArray(vector, &data));
  return vector;
}

PetscErrorCode residual(TS, PetscReal, Vec q, Vec v, Vec a, Vec out, void* context) {
  auto& s = *static_cast<Structure*>(context);
  require(MatMult(s.mass, a, out));
  require(MatMultAdd(s.damping, v, out, out));
  require(MatMultAdd(s.stiffness, q, out, out));
  return 0;
}

PetscErrorCode jacobian(TS, PetscReal, Vec, Vec, Vec, PetscReal on_v, PetscReal on_a, Mat matrix, Mat, void* context) {
  auto& s = *static_cast<Structure*>(context);
  require(MatCopy(s.stiffness, matrix, SAME_NONZERO_PATTERN));
  require(MatAXPY(matrix, on_v, s.damping, SAME_NONZERO_PATTERN));
  require(MatAXPY(matrix, on_a, s.mass, SAME_NONZERO_PATTERN));
  return 0;
}

}  // namespace

PetscRun petsc_alpha2(const system::LocallyNonlinear& system, const system::State& start, double h, int steps) {
  if (!PetscInitializeCalled) require(PetscInitializeNoArguments());
  const SparseMatrix pattern = system.mass() + SparseMatrix(system.damping() + system.stiffness());
  Structure s;
  s.mass = matrix_of(system.mass(), pattern);
  s.damping = matrix_of(system.damping(), pattern);
  s.stiffness = matrix_of(system.stiffness(), pattern);
  Mat matrix = nullptr;
  require(MatDuplicate(s.stiffness, MAT_COPY_VALUES, &matrix));
  Vec q = vector_of(start.q), v = vector_of(start.v);
  TS ts = nullptr;
  require(TSCreate(PETSC_COMM_SELF, &ts));
  require(TSSetType(ts, TSALPHA2));
  require(TSAlpha2SetRadius(ts, 0.9));
  require(TSSetI2Function(ts, nullptr, residual, &s));
  require(TSSetI2Jacobian(ts, matrix, matrix, jacobian, &s));
  require(TSSetTimeStep(ts, h));
  require(TSSetMaxSteps(ts, steps));
  require(TSSetMaxTime(ts, 1e9));
  require(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  TSAdapt adapt = nullptr;
  require(TSGetAdapt(ts, &adapt));
  require(TSAdaptSetType(adapt, TSADAPTNONE));
  SNES newton = nullptr;
  require(TSGetSNES(ts, &newton));
  require(SNESSetType(newton, SNESNEWTONLS));  // one iteration a step; SNESKSPONLY does not advance TSALPHA2
  KSP solver = nullptr;
  require(SNESGetKSP(newton, &solver));
  require(KSPSetType(solver, KSPPREONLY));
  PC direct = nullptr;
  require(KSPGetPC(solver, &direct));
  require(PCSetType(direct, PCCHOLESKY));
  require(PCFactorSetMatSolverType(direct, MATSOLVERCHOLMOD));
  require(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  require(TS2SetSolution(ts, q, v));
  const double begin = cpu_seconds();
  require(TSSolve(ts, nullptr));
  PetscRun run;
  run.cpu = cpu_seconds() - begin;
  PetscInt solves = 0;
  require(TSGetKSPIterations(ts, &solves));
  run.solves = solves;
  const double* data = nullptr;
  require(VecGetArrayRead(q, &data));
  run.q = Eigen::Map<const Vector>(data, system.size());
  require(VecRestoreArrayRead(q, &data));
  require(TSDestroy(&ts));
  for (Mat* each : {&matrix, &s.mass, &s.damping, &s.stiffness}) require(MatDestroy(each));
  for (Vec* each : {&q, &v}) require(VecDestroy(each));
  return run;
}

}  // namespace rubato::benchmarks
