#include <rubato/core/error.hpp>
#include <rubato/integrate/contact_problem.hpp>
#include <rubato/integrate/law_problem.hpp>
#include <rubato/integrate/load_values.hpp>
#include <rubato/integrate/methods/steppers.hpp>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>
#include <optional>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr Index largest_size = 500;  // beyond, the matrix exponential of twice the size takes minutes and gigabytes

/// y1 = E y0 + loads + sliders on y = (q, v), all columns from one matrix exponential of the structure augmented by
/// what generates its inputs: an oscillator for each harmonic load (so resonance needs no special case), and a value
/// with a slope for every other load and every contact.
class ExponentialStepper final : public Stepper {
 public:
  explicit ExponentialStepper(const system::LocallyNonlinear& system)
      : system_(system),
        n_(system.size()),
        m_(system.contact_count()),
        sliders_(system.slider_count()),
        loads_(system.loads()) {
    if (system.has_laws()) laws_.emplace(system);
    y0_.resize(2 * n_);
    y1_.resize(2 * n_);
    input_.resize(2 * static_cast<Index>(loads_.count()));
    trial_.resize(m_);
    penetration_.resize(m_);
  }

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    if (h != h_ && !prepare(h)) return {StepOutcome::singular, -1};
    loads_.evaluate(from.t, t1);
    const auto& terms = system_.loads().terms();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto k = static_cast<Index>(2 * i);
      const auto* harmonic = std::get_if<model::HarmonicLaw>(&terms[i].law);
      input_[k] = loads_.start(i);
      input_[k + 1] =
          harmonic ? std::sin(harmonic->angular_frequency * from.t + harmonic->phase) : loads_.end(i) - loads_.start(i);
    }
    y0_.head(n_) = from.q;
    y0_.tail(n_) = h * from.v;
    y1_.noalias() = propagator_ * y0_;
    if (input_.size() > 0) y1_.noalias() += on_load_ * input_;
    if (m_ > 0) y1_.noalias() -= (on_value_ - on_slope_) * from.slider_force;
    to.t = t1;
    if (laws_) {
      set_free_motion();
      const StepReport report = laws_->solve(from, to);
      if (report.outcome != StepOutcome::accepted)
        return {report.outcome, report.outcome == StepOutcome::not_finite ? loads_.fault() : report.worst};
      y1_.noalias() -= on_slope_ * to.slider_force;
    } else if (m_ > 0) {
      for (Index i = 0; i < sliders_; ++i) {
        const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
        double travel = 0.0;
        if (slider.first != ground) travel += y1_[slider.first] - from.q[slider.first];
        if (slider.second != ground) travel -= y1_[slider.second] - from.q[slider.second];
        trial_[i] = from.slider_force[i] + slider.stiffness * travel;
      }
      for (Index i = sliders_; i < m_; ++i) {
        const auto& stop = system_.stops()[static_cast<std::size_t>(i - sliders_)];
        penetration_[i] = -stop.gap;
        double rate = 0.0;  // times h
        if (stop.first != ground) penetration_[i] += y1_[stop.first], rate += y1_[n_ + stop.first];
        if (stop.second != ground) penetration_[i] -= y1_[stop.second], rate -= y1_[n_ + stop.second];
        trial_[i] = stop.stiffness * penetration_[i] + stop.damping * rate / h;
      }
      if (!contact_.solve(trial_.data(), from.slider_force.data(), to.slider_force.data(), penetration_.data())) {
        if (std::isfinite(trial_.sum())) return {StepOutcome::not_converged, contact_.worst()};
        return {StepOutcome::not_finite, loads_.fault()};
      }
      y1_.noalias() -= on_slope_ * to.slider_force;
    }
    to.t = t1;
    to.q = y1_.head(n_);
    to.v = y1_.tail(n_) / h;
    if (!std::isfinite(y1_.sum()))
      for (Index i = 0; i < 2 * n_; ++i)
        if (!std::isfinite(y1_[i])) return {StepOutcome::not_finite, loads_.fault() >= 0 ? loads_.fault() : i % n_};
    return {};
  }

  int factorisations() const override { return factorisations_; }

 private:
  /// What the contacts do without forces at the end of the step.
  void set_free_motion() {
    for (Index i = 0; i < m_; ++i) {
      const auto& ends = system_.contacts()[static_cast<std::size_t>(i)];
      double u = 0.0, rate = 0.0;
      if (ends.first != ground) u += y1_[ends.first], rate += y1_[n_ + ends.first];
      if (ends.second != ground) u -= y1_[ends.second], rate -= y1_[n_ + ends.second];
      laws_->free_displacement()[i] = u;
      laws_->free_velocity()[i] = rate / h_;
    }
    for (const auto& [contact, place, weight] : system_.shares()) {
      laws_->free_displacement()[contact] += weight * y1_[place];
      laws_->free_velocity()[contact] += weight * y1_[n_ + place] / h_;
    }
  }

  // In the time s = (t - t0)/h and with h v in place of v, so that the exponent is small numbers.
  bool prepare(double h) {
    ++factorisations_;
    const Eigen::LLT<Matrix> mass{Matrix(system_.mass())};
    if (mass.info() != Eigen::Success) return false;
    const auto& terms = system_.loads().terms();
    const Index loads = static_cast<Index>(terms.size()), size = 2 * n_ + 2 * loads + 2 * m_;
    Matrix exponent = Matrix::Zero(size, size);
    exponent.block(0, n_, n_, n_).setIdentity();
    exponent.block(n_, 0, n_, n_) = -h * h * mass.solve(Matrix(system_.stiffness()));
    exponent.block(n_, n_, n_, n_) = -h * mass.solve(Matrix(system_.damping()));
    Matrix inputs = Matrix::Zero(n_, loads + m_);
    for (Index i = 0; i < loads; ++i) {
      const auto& term = terms[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < term.rows.size(); ++k) inputs(term.rows[k], i) += term.weights[k];
    }
    for (Index i = 0; i < m_; ++i) {
      const auto& ends = system_.contacts()[static_cast<std::size_t>(i)];
      if (ends.first != ground) inputs(ends.first, loads + i) += 1.0;
      if (ends.second != ground) inputs(ends.second, loads + i) -= 1.0;
    }
    for (const auto& share : system_.shares()) inputs(share.coordinate, loads + share.contact) += share.weight;
    // Eigen's solve reads the first of no columns.
    const Matrix driven = inputs.cols() > 0 ? Matrix(h * h * mass.solve(inputs)) : Matrix(n_, 0);
    for (Index i = 0; i < loads + m_; ++i) {
      const Index value = 2 * n_ + 2 * i;
      exponent.block(n_, value, n_, 1) = driven.col(i);
      const auto* harmonic =
          i < loads ? std::get_if<model::HarmonicLaw>(&terms[static_cast<std::size_t>(i)].law) : nullptr;
      exponent(value, value + 1) = harmonic ? -harmonic->angular_frequency * h : 1.0;
      if (harmonic) exponent(value + 1, value) = harmonic->angular_frequency * h;
    }
    const Matrix flow = exponent.exp();
    propagator_ = flow.topLeftCorner(2 * n_, 2 * n_);
    on_load_ = flow.block(0, 2 * n_, 2 * n_, 2 * loads);
    on_value_.resize(2 * n_, m_);
    on_slope_.resize(2 * n_, m_);
    for (Index i = 0; i < m_; ++i) {
      on_value_.col(i) = flow.block(0, 2 * n_ + 2 * (loads + i), 2 * n_, 1);
      on_slope_.col(i) = flow.block(0, 2 * n_ + 2 * (loads + i) + 1, 2 * n_, 1);
    }
    if (m_ > 0) {
      const Matrix joins = inputs.rightCols(m_);
      const Matrix compliance = joins.transpose() * on_slope_.topRows(n_);
      const Matrix velocity_compliance = joins.transpose() * on_slope_.bottomRows(n_) / h;
      if (laws_)
        laws_->reset(compliance, velocity_compliance);
      else
        contact_.reset(compliance, velocity_compliance, system_.sliders(), system_.stops());
    }
    h_ = h;
    return flow.allFinite();
  }

  const system::LocallyNonlinear& system_;
  Index n_, m_, sliders_;
  LoadValues loads_;
  double h_ = std::nan("");
  int factorisations_ = 0;
  Matrix propagator_, on_load_, on_value_, on_slope_;
  Vector y0_, y1_, input_, trial_, penetration_;
  ContactProblem contact_;
  std::optional<LawProblem> laws_;  // in its place where there are others than sliders and stops
};

}  // namespace

std::unique_ptr<Stepper> make_exponential_stepper(const system::LocallyNonlinear& system) {
  if (system.size() > largest_size)
    throw InvalidInput(
        fmt::format("the method exponential is for up to {} coordinates, the model has {}; take "
                    "\"generalized_alpha\"",
                    largest_size, system.size()));
  return std::make_unique<ExponentialStepper>(system);
}

}  // namespace rubato::integrate
