#include "damper_problem.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace rubato::benchmarks {
namespace {

int rate(realtype t, N_Vector y, N_Vector dy, void* problem) {
  (*static_cast<DamperProblem*>(problem))(N_VGetArrayPointer(y), N_VGetArrayPointer(dy), t);
  return 0;
}

int jacobian(realtype, N_Vector, N_Vector, SUNMatrix matrix, void* problem, N_Vector, N_Vector, N_Vector) {
  static_cast<DamperProblem*>(problem)->jacobian(
      [matrix](int row, int column, double value) { SM_ELEMENT_D(matrix, row, column) = value; });
  return 0;
}

int distances(realtype, N_Vector y, realtype* out, void* problem) {
  for (int slider = 0; slider < 2; ++slider)
    out[slider] = static_cast<DamperProblem*>(problem)->distance(slider, N_VGetArrayPointer(y));
  return 0;
}

void require(int status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("CVODE: ") + what);
}

}  // namespace

Samples run_cvode(DamperProblem problem, int periods, double tolerance, Multistep method) {
  sundials::Context context;
  const std::unique_ptr<_generic_N_Vector, decltype(&N_VDestroy)> y(N_VNew_Serial(10, context), N_VDestroy);
  const std::unique_ptr<_generic_SUNMatrix, decltype(&SUNMatDestroy)> matrix(SUNDenseMatrix(10, 10, context),
                                                                             SUNMatDestroy);
  const std::unique_ptr<_generic_SUNLinearSolver, decltype(&SUNLinSolFree)> linear(
      SUNLinSol_Dense(y.get(), matrix.get(), context), SUNLinSolFree);
  const std::unique_ptr<_generic_SUNNonlinearSolver, decltype(&SUNNonlinSolFree)> fixed_point(
      SUNNonlinSol_FixedPoint(y.get(), 0, context), SUNNonlinSolFree);
  void* cvode = CVodeCreate(method == Multistep::adams ? CV_ADAMS : CV_BDF, context);
  const std::unique_ptr<void, void (*)(void*)> owner(cvode, [](void* memory) { CVodeFree(&memory); });

  N_VConst(0.0, y.get());
  require(CVodeInit(cvode, rate, 0.0, y.get()), "init");
  require(CVodeSStolerances(cvode, tolerance, tolerance), "tolerances");
  require(CVodeSetUserData(cvode, &problem), "user data");
  require(CVodeSetMaxNumSteps(cvode, 100'000), "steps");
  if (method == Multistep::adams) {
    require(CVodeSetNonlinearSolver(cvode, fixed_point.get()), "fixed point");
  } else {
    require(CVodeSetLinearSolver(cvode, linear.get(), matrix.get()), "linear solver");
    require(CVodeSetJacFn(cvode, jacobian), "jacobian");
  }
  int falling[2] = {-1, -1};
  require(CVodeRootInit(cvode, 2, distances), "roots");
  require(CVodeSetRootDirection(cvode, falling), "root direction");
  require(CVodeSetNoInactiveRootWarn(cvode), "warning");

  const int count = periods * samples_a_period;
  const double interval = problem.period() / samples_a_period;
  Samples samples;
  samples.reserve(static_cast<std::size_t>(count));
  double t = 0.0;
  while (static_cast<int>(samples.size()) < count) {
    const int status = CVode(cvode, interval * static_cast<double>(samples.size() + 1), y.get(), &t, CV_NORMAL);
    require(status, "step");
    const double* const now = N_VGetArrayPointer(y.get());
    if (status == CV_ROOT_RETURN) {
      int found[2] = {0, 0};
      CVodeGetRootInfo(cvode, found);
      for (int slider = 0; slider < 2; ++slider)
        if (found[slider] != 0) problem.change(slider, now);
      require(CVodeReInit(cvode, t, y.get()), "restart");
      continue;
    }
    samples.push_back({now[0], now[1], now[2], now[3], now[4]});
  }
  return samples;
}

}  // namespace rubato::benchmarks
