#include <rubato/integrate/law_problem.hpp>
#include <rubato/numerics/newton.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double enough = 16.0;  // of round-off

}  // namespace

/// The laws taken as linear rows of the complementarity problem; along the way to its solution sliders and stops stay
/// exact.
struct LawProblem::Iteration : numerics::NewtonProblem {
  Iteration(LawProblem& problem, const system::State& from_, system::State& to_) : p(problem), from(from_), to(to_) {}

  static constexpr numerics::NewtonRules rules() {
    numerics::NewtonRules rules;
    rules.most_iterations = 60;
    rules.most_halvings = 20;
    return rules;
  }
  double evaluate(bool) { return boxes_hold ? p.evaluate(p.trial_force_, to) : HUGE_VAL; }
  bool is_solved(double error) const { return error <= enough; }
  bool factorise() {
    p.linearise();
    if (!p.linearised_.solve(p.trial_.data(), from.slider_force.data(), p.next_.data(), p.penetration_.data()))
      return false;
    p.take_known_forces(has_full_steps);
    return true;
  }
  double correct() {
    p.next_ -= p.force_;
    return 1.0;  // the residual alone decides
  }
  void move(double part) {
    p.trial_force_ = p.force_ + part * p.next_;
    if (part > 0.0 && part < 1.0) boxes_hold = p.solve_boxes(from, p.trial_force_);
  }
  bool is_lower(double error, double before, double part) const {
    return has_full_steps || error < before * (1.0 - 1e-4 * part) || error <= enough;
  }
  bool may_be_halved(double) const { return boxes_hold; }
  void accept(double) { p.force_.swap(p.trial_force_); }

  LawProblem& p;
  const system::State& from;
  system::State& to;
  bool boxes_hold = true;
  bool has_full_steps = false;  ///< whether the residual falls or not
};

LawProblem::LawProblem(const system::LocallyNonlinear& system)
    : system_(system),
      m_(system.contact_count()),
      boxes_(system.first_law()),
      u_free_(m_),
      v_free_(m_),
      trial_(m_),
      penetration_(m_),
      box_trial_(boxes_),
      box_penetration_(boxes_),
      force_(m_),
      next_(m_),
      trial_force_(m_),
      u_(m_),
      v_(m_),
      size_(m_),
      start_(static_cast<std::size_t>(system.law_count())),
      end_(start_),
      answer_(start_.size()),
      block_start_(static_cast<std::size_t>(system.block_count())),
      block_end_(block_start_.size()),
      block_answer_(block_start_.size()),
      reach_(static_cast<std::size_t>(m_ - boxes_)),
      first_u_(m_),
      first_v_(m_),
      whole_u_(m_),
      whole_v_(m_),
      known_(m_),
      has_kinks_(system.has_normals() || system.block_count() > 0),
      slopes_are_bounded_(
          std::all_of(system.laws().begin(), system.laws().end(),
                      [](const model::LawBetween& law) { return std::isfinite(law.law->largest_stiffness()); })),
      joined_start_{0} {
  for (const model::BlockBetween& block : system.blocks()) block_velocity_.push_back(block.law->sliding_velocity());
  block_drift_.resize(block_velocity_.size());
  for (Index i = boxes_; i < m_; ++i) {
    const std::vector<model::Share> joined = system.column(i);
    joined_.insert(joined_.end(), joined.begin(), joined.end());
    joined_start_.push_back(joined_.size());
  }
}

void LawProblem::reset(const Matrix& compliance, const Matrix& velocity_compliance) {
  compliance_ = compliance;
  velocity_compliance_ = velocity_compliance;
  linearised_.reset(compliance, velocity_compliance, system_.sliders(), system_.stops(), m_ - boxes_);
  if (boxes_ > 0)
    boxes_alone_.reset(compliance.topLeftCorner(boxes_, boxes_), velocity_compliance.topLeftCorner(boxes_, boxes_),
                       system_.sliders(), system_.stops());
}

// As ContactProblem has them.
void LawProblem::set_box_trials(const system::State& from) {
  for (Index i = 0; i < boxes_; ++i) {
    penetration_[i] = 0.0;
    if (i < system_.slider_count()) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      trial_[i] = from.slider_force[i] + slider.stiffness * (u_free_[i] - system_.relative_displacement(i, from.q));
    } else {
      const auto& stop = system_.stops()[static_cast<std::size_t>(i - system_.slider_count())];
      penetration_[i] = u_free_[i] - stop.gap;
      trial_[i] = stop.stiffness * penetration_[i] + stop.damping * v_free_[i];
    }
  }
}

