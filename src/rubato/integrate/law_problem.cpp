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
    return p.linearised_.solve(p.trial_.data(), from.slider_force.data(), p.next_.data(), p.penetration_.data());
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
    return error < before * (1.0 - 1e-4 * part) || error <= enough;
  }
  bool may_be_halved(double) const { return boxes_hold; }
  void accept(double) { p.force_.swap(p.trial_force_); }

  LawProblem& p;
  const system::State& from;
  system::State& to;
  bool boxes_hold = true;
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
      start_(static_cast<std::size_t>(system.law_count())),
      end_(start_),
      answer_(start_.size()),
      reach_(start_.size()),
      joined_start_{0} {
  for (Index i = boxes_; i < m_; ++i) {
    const std::vector<model::Share> joined = system.column(i);
    joined_.insert(joined_.end(), joined.begin(), joined.end());
    joined_start_.push_back(joined_.size());
  }
}

void LawProblem::reset(const Matrix& compliance, const Matrix& velocity_compliance) {
  compliance_ = compliance;
  velocity_compliance_ = velocity_compliance;
  linearised_.reset(compliance, velocity_compliance, system_.sliders(), system_.stops(), system_.law_count());
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
  // Written out: calls of a product cost more than the product where there are a few laws.
  for (Index j = 0; j < m_; ++j)
    for (Index i = boxes_; i < m_; ++i) {
      u_[i] -= compliance_(i, j) * force[j];
      v_[i] -= velocity_compliance_(i, j) * force[j];
    }
  double largest = 0.0;
  for (std::size_t j = 0; j < answer_.size(); ++j) {
    const Index i = boxes_ + static_cast<Index>(j), place = system_.memory_of(static_cast<Index>(j));
    end_[j].u = u_[i];
    end_[j].rate = v_[i];
    answer_[j] = system_.laws()[j].law->advance(start_[j], memory_ + place, end_[j], to.memory.data() + place);
    const double round_off =
        epsilon * (std::abs(answer_[j].force) + std::abs(force[i]) + std::abs(answer_[j].by_u) * reach_[j] +
                   std::abs(answer_[j].by_rate) * (std::abs(v_free_[i]) + std::abs(v_[i])));
    const double error = std::abs(answer_[j].force - force[i]);
    if (!std::isfinite(error)) {
      worst_ = i;
      return HUGE_VAL;
    }
    const double share = error == 0.0 ? 0.0 : error / std::max(round_off, std::numeric_limits<double>::min());
    if (share >= largest) {
      largest = share;
      worst_ = i;
    }
  }
  return largest;
}

void LawProblem::linearise() {
  for (std::size_t j = 0; j < answer_.size(); ++j) {
    const Index i = boxes_ + static_cast<Index>(j);
    const model::LawAnswer& a = answer_[j];
    linearised_.set_slopes(i, a.by_u, a.by_rate);
    trial_[i] = a.force + a.by_u * (u_free_[i] - u_[i]) + a.by_rate * (v_free_[i] - v_[i]);
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
    reach_[j] = std::max(std::abs(start_[j].u), std::abs(u_free_[i]));
    for (std::size_t s = joined_start_[j]; s < joined_start_[j + 1]; ++s)
      reach_[j] = std::max(reach_[j], std::abs(joined_[s].weight * from.q[joined_[s].coordinate]));
  }
  force_ = from.slider_force;
}

StepReport LawProblem::solve(const system::State& from, system::State& to) {
  constexpr double good = 1e6;  // a correction that no longer helps leaves at most 1e-10 of the forces
  start(from, to);
  if (!solve_boxes(from, force_)) return failure(StepOutcome::not_converged);
  trial_force_ = force_;
  Iteration iteration(*this, from, to);
  const numerics::NewtonReport report = numerics::newton(iteration, Iteration::rules());
  if (report.outcome == numerics::NewtonOutcome::diverged && iteration.boxes_hold && report.residual <= good)
    evaluate(force_, to);  // as good as it gets
  else if (!report.has_converged())
    return failure(report.outcome == numerics::NewtonOutcome::not_finite ? StepOutcome::not_finite
                                                                         : StepOutcome::not_converged);
  // The forces that the laws have at the end are those that the step took.
  to.slider_force = force_;
  return {};
}

StepReport LawProblem::failure(StepOutcome outcome) const {
  if (!u_free_.allFinite() || !v_free_.allFinite()) return {StepOutcome::not_finite, -1};
  return {outcome, worst_};
}

}  // namespace rubato::integrate
