#include <rubato/core/error.hpp>
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/numerics/ordered_factor.hpp>
#include <rubato/system/assemble.hpp>

#include "measure.hpp"
#ifdef RUBATO_WITH_PETSC
#include "peers/petsc_alpha2.hpp"
#endif
#include "support/frame.hpp"

#include <fmt/core.h>
#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

// Steps of large structures beside a loop of one product and one solve with the factor of the library, written out by
// hand: the portal frame in 33,000 elements, and a lattice of beams read from CSV files.
namespace {

using namespace rubato;
using benchmarks::cpu_seconds;

double bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

template <class Task>
auto timed(const char* what, Task&& task) {
  const double start = cpu_seconds();
  auto result = task();
  fmt::print("  {:<44}{:>10.3f} s\n", what, cpu_seconds() - start);
  return result;
}

system::LocallyNonlinear assembled(const model::ModelDescription& description) {
  return timed("build and assemble", [&] { return system::assemble(model::build(description, {})); });
}

/// 33,000 elements; nodes 1 and 5 held as in the paper's case PMM.
model::ModelDescription fine_frame() {
  model::ModelDescription description = rubato::testing::portal_frame();
  for (auto& beam : description.structure.beams) beam.elements = 5500;
  description.displacements = {{"1.y", 0.006, {}}, {"5.x", 0.01, {}}};
  return description;
}

/// A plane lattice of square cells, clamped along its lower edge, as a study with two CSV files.
void write_lattice(const std::filesystem::path& folder, int columns, int rows) {
  std::ofstream nodes(folder / "nodes.csv"), beams(folder / "beams.csv"), study(folder / "study.toml");
  nodes << "name,x,y\n";
  beams << "first,second,section,material\n";
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto name = [&](int r, int c) { return fmt::format("n{}-{}", r, c); };
      nodes << fmt::format("{},{},{}\n", name(row, column), column, row);
      if (row > 0) beams << fmt::format("{},{},bar,steel\n", name(row - 1, column), name(row, column));
      if (row > 0 && column > 0) beams << fmt::format("{},{},bar,steel\n", name(row, column - 1), name(row, column));
    }
  study << R"(title = "A lattice of beams"
[nodes]
file = "nodes.csv"
[beams]
file = "beams.csv"
[[material]]
name = "steel"
young = 206e9
poisson = 0.3
density = 7800.0
[[section]]
name = "bar"
area = 3.2e-3
inertia = 1.707e-6
shear_factor = 0.8333333333333334
)";
  for (int column = 0; column < columns; ++column)
    study << fmt::format("[[support]]\nnode = \"n0-{}\"\nfix = [\"x\", \"y\", \"rz\"]\n", column);
  study << fmt::format("[[displacement]]\non = \"n{}-{}.x\"\nvalue = 0.01\n", rows, columns / 2);
  study << "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\ncount = 1\n";
}

/// Average acceleration of an undamped structure without loads: one product, one solve.
class BareLoop {
 public:
  BareLoop(const system::LocallyNonlinear& system, const system::State& start, double h)
      : system_(system), h_(h), q_(start.q), v_(start.v), a_(start.auxiliary_acceleration), right_(system.size()) {
    const SparseMatrix effective = system.mass() + SparseMatrix(0.25 * h * h * system.stiffness());
    factor_.analyse(effective, {});
    if (!factor_.factorise(effective)) throw InvalidInput("the effective matrix is not positive definite");
  }
  void run(int steps) {
    const double h = h_;
    for (int i = 0; i < steps; ++i) {
      q_ += h * v_ + (0.25 * h * h) * a_;
      v_ += (0.5 * h) * a_;
      right_.noalias() = system_.stiffness() * q_;
      factor_.solve(right_, a_);
      a_ = -a_;
      q_ += (0.25 * h * h) * a_;
      v_ += (0.5 * h) * a_;
    }
    benchmarks::keep(q_[0]);
  }
  double factor_bytes() const { return static_cast<double>(factor_.bytes()); }

 private:
  const system::LocallyNonlinear& system_;
  double h_;
  Vector q_, v_, a_, right_;
  numerics::OrderedFactor factor_;
};