/// The forces of sliders and stops for given ones of the laws.
bool LawProblem::solve_boxes(const system::State& from, Vector& force) {
  if (boxes_ == 0) return true;
  const Index laws = m_ - boxes_;
  for (Index i = 0; i < boxes_; ++i) {
    const double u = compliance_.row(i).tail(laws).dot(force.tail(laws));
    if (i < system_.slider_count()) {
      box_trial_[i] = trial_[i] - system_.sliders()[static_cast<std::size_t>(i)].stiffness * u;
      box_penetration_[i] = 0.0;
    } else {
      const auto& stop = system_.stops()[static_cast<std::size_t>(i - system_.slider_count())];
      box_penetration_[i] = penetration_[i] - u;
      box_trial_[i] =
          trial_[i] - stop.stiffness * u - stop.damping * velocity_compliance_.row(i).tail(laws).dot(force.tail(laws));
    }
  }
  return boxes_alone_.solve(box_trial_.data(), from.slider_force.data(), force.data(), box_penetration_.data());
}

/// Answers of the laws where given forces lead, and the largest error of their equations, over their round-off.
double LawProblem::evaluate(const Vector& force, system::State& to) {
  u_ = u_free_;
  v_ = v_free_;
  const Index first = system_.has_normals() ? 0 : boxes_;  // stops may press on laws
  // Written out: calls of a product cost more than the product where there are a few laws.
  size_.setZero();
  for (Index j = 0; j < m_; ++j)
    for (Index i = first; i < m_; ++i) {
      const double change = compliance_(i, j) * force[j];
      u_[i] -= change;
      v_[i] -= velocity_compliance_(i, j) * force[j];
      size_[i] += std::abs(change);
    }
  double largest = 0.0;
  for (std::size_t j = 0; j < answer_.size(); ++j) {
    const Index i = boxes_ + static_cast<Index>(j), place = system_.memory_of(static_cast<Index>(j));
    end_[j].u = u_[i];
    end_[j].rate = v_[i];
    if (system_.has_normals()) press(static_cast<Index>(j), force);
    answer_[j] = system_.laws()[j].law->advance(start_[j], memory_ + place, end_[j], to.memory.data() + place);
    const double round_off = epsilon * (std::abs(answer_[j].force) + std::abs(force[i]) +
                                        std::abs(answer_[j].by_u) * (reach_[j] + size_[i]) +
                                        std::abs(answer_[j].by_rate) * (std::abs(v_free_[i]) + std::abs(v_[i])) +
                                        std::abs(answer_[j].by_normal * end_[j].normal));
    take_error(i, std::abs(answer_[j].force - force[i]), round_off, largest);
    if (largest == HUGE_VAL) return largest;
  }
  for (Index b = 0; b < system_.block_count() && largest < HUGE_VAL; ++b) evaluate_block(b, force, to, largest);
  return largest;
}

/// The largest error over its round-off so far; infinite from one that is no number on.
void LawProblem::take_error(Index contact, double error, double round_off, double& largest) {
  if (!std::isfinite(error)) {
    worst_ = contact;
    largest = HUGE_VAL;
    return;
  }
  const double share = error == 0.0 ? 0.0 : error / std::max(round_off, std::numeric_limits<double>::min());
  if (share >= largest) {
    largest = share;
    worst_ = contact;
  }
}

void LawProblem::evaluate_block(Index block, const Vector& force, system::State& to, double& largest) {
  const auto b = static_cast<std::size_t>(block);
  const model::BlockLaw& law = *system_.blocks()[b].law;
  const Index first = system_.row_of_block(block), place = system_.memory_of_block(block), size = law.size();
  for (Index r = 0; r < size; ++r) {
    block_end_[b].u[r] = u_[first + r];
    block_end_[b].rate[r] = v_[first + r];
  }
  if (block_velocity_[b] != 0.0) {
    block_end_[b].u[0] += block_drift_[b];
    block_end_[b].rate[0] += block_velocity_[b];
  }
  model::BlockAnswer& answer = block_answer_[b];
  answer = law.advance(block_start_[b], memory_ + place, block_end_[b], to.memory.data() + place);
  for (Index r = 0; r < size && largest < HUGE_VAL; ++r) {
    const Index i = first + r;
    double of_terms = std::abs(answer.force[r]) + std::abs(force[i]);
    for (Index k = 0; k < size; ++k)
      of_terms +=
          std::abs(answer.by_u[r][k]) * (reach_[static_cast<std::size_t>(first + k - boxes_)] + size_[first + k]) +
          std::abs(answer.by_rate[r][k]) * (std::abs(v_free_[first + k]) + std::abs(v_[first + k]));
    take_error(i, std::abs(answer.force[r] - force[i]), epsilon * of_terms, largest);
  }
}

