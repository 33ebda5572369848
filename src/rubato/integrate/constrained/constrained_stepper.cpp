#include <rubato/core/error.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/system/constrained_equations.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

class ConstrainedStepper final : public Stepper {
 public:
  /// @param equations  lent
  ConstrainedStepper(const GeneralizedAlpha& method, system::ConstrainedEquations& equations, const NewtonPlan& plan)
      : p_(method),
        plan_(plan),
        system_(equations.system()),
        equations_(equations),
        travel_(system_.size()),
        force_(system_.size()),
        product_(system_.size()),
        constraint_(system_.constraint_count()),
        has_followed_reactions_(system_.has_followed_reactions()),
        has_slip_(system_.has_slip_directions()) {
    const system::ConstrainedSystem& of = system_;
    is_smooth_ = !of.has_kinks() && !has_followed_reactions_ && !has_slip_;
    rules_.most_iterations = plan.most_iterations;
    rules_.keep_below = 0.1;
    if (!has_slip_) rules_.diverged_above = 2.0;
    tolerance_ = plan.tolerance * (plan.reference > 0.0 ? plan.reference : extent(of));
  }

  void step_changes(system::State& state, double ratio) override {
    if (p_.alpha_m == p_.alpha_f) return;
    state.auxiliary_acceleration = state.acceleration + ratio * (state.auxiliary_acceleration - state.acceleration);
  }

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    const int before = equations_.matrix().count();
    const StepReport report = step(from, h, t1, to);
    factorisations_ += equations_.matrix().count() - before;
    equations_.set_reaction_lag(from.reaction_lag, 0.0);  // whoever uses them next is in no step
    return report;
  }

  double shift() const override { return p_.alpha_m - p_.alpha_f; }
  int factorisations() const override { return factorisations_; }

 private:
  StepReport step(const system::State& from, double h, double t1, system::State& to) {
    if (plan_.avoids_singular_ends) count_usual_redundancy(from);
    const double mean = (1.0 - p_.alpha_f) / (1.0 - p_.alpha_m);
    scale_ = mean * p_.beta * h * h;
    to.t = t1;
    to.phase = from.phase;
    to.rubbing = from.rubbing;
    to.stuck_at = from.stuck_at;
    equations_.set_slip_floors(from, h, to);
    equations_.set_reaction_lag(from.reaction_lag, h);
    equations_.begin_step(from);
    to.memory = from.memory;
    to.slider_force = from.slider_force;
    to.multiplier = from.multiplier;
    to.reaction_lag = from.reaction_lag;
    predict(from, h);
    Iterates iterates{*this, from, h, to};
    switch (numerics::newton(iterates, rules_).outcome) {
      case numerics::NewtonOutcome::converged:
        break;
      case numerics::NewtonOutcome::singular:
        return fault(StepOutcome::singular);
      case numerics::NewtonOutcome::not_finite:
        return fault(StepOutcome::not_finite);
      default:
        return fault(StepOutcome::not_converged);
    }
    double apart = 0.0;
    const Index worst = equations_.matrix().worst_leak(constraint_, apart);
    if (apart > most_apart * (1.0 + from.q.cwiseAbs().maxCoeff())) return {StepOutcome::overdetermined, worst};
    // Where rows repeat each other always, those that do so at one time only are not told apart from them.
    const bool is_held = !plan_.avoids_singular_ends || usual_ > 0 || equations_.matrix().nearly_redundant_rows() == 0;
    return is_held ? finish(from, h, iterates.is_placed, to) : fault(StepOutcome::singular);
  }

  /// The equations of the step as Newton's method sees them. The iterate is the travel and, in `to`, the multipliers;
  /// corrections are measured in the mass norm. After it has converged constraint_ holds the last correction of the
  /// scaled multipliers.
  struct Iterates : numerics::NewtonProblem {
    Iterates(ConstrainedStepper& of, const system::State& from_, double h_, system::State& to_)
        : s(of), from(from_), h(h_), to(to_) {}

    double evaluate(bool with_tangent) {
      if (!is_first) s.take_correction();
      s.place(from, h, to);
      s.equations_.go_to_end(to, model::Side::left);
      if (with_tangent) {
        const double mean = (1.0 - s.p_.alpha_f) / (1.0 - s.p_.alpha_m);
        s.equations_.linearise({1.0, mean * s.p_.gamma * h, s.scale_, 0.0, true, takes_secants}, to.multiplier,
                               s.force_, s.constraint_);
      } else {
        s.equations_.residual(s.force_, s.constraint_);
      }
      return 0.0;
    }

    bool factorise() { return s.equations_.factorise(); }

    double correct() {
      // Multipliers start from zero: what the constraints do not determine of them stays out.
      if (is_first)
        to.multiplier.setZero();
      else
        s.equations_.add_constraint_force(to.multiplier, 1.0, s.force_);
      is_first = false;
      s.system_.times_mass(to.acceleration, s.product_);
      s.force_ = -s.scale_ * (s.force_ + s.product_);
      s.constraint_ = -s.constraint_;
      s.equations_.solve(s.force_, s.constraint_);
      s.system_.times_mass(s.force_, s.product_);
      return std::sqrt(s.force_.dot(s.product_));
    }

    double expected_contraction(double size) { return s.first_ratio(from, size); }

    // The travel follows where the iterate is placed: a last correction that is negligible leaves it where it is.
    void move(double /*part*/) { to.multiplier += (1.0 / s.scale_) * s.constraint_; }

    // Errors shrink by the ratio of the last two corrections: what is left is the rest of a geometric series.
    numerics::NewtonVerdict judge(const numerics::NewtonIteration& iteration) {
      const double ratio = iteration.contraction, size = iteration.size;
      const bool is_first_correction = iteration.number == 0;
      if (is_first_correction) {
        to.contraction = growth * from.contraction;
        to.correction = from.correction;
      } else if (iteration.number == 1) {
        to.contraction = safety * ratio;
        to.correction = iteration.last;
      }
      // The direction of a slow slip turned too far.
      takes_secants = !is_first_correction && s.has_slip_ && !takes_secants && ratio > 0.5;
      const bool is_noise = !is_first_correction && size <= noise * s.tolerance_;
      const double before = is_noise && !(ratio < 1.0) ? size : numerics::error_before(size, ratio);
      is_placed = !is_first_correction && before <= negligible * s.tolerance_;
      return ratio * before <= s.tolerance_ ? numerics::NewtonVerdict::converged : numerics::NewtonVerdict::go_on;
    }

    ConstrainedStepper& s;
    const system::State& from;
    const double h;
    system::State& to;
    bool is_first = true;
    bool takes_secants = false;  // of frictions' slopes
    bool is_placed = false;      // the last correction moves nothing: `to`, and G, stand where they shall
  };

  /// What a first correction leaves of the error. With Newton's own matrix less than nine tenths, but not across a
  /// kink, where the acceleration of a short step would be made of what is left; and what a step before measured, in
  /// proportion to the correction where that is larger (Newton's method is quadratic: Deuflhard 2004, 2.1). Each step
  /// that relies on it trusts it less (as in Hairer and Wanner 1996, IV.8).
  double first_ratio(const system::State& from, double size) const {
    if (size <= round_off * tolerance_) return most_left;
    if (!is_smooth_) return 1.0;
    return std::min(most_left, from.contraction * std::max(1.0, size / from.correction));
  }

  /// The travel if the acceleration goes on changing as the two that the state carries say: A stands shift h from a, so
  /// that (A - a)/shift is its change in a step. What Newton then corrects is of fourth order in h. Where it is no
  /// small part of A itself, vibrations are faster than the steps, and it says nothing.
  void predict(const system::State& from, double h) {
    constexpr double small = 0.2;
    const Index n = travel_.size();
    const double inverse = shift() == 0.0 ? 0.0 : 1.0 / shift();
    const double* __restrict const v = from.v.data();
    const double* __restrict const shifted = from.auxiliary_acceleration.data();
    const double* __restrict const now = from.acceleration.data();
    double* __restrict const travel = travel_.data();
    double change_squared = 0.0, squared = 0.0;
    for (Index i = 0; i < n; ++i) {
      const double change = inverse * (shifted[i] - now[i]);
      change_squared += change * change;
      squared += shifted[i] * shifted[i];
    }
    const double by_change = change_squared <= small * small * squared ? p_.beta * h * h * inverse : 0.0;
    for (Index i = 0; i < n; ++i) travel[i] = h * v[i] + 0.5 * h * h * shifted[i] + by_change * (shifted[i] - now[i]);
  }

  /// Adds the correction in force_ to the travel.
  void take_correction() {
    system_.to_travel(travel_, force_);
    travel_ += force_;
  }

  /// q, v and both accelerations of `to` for the travel dq.
  void place(const system::State& from, double h, system::State& to) {
    const Index n = travel_.size();
    to.auxiliary_acceleration.resize(n);
    to.v.resize(n);
    to.acceleration.resize(n);
    const double inverse = 1.0 / (p_.beta * h * h), to_acceleration = 1.0 / (1.0 - p_.alpha_f);
    const double before = h * (1.0 - p_.gamma), after = h * p_.gamma, start = h * h * (0.5 - p_.beta);
    const double new_share = to_acceleration * (1.0 - p_.alpha_m), old_share = to_acceleration * p_.alpha_m;
    const double last_share = to_acceleration * p_.alpha_f;
    const double* __restrict const travel = travel_.data();
    const double* __restrict const v = from.v.data();
    const double* __restrict const shifted = from.auxiliary_acceleration.data();
    const double* __restrict const last = from.acceleration.data();
    double* __restrict const new_v = to.v.data();
    double* __restrict const new_shifted = to.auxiliary_acceleration.data();
    double* __restrict const now = to.acceleration.data();
    for (Index i = 0; i < n; ++i) {  // one pass: long chains do not fit the first-level cache
      const double next = inverse * (travel[i] - h * v[i] - start * shifted[i]);
      new_shifted[i] = next;
      new_v[i] = v[i] + (before * shifted[i] + after * next);
      now[i] = new_share * next + old_share * shifted[i] - last_share * last[i];
    }
    system_.retract(from.q, travel_, to.q);
  }

  /// @param is_placed  see Iterates
  StepReport finish(const system::State& from, double h, bool is_placed, system::State& to) {
    if (!is_placed) {
      take_correction();
      place(from, h, to);
    }
    if (plan_.projects_velocities && constraint_.size() > 0) {
      equations_.set_reaction_lag(from.reaction_lag, 0.0);
      if (!project(is_placed, to)) return fault(StepOutcome::singular);
      if (has_followed_reactions_) to.reaction_lag = (1.0 / (h * h)) * constraint_;
    }
    equations_.set_reaction_lag(from.reaction_lag, h);
    equations_.move_laws(to);
    if (to.q.allFinite() && to.v.allFinite() && to.multiplier.allFinite() && to.memory.allFinite()) return {};
    return fault(StepOutcome::not_finite);
  }

  /// How many rows repeat others in the configuration of the start, with the locks and the friction of now.
  void count_usual_redundancy(const system::State& now) {
    if (usual_ >= 0 && now.phase == usual_for_.phase && now.rubbing == usual_for_.rubbing) return;
    usual_for_ = system_.start();
    usual_for_.phase = now.phase;
    usual_for_.rubbing = now.rubbing;
    usual_for_.stuck_at = now.stuck_at;
    equations_.go_to(usual_for_, model::Side::left);
    equations_.linearise({}, usual_for_.multiplier, force_, constraint_);
    constexpr double left = 1e-6;  // the configuration of the start may be given to a few digits
    usual_ = equations_.factorise() ? static_cast<int>(equations_.redundant_rows(left).size()) : 0;
  }

  /// Removes from the velocities what the constraints forbid, M dv + G^T impulse = 0. Newton's factors, which are
  /// there, hold stiffness beside M: what stiff parts would give to the impulses makes reactions that the motion does
  /// not have. They hold the slopes of friction that follows reactions, too: what that would give to the impulses in
  /// each step is of first order in it. Where either is not small M has factors of its own; false where it has none.
  ///
  /// From projected velocities, positions lead the auxiliary acceleration across the constraints to stand 1/3 - 2 beta
  /// of a step from equilibrium, instead of 1/2 - gamma: multipliers of the step are of first order. The impulse makes
  /// up for the same difference, so that over h it is what they lack of the reactions.
  bool project(bool is_placed, system::State& to) {
    if (!is_placed) {
      equations_.go_to_end(to, model::Side::left);
      equations_.constraints(constraint_);
    }
    if (!equations_.has_sliding_reactions()) {
      find_velocity_change(to);
      system_.times_mass(force_, product_);
      const double momentum = product_.norm();
      equations_.add_constraint_force(constraint_, 1.0, product_);
      if (product_.norm() <= foreign * momentum) {
        to.v += force_;
        return true;
      }
    }
    equations_.linearise({1.0, 0.0, 0.0, 0.0}, to.multiplier, force_, constraint_);
    if (!equations_.factorise()) return false;
    find_velocity_change(to);
    to.v += force_;
    return true;
  }

  /// With the factors of now: force_ becomes dv, constraint_ the impulse.
  void find_velocity_change(const system::State& to) {
    equations_.constraint_rate(to.v, constraint_);
    constraint_ = -constraint_;
    force_.setZero();
    equations_.solve(force_, constraint_);
  }

  /// The coordinate whose correction was not finite, or the largest.
  StepReport fault(StepOutcome outcome) const {
    Index worst = 0;
    double largest = -1.0;
    for (Index i = 0; i < force_.size(); ++i) {
      if (!std::isfinite(force_[i])) return {outcome, i};
      if (std::abs(force_[i]) > largest) {
        largest = std::abs(force_[i]);
        worst = i;
      }
    }
    return {outcome, worst};
  }

  static constexpr double round_off = 1e-6;   // of the tolerance: a first correction that says that nothing moves
  static constexpr double most_left = 0.9;    // of a first correction, by the matrix of the same iterate
  static constexpr double negligible = 1e-2;  // of the tolerance
  static constexpr double safety = 10.0;      // on the measured share that a first correction leaves
  static constexpr double growth = 1.2;       // of that share in each step that relies on it
  static constexpr double most_apart = 1e-8;  // of the size, that constraints may stay apart
  static constexpr double noise = 1e-4;       // of the tolerance: corrections that need not shrink
  static constexpr double foreign = 1e-2;     // of the momentum of a projection: what is no impulse of constraints

  GeneralizedAlpha p_;
  NewtonPlan plan_;
  const system::ConstrainedSystem& system_;
  system::ConstrainedEquations& equations_;
  int factorisations_ = 0;
  Vector travel_, force_, product_, constraint_;
  numerics::NewtonRules rules_;
  double tolerance_ = 0.0, scale_ = 0.0;
  bool is_smooth_ = true;        // the slopes of all forces
  bool has_followed_reactions_;  // by friction
  bool has_slip_;                // directions of friction
  system::State usual_for_;
  int usual_ = -1;  // rows that repeat others; -1: not known yet
};

