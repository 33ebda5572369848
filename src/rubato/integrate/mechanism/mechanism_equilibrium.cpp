#include <rubato/integrate/mechanism/active_locks.hpp>
#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/numerics/newton.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::integrate {
namespace {

constexpr double first_shift = 1e-3, least_shift = 1e-12,
                 most_shift = 1e6;  // over the stiffness per mass of the mechanism

class Search {
 public:
  Search(system::MechanismEquations& equations, const system::State& given, const EquilibriumPlan& plan)
      : equations_(equations), mechanism_(equations.mechanism()), plan_(plan), locks_(mechanism_, given) {
    const Index n = mechanism_.size(), c = mechanism_.constraint_count();
    found_.state = given;
    std::fill(found_.state.rubbing.begin(), found_.state.rubbing.end(), model::friction_free);
    found_.state.v = found_.state.acceleration = found_.state.auxiliary_acceleration = Vector::Zero(n);
    // Laws on which reactions press begin with those that are known: without any they would hold nothing, and
    // Newton's method would go past where they hold.
    const auto& laws = mechanism_.model().laws;
    const bool is_pressed =
        std::any_of(laws.begin(), laws.end(), [](const auto& law) { return law.reaction.presses(); });
    if (!is_pressed || given.multiplier.size() != c) found_.state.multiplier = Vector::Zero(c);
    force_.resize(n);
    product_.resize(n);
    constraint_.resize(c);
    next_ = given.q;
    extent_ = mechanism_.extent(given.q);
    (void)locks_.meet(found_.state, extent_);
    sizes_.resize(n);
    for (Index i = 0; i < n; ++i)
      sizes_[i] = mechanism_.model().is_rotation[static_cast<std::size_t>(i)] != 0 ? 1.0 : extent_;
    inertia_ = mechanism_.mass().diagonal();
    reference_ =
        mechanism_.reference() > 0.0 ? mechanism_.reference() : std::sqrt(sizes_.dot(inertia_.cwiseProduct(sizes_)));
  }

  /// Downhill from a configuration that may be far away.
  MechanismEquilibrium downhill() {
    scale_ = stiffness_per_mass();
    numerics::NewtonRules rules;
    rules.most_iterations =
        static_cast<int>(plan_.most_iterations / (locks_.any_open(found_.state) ? shorter_with_locks : 1.0));
    Downhill way(*this, rules.most_iterations);
    numerics::newton(way, rules);
    return found_;
  }

  /// Newton's method alone, under a share of the loads: quick near an equilibrium, stable or not. It begins anew where
  /// locks change, and the equations with them.
  /// @param load  [-]
  MechanismEquilibrium near(double load) {
    numerics::NewtonRules rules;
    rules.most_iterations = 30;  // it converges in ten, or not at all
    scale_ = stiffness_per_mass();
    numerics::NewtonReport report;
    do {
      Near way(*this, load);
      report = numerics::newton(way, rules);
      found_.iterations += report.iterations;
    } while (report.outcome == numerics::NewtonOutcome::stopped);
    return found_;
  }

 private:
  /// What leads from the state to the next one: `share` of the solution, and the size of the whole in the mass norm.
  struct Correction {
    double share, size;
  };

  /// Equilibrium under a share of the loads, as Newton's method sees it. Stops where locks change.
  struct Near : numerics::NewtonProblem {
    Near(Search& of, double load_) : s(of), load(load_), changes(of.locks_.changes()) {}

    double evaluate(bool /*with_tangent*/) { return s.linearise(0.0, load); }
    bool factorise() { return s.equations_.factorise(); }
    double correct() {
      correction = s.correct();
      return correction.size;
    }
    double longest_part() { return correction.share; }
    void move(double part) { (void)s.advance(part); }

    numerics::NewtonVerdict judge(const numerics::NewtonIteration&) {
      if (s.locks_.changes() != changes) return numerics::NewtonVerdict::stop;
      if (!s.is_small(correction)) return numerics::NewtonVerdict::go_on;
      if (!s.settles()) return numerics::NewtonVerdict::stop;
      s.found_.is_stable = s.factorise(least_shift * s.scale_, load) && s.equations_.matrix().is_positive();
      return numerics::NewtonVerdict::converged;
    }

    Search& s;
    double load;
    int changes;
    Correction correction{};
  };

  /// The same under all loads with K + shift M, as Newton's method sees it. Each evaluation raises the shift until the
  /// correction leads downhill.
  struct Downhill : numerics::NewtonProblem {
    Downhill(Search& of, int most_) : s(of), most(most_), shift(first_shift * of.scale_) {}

