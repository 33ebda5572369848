#include <rubato/integrate/equilibrium/easiest_motion.hpp>
#include <rubato/integrate/equilibrium/rounding.hpp>
#include <rubato/integrate/equilibrium/static_by_growth.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/numerics/definiteness.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double drift = 1e-9;       // of its stiffness that an open stop lends where nothing else resists
constexpr double round_off = 1e-12;  // of a relative displacement: a step as short changes no contact

/// Forces of the sliders and stops for given displacements.
class Contacts {
 public:
  explicit Contacts(const system::LocallyNonlinear& system) : system_(system), force(system.contact_count()) {}

  void load(const Vector& q) {
    for (Index i = 0; i < system_.slider_count(); ++i) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      force[i] = std::clamp(slider.stiffness * system_.relative_displacement(i, q), -slider.limit, slider.limit);
    }
    for (Index j = 0; j < system_.stop_count(); ++j) {
      const auto& stop = system_.stops()[static_cast<std::size_t>(j)];
      const Index i = system_.slider_count() + j;
      force[i] = stop.stiffness * std::max(0.0, system_.relative_displacement(i, q) - stop.gap);
    }
  }
  /// Sliders that stick and stops that are closed.
  std::vector<char> holding(const Vector& q) const {
    std::vector<char> set(system_.contacts().size());
    const std::size_t sliders = system_.sliders().size();
    for (std::size_t i = sliders; i < set.size(); ++i)
      set[i] = system_.relative_displacement(static_cast<Index>(i), q) > system_.stops()[i - sliders].gap;
    for (std::size_t i = 0; i < sliders; ++i)
      set[i] = std::abs(system_.sliders()[i].stiffness * system_.relative_displacement(static_cast<Index>(i), q)) <=
               system_.sliders()[i].limit;
    return set;
  }

 private:
  const system::LocallyNonlinear& system_;

 public:
  Vector force;  ///< fc [m]
};

class StaticSolver {
 public:
  StaticSolver(const system::LocallyNonlinear& system, std::span<const model::Held> held)
      : system_(system), held_(held), contacts_(system), load_(system.size()), place_(system.size()) {
    system::Loads loads = system.loads();
    loads.evaluate_static(0.0, load_, model::Side::left);
    for (const auto& force : system.held_forces()) load_[force.coordinate] += force.value;
    std::fill(place_.begin(), place_.end(), 0);
    result_.state = system.start();
    result_.state.t = 0.0;
    result_.state.q.setZero();
    for (const auto& displacement : held) {
      result_.state.q[displacement.coordinate] = displacement.value;
      place_[static_cast<std::size_t>(displacement.coordinate)] = ground;
    }
    for (Index i = 0; i < system.size(); ++i) {
      if (place_[static_cast<std::size_t>(i)] == ground) continue;
      place_[static_cast<std::size_t>(i)] = static_cast<Index>(free_.size());
      free_.push_back(i);
    }
  }

  StaticEquilibrium solve() {
    Settling settling(*this);
    numerics::NewtonRules rules;
    // Each contact changes its state a few times at most; the energy falls with every step.
    rules.most_iterations = 20 + 10 * static_cast<int>(settling.set.size());
    switch (numerics::newton(settling, rules).outcome) {
      case numerics::NewtonOutcome::converged:
        for (int refinement = 0; refinement < 2; ++refinement) {
          settling.correct();
          settling.move(settling.longest_part());
        }
        finish();
        return std::move(result_);
      case numerics::NewtonOutcome::singular:
        return no_equilibrium(settling.set);
      default:
        result_.outcome = StaticOutcome::not_settled;
        return std::move(result_);
    }
  }

 private:
  /// The equilibrium as Newton's method sees it: the tangent is that of a set of contacts that hold, and has converged
  /// where a whole step changes no contact.
  struct Settling : numerics::NewtonProblem {
    // Sliders begin stuck, stops as they are without displacement.
    explicit Settling(StaticSolver& of) : s(of), q(of.result_.state.q), set(of.contacts_.holding(q)) {
      std::fill_n(set.begin(), s.system_.sliders().size(), 1);
    }