/// What presses on a law at the end of the step; an open stop presses with less than nothing.
void LawProblem::press(Index law, const Vector& force) {
  const Index by = system_.normal_contact(law);
  if (by < 0) return;  // known from the start
  double& normal = end_[static_cast<std::size_t>(law)].normal;
  normal = force[by];
  if (by >= boxes_ || normal > 0.0) return;
  const model::Stop& stop = system_.stops()[static_cast<std::size_t>(by - system_.slider_count())];
  normal = std::min(0.0, stop.stiffness * (u_[by] - stop.gap));
}

void LawProblem::linearise() {
  for (std::size_t j = 0; j < answer_.size(); ++j) {
    const Index i = boxes_ + static_cast<Index>(j);
    const model::LawAnswer& a = answer_[j];
    linearised_.set_slopes(i, a.by_u, a.by_rate);
    trial_[i] = a.force + a.by_u * (u_free_[i] - u_[i]) + a.by_rate * (v_free_[i] - v_[i]);
    if (a.by_normal == 0.0) continue;
    const Index by = system_.normal_contact(static_cast<Index>(j));
    if (by < 0) continue;
    linearised_.add_slope(i, by, a.by_normal);
    trial_[i] -= a.by_normal * end_[j].normal;
  }
  for (Index b = 0; b < system_.block_count(); ++b) linearise_block(b);
}

void LawProblem::linearise_block(Index block) {
  const model::BlockAnswer& a = block_answer_[static_cast<std::size_t>(block)];
  const Index first = system_.row_of_block(block), size = system_.blocks()[static_cast<std::size_t>(block)].law->size();
  for (Index r = 0; r < size; ++r) {
    const Index i = first + r;
    trial_[i] = a.force[r];
    linearised_.set_slopes(i, 0.0, 0.0);
    for (Index k = 0; k < size; ++k) {
      if (a.by_u[r][k] == 0.0 && a.by_rate[r][k] == 0.0) continue;
      linearised_.add_slopes(i, first + k, a.by_u[r][k], a.by_rate[r][k]);
      trial_[i] +=
          a.by_u[r][k] * (u_free_[first + k] - u_[first + k]) + a.by_rate[r][k] * (v_free_[first + k] - v_[first + k]);
    }
  }
}

/// Forces that no other changes, of laws that slip or are open, without the round-off of the equations of others:
/// beside it the force of an open law would never be zero.
void LawProblem::take_known_forces(bool of_all_laws) {
  for (std::size_t j = 0; j < answer_.size(); ++j) {
    const model::LawAnswer& a = answer_[j];
    const bool is_known =
        a.by_u == 0.0 && a.by_rate == 0.0 && (a.by_normal == 0.0 || system_.normal_contact(static_cast<Index>(j)) < 0);
    const Index i = boxes_ + static_cast<Index>(j);
    if (is_known && (of_all_laws || system_.laws()[j].law->takes_normal())) next_[i] = trial_[i];
  }
  for (Index b = 0; b < system_.block_count(); ++b) {
    const model::BlockAnswer& a = block_answer_[static_cast<std::size_t>(b)];
    const Index first = system_.row_of_block(b), size = system_.blocks()[static_cast<std::size_t>(b)].law->size();
    for (Index r = 0; r < size; ++r)
      if (std::all_of(a.by_u[r], a.by_u[r] + size, [](double slope) { return slope == 0.0; }) &&
          std::all_of(a.by_rate[r], a.by_rate[r] + size, [](double slope) { return slope == 0.0; }))
        next_[first + r] = trial_[first + r];
  }
}

void LawProblem::start(const system::State& from, const system::State& to) {
  set_box_trials(from);
  memory_ = from.memory.data();
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const Index i = boxes_ + static_cast<Index>(j);
    start_[j] = {0.0, 0.0, from.t, model::Side::right};
    for (std::size_t s = joined_start_[j]; s < joined_start_[j + 1]; ++s) {
      start_[j].u += joined_[s].weight * from.q[joined_[s].coordinate];
      start_[j].rate += joined_[s].weight * from.v[joined_[s].coordinate];
    }
    end_[j].t = to.t;
    end_[j].side = model::Side::left;
    if (system_.has_normals()) {
      const Index law = static_cast<Index>(j);
      start_[j].normal = system_.normal_force(law, from, from.slider_force, model::Side::right);
      if (system_.normal_contact(law) < 0)
        end_[j].normal = system_.normal_force(law, to, from.slider_force, model::Side::left);
    }
    reach_[j] = std::max(std::abs(start_[j].u), std::abs(u_free_[i]));
    for (std::size_t s = joined_start_[j]; s < joined_start_[j + 1]; ++s)
      reach_[j] = std::max(reach_[j], std::abs(joined_[s].weight * from.q[joined_[s].coordinate]));
  }
  for (std::size_t b = 0; b < block_start_.size(); ++b) {
    const auto block = static_cast<Index>(b);
    block_start_[b] = system_.block_point(block, from);
    block_drift_[b] = block_velocity_[b] * to.t;
    const Index first = system_.row_of_block(block);
    for (Index i = first; i < first + system_.blocks()[b].law->size(); ++i) {
      const auto j = static_cast<std::size_t>(i - boxes_);
      reach_[j] = std::max(std::abs(block_start_[b].u[i - first]), std::abs(u_free_[i]));
      for (std::size_t s = joined_start_[j]; s < joined_start_[j + 1]; ++s)
        reach_[j] = std::max(reach_[j], std::abs(joined_[s].weight * from.q[joined_[s].coordinate]));
    }
  }
  force_ = from.slider_force;
}

