// What mechanisms cost through the public driver: time for an error that is measured against a closed form or a
// converged run, and time for a step of chains and of a large flexible mechanism.
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

#include <measure.hpp>
#include <mechanism_models.hpp>
#include <support/bricard.hpp>
#include <support/double_pendulum.hpp>
#include <support/locking_bars.hpp>

#include <cstdio>
#include <functional>
#include <string>

namespace {

using namespace rubato;
using namespace rubato::integrate;
using benchmarks::median_times;

/// How a run picks its steps: equal ones, or the default control with a tolerance, or that of the paper.
struct Choice {
  Method method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  enum class Kind { fixed, automatic, paper } kind = Kind::fixed;
  double step_or_tolerance = 0.0;
};

struct Ran {
  long steps = 0;
  long factorisations = 0;
  bool has_reached = false;
  system::State state;
};

Ran run(const system::Mechanism& mechanism, const Choice& choice, double end, Observer* observer = nullptr) {
  const bool is_automatic = choice.kind == Choice::Kind::automatic;
  NewtonPlan newton;
  newton.projects_velocities = is_automatic;
  newton.avoids_singular_ends = choice.kind != Choice::Kind::fixed;
  const auto stepper = make_stepper(choice.method, mechanism, newton);
  system::MechanismEquations equations(mechanism);
  Ran ran;
  ran.state = make_consistent(equations, mechanism.start()).state;
  if (choice.kind == Choice::Kind::fixed) {
    shift_acceleration(equations, ran.state, stepper->shift() * choice.step_or_tolerance);
    const MarchReport report = march(*stepper, ran.state, choice.step_or_tolerance, end, observer);
    ran.steps = report.steps;
    ran.has_reached = report.end == MarchEnd::reached;
  } else {
    EstimatorKind kind = LocalError{choice.step_or_tolerance};
    StepPlan plan;
    plan.smallest = 1e-12 * end;
    plan.largest = end / 50.0;
    plan.locate_events = true;
    if (!is_automatic) {
      kind = InertiaJump{choice.step_or_tolerance, mechanism.reference(), true};
      plan.controller = CardonaCassano{};
      plan.rebuild = false;
      plan.first = 1e-3;
    }
    const auto estimator =
        make_estimator(kind, std::get<GeneralizedAlpha>(choice.method.formula),
                       make_error_space(mechanism, ran.state, choice.step_or_tolerance), ran.state, end);
    MechanismTimeline timeline(mechanism, 1e-12 * end);
    const AdaptiveReport report = march(*stepper, *estimator, plan, timeline, ran.state, end, observer);
    ran.steps = report.march.steps;
    ran.has_reached = report.march.end == MarchEnd::reached;
  }
  ran.factorisations = stepper->factorisations();
  return ran;
}

/// The largest of a measure of the error over the ends of all steps.
struct Worst final : Observer {
  std::function<double(const system::State&)> error;
  double largest = 0.0;
  bool accepted(const system::State&, const system::State& after) override {
    largest = std::max(largest, std::abs(error(after)));
    return true;
  }
};

/// The coarsest of a ladder of steps (or tolerances) whose error meets the target, by factors of 2^(1/4), and its time.
void work_for_error(const char* problem, const system::Mechanism& mechanism, Choice choice, double end, double target,
                    const std::function<double(const system::State&)>& error, double first, int rounds) {
  choice.step_or_tolerance = first;
  for (int i = 0; i < 60; ++i, choice.step_or_tolerance *= 0.84089641525371454) {
    Worst worst;
    worst.error = error;
    const Ran ran = run(mechanism, choice, end, &worst);
    if (!ran.has_reached || !(worst.largest <= target)) continue;
    const double time = median_times({[&] { benchmarks::keep(run(mechanism, choice, end).state.q[0]); }}, rounds)[0];
    std::printf("%-28s %-10s %-9.3g %8ld steps %6.2f fact/step  error %.2g  %9.3f ms\n", problem,
                choice.kind == Choice::Kind::fixed ? "step" : "tolerance", choice.step_or_tolerance, ran.steps,
                static_cast<double>(ran.factorisations) / static_cast<double>(ran.steps), worst.largest, 1e3 * time);
    std::fflush(stdout);
    return;
  }
  std::printf("%-28s the ladder does not meet %.2g: it ends with %.3g\n", problem, target, choice.step_or_tolerance);
}

void pendulum() {
  const system::Mechanism mechanism(benchmarks::planar_pendulum());
  const auto energy = [&](const system::State& s) {
    return 0.5 * s.v.squaredNorm() + 9.81 * s.q[4];  // level at the start
  };
  Choice choice;
  for (const auto& [name, method] :
       {std::pair{"pendulum, rho_inf 0.9", make_method("generalized_alpha", {{"rho_inf", 0.9}})},
        std::pair{"pendulum, rho_inf 0.99", make_method("generalized_alpha", {{"rho_inf", 0.99}})},
        std::pair{"pendulum, hht -0.01", make_method("hht", {{"alpha", -0.01}})}}) {
    choice.method = method;
    work_for_error(name, mechanism, choice, 10.0, 1e-5, energy, 4e-3, 5);
  }
}

void four_bars() {
  for (const int count : {2, 40}) {
    const system::Mechanism mechanism(benchmarks::windows(count));
    const benchmarks::TurnOfWindows exact(count, 10.0);
    const auto corner = [&](const system::State& s) {  // on a circle of 1 m
      return 2.0 * std::sin(0.5 * (0.5 * std::numbers::pi - exact(s.t) - s.q[5]));
    };
    const std::string name = "four-bar, N = " + std::to_string(count);
    Choice choice;
    work_for_error(name.c_str(), mechanism, choice, 10.0, 1e-4, corner, 2e-3, 3);
  }
}

/// Bricard's mechanism with all its hinges, against the route of one coordinate: where the middle of the third rod is,
/// every millisecond, and cubics between (errors of 1e-8 m).
void bricard() {
  const system::Mechanism mechanism(benchmarks::bricard());
  constexpr double duration = 10.0, spacing = 1e-3;
  std::vector<numerics::Vector3> middles;
  testing::Bricard exact;
  for (int i = 0; i <= static_cast<int>(duration / spacing) + 2; ++i) {
    const auto motion = exact.motion();
    middles.push_back(0.5 * (motion.corner[2] + motion.corner[3]));
    exact.go(spacing, spacing);
  }
  const auto error = [&](const system::State& s) {
    const auto i = static_cast<std::size_t>(std::max(1.0, std::floor(s.t / spacing)));
    const double x = s.t / spacing - static_cast<double>(i);
    const numerics::Vector3 middle =
        -x * (x - 1.0) * (x - 2.0) / 6.0 * middles[i - 1] + (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0 * middles[i] -
        (x + 1.0) * x * (x - 2.0) / 2.0 * middles[i + 1] + (x + 1.0) * x * (x - 1.0) / 6.0 * middles[i + 2];
    return (s.q.segment<3>(3 * 7) - middle).norm();
  };
  Choice choice;
  work_for_error("Bricard, equal steps", mechanism, choice, 10.0, 1e-4, error, 1e-2, 7);
  choice.kind = Choice::Kind::automatic;
  work_for_error("Bricard, default", mechanism, choice, 10.0, 1e-4, error, 1e-2, 7);
}

void double_pendulum() {
  const system::Mechanism mechanism(testing::double_pendulum());
  Choice choice;
  choice.kind = Choice::Kind::paper;
  choice.method = make_method("hht", {{"alpha", -0.15}});
  choice.step_or_tolerance = 1e-4;
  const auto error = [&](const system::State& s) {
    if (s.t != 5.0) return 0.0;
    const auto exact = testing::double_pendulum_at(5.0);
    double largest = 0.0;
    for (int i = 0; i < 4; ++i)
      largest = std::max(largest, std::abs(testing::double_pendulum_position(s, i) - exact[std::size_t(i)]));
    return largest;
  };
  work_for_error("double pendulum, paper", mechanism, choice, 5.0, 1.6e-3, error, 1e-4, 21);
  choice.kind = Choice::Kind::automatic;
  choice.method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  work_for_error("double pendulum, default", mechanism, choice, 5.0, 1.6e-3, error, 3e-3, 21);
}

void locking_bars() {
  const auto bars = testing::locking_bars(testing::LockingLaw::stop);
  const auto angle = bars.angle;
  const system::Mechanism mechanism(testing::locking_bars(testing::LockingLaw::stop).mechanism);
  for (const bool is_after : {false, true}) {
    const double end = is_after ? 1.6 : 1.0, exact = is_after ? 2.436617153 : 1.9370165052;
    const auto error = [&](const system::State& s) { return s.t == end ? angle.value(s.q.data()) - exact : 0.0; };
    const char* const name = is_after ? "locking bars, after" : "locking bars, before";
    Choice choice;
    choice.kind = Choice::Kind::paper;
    choice.method = make_method("hht", {{"alpha", -0.15}});
    work_for_error(name, mechanism, choice, end, 3e-3, error, is_after ? 3e-4 : 1e-2, 7);
    choice.kind = Choice::Kind::automatic;
    choice.method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
    work_for_error(name, mechanism, choice, end, 3e-3, error, 1e-2, 7);
  }
}

/// Time of a step of 1 ms while a chain falls for 0.2 s.
void chains() {
  for (const bool in_space : {false, true})
    for (const int count : {10, 100, 1000}) {
      const system::Mechanism mechanism(in_space ? benchmarks::space_chain(count) : benchmarks::plane_chain(count));
      const auto stepper = make_stepper(Choice{}.method, mechanism);
      system::MechanismEquations equations(mechanism);
      const double h = 1e-3, end = 0.2;
      system::State start = make_consistent(equations, mechanism.start()).state;
      shift_acceleration(equations, start, stepper->shift() * h);
      long steps = 0;
      const int before = stepper->factorisations();
      const double time = median_times({[&] {
                                         system::State state = start;
                                         steps += march(*stepper, state, h, end).steps;
                                       }},
                                       count < 1000 ? 7 : 3)[0];
      std::printf("chain in %s, %5d rods: %9.2f us a step, %.2f factorisations\n", in_space ? "space" : "the plane",
                  count, 1e6 * time / (end / h),
                  static_cast<double>(stepper->factorisations() - before) / double(steps));
      std::fflush(stdout);
    }
}

/// Steps of a flexible mechanism, with what a factorisation and an evaluation of it cost.
void flexible() {
  for (const int count : {1000, 10000}) {
    const system::Mechanism mechanism(benchmarks::flexible_pendulum(count));
    const auto stepper = make_stepper(Choice{}.method, mechanism);
    system::MechanismEquations equations(mechanism);
    const double h = 1e-3, end = 0.05;
    const system::State start = make_consistent(equations, mechanism.start()).state;
    long steps = 0;
    const int before = stepper->factorisations();
    Vector force(mechanism.size()), constraint(mechanism.constraint_count());
    const auto times =
        median_times({[&] {
                        system::State state = start;
                        steps += march(*stepper, state, h, end).steps;
                      },
                      [&] {
                        equations.go_to(start, model::Side::right);
                        for (int i = 0; i < 10; ++i) {
                          equations.linearise({1.0, 0.0, h * h, 0.0, true}, start.multiplier, force, constraint);
                          if (!equations.factorise()) std::printf("singular\n");
                        }
                      }},
                     3);
    const double step = times[0] / (end / h), factorisation = times[1] / 10.0;
    std::printf(
        "flexible, %5d beams: %9.3f ms a step = %.2f of a factorisation with its matrix (%.3f ms), %.2f "
        "factorisations a step\n",
        count, 1e3 * step, step / factorisation, 1e3 * factorisation,
        static_cast<double>(stepper->factorisations() - before) / double(steps));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const std::pair<const char*, void (*)()> parts[] = {
      {"pendulum", pendulum},         {"four_bars", four_bars},
      {"bricard", bricard},           {"double_pendulum", double_pendulum},
      {"locking_bars", locking_bars}, {"chains", chains},
      {"flexible", flexible}};
  for (const auto& [name, part] : parts)
    if (only.empty() || only == name) part();
}
