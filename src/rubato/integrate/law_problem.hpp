#pragma once

#include <rubato/integrate/contact_problem.hpp>
#include <rubato/integrate/step_report.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// The forces of all contacts at the end of a step of a structure that has other laws than sliders and stops.
///
///   u = u_free - W fc,   du/dt = v_free - W' fc,   fc = law(u, du/dt, t) from its memory at the start of the step
///
/// by Newton's method on the laws, with their consistent tangents; sliders and stops are solved for exactly at every
/// iteration (ContactProblem), so that it is the method of Josephy (1979) for generalised equations. A step that does
/// not bring the laws nearer to their equations is shortened. The force of a contact that presses on a law enters the
/// linear row of the law, which makes the linear problem unsymmetric; so do laws of several numbers, whose rows are
/// linear in all of them.
class LawProblem {
 public:
  explicit LawProblem(const system::LocallyNonlinear& system);

  /// @param compliance           W [m x m] [m/N]
  /// @param velocity_compliance  W' [m x m] [m/(N s)]
  void reset(const Matrix& compliance, const Matrix& velocity_compliance);

  /// What the contacts would do without forces at the end of the step, to be filled in [m] [m], [m/s].
  Vector& free_displacement() { return u_free_; }
  Vector& free_velocity() { return v_free_; }

  /// Writes slider_force and memory of `to`, whose time is the end of the step.
  /// @return accepted; not_converged, with the worst contact; not_finite
  StepReport solve(const system::State& from, system::State& to);

 private:
  struct Iteration;

  void start(const system::State& from, const system::State& to);
  numerics::NewtonOutcome iterate(const system::State& from, system::State& to, bool has_full_steps, double good);
  bool solve_by_parts(const system::State& from, system::State& to);
  void press(Index law, const Vector& force);
  void linearise();
  void linearise_block(Index block);
  void take_known_forces(bool of_all_laws);
  bool solve_boxes(const system::State& from, Vector& force);
  void set_box_trials(const system::State& from);
  double evaluate(const Vector& force, system::State& to);
  void evaluate_block(Index block, const Vector& force, system::State& to, double& largest);
  void take_error(Index contact, double error, double round_off, double& largest);
  StepReport failure(StepOutcome outcome) const;

  const system::LocallyNonlinear& system_;
  Index m_, boxes_;
  Matrix compliance_, velocity_compliance_;
  ContactProblem linearised_, boxes_alone_;
  Vector u_free_, v_free_, trial_, penetration_, box_trial_, box_penetration_;
  Vector force_, next_, trial_force_, u_, v_;               // of all contacts
  Vector size_;                                             // of what forces do to u, all of it added: its round-off
  const double* memory_ = nullptr;                          // of the laws at the start of the step
  std::vector<model::LawPoint> start_, end_;                // of each law
  std::vector<model::LawAnswer> answer_;                    // of each law, at end_
  std::vector<model::BlockPoint> block_start_, block_end_;  // of each block
  std::vector<double> block_velocity_, block_drift_;        // of each: V, and V t at the end of the step
  std::vector<model::BlockAnswer> block_answer_;
  std::vector<double> reach_;  // the largest displacement behind u of each law and row of a block: its round-off
  Vector first_u_, first_v_, whole_u_, whole_v_, known_;  // of a motion that is made in parts
  bool has_kinks_;                    // more than those of a law alone: laws that are pressed, and blocks
  bool slopes_are_bounded_;           // else a solution far away may be none of the motion from the start
  std::vector<model::Share> joined_;  // what laws and rows of blocks join, those of j from joined_start_[j]
  std::vector<std::size_t> joined_start_;
  Index worst_ = -1;
};

}  // namespace rubato::integrate
