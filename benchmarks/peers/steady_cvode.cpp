#include "steady_march.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace rubato::benchmarks {
namespace {

void require(int status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("CVODE: ") + what);
}

template <class Problem>
double march(Problem& problem, std::array<double, 2 * Problem::coordinates>& state, int observed, const MarchEnd& end) {
  constexpr int n = Problem::coordinates;
  const auto rate = [](realtype t, N_Vector y, N_Vector dy, void* of) {
    (*static_cast<Problem*>(of))(N_VGetArrayPointer(y), N_VGetArrayPointer(dy), t);
    return 0;
  };
  const auto distances = [](realtype, N_Vector y, realtype* out, void* of) {
    for (int i = 0; i < Problem::sliders; ++i) out[i] = static_cast<Problem*>(of)->distance(i, N_VGetArrayPointer(y));
    return 0;
  };
  sundials::Context context;
  using Owner = std::unique_ptr<_generic_N_Vector, decltype(&N_VDestroy)>;
  const Owner y(N_VNew_Serial(2 * n, context), N_VDestroy), at(N_VNew_Serial(2 * n, context), N_VDestroy);
  const std::unique_ptr<_generic_SUNNonlinearSolver, decltype(&SUNNonlinSolFree)> fixed_point(
      SUNNonlinSol_FixedPoint(y.get(), 0, context), SUNNonlinSolFree);
  void* cvode = CVodeCreate(CV_ADAMS, context);
  const std::unique_ptr<void, void (*)(void*)> owner(cvode, [](void* memory) { CVodeFree(&memory); });
  std::copy(state.begin(), state.end(), N_VGetArrayPointer(y.get()));
  require(CVodeInit(cvode, rate, 0.0, y.get()), "init");
  require(CVodeSStolerances(cvode, end.tolerance, end.tolerance), "tolerances");
  require(CVodeSetUserData(cvode, &problem), "user data");
  require(CVodeSetNonlinearSolver(cvode, fixed_point.get()), "fixed point");
  std::array<int, Problem::sliders> falling;
  falling.fill(-1);
  require(CVodeRootInit(cvode, Problem::sliders, distances), "roots");
  require(CVodeSetRootDirection(cvode, falling.data()), "root direction");
  require(CVodeSetNoInactiveRootWarn(cvode), "warning");

  PeriodWatch<n> watch(state, problem.period(), end, observed);
  const double period = problem.period();
  double next = period, t = 0.0, before_time = 0.0;
  double before = state[n + observed];
  const double *const now = N_VGetArrayPointer(y.get()), *const between = N_VGetArrayPointer(at.get());
  for (;;) {
    const int status = CVode(cvode, 2.0 * next, y.get(), &t, CV_ONE_STEP);
    require(status, "step");
    const double after = now[n + observed];
    if ((before > 0.0) != (after > 0.0)) {
      // The turning point by bisection of the interpolated speed.
      double low = before_time, high = t;
      for (int halving = 0; halving < 20; ++halving) {
        const double middle = 0.5 * (low + high);
        require(CVodeGetDky(cvode, middle, 0, at.get()), "interpolation");
        ((between[n + observed] > 0.0) == (before > 0.0) ? low : high) = middle;
      }
      watch.turn(between[observed]);
    }
    if (next <= t) {
      require(CVodeGetDky(cvode, next, 0, at.get()), "interpolation");
      std::copy(between, between + 2 * n, state.begin());
      if (watch.closes(state)) return watch.amplitude();
      next += period;
    }
    if (status == CV_ROOT_RETURN) {
      std::array<int, Problem::sliders> found{};
      CVodeGetRootInfo(cvode, found.data());
      for (int i = 0; i < Problem::sliders; ++i)
        if (found[i] != 0) problem.change(i, now);
      require(CVodeReInit(cvode, t, y.get()), "restart");
    }
    before = after;
    before_time = t;
  }
}

}  // namespace

double steady_cvode(SingleMassProblem& problem, std::array<double, 2>& y, int observed, const MarchEnd& end) {
  return march(problem, y, observed, end);
}
double steady_cvode(DamperProblem& problem, std::array<double, 10>& y, int observed, const MarchEnd& end) {
  return march(problem, y, observed, end);
}

}  // namespace rubato::benchmarks
