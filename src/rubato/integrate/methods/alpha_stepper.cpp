#include <rubato/integrate/load_values.hpp>
#include <rubato/integrate/methods/alpha_step.hpp>
#include <rubato/integrate/methods/steppers.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rubato::integrate {
namespace {

/// Keeps the matrices of the last steps of different lengths. Where loads have rows at equal distances, or modes beat,
/// few lengths come again and again: on a building of 41 coordinates under its record sixteen of them save nine
/// factorisations in ten. Sparse factors are too large to keep more than one.
class PreparedSteps {
 public:
  PreparedSteps(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system)
      : parameters_(parameters), system_(system), most_(system.size() <= largest_dense_size ? 16 : 1) {}

  bool prepare(double h) {
    const auto found = std::find_if(kept_.begin(), kept_.end(), [h](const Kept& kept) { return kept.h == h; });
    if (found != kept_.end()) {
      std::rotate(kept_.begin(), found, found + 1);
      return true;
    }
    if (kept_.size() < most_) kept_.push_back({std::nan(""), make_alpha_step(parameters_, system_)});
    std::rotate(kept_.begin(), kept_.end() - 1, kept_.end());
    Kept& now = kept_.front();
    now.h = std::nan("");
    ++factorisations_;
    if (!now.step->prepare(h)) return false;
    now.h = h;
    return true;
  }
  /// The step prepared last.
  AlphaStep* operator->() { return kept_.front().step.get(); }
  int factorisations() const { return factorisations_; }

 private:
  struct Kept {
    double h;
    std::unique_ptr<AlphaStep> step;
  };

  GeneralizedAlpha parameters_;
  const system::LocallyNonlinear& system_;
  std::size_t most_;
  std::vector<Kept> kept_;  // used last first
  int factorisations_ = 0;
};

class AlphaStepper final : public Stepper {
 public:
  AlphaStepper(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system)
      : p_(parameters), system_(system), step_(parameters, system), loads_(system.loads()), load_(loads_.count()) {}

  double shift() const override { return p_.alpha_m - p_.alpha_f; }

  // Its distance from the acceleration at t is proportional to h.
  void step_changes(system::State& state, double ratio) override {
    if (p_.alpha_m == 0.0 && p_.alpha_f == 0.0) return;
    if (!equilibrium_) {  // most marches never need it, and it may factorise the mass
      equilibrium_.emplace(system_);
      acceleration_.resize(system_.size());
    }
    (*equilibrium_)(state, acceleration_);
    state.auxiliary_acceleration = acceleration_ + ratio * (state.auxiliary_acceleration - acceleration_);
  }

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    if (!step_.prepare(h)) return {StepOutcome::singular, -1};
    if (p_.alpha_f == 0.0) {
      loads_.evaluate_end(t1);
      for (std::size_t i = 0; i < load_.size(); ++i) load_[i] = loads_.end(i);
    } else {
      loads_.evaluate(from.t, t1);
      for (std::size_t i = 0; i < load_.size(); ++i)
        load_[i] = (1.0 - p_.alpha_f) * loads_.end(i) + p_.alpha_f * loads_.start(i);
    }
    to.t = t1;
    StepReport report = step_->solve(from, load_.data(), to);
    if (report.outcome != StepOutcome::accepted && loads_.fault() >= 0) report.worst = loads_.fault();
    return report;
  }

  int factorisations() const override { return step_.factorisations(); }

 private:
  GeneralizedAlpha p_;
  const system::LocallyNonlinear& system_;
  PreparedSteps step_;
  LoadValues loads_;
  std::vector<double> load_;
  std::optional<system::EquilibriumAcceleration> equilibrium_;
  Vector acceleration_;
};

/// Linear acceleration to t + theta h under the load continued linearly, then back to t + h on the same line. The
/// return map of the sliders runs to t + theta h with the trial motion and to t + h with the accepted one, and so do
/// the stops.
class WilsonStepper final : public Stepper {
 public:
  WilsonStepper(const WilsonTheta& method, const system::LocallyNonlinear& system)
      : theta_(method.theta),
        system_(system),
        step_(GeneralizedAlpha{0.0, 0.0, 1.0 / 6.0, 0.5}, system),
        loads_(system.loads()),
        load_(loads_.count()),
        beyond_(system.start()) {}

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    if (!step_.prepare(theta_ * h)) return {StepOutcome::singular, -1};
    loads_.evaluate(from.t, t1);
    for (std::size_t i = 0; i < load_.size(); ++i)
      load_[i] = loads_.start(i) + theta_ * (loads_.end(i) - loads_.start(i));
    beyond_.t = from.t + theta_ * h;
    StepReport report = step_->solve(from, load_.data(), beyond_);
    if (report.outcome != StepOutcome::accepted) {
      if (loads_.fault() >= 0) report.worst = loads_.fault();
      return report;
    }
    const Vector& a0 = from.auxiliary_acceleration;
    to.t = t1;
    to.auxiliary_acceleration = a0 + (beyond_.auxiliary_acceleration - a0) / theta_;
    to.v = from.v + (0.5 * h) * (a0 + to.auxiliary_acceleration);
    to.q = from.q + h * from.v + (h * h / 6.0) * (2.0 * a0 + to.auxiliary_acceleration);
    for (Index i = 0; i < system_.slider_count(); ++i) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const double travel = system_.relative_displacement(i, to.q) - system_.relative_displacement(i, from.q);
      to.slider_force[i] = std::clamp(from.slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
    }
    system_.set_stop_forces(to);
    system_.move_laws(from, to);
    return report;
  }

  int factorisations() const override { return step_.factorisations(); }

 private:
  double theta_;
  const system::LocallyNonlinear& system_;
  PreparedSteps step_;
  LoadValues loads_;
  std::vector<double> load_;
  system::State beyond_;
};

}  // namespace

std::unique_ptr<Stepper> make_alpha_stepper(const GeneralizedAlpha& parameters,
                                            const system::LocallyNonlinear& system) {
  return std::make_unique<AlphaStepper>(parameters, system);
}

std::unique_ptr<Stepper> make_wilson_stepper(const WilsonTheta& method, const system::LocallyNonlinear& system) {
  return std::make_unique<WilsonStepper>(method, system);
}

}  // namespace rubato::integrate