/// Newton's method from the forces at hand, with memory and forces of the contacts as it leaves them.
/// @param good  the residual up to which a solution is one that no correction makes better
numerics::NewtonOutcome LawProblem::iterate(const system::State& from, system::State& to, bool has_full_steps,
                                            double good) {
  if (!solve_boxes(from, force_)) return numerics::NewtonOutcome::singular;
  trial_force_ = force_;
  Iteration iteration(*this, from, to);
  iteration.has_full_steps = has_full_steps;
  const numerics::NewtonReport report = numerics::newton(iteration, Iteration::rules());
  if (!(report.outcome == numerics::NewtonOutcome::diverged && iteration.boxes_hold && report.residual <= good))
    return report.outcome;
  evaluate(force_, to);  // as good as it gets
  return numerics::NewtonOutcome::converged;
}

StepReport LawProblem::solve(const system::State& from, system::State& to) {
  constexpr double fair = 1e6;    // a correction that no longer helps leaves at most 1e-10 of the forces
  constexpr double better = 1e3;  // beside a kink it may be a piece of the law that is not that of the solution
  start(from, to);
  numerics::NewtonOutcome outcome = iterate(from, to, false, has_kinks_ ? better : fair);
  if (outcome != numerics::NewtonOutcome::converged) {
    const Index worst = worst_;
    // Else a solution far away may be none of the motion from the start; the forces that press are near.
    bool is_solved = (slopes_are_bounded_ || has_kinks_) && solve_by_parts(from, to);
    if (!is_solved && has_kinks_) {
      force_ = from.slider_force;
      outcome = iterate(from, to, false, fair);
      is_solved = outcome == numerics::NewtonOutcome::converged;
    }
    if (!is_solved) {
      worst_ = worst;
      return failure(outcome == numerics::NewtonOutcome::not_finite ? StepOutcome::not_finite
                                                                    : StepOutcome::not_converged);
    }
  }
  // The forces that the laws have at the end are those that the step took.
  to.slider_force = force_;
  return {};
}

// Newton's method may turn in circles over the kinks of laws that slip, open and close. Full steps end at the piece of
// the solution if they end at all; where they do not, the free motion is made in parts, each of which passes few kinks.
bool LawProblem::solve_by_parts(const system::State& from, system::State& to) {
  constexpr double least_part = 1e-3, good = 1e3;
  whole_u_ = u_free_;
  whole_v_ = v_free_;
  known_ = from.slider_force;
  // Where the forces of the start lead back to the start.
  for (Index i = 0; i < m_; ++i) {
    first_u_[i] = system_.relative_displacement(i, from.q);
    first_v_[i] = system_.relative_displacement(i, from.v);
  }
  first_u_.noalias() += compliance_ * known_;
  first_v_.noalias() += velocity_compliance_ * known_;
  double reached = 0.0, part = slopes_are_bounded_ ? 1.0 : 0.25;
  while (reached < 1.0 && part >= least_part) {
    const double share = std::min(1.0, reached + part);
    u_free_ = share < 1.0 ? first_u_ + share * (whole_u_ - first_u_) : whole_u_;
    v_free_ = share < 1.0 ? first_v_ + share * (whole_v_ - first_v_) : whole_v_;
    set_box_trials(from);
    bool is_solved = false;
    for (const bool has_full_steps : {true, false}) {
      force_ = known_;
      is_solved = is_solved || iterate(from, to, has_full_steps, good) == numerics::NewtonOutcome::converged;
      if (is_solved) break;
    }
    if (is_solved) {
      known_ = force_;
      reached = share;
      part *= 2.0;
    } else {
      part = 0.5 * (share - reached);
    }
  }
  u_free_ = whole_u_;
  v_free_ = whole_v_;
  set_box_trials(from);
  return reached >= 1.0;
}

StepReport LawProblem::failure(StepOutcome outcome) const {
  if (!u_free_.allFinite() || !v_free_.allFinite()) return {StepOutcome::not_finite, -1};
  return {outcome, worst_};
}

}  // namespace rubato::integrate
