#include <rubato/integrate/equilibrium/contact_tangent.hpp>
#include <rubato/integrate/equilibrium/easiest_motion.hpp>
#include <rubato/integrate/equilibrium/rounding.hpp>
#include <rubato/integrate/equilibrium/static_by_growth.hpp>
#include <rubato/numerics/newton.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rubato::integrate {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int operations_of_a_law = 32;  // roundings that its force may have

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
    for (Index i = 0; i < system.contact_count(); ++i) columns_.push_back(system.column(i));
    own_diagonal_ = system.stiffness().diagonal();
    magnitude_ = system.stiffness().cwiseAbs();
    most_summands_ = most_summands();
    tangent_.emplace(system, place_, static_cast<Index>(free_.size()));
    if (!free_.empty()) factor_.analyse(tangent_->with(slope_));
    reach_.setZero(system.contact_count());
    block_slopes_.resize(static_cast<std::size_t>(system.block_count()));
    take_normals();
    is_symmetric_ = is_symmetric_ && system.block_count() == 0;
    for (const model::LawBetween& law : system.laws())
      slopes_are_bounded_ = slopes_are_bounded_ && std::isfinite(law.law->largest_stiffness());
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
      if (is_balanced() && is_stable()) {
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
    result.rounding = rounding_of_stiffness(system_, free_, factor_, state_.q);
    return result;
  }

  // What numerics::newton asks for.
  double evaluate(bool) {
    load_contacts();
    residual_ = share_ * load_ - system_.stiffness() * state_.q;
    system_.add_slider_forces(state_.slider_force, -1.0, residual_);
    diagonal_ = own_diagonal_;
    // What the residual is made of, whose round-off it has. That of a contact comes with the places of its ends.
    terms_ = share_ * load_.cwiseAbs();
    terms_.noalias() += magnitude_ * state_.q.cwiseAbs();
    for (Index i = 0; i < system_.contact_count(); ++i) {
      double reach = 0.0;
      const auto& column = columns_[static_cast<std::size_t>(i)];
      for (const auto& [place, weight] : column) reach += std::abs(weight * state_.q[place]);
      reach_[i] = reach;
      for (const auto& [place, weight] : column) {
        const double share = std::abs(weight);
        diagonal_[place] += share * share * std::abs(slope_[i]);
        terms_[place] += share * (std::abs(state_.slider_force[i]) + std::abs(slope_[i]) * reach);
      }
    }
    for_each_cross_slope([&](Index i, Index k, double slope) {
      for (const auto& [place, weight] : columns_[static_cast<std::size_t>(i)])
        terms_[place] += std::abs(weight * slope) * reach_[k];
    });
    is_round_off_ = true;
    double sum = 0.0, of_terms = 0.0;
    for (const Index i : free_) {
      is_round_off_ = is_round_off_ && std::abs(residual_[i]) <= epsilon * terms_[i];
      const double stiffness = std::max(diagonal_[i], 1e-300);
      sum += residual_[i] * residual_[i] / stiffness;
      of_terms += terms_[i] * terms_[i] / stiffness;
    }
    of_terms_ = std::sqrt(of_terms);
    return std::sqrt(sum);
  }
  bool is_solved(double residual) {
    last_ = residual;
    may_be_enough_ = may_be_round_off(residual);
    return is_round_off_;
  }
  bool factorise() {
    if (free_.empty()) return true;
    ++factorisations_;
    if (!is_symmetric_) return factorise_with_normals();
    return factor_.factorise(tangent_->with(slope_));
  }
  double correct() {
    Vector right(static_cast<Index>(free_.size())), solution;
    for (std::size_t i = 0; i < free_.size(); ++i) right[static_cast<Index>(i)] = residual_[free_[i]];
    if (!free_.empty() && is_symmetric_)
      factor_.solve(right, solution);
    else if (!free_.empty())
      solution = unsymmetric_.solve(right);
    for (std::size_t i = 0; i < free_.size(); ++i) change_[free_[i]] = solution[static_cast<Index>(i)];
    return change_.norm();
  }
  void move(double part) { state_.q = accepted_ + part * change_; }
  void accept(double residual) {
    accepted_ = state_.q;
    has_stalled_ = residual > 0.5 * last_ && may_be_round_off(residual);
  }
  /// As refinement of linear equations ends (Higham 2002, section 12.2): a correction that no longer halves the
  /// residual repairs round-off alone.
  numerics::NewtonVerdict judge(const numerics::NewtonIteration&) const {
    return has_stalled_ ? numerics::NewtonVerdict::converged : numerics::NewtonVerdict::go_on;
  }
  bool may_be_halved(double) const { return !is_round_off_ && !may_be_enough_; }
  bool is_lower(double residual, double before, double part) const {
    return has_full_steps_ || is_round_off_ || residual < (1.0 - 0.1 * part) * before;
  }

 private:
  /// Newton's method to round-off of the residual.
  bool is_balanced() {
    const Vector begin = accepted_;
    const numerics::NewtonReport report = numerics::newton(*this, rules());
    if (report.has_converged()) return true;
    if (report.outcome == numerics::NewtonOutcome::diverged && may_be_enough_) {
      evaluate(true);  // no correction does better
      return true;
    }
    return slopes_are_bounded_ && is_balanced_by_full_steps(begin);
  }

  /// Over the kinks of laws that slip, open and close the residual may have to rise before it vanishes.
  bool is_balanced_by_full_steps(const Vector& begin) {
    state_.q = accepted_ = begin;
    has_full_steps_ = true;
    const bool is_found = numerics::newton(*this, rules()).has_converged();
    has_full_steps_ = false;
    return is_found;
  }

  /// Whether a residual is no larger than the sums at all coordinates may be off by together: one of m terms by m - 1
  /// roundings of them, besides those of the terms.
  bool may_be_round_off(double residual) const { return residual <= most_summands_ * epsilon * of_terms_; }

  /// Of the residual at a free coordinate.
  int most_summands() const {
    std::vector<int> count(place_.size(), 1);  // the load
    for (Index column = 0; column < system_.size(); ++column)
      for (SparseMatrix::InnerIterator entry(system_.stiffness(), column); entry; ++entry)
        ++count[static_cast<std::size_t>(entry.row())];
    for (Index i = 0; i < system_.contact_count(); ++i)
      for (const auto& share : columns_[static_cast<std::size_t>(i)])
        count[static_cast<std::size_t>(share.coordinate)] += i < system_.first_law() ? 1 : operations_of_a_law;
    int most = 0;
    for (const Index i : free_) most = std::max(most, count[static_cast<std::size_t>(i)]);
    return most;
  }

  static numerics::NewtonRules rules() {
    numerics::NewtonRules rules;
    rules.most_iterations = 60;
    rules.most_halvings = 30;
    rules.memory = 3;
    return rules;
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
        break;
      }
    }
    for (const Index law : system_.law_order()) load_law(law);
    for (Index b = 0; b < system_.block_count(); ++b) load_block(b);
  }

  /// From rest, in a straight line.
  void load_block(Index b) {
    const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(b)].law;
    const Index first = system_.row_of_block(b), memory = system_.memory_of_block(b);
    virgin_.setZero(system_.memory_size());
    model::BlockPoint to;
    for (Index i = 0; i < law.size(); ++i) to.u[i] = system_.relative_displacement(first + i, state_.q);
    model::BlockAnswer& answer = block_slopes_[static_cast<std::size_t>(b)];
    answer = law.advance({}, virgin_.data() + memory, to, state_.memory.data() + memory);
    for (Index i = 0; i < law.size(); ++i) {
      state_.slider_force[first + i] = answer.force[i];
      slope_[first + i] = answer.by_u[i][i];
    }
  }

  /// Of forces of blocks by other numbers than their own: take(contact, other contact, slope).
  template <class Take>
  void for_each_cross_slope(const Take& take) const {
    for (Index b = 0; b < system_.block_count(); ++b) {
      const Index first = system_.row_of_block(b), size = system_.blocks()[static_cast<std::size_t>(b)].law->size();
      const model::BlockAnswer& answer = block_slopes_[static_cast<std::size_t>(b)];
      for (Index i = 0; i < size; ++i)
        for (Index k = 0; k < size; ++k)
          if (i != k && answer.by_u[i][k] != 0.0) take(first + i, first + k, answer.by_u[i][k]);
    }
  }

  void load_law(Index law) {
    const Index i = system_.first_law() + law, memory = system_.memory_of(law);
    const double u = system_.relative_displacement(i, state_.q);
    virgin_.setZero(system_.memory_size());
    model::LawPoint from{0.0, 0.0, 0.0, model::Side::left}, to{u, 0.0, 0.0, model::Side::left};
    if (system_.has_normals()) {
      from.normal = normal_at_rest_[law];
      to.normal = system_.normal_force(law, state_, state_.slider_force, model::Side::left);
    }
    const model::LawAnswer answer = system_.laws()[static_cast<std::size_t>(law)].law->advance(
        from, virgin_.data() + memory, to, state_.memory.data() + memory);
    state_.slider_force[i] = answer.force;
    slope_[i] = answer.by_u;
    by_normal_[law] = answer.by_normal;
  }

  /// What presses where nothing has moved, from where normal forces grow with the motion.
  void take_normals() {
    by_normal_.setZero(system_.law_count());
    normal_at_rest_.setZero(system_.law_count());
    if (!system_.has_normals()) return;
    system::State rest = state_;
    rest.v.setZero();
    rest.slider_force.setZero();
    system_.set_stop_forces(rest);
    system_.set_law_forces(rest, model::Side::left);
    for (Index j = 0; j < system_.law_count(); ++j) {
      normal_at_rest_[j] = system_.normal_force(j, rest, rest.slider_force, model::Side::left);
      is_symmetric_ = is_symmetric_ && system_.normal_contact(j) < 0;
    }
  }

  /// With what normal forces that follow from the motion add: the force of a law changes by
  ///   df = slope b^T dq + (df/dN) dN,   dN the change of the force that presses, by the same formula,
  /// and with the slopes of blocks by other numbers than their own.
  bool factorise_with_normals() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](const model::Share& row, const model::Share& column, double slope) {
      const Index to = place_[static_cast<std::size_t>(row.coordinate)];
      const Index from = place_[static_cast<std::size_t>(column.coordinate)];
      if (to != ground && from != ground) entries.emplace_back(to, from, row.weight * column.weight * slope);
    };
    std::vector<std::vector<model::Share>> changes(static_cast<std::size_t>(system_.law_count()));
    for (const Index law : system_.law_order()) {
      const Index by = system_.normal_contact(law);
      if (by < 0 || by_normal_[law] == 0.0) continue;
      auto& change = changes[static_cast<std::size_t>(law)];
      for (const model::Share& share : columns_[static_cast<std::size_t>(by)])
        change.push_back({share.coordinate, by_normal_[law] * slope_[by] * share.weight});
      if (by >= system_.first_law())
        for (const model::Share& share : changes[static_cast<std::size_t>(by - system_.first_law())])
          change.push_back({share.coordinate, by_normal_[law] * share.weight});
      for (const model::Share& row : columns_[static_cast<std::size_t>(system_.first_law() + law)])
        for (const model::Share& column : change) add(row, column, 1.0);
    }
    for_each_cross_slope([&](Index i, Index k, double slope) {
      for (const model::Share& row : columns_[static_cast<std::size_t>(i)])
        for (const model::Share& column : columns_[static_cast<std::size_t>(k)]) add(row, column, slope);
    });
    const auto n = static_cast<Index>(free_.size());
    SparseMatrix added(n, n);
    added.setFromTriplets(entries.begin(), entries.end());
    unsymmetric_.compute(Eigen::SparseMatrix<double>(tangent_->with(slope_) + added));
    return unsymmetric_.info() == Eigen::Success;
  }

  /// Pivots of the symmetric part find what nothing resists. A tangent that is not symmetric has given way, too, where
  /// its determinant has changed its sign.
  bool is_stable() {
    if (free_.empty()) return true;
    if (!factorise_resisting(tangent_->with(slope_), numerics::Pivots::positive, factor_, factorisations_, moving_))
      return false;
    return is_symmetric_ || (factorise_with_normals() && unsymmetric_.signDeterminant() > 0.0);
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
  std::optional<ContactTangent> tangent_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> unsymmetric_;  // where a normal force follows from the motion
  bool is_symmetric_ = true;
  int factorisations_ = 0;
  double share_ = 1.0;  // of the loads
  system::State state_;
  Vector own_diagonal_;                             // of the stiffness without contacts
  SparseMatrix magnitude_;                          // of its entries
  Vector diagonal_, terms_;                         // with contacts; the sizes of what the residual sums up
  double of_terms_ = 0.0;                           // measured as the residual is
  std::vector<std::vector<model::Share>> columns_;  // of B
  int most_summands_ = 0;
  double last_ = 0.0;           // the residual at the last iterate that was accepted
  bool may_be_enough_ = false;  // likewise
  bool is_round_off_ = false, has_stalled_ = false;
  bool has_full_steps_ = false;     // whether the residual falls or not
  bool slopes_are_bounded_ = true;  // else an equilibrium far away may be one that loads do not lead to
  Vector accepted_, change_, residual_, slope_, virgin_;
  Vector reach_;  // of each contact, what its u is made of
  std::vector<model::BlockAnswer> block_slopes_;
  Vector by_normal_, normal_at_rest_;  // of each law: df/dN, and what presses where nothing has moved
};

}  // namespace

StaticEquilibrium grow_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held) {
  return Growth(system, held).solve();
}

}  // namespace rubato::integrate