    double evaluate(bool /*with_tangent*/) {
      leads_downhill = false;
      for (; s.found_.iterations < most; ++s.found_.iterations) {
        if (!s.factorise(shift)) {
          if (!std::isfinite(s.found_.residual) || !(shift < most_shift * s.scale_)) break;
          shift *= 10.0;  // a pivot that vanishes does so with one shift
          continue;
        }
        norm = s.force_norm();
        const bool climbs = !s.equations_.matrix().is_positive() && shift < most_shift * s.scale_;
        correction = s.correct();
        leads_downhill = !climbs;
        if (leads_downhill || !std::isfinite(correction.size)) break;
        // Newton's method would climb, and a larger shift leads downhill; unless nothing is left to go.
        has_nothing_left = s.is_small(correction) && s.stands() && s.settles();
        if (has_nothing_left) break;
        shift *= 10.0;
      }
      return s.found_.residual;
    }

    bool is_solved(double) { return has_nothing_left; }
    bool factorise() { return leads_downhill; }
    double correct() { return correction.size; }
    double longest_part() { return correction.share; }
    void move(double part) { has_changed = s.advance(part); }

    numerics::NewtonVerdict judge(const numerics::NewtonIteration&) {
      if (!has_changed && s.is_small(correction) && shift <= settled * s.scale_) {
        if (s.settles()) {
          s.found_.is_stable = s.factorise(least_shift * s.scale_) && s.equations_.matrix().is_positive();
          return numerics::NewtonVerdict::converged;
        }
        has_changed = true;
      }
      ++s.found_.iterations;
      if (has_changed) {
        shift = std::max(shift, first_shift * s.scale_);
        last = HUGE_VAL;
        return numerics::NewtonVerdict::go_on;
      }
      // The shift falls as the residual does, and faster near the end; where the residual grows it stays.
      const double fall = std::isfinite(last) ? std::clamp(norm / last, 0.05, 1.0) : 1.0;
      shift = std::max(least_shift * s.scale_, shift * (correction.share == 1.0 ? std::min(fall, 0.5) : 1.0));
      last = norm;
      return numerics::NewtonVerdict::go_on;
    }

    Search& s;
    int most;
    double shift, norm = 0.0, last = HUGE_VAL;
    bool leads_downhill = false, has_nothing_left = false, has_changed = false;
    Correction correction{};
  };

  /// The residual under a share of the loads, and the matrix  K + shift M. Returns the largest force that is left.
  double linearise(double shift, double load = 1.0) {
    const system::MechanismEquations::Weights weights{shift, 0.0, 1.0, scale_, true};
    equations_.go_to_end(found_.state, model::Side::right);
    equations_.linearise(weights, found_.state.multiplier, force_, constraint_);
    if (load != 1.0) equations_.scale_loads(load, weights, force_);
    equations_.add_constraint_force(found_.state.multiplier, 1.0, force_);
    found_.residual = force_.size() > 0 ? force_.cwiseAbs().maxCoeff(&found_.worst) : 0.0;
    return found_.residual;
  }

  /// False where there are no numbers, or no factors.
  bool factorise(double shift, double load = 1.0) {
    return std::isfinite(linearise(shift, load)) && equations_.factorise();
  }

  Correction correct() {
    force_ = -force_;
    constraint_ = -constraint_;
    equations_.solve(force_, constraint_);
    mechanism_.times_mass(force_, product_);
    return {longest_share(), std::sqrt(std::max(force_.dot(product_), 0.0))};
  }

  /// Takes a share of the correction, up to the first lock. Returns whether that meets a lock.
  bool advance(double share) {
    system::State& state = found_.state;
    mechanism_.retract(state.q, share * force_, next_);
    if (locks_.passes(state, next_, extent_)) {
      // Up to the first lock: what lies behind it is not on the way.
      constexpr int halvings = 40;
      double before = 0.0;
      for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (before + share);
        mechanism_.retract(state.q, middle * force_, next_);
        (locks_.passes(state, next_, extent_) ? share : before) = middle;
      }
      mechanism_.retract(state.q, share * force_, next_);
    }
    std::swap(state.q, next_);
    state.multiplier += share * constraint_;
    return locks_.meet(state, extent_);
  }

  /// Whether all locks that hold press in the equilibrium that is found; those that would pull are opened.
  bool settles() {
    found_.is_found = !locks_.release(found_.state, extent_) && locks_.unsettled() < 0;
    found_.unsettled_lock = locks_.unsettled();
    return found_.is_found || found_.unsettled_lock >= 0;
  }

  bool is_small(const Correction& correction) const {
    return correction.share == 1.0 && correction.size <= plan_.tolerance * reference_;
  }

  /// Whether the state is an equilibrium of its own, from which all that goes downhill begins with round-off.
  bool stands() {
    if (!factorise(least_shift * scale_)) return false;
    const bool is_stable = equations_.matrix().is_positive();
    const Correction correction = correct();
    if (!is_small(correction) || advance(correction.share)) return false;
    found_.is_found = true;
    found_.is_stable = is_stable;
    return true;
  }

