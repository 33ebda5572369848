#include <rubato/core/error.hpp>
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>

#include "measure.hpp"
#include "support/exact_errors.hpp"
#include "support/free_vibration.hpp"
#include "support/stop_flow.hpp"
#include "work_problems.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>

// Work against error of steps that are fixed, of the paper's controller and estimator, and of the default ones, on the
// examples; as CSV. `tools/make_work_error.py` draws it and writes the tables of docs/theory/automatic-steps.md.
namespace {

using namespace rubato;
using benchmarks::cpu_seconds;
using benchmarks::WorkProblem;

/// A way to choose steps and the number that tells how fine: a step, or a tolerance.
struct Route {
  const char* name;
  double first, last, ratio;  ///< of the numbers to run
};

struct Counts {
  long steps = 0, rejected = 0, solves = 0, factorisations = 0;
  double largest_step = 0.0;
  bool reached = false;
};

class Bench {
 public:
  explicit Bench(const WorkProblem& problem) : problem_(problem), method_(integrate::make_method("generalized_alpha")) {
    weigh_factorisation();
  }

  /// One CSV row for each number of the ladder, while the errors are above `least`.
  void run(const Route& route, double least) {
    for (double number = route.first; number > route.last * 0.99; number *= route.ratio) {
      Counts counts;
      const double error = error_of(route, number, counts);
      if (!counts.reached) continue;
      const double cpu = cpu_of([&] { (void)march(route, number, nullptr); });
      fmt::print("{},{},{},{},{:.6g},{:.6e},{},{},{},{},{:.2f},{:.6e}\n", problem_.name,
                 static_cast<int>(problem_.kind), problem_.is_linear ? 1 : 0, route.name, number, error, counts.steps,
                 counts.rejected, counts.solves, counts.factorisations, factorisation_, cpu);
      std::fflush(stdout);
      if (!(error > least)) break;
    }
  }

 private:
  double error_of(const Route& route, double number, Counts& counts) {
    if (problem_.system.stop_count() > 0) {
      if (!stop_) stop_.emplace(problem_.system, problem_.start, problem_.duration);
      const auto truth = [this](double t) { return stop_->at(t); };
      testing::LargestError<decltype(truth)> errors(problem_.system, truth);
      counts = march(route, number, &errors);
      return errors.relative();
    }
    testing::ExactErrors errors(problem_.system, problem_.start);
    counts = march(route, number, &errors);
    errors.finish();
    return errors.relative();
  }

  Counts march(const Route& route, double number, integrate::Observer* observer) const {
    const std::string name = route.name;
    const auto stepper = integrate::make_stepper(method_, problem_.system);
    system::State state = problem_.start;
    if (name == "fixed") {
      const double step = problem_.duration / std::ceil(problem_.duration / number);
      const auto report = integrate::march(*stepper, state, step, problem_.duration, observer);
      return {
          report.steps, 0, report.steps, stepper->factorisations(), step, report.end == integrate::MarchEnd::reached};
    }
    integrate::StepPlan plan;
    integrate::EstimatorKind kind = integrate::LocalError{number};
    plan.largest = problem_.duration / 50.0;
    plan.smallest = 1e-12 * problem_.duration;
    plan.locate_events = problem_.system.stop_count() > 0;  // the default of a study
    plan.locate_sliders = false;
    if (name == "cardona_cassano") {
      plan.controller = integrate::CardonaCassano{};
      kind = integrate::InertiaJump{number, reference_value(), false};
    }
    const auto estimator = integrate::make_estimator(kind, method_, problem_.system, *stepper, problem_.duration);
    const auto report =
        integrate::march(*stepper, *estimator, plan, problem_.system, state, problem_.duration, observer);
    return {report.march.steps,    report.rejected,     report.solves,
            report.factorisations, report.largest_step, report.march.end == integrate::MarchEnd::reached};
  }

  /// l of the paper: the model's, else of the start, else a displacement of a metre everywhere.
  double reference_value() const {
    if (problem_.system.reference() > 0.0) return problem_.system.reference();
    const Vector& q = problem_.start.q;
    if (q.squaredNorm() > 0.0) return std::sqrt(q.dot(problem_.system.mass() * q));
    return std::sqrt(problem_.system.mass().diagonal().sum());
  }

  static double cpu_of(const std::function<void()>& task) {
    std::vector<double> times;
    const double begin = cpu_seconds();
    while (times.size() < 3 || (cpu_seconds() - begin < 0.02 && times.size() < 200)) {
      const double start = cpu_seconds();
      task();
      times.push_back(cpu_seconds() - start);
      if (times.back() > 1.0) break;
    }
    return benchmarks::median(times);
  }

  /// What a factorisation costs in steps.
  void weigh_factorisation() {
    const auto stepper = integrate::make_stepper(method_, problem_.system);
    system::State from = problem_.start, to = from;
    const double h = 1e-4 * problem_.duration;
    int turn = 0;
    const auto attempts = [&](bool with_change) {
      for (int i = 0; i < 50; ++i) {
        const double step = with_change ? h * (1.0 - 1e-4 * ++turn) : h;  // never one that is remembered
        (void)stepper->attempt(from, step, from.t + step, to);
      }
    };
    attempts(false);
    const auto times = benchmarks::median_times({[&] { attempts(false); }, [&] { attempts(true); }}, 9);
    factorisation_ = times[1] / times[0] - 1.0;
  }

  const WorkProblem& problem_;
  std::optional<testing::StopFlow> stop_;
  integrate::Method method_;
  double factorisation_ = 0.0;
};

}  // namespace

/// @param words  the folder of the examples; then names of problems, all unless given
int main(int count, char** words) {
  if (count < 2) {
    fmt::print(stderr, "usage: work_error EXAMPLES [PROBLEM ...]\n");
    return 2;
  }
  try {
    const auto problems = benchmarks::work_problems(words[1]);
    fmt::print("problem,kind,linear,route,number,error,steps,rejected,solves,factorisations,factorisation_cost,cpu\n");
    for (const WorkProblem& problem : problems) {
      if (count > 2 && std::find(words + 2, words + count, problem.name) == words + count) continue;
      Bench bench(problem);
      const double least = 1e-5, root = std::sqrt(2.0);
      bench.run({"fixed", problem.duration / 50.0, problem.duration * 1e-7, 1.0 / root}, least);
      bench.run({"cardona_cassano", 10.0, 1e-12, std::pow(0.1, 0.25)}, least);
      bench.run({"pi", 1e-2, 1e-8, std::pow(0.1, 0.25)}, problem.is_linear ? 0.0 : least);
    }
  } catch (const InvalidInput& fault) {
    fmt::print(stderr, "{}\n", fault.message());
    return 2;
  }
}
