#include <rubato/integrate/equilibrium/contact_tangent.hpp>
#include <rubato/integrate/equilibrium/contacts_from_rest.hpp>
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
constexpr double least_step = 1e-6;      // of the loads

class Growth final : public numerics::NewtonProblem {
 public:
  Growth(const system::LocallyNonlinear& system, std::span<const model::Held> held)
      : system_(system),
        contacts_(system),
        held_(held),
        load_(system.size()),
        place_(static_cast<std::size_t>(system.size()), 0) {
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
    change_.setZero(system.size());
    accepted_ = state_.q;
    for (Index i = 0; i < system.contact_count(); ++i) columns_.push_back(system.column(i));
    own_diagonal_ = system.stiffness().diagonal();
    magnitude_ = system.stiffness().cwiseAbs();
    most_summands_ = most_summands();
    tangent_.emplace(system, place_, static_cast<Index>(free_.size()));
    if (!free_.empty()) factor_.analyse(tangent_->with(contacts_.slope()));
    reach_.setZero(system.contact_count());
    for (const model::LawBetween& law : system.laws())
      slopes_are_bounded_ = slopes_are_bounded_ && std::isfinite(law.law->largest_stiffness());
  }

  StaticEquilibrium solve() {
    StaticEquilibrium result;
    const double reached = system_.block_count() > 0 ? grow_from_touch() : grow(0.0);
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
    contacts_.load(state_);
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
        diagonal_[place] += share * share * std::abs(contacts_.slope()[i]);
        terms_[place] += share * (std::abs(state_.slider_force[i]) + std::abs(contacts_.slope()[i]) * reach);
      }
    }
    contacts_.for_each_cross_slope([&](Index i, Index k, double slope) {
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
    if (!contacts_.is_symmetric()) return factorise_with_normals();
    return factor_.factorise(tangent_->with(contacts_.slope()));
  }
  double correct() {
    Vector right(static_cast<Index>(free_.size())), solution;
    for (std::size_t i = 0; i < free_.size(); ++i) right[static_cast<Index>(i)] = residual_[free_[i]];
    if (!free_.empty() && contacts_.is_symmetric())
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
  /// Raises something from a share that is known to be balanced to all of it, by steps that are as small as it takes.
  /// @return the share that was reached
  template <class Attempt>
  double raise(double reached, const Attempt& attempt) {
    double step = 1.0;
    Vector known = state_.q;
    while (reached < 1.0) {
      const double to = std::min(1.0, reached + step);
      if (attempt(to)) {
        reached = to;
        known = state_.q;
        step *= 2.0;
        continue;
      }
      state_.q = known;
      step = 0.5 * (to - reached);
      if (!(step >= least_step)) break;
    }
    return reached;
  }
  double grow(double from) {
    return raise(from, [this](double share) { return rests_under(share); });
  }
  /// From where q is.
  bool rests_under(double share) {
    share_ = share;
    for (const auto& one : held_) state_.q[one.coordinate] = share * one.value;
    accepted_ = state_.q;
    return is_balanced() && is_stable();
  }

  /// Where contacts just touch forces follow the loads in proportion from the start, and no share of the loads is
  /// easier than another. The way on which they open, stick and slip at first is that of contacts that are pressed a
  /// little, or a little apart, as this goes to zero.
  double grow_from_touch() {
    state_.q.setZero();
    if (rests_under(1.0)) return 1.0;
    state_.q.setZero();
    if (rests_under(least_step)) return grow(least_step);
    const double force = force_on_contacts();
    for (const double sense : {-1.0, 1.0}) {
      const auto widen = [&](double part) {
        for (Index b = 0; b < system_.block_count(); ++b)
          contacts_.widened()[b] = part * sense * force / normal_stiffness(b);
      };
      widen(1.0);
      state_.q.setZero();
      const bool begins = raise(0.0, [&](double part) { return rests_under(part * least_step); }) == 1.0;
      const bool leads = begins && raise(0.0, [&](double part) {
                                     widen(1.0 - part);
                                     return rests_under(least_step);
                                   }) == 1.0;
      contacts_.widened().setZero();
      if (leads) return grow(least_step);
    }
    state_.q.setZero();
    return 0.0;
  }
  double normal_stiffness(Index block) const {
    const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(block)].law;
    return law.limit_stiffness(law.size() - 1, true);
  }
  /// The largest that would press or pull a contact where all of them held, under the smallest share of the loads.
  double force_on_contacts() {
    share_ = least_step;
    state_.q.setZero();
    for (const auto& one : held_) state_.q[one.coordinate] = share_ * one.value;
    accepted_ = state_.q;
    evaluate(true);
    if (!factorise()) return 0.0;
    correct();
    double force = 0.0;
    for (Index b = 0; b < system_.block_count(); ++b) {
      const Index normal = system_.row_of_block(b) + system_.blocks()[static_cast<std::size_t>(b)].law->size() - 1;
      force = std::max(force, normal_stiffness(b) * std::abs(system_.relative_displacement(normal, change_)));
    }
    return force;
  }

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
      if (by < 0 || contacts_.by_normal()[law] == 0.0) continue;
      auto& change = changes[static_cast<std::size_t>(law)];
      for (const model::Share& share : columns_[static_cast<std::size_t>(by)])
        change.push_back({share.coordinate, contacts_.by_normal()[law] * contacts_.slope()[by] * share.weight});
      if (by >= system_.first_law())
        for (const model::Share& share : changes[static_cast<std::size_t>(by - system_.first_law())])
          change.push_back({share.coordinate, contacts_.by_normal()[law] * share.weight});
      for (const model::Share& row : columns_[static_cast<std::size_t>(system_.first_law() + law)])
        for (const model::Share& column : change) add(row, column, 1.0);
    }
    contacts_.for_each_cross_slope([&](Index i, Index k, double slope) {
      for (const model::Share& row : columns_[static_cast<std::size_t>(i)])
        for (const model::Share& column : columns_[static_cast<std::size_t>(k)]) add(row, column, slope);
    });
    const auto n = static_cast<Index>(free_.size());
    SparseMatrix added(n, n);
    added.setFromTriplets(entries.begin(), entries.end());
    unsymmetric_.compute(Eigen::SparseMatrix<double>(tangent_->with(contacts_.slope()) + added));
    return unsymmetric_.info() == Eigen::Success;
  }

  /// Pivots of the symmetric part find what nothing resists. A tangent that is not symmetric has given way, too, where
  /// its determinant has changed its sign.
  bool is_stable() {
    if (free_.empty()) return true;
    if (!factorise_resisting(tangent_->with(contacts_.slope()), numerics::Pivots::positive, factor_, factorisations_,
                             moving_))
      return false;
    return contacts_.is_symmetric() || (factorise_with_normals() && unsymmetric_.signDeterminant() > 0.0);
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
  ContactsFromRest contacts_;
  std::span<const model::Held> held_;
  Vector load_;
  std::vector<Index> place_, free_;  // place of a coordinate among the free ones, and back
  std::vector<Index> moving_;        // places of the easiest motion
  numerics::OrderedFactor factor_;
  std::optional<ContactTangent> tangent_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> unsymmetric_;  // where a normal force follows from the motion
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
  Vector accepted_, change_, residual_;
  Vector reach_;  // of each contact, what its u is made of
};

}  // namespace

StaticEquilibrium grow_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held) {
  return Growth(system, held).solve();
}

}  // namespace rubato::integrate