    double evaluate(bool /*with_tangent*/) { return 0.0; }

    bool factorise() {
      while (!s.factorise(set, 0.0)) {
        // What only open stops could hold drifts to the first of them.
        const Index met = s.has_open_stop(set) && s.factorise(set, drift) ? s.drift_to_stop(set) : -1;
        if (met < 0) return false;
        set[static_cast<std::size_t>(met)] = 1;
      }
      return true;
    }

    double correct() {
      change = s.change_of(s.unbalanced(q));
      changes = s.changes_along(q, change);
      return change.allFinite() ? change.cwiseAbs().maxCoeff() : HUGE_VAL;
    }

    // Newton's step is shortened to where the energy is least along it.
    double longest_part() { return changes.empty() ? 1.0 : s.least_energy_along(q, change, changes); }

    void move(double part) { q += part * change; }

    numerics::NewtonVerdict judge(const numerics::NewtonIteration&) {
      std::vector<char> next = s.contacts_.holding(q);
      const bool has_settled = changes.empty() && next == set;
      set = std::move(next);
      return has_settled ? numerics::NewtonVerdict::converged : numerics::NewtonVerdict::go_on;
    }

    StaticSolver& s;
    Vector& q;
    std::vector<char> set;  // sliders that stick and stops that are closed
    Vector change;
    std::vector<double> changes;  // parts of it at which contacts change their states
  };

  bool has_open_stop(const std::vector<char>& set) const {
    return std::find(set.begin() + system_.slider_count(), set.end(), 0) != set.end();
  }

  Vector change_of(const Vector& residual) const {
    if (free_.empty()) return Vector::Zero(system_.size());
    Vector right(static_cast<Index>(free_.size()));
    for (std::size_t i = 0; i < free_.size(); ++i) right[static_cast<Index>(i)] = residual[free_[i]];
    Vector solution;
    factor_.solve(right, solution);
    Vector change = Vector::Zero(system_.size());
    for (std::size_t i = 0; i < free_.size(); ++i) change[free_[i]] = solution[static_cast<Index>(i)];
    return change;
  }

  /// Moves along the unbalanced forces until the first open stop closes, and returns it; -1 if none is on the way.
  Index drift_to_stop(const std::vector<char>& set) {
    Vector& q = result_.state.q;
    const Vector change = change_of(unbalanced(q));
    double nearest = HUGE_VAL;
    Index met = -1;
    for (Index i = system_.slider_count(); i < system_.contact_count(); ++i) {
      if (set[static_cast<std::size_t>(i)]) continue;
      const double gap = system_.stops()[static_cast<std::size_t>(i - system_.slider_count())].gap;
      const double approach = system_.relative_displacement(i, change);
      const double length = (gap - system_.relative_displacement(i, q)) / approach;
      if (!(approach > 0.0 && length < nearest)) continue;
      nearest = length;
      met = i;
    }
    if (met >= 0) q += nearest * change;
    return met;
  }

  StaticEquilibrium no_equilibrium(const std::vector<char>& set) {
    const auto sliders_end = set.begin() + system_.slider_count();
    const bool all_stick = std::find(set.begin(), sliders_end, 0) == sliders_end;
    result_.outcome = all_stick ? StaticOutcome::mechanism : StaticOutcome::gives_way;
    return std::move(result_);
  }

  double stiffness_of(std::size_t contact) const {
    const std::size_t sliders = system_.sliders().size();
    return contact < sliders ? system_.sliders()[contact].stiffness : system_.stops()[contact - sliders].stiffness;
  }