  static constexpr double shorter_with_locks = 0.2;
  static constexpr double settled = 1e-6;  // a shift that leaves a linear convergence of soft modes to be waited for

  /// Stiffness over mass of the mechanism in an arbitrary direction [1/s2], from a small motion along it: shifts by
  /// shares of the extent and turns by those of a radian, so that the units of the model are nothing to it.
  double stiffness_per_mass() {
    const Index n = mechanism_.size();
    Vector along(n), before(n), after(n);
    for (Index i = 0; i < n; ++i) along[i] = sizes_[i] * std::sin(1.0 + 2.4 * static_cast<double>(i));
    constexpr double step = 1e-6;
    system::State moved = found_.state;
    equations_.go_to_end(found_.state, model::Side::right);
    equations_.residual(before, constraint_);
    mechanism_.retract(found_.state.q, step * along, moved.q);
    equations_.go_to_end(moved, model::Side::right);
    equations_.residual(after, constraint_);
    mechanism_.times_mass(along, product_);
    const double mass = along.dot(product_);
    const double stiffness = std::abs((after - before).dot(along)) / step;
    equations_.external_force(after);
    const double loads = after.cwiseProduct(along).norm();  // where only loads and constraints hold it
    const double most = std::max(stiffness, loads);
    return most > 0.0 ? most / mass : 1.0;  // where nothing acts any scale serves
  }

  /// What is left of the equations, in the mass norm of the accelerations that it would make [m/s2 sqrt(kg)].
  double force_norm() const {
    return std::hypot(force_.cwiseQuotient(inertia_.cwiseSqrt()).norm(),
                      scale_ * equations_.matrix().gap_norm(constraint_));
  }

  /// The share of the correction that turns and shifts nothing too far.
  double longest_share() const {
    double turn = 0.0, way = 0.0;
    for (Index i = 0; i < force_.size(); ++i) {
      const bool is_rotation = mechanism_.model().is_rotation[static_cast<std::size_t>(i)] != 0;
      double& largest = is_rotation ? turn : way;
      largest = std::max(largest, std::abs(force_[i]));
    }
    // Where locks may be met joints must not come apart on the way: a lock out of reach would be.
    const double shorter = locks_.any_open(found_.state) ? shorter_with_locks : 1.0;
    double share = 1.0;
    if (turn > shorter * plan_.largest_turn) share = std::min(share, shorter * plan_.largest_turn / turn);
    if (way > shorter * plan_.largest_shift * extent_)
      share = std::min(share, shorter * plan_.largest_shift * extent_ / way);
    return share;
  }

  system::MechanismEquations& equations_;
  const system::Mechanism& mechanism_;
  EquilibriumPlan plan_;
  ActiveLocks locks_;
  MechanismEquilibrium found_;
  Vector force_, product_, constraint_, next_;
  Vector sizes_;    // what a unit of a coordinate is compared with: the extent, or a radian [n]
  Vector inertia_;  // diagonal of M [n]
  double extent_ = 1.0, reference_ = 1.0, scale_ = 1.0;
};

/// Raises the loads from zero. Where it fails the state is the last equilibrium that was found, at a share of the
/// loads.
MechanismEquilibrium by_load_steps(system::MechanismEquations& equations, const system::State& given,
                                   const EquilibriumPlan& plan) {
  MechanismEquilibrium last, tried;
  last.state = given;
  last.load = 0.0;
  double step = plan.first_load_step;
  int iterations = 0, steps = 0;
  while (last.load < 1.0 && step >= plan.least_load_step) {
    const double load = last.load + step >= 1.0 - 1e-9 ? 1.0 : last.load + step;
    tried = Search(equations, last.state, plan).near(load);
    iterations += tried.iterations;
    if (tried.is_found) {
      last = std::move(tried);
      last.load = load;
      ++steps;
      step *= 2.0;
    } else {
      step *= 0.5;
    }
  }
  last.iterations = iterations;
  last.load_steps = steps;
  if (last.load == 1.0) return last;
  last.is_found = false;
  last.residual = tried.residual;
  last.worst = tried.worst;
  return last;
}

}  // namespace

MechanismEquilibrium find_equilibrium(system::MechanismEquations& equations, const system::State& given,
                                      const EquilibriumPlan& plan) {
  // However far the search goes, laws see one way without a turn from the configuration given.
  system::State at_rest = given;
  at_rest.v.setZero();
  equations.begin_step(at_rest);
  MechanismEquilibrium found = Search(equations, given, plan).downhill();
  if (!found.is_found && found.unsettled_lock < 0) {
    MechanismEquilibrium raised = by_load_steps(equations, given, plan);
    raised.iterations += found.iterations;
    if (raised.load > 0.0) {
      found = std::move(raised);
    } else {
      found.iterations = raised.iterations;
      found.load = 0.0;
    }
  }
  equations.move_laws(found.state);
  return found;
}

}  // namespace rubato::integrate
