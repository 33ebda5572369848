#include <rubato/integrate/equilibrium/easiest_motion.hpp>
#include <rubato/integrate/equilibrium/static_by_growth.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

class Growth final : public numerics::NewtonProblem {
 public:
  Growth(const system::LocallyNonlinear& system, std::span<const model::Held> held)
      : system_(system), held_(held), load_(system.size()), place_(static_cast<std::size_t>(system.size()), 0) {
    system::Loads loads = system.loads();
    loads.evaluate_static(0.0, load_, model::Side::left);
    for (const auto& force : system.held_forces()) load_[force.coordinate] += force.value;
    for (const auto& one : held) place_[static_cast<std::size_t>(one.coordinate)] = ground;
    for (Index i = 0; i < system.size(); ++i) {
      if (place_[static_cast<std::size_t>(i)] == ground) continue;
      place_[static_cast<std::size_t>(i)] = static_cast<Index>(free_.size());
      free_.push_back(i);
    }
    state_ = system.start();
    state_.t = 0.0;
    state_.q.setZero();
    state_.memory.setZero();
    slope_.setZero(system.contact_count());
    change_.setZero(system.size());
    accepted_ = state_.q;
  }

  StaticEquilibrium solve() {
    StaticEquilibrium result;
    constexpr double least_step = 1e-6;
    double reached = 0.0, step = 1.0;
    Vector known = state_.q;
    while (reached < 1.0) {
      share_ = std::min(1.0, reached + step);
      for (const auto& one : held_) state_.q[one.coordinate] = share_ * one.value;
      accepted_ = state_.q;
      if (numerics::newton(*this, rules()).has_converged() && is_stable()) {
        reached = share_;
        known = state_.q;
        step *= 2.0;
        continue;
      }
      state_.q = known;
      step = 0.5 * (share_ - reached);
      if (!(step >= least_step)) break;
    }
    share_ = reached;
    evaluate(true);
    result.factorisations = factorisations_;
    result.reached = reached;
    if (reached == 0.0 && !is_stable()) {
      result.outcome = StaticOutcome::mechanism;
      for (const Index i : moving_) result.moving.push_back(free_[static_cast<std::size_t>(i)]);
      return result;
    }
    if (reached < 1.0) {
      result.outcome = StaticOutcome::gives_way_on_the_way;
      name_easiest(result);
      return result;
    }
    result.outcome = StaticOutcome::found;
    result.reaction.resize(static_cast<Index>(held_.size()));
    for (std::size_t i = 0; i < held_.size(); ++i)
      result.reaction[static_cast<Index>(i)] = -residual_[held_[i].coordinate];
    result.state = state_;
    return result;
  }

  // What numerics::newton asks for.
  double evaluate(bool) {
    load_contacts();
    residual_ = share_ * load_ - system_.stiffness() * state_.q;
    system_.add_slider_forces(state_.slider_force, -1.0, residual_);
    // Round-off of the sum at each coordinate.
    Vector terms = share_ * load_.cwiseAbs() + system_.stiffness().cwiseAbs() * state_.q.cwiseAbs();
    for (Index i = 0; i < system_.contact_count(); ++i)
      for (const Index end : ends(i))
        if (end != ground)
          terms[end] += std::abs(state_.slider_force[i]) +
                        std::abs(slope_[i]) * std::abs(system_.relative_displacement(i, state_.q));
    is_round_off_ = true;
    double sum = 0.0;
    for (const Index i : free_) {
      is_round_off_ = is_round_off_ && std::abs(residual_[i]) <= 1e-14 * terms[i];
      const double stiffness = system_.stiffness().coeff(i, i) + of_contacts(i);
      sum += residual_[i] * residual_[i] / std::max(stiffness, 1e-300);
    }
    return std::sqrt(sum);
  }
  bool is_solved(double) const { return is_round_off_; }
  bool factorise() {
    if (free_.empty()) return true;
    ++factorisations_;
    return factor_.factorise(analysed_tangent());
  }
  double correct() {
    Vector right(static_cast<Index>(free_.size())), solution;
    for (std::size_t i = 0; i < free_.size(); ++i) right[static_cast<Index>(i)] = residual_[free_[i]];
    if (!free_.empty()) factor_.solve(right, solution);
    for (std::size_t i = 0; i < free_.size(); ++i) change_[free_[i]] = solution[static_cast<Index>(i)];
    return change_.norm();
  }
  void move(double part) { state_.q = accepted_ + part * change_; }
  void accept(double) { accepted_ = state_.q; }
  /// A correction below round-off ends the iteration where the residual keeps more of it.
  numerics::NewtonVerdict judge(const numerics::NewtonIteration&) const {
    return change_.norm() <= 1e-15 * state_.q.norm() ? numerics::NewtonVerdict::converged
                                                     : numerics::NewtonVerdict::go_on;
  }
  bool may_be_halved(double) const { return !is_round_off_; }
  bool is_lower(double residual, double before, double part) const {
    return is_round_off_ || residual < (1.0 - 0.1 * part) * before;
  }