  /// @param open  share of their stiffness that open stops have
  SparseMatrix tangent(const std::vector<char>& set, double open) const {
    std::vector<Eigen::Triplet<double>> entries;
    const SparseMatrix& k = system_.stiffness();
    entries.reserve(static_cast<std::size_t>(k.nonZeros()) + free_.size() + 4 * set.size());
    const auto add = [&](Index row, Index column, double value) {
      const Index i = place_[static_cast<std::size_t>(row)], j = place_[static_cast<std::size_t>(column)];
      if (i != ground && j != ground) entries.emplace_back(i, j, value);
    };
    for (Index column = 0; column < k.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(k, column); entry; ++entry) add(entry.row(), column, entry.value());
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double share = set[i] ? 1.0 : i < system_.sliders().size() ? 0.0 : open;
      if (share == 0.0) continue;
      const double stiffness = share * stiffness_of(i);
      const std::vector<model::Share> joined = system_.column(static_cast<Index>(i));
      for (const model::Share& row : joined)
        for (const model::Share& other : joined)
          add(row.coordinate, other.coordinate, row.weight * other.weight * stiffness);
    }
    const auto n = static_cast<Index>(free_.size());
    for (Index i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);  // the diagonal is always there
    SparseMatrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  bool factorise(const std::vector<char>& set, double open) {
    if (free_.empty()) return true;
    const SparseMatrix matrix = tangent(set, open);
    factor_.analyse(matrix);
    std::vector<Index> moving;
    if (factorise_resisting(matrix, numerics::Pivots::nonzero, factor_, result_.factorisations, moving)) return true;
    result_.moving.clear();
    for (const Index i : moving) result_.moving.push_back(free_[static_cast<std::size_t>(i)]);
    return false;
  }

  /// Where between 0 and 1 contacts change their states on the way along `change`, rising.
  std::vector<double> changes_along(const Vector& q, const Vector& change) const {
    std::vector<double> lengths;
    for (Index i = 0; i < system_.contact_count(); ++i) {
      const double u = system_.relative_displacement(i, q), rate = system_.relative_displacement(i, change);
      const auto meet = [&](double threshold) {
        if (!(std::abs(rate) > round_off * std::max(std::abs(u), std::abs(threshold)))) return;
        const double length = (threshold - u) / rate;
        if (length > 0.0 && length < 1.0) lengths.push_back(length);
      };
      if (i < system_.slider_count()) {
        const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
        meet(slider.limit / slider.stiffness);
        meet(-slider.limit / slider.stiffness);
      } else {
        meet(system_.stops()[static_cast<std::size_t>(i - system_.slider_count())].gap);
      }
    }
    std::sort(lengths.begin(), lengths.end());
    return lengths;
  }

  /// The slope of the energy along `change` is straight between the changes of contacts, and rises.
  double least_energy_along(const Vector& q, const Vector& change, std::vector<double> lengths) {
    lengths.push_back(1.0);
    double before = 0.0, slope_before = -change.dot(unbalanced(q));
    for (const double length : lengths) {
      const double slope = -change.dot(unbalanced(q + length * change));
      if (slope >= 0.0)
        return slope > slope_before ? before - (length - before) * slope_before / (slope - slope_before) : length;
      before = length;
      slope_before = slope;
    }
    return 1.0;
  }

  Vector unbalanced(const Vector& q) {
    contacts_.load(q);
    Vector residual = load_ - system_.stiffness() * q;
    system_.add_slider_forces(contacts_.force, -1.0, residual);
    return residual;
  }

  void finish() {
    const Vector residual = unbalanced(result_.state.q);
    result_.state.slider_force = contacts_.force;
    result_.reaction.resize(static_cast<Index>(held_.size()));
    for (std::size_t i = 0; i < held_.size(); ++i)
      result_.reaction[static_cast<Index>(i)] = -residual[held_[i].coordinate];
    result_.outcome = StaticOutcome::found;
    result_.rounding = rounding_of_stiffness(system_, free_, factor_, result_.state.q);
    result_.is_stable =
        free_.empty() || !numerics::is_indefinite(tangent(contacts_.holding(result_.state.q), 0.0), factor_);
  }

  const system::LocallyNonlinear& system_;
  std::span<const model::Held> held_;
  Contacts contacts_;
  Vector load_;
  std::vector<Index> place_, free_;  // place of a coordinate among the free ones, and back
  numerics::OrderedFactor factor_;
  StaticEquilibrium result_;
};

}  // namespace

StaticEquilibrium find_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held) {
  if (system.has_laws()) return grow_equilibrium(system, held);
  return StaticSolver(system, held).solve();
}

}  // namespace rubato::integrate