void compare_steps(const system::LocallyNonlinear& system, const system::State& start, double h) {
  constexpr int steps = 20;
  BareLoop bare(system, start, h);
  const double before = bytes_in_use();
  const auto stepper = integrate::make_stepper(integrate::make_method("generalized_alpha"), system);
  system::State state = start, other = start;
  timed("first factorisation", [&] { return stepper->attempt(state, h, state.t + h, other).outcome; });
  const double bytes = bytes_in_use() - before;
  const auto times = benchmarks::median_times(
      {[&] { bare.run(steps); }, [&] { (void)march(*stepper, state, h, state.t + steps * h, nullptr); }}, 7);
  const double each = 1e9 / (steps * static_cast<double>(system.size()));
  fmt::print("  {:<44}{:>10.1f} ns an unknown\n", "bare loop: a product, a solve", times[0] * each);
  fmt::print("  {:<44}{:>10.1f} ns an unknown, {:.2f} of it\n", "generalized-alpha, a step", times[1] * each,
             times[1] / times[0]);
  fmt::print("  {:<44}{:>10.2f} (factor: {:.1f} MB)\n", "memory of states and stepper over the factor",
             bytes / bare.factor_bytes(), 1e-6 * bare.factor_bytes());
}

#ifdef RUBATO_WITH_PETSC
/// The same method with the same step: the same error, but for its first step.
void compare_with_petsc(const system::LocallyNonlinear& system, const system::State& start, double h) {
  constexpr int steps = 50;
  const auto stepper = integrate::make_stepper(integrate::make_method("generalized_alpha"), system);
  system::State state = start;
  const double begin = cpu_seconds();
  (void)march(*stepper, state, h, steps * h, nullptr);
  const double ours = cpu_seconds() - begin;
  const benchmarks::PetscRun peer = benchmarks::petsc_alpha2(system, start, h, steps);
  fmt::print("  {:<44}{:>10.3f} s for {} steps, one factorisation included\n", "generalized-alpha", ours, steps);
  fmt::print("  {:<44}{:>10.3f} s, {} solves, {:.1f} times ours; q differs by {:.1e}\n", "PETSc TSALPHA2 with CHOLMOD",
             peer.cpu, peer.solves, peer.cpu / ours, (peer.q - state.q).norm() / state.q.norm());
}
#endif

/// The reference value is that of the frame in six elements: the paper's falls with the square root of their number,
/// and would make the same tolerance 74 times as strict here.
void automatic_steps(const system::LocallyNonlinear& system, system::State state) {
  const auto method = integrate::make_method("hht", {{"alpha", -0.05}});
  const auto stepper = integrate::make_stepper(method, system);
  constexpr double reference = 34.04123;
  integrate::StepPlan plan;
  plan.controller = integrate::CardonaCassano{};
  plan.first = 1e-4;
  plan.rebuild = false;
  const auto estimator =
      integrate::make_estimator(integrate::InertiaJump{1e-4, reference, true}, method, system, *stepper, 0.12);
  const double start = cpu_seconds();
  const auto report = march(*stepper, *estimator, plan, system, state, 0.12);
  fmt::print("  {:<44}{:>10} solves, {} factorisations, {} rejected, {:.2f} s\n", "cardona_cassano, TOL = 1e-4",
             report.solves, report.factorisations, report.rejected, cpu_seconds() - start);
}

system::State released(const system::LocallyNonlinear& system) {
  const auto equilibrium =
      timed("static start", [&] { return integrate::find_equilibrium(system, system.held_displacements()); });
  if (equilibrium.outcome != integrate::StaticOutcome::found) throw InvalidInput("no static start");
  return integrate::consistent_start(system, equilibrium.state);
}

}  // namespace

int main() {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("lattice-{}", getpid());
  try {
    {
      fmt::print("frame, 33,000 elements\n");
      const auto system = assembled(fine_frame());
      fmt::print("  {} unknowns\n", system.size());
      const system::State start = released(system);
      compare_steps(system, start, 1e-4);
      automatic_steps(system, start);
#ifdef RUBATO_WITH_PETSC
      compare_with_petsc(system, start, 1e-4);
#endif
    }
    fmt::print("\nlattice of beams\n");
    std::filesystem::create_directory(folder);
    write_lattice(folder, 180, 181);
    const auto study = timed("read from CSV files", [&] { return io::read_study(folder / "study.toml"); });
    const auto system = assembled(study.model);
    fmt::print("  {} unknowns\n", system.size());
    compare_steps(system, released(system), 1e-4);
  } catch (const InvalidInput& fault) {
    fmt::print(stderr, "{}\n", fault.message());
  }
  std::filesystem::remove_all(folder);
}