/// A stepper with equations of its own.
class OwningStepper final : public Stepper {
 public:
  OwningStepper(const GeneralizedAlpha& method, const system::ConstrainedSystem& of, const NewtonPlan& plan)
      : equations_(of.equations()), stepper_(method, *equations_, plan) {}

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    return stepper_.attempt(from, h, t1, to);
  }
  void step_changes(system::State& state, double ratio) override { stepper_.step_changes(state, ratio); }
  double shift() const override { return stepper_.shift(); }
  int factorisations() const override { return stepper_.factorisations(); }

 private:
  std::unique_ptr<system::ConstrainedEquations> equations_;
  ConstrainedStepper stepper_;
};

}  // namespace

double spectral_radius_at_infinity(const GeneralizedAlpha& p, bool projects_velocities) {
  // Roots of the characteristic polynomial of the step for omega h -> infinity, in A, h v and q: with f weighted by
  // (1 - alpha_f) and alpha_f, one root is -alpha_f/(1 - alpha_f), the others those of
  // beta x^2 + (1/2 + gamma - 2 beta) x + (1/2 - gamma + beta) = 0. Where each step begins with v = 0 only
  // beta A1 + (1/2 - beta) A0 = 0 is left of the latter.
  const double forces = std::abs(p.alpha_f / (1.0 - p.alpha_f));
  if (projects_velocities) return std::max(forces, std::abs((0.5 - p.beta) / p.beta));
  const double b = 0.5 + p.gamma - 2.0 * p.beta, c = 0.5 - p.gamma + p.beta;
  const double discriminant = b * b - 4.0 * p.beta * c;
  const double kinematics =
      discriminant < 0.0 ? std::sqrt(std::abs(c / p.beta)) : (std::abs(b) + std::sqrt(discriminant)) / (2.0 * p.beta);
  return std::max(forces, kinematics);
}

