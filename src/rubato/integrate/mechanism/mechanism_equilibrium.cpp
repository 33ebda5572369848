#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/integrate/mechanism/met_locks.hpp>

#include <algorithm>
#include <cmath>

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
    found_.state.multiplier = Vector::Zero(c);
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
    double shift = first_shift * scale_, last = HUGE_VAL;
    const int most =
        static_cast<int>(plan_.most_iterations / (locks_.any_open(found_.state) ? shorter_with_locks : 1.0));
    for (found_.iterations = 0; found_.iterations < most; ++found_.iterations) {
      if (!factorise(shift)) {
        if (!std::isfinite(found_.residual) || !(shift < most_shift * scale_)) return found_;
        shift *= 10.0;  // a pivot that vanishes does so with one shift
        continue;
      }
      const double norm = force_norm();
      const bool climbs = !equations_.is_positive() && shift < most_shift * scale_;
      const Correction correction = correct();
      if (!std::isfinite(correction.size)) return found_;
      if (climbs) {
        // Newton's method would climb, and a larger shift leads downhill; unless nothing is left to go.
        if (is_small(correction) && stands() && settles()) return found_;
        shift *= 10.0;
        continue;
      }
      bool has_changed = advance(correction);
      if (!has_changed && is_small(correction) && shift <= settled * scale_) {
        found_.is_found = true;
        if (settles()) {
          found_.is_stable = factorise(least_shift * scale_) && equations_.is_positive();
          return found_;
        }
        has_changed = true;
      }
      if (has_changed) {
        shift = std::max(shift, first_shift * scale_);
        last = HUGE_VAL;
        continue;
      }
      // The shift falls as the residual does, and faster near the end; where the residual grows it stays.
      const double fall = std::isfinite(last) ? std::clamp(norm / last, 0.05, 1.0) : 1.0;
      shift = std::max(least_shift * scale_, shift * (correction.share == 1.0 ? std::min(fall, 0.5) : 1.0));
      last = norm;
    }
    return found_;
  }

  /// Newton's method alone, under a share of the loads: quick near an equilibrium, stable or not.
  /// @param load  [-]
  MechanismEquilibrium near(double load) {
    constexpr int enough = 30;  // it converges in ten, or not at all
    scale_ = stiffness_per_mass();
    for (found_.iterations = 0; found_.iterations < enough * (1 + locks_.changes()); ++found_.iterations) {
      if (!factorise(0.0, load)) return found_;
      const Correction correction = correct();
      if (!std::isfinite(correction.size)) return found_;
      if (advance(correction) || !is_small(correction)) continue;
      found_.is_found = true;
      if (!settles()) continue;
      found_.is_stable = factorise(least_shift * scale_, load) && equations_.is_positive();
      return found_;
    }
    return found_;
  }

 private:
  /// What leads from the state to the next one: `share` of the solution, and the size of the whole in the mass norm.
  struct Correction {
    double share, size;
  };

  /// The residual and the factors of  K + shift M  under a share of the loads; false where they are no numbers.
  bool factorise(double shift, double load = 1.0) {
    const system::MechanismEquations::Weights weights{shift, 0.0, 1.0, scale_};
    equations_.go_to(found_.state, model::Side::right);
    equations_.linearise(weights, found_.state.multiplier, force_, constraint_);
    if (load != 1.0) equations_.scale_loads(load, weights, force_);
    equations_.add_constraint_force(found_.state.multiplier, 1.0, force_);
    found_.residual = force_.size() > 0 ? force_.cwiseAbs().maxCoeff(&found_.worst) : 0.0;
    return std::isfinite(found_.residual) && equations_.factorise();
  }

  Correction correct() {
    force_ = -force_;
    constraint_ = -constraint_;
    equations_.solve(force_, constraint_);
    mechanism_.times_mass(force_, product_);
    return {longest_share(), std::sqrt(std::max(force_.dot(product_), 0.0))};
  }

  /// Returns whether that meets a lock.
  bool advance(const Correction& correction) {
    system::State& state = found_.state;
    double share = correction.share;
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
    const bool is_stable = equations_.is_positive();
    const Correction correction = correct();
    if (!is_small(correction) || advance(correction)) return false;
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
    equations_.go_to(found_.state, model::Side::right);
    equations_.residual(before, constraint_);
    mechanism_.retract(found_.state.q, step * along, moved.q);
    equations_.go_to(moved, model::Side::right);
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
    return std::hypot(force_.cwiseQuotient(inertia_.cwiseSqrt()).norm(), scale_ * equations_.gap_norm(constraint_));
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
  MetLocks locks_;
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
  MechanismEquilibrium at_once = Search(equations, given, plan).downhill();
  if (at_once.is_found || at_once.unsettled_lock >= 0) return at_once;
  MechanismEquilibrium raised = by_load_steps(equations, given, plan);
  raised.iterations += at_once.iterations;
  if (raised.load > 0.0) return raised;
  at_once.iterations = raised.iterations;
  at_once.load = 0.0;
  return at_once;
}

}  // namespace rubato::integrate