 private:
  static numerics::NewtonRules rules() {
    numerics::NewtonRules rules;
    rules.most_iterations = 60;
    rules.most_halvings = 30;
    rules.memory = 3;
    return rules;
  }

  std::array<Index, 2> ends(Index contact) const {
    const auto& both = system_.contacts()[static_cast<std::size_t>(contact)];
    return {both.first, both.second};
  }

  double of_contacts(Index coordinate) const {
    double sum = 0.0;
    for (Index i = 0; i < system_.contact_count(); ++i)
      for (const Index end : ends(i))
        if (end == coordinate) sum += std::abs(slope_[i]);
    return sum;
  }

  /// Forces and slopes of all contacts where q is.
  void load_contacts() {
    for (Index i = 0; i < system_.contact_count(); ++i) {
      const double u = system_.relative_displacement(i, state_.q);
      double& force = state_.slider_force[i];
      if (i < system_.slider_count()) {
        const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
        force = std::clamp(slider.stiffness * u, -slider.limit, slider.limit);
        slope_[i] = std::abs(slider.stiffness * u) <= slider.limit ? slider.stiffness : 0.0;
      } else if (i < system_.first_law()) {
        const auto& stop = system_.stops()[static_cast<std::size_t>(i - system_.slider_count())];
        force = stop.stiffness * std::max(0.0, u - stop.gap);
        slope_[i] = u > stop.gap ? stop.stiffness : 0.0;
      } else {
        const Index law = i - system_.first_law(), memory = system_.memory_of(law);
        virgin_.setZero(system_.memory_size());
        const model::LawPoint from{0.0, 0.0, 0.0, model::Side::left}, to{u, 0.0, 0.0, model::Side::left};
        const model::LawAnswer answer = system_.laws()[static_cast<std::size_t>(law)].law->advance(
            from, virgin_.data() + memory, to, state_.memory.data() + memory);
        force = answer.force;
        slope_[i] = answer.by_u;
      }
    }
  }

  SparseMatrix tangent() const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](Index row, Index column, double value) {
      const Index i = place_[static_cast<std::size_t>(row)], j = place_[static_cast<std::size_t>(column)];
      if (i != ground && j != ground) entries.emplace_back(i, j, value);
    };
    for (Index column = 0; column < system_.size(); ++column)
      for (SparseMatrix::InnerIterator entry(system_.stiffness(), column); entry; ++entry)
        add(entry.row(), column, entry.value());
    for (Index i = 0; i < system_.contact_count(); ++i) {
      const auto [first, second] = ends(i);
      if (first != ground) add(first, first, slope_[i]);
      if (second != ground) add(second, second, slope_[i]);
      if (first == ground || second == ground) continue;
      add(first, second, -slope_[i]);
      add(second, first, -slope_[i]);
    }
    const auto n = static_cast<Index>(free_.size());
    for (Index i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);  // the diagonal is always there
    SparseMatrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  SparseMatrix analysed_tangent() {
    SparseMatrix matrix = tangent();
    if (!is_analysed_) factor_.analyse(matrix);
    is_analysed_ = true;
    return matrix;
  }

  bool is_stable() {
    return free_.empty() ||
           factorise_resisting(analysed_tangent(), numerics::Pivots::positive, factor_, factorisations_, moving_);
  }

  /// The coordinates that a little more of the loads would move most.
  void name_easiest(StaticEquilibrium& result) {
    if (!factorise()) return;
    residual_ = load_;
    correct();
    const Vector size = change_.cwiseAbs();
    for (const Index i : free_)
      if (size[i] > 0.1 * size.maxCoeff()) result.moving.push_back(i);
  }

  const system::LocallyNonlinear& system_;
  std::span<const model::Held> held_;
  Vector load_;
  std::vector<Index> place_, free_;  // place of a coordinate among the free ones, and back
  std::vector<Index> moving_;        // places of the easiest motion
  numerics::OrderedFactor factor_;
  bool is_analysed_ = false, is_round_off_ = false;
  int factorisations_ = 0;
  double share_ = 1.0;  // of the loads
  system::State state_;
  Vector accepted_, change_, residual_, slope_, virgin_;
};

}  // namespace

StaticEquilibrium grow_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held) {
  return Growth(system, held).solve();
}

}  // namespace rubato::integrate