void check_stepper(const Method& method, const system::ConstrainedSystem& system, const NewtonPlan& plan, bool force) {
  const auto* alpha = std::get_if<GeneralizedAlpha>(&method.formula);
  if (!alpha || !(alpha->beta > 0.0))
    throw InvalidInput(
        fmt::format("{} does not march mechanisms, whose equations are solved implicitly; take "
                    "\"generalized_alpha\", \"hht\" or \"wbz\"",
                    method.name));
  constexpr double round_off = 1e-6;  // double roots are found to the square root of round-off
  const double radius = spectral_radius_at_infinity(*alpha);
  const bool is_damped = radius < 1.0 - round_off;
  const bool may_be_projected = spectral_radius_at_infinity(*alpha, true) <= 1.0 + round_off;
  if (system.constraint_count() > 0 && !force && !is_damped && !(may_be_projected && plan.projects_velocities))
    throw InvalidInput(
        fmt::format("{} with the spectral radius {:.4g} at infinite frequency does not march a mechanism with "
                    "constraints: nothing damps their multipliers, which oscillate from step to step; take "
                    "{{ name = \"hht\", alpha = -0.05 }} or {{ name = \"generalized_alpha\", rho_inf = 0.9 }}, or set "
                    "{}allow_unstable = true",
                    method.name, radius, may_be_projected ? "project_velocities = true or " : ""));
}

std::unique_ptr<Stepper> make_stepper(const Method& method, const system::ConstrainedSystem& system,
                                      const NewtonPlan& plan, bool force) {
  check_stepper(method, system, plan, force);
  return std::make_unique<OwningStepper>(std::get<GeneralizedAlpha>(method.formula), system, plan);
}

std::unique_ptr<Stepper> make_stepper(const Method& method, system::ConstrainedEquations& equations,
                                      const NewtonPlan& plan, bool force) {
  check_stepper(method, equations.system(), plan, force);
  return std::make_unique<ConstrainedStepper>(std::get<GeneralizedAlpha>(method.formula), equations, plan);
}

}  // namespace rubato::integrate
