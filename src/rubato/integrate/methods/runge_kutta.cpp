#include <rubato/integrate/methods/steppers.hpp>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::integrate {
namespace {

/// The tableau on (q, v). A stage sees the slider forces of the return map from the start of the step to the stage's
/// displacement, so that within a step the law is a function of the displacement, as the implicit steps have it. The
/// first stage keeps the forces of the start: that of a stop may have jumped there.
class RungeKuttaStepper final : public Stepper {
 public:
  RungeKuttaStepper(const RungeKutta& method, const system::LocallyNonlinear& system)
      : tableau_(method.tableau), system_(system), loads_(system.loads()), stage_(system.start()) {
    const Index n = system.size();
    slope_q_.assign(static_cast<std::size_t>(tableau_.stages), Vector::Zero(n));
    slope_v_ = slope_q_;
    force_.resize(n);
    if (system.has_diagonal_mass())
      inverse_mass_ = Vector(system.mass().diagonal()).cwiseInverse();
    else
      mass_factor_.compute(system.mass());
  }

  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    h_ = h;
    for (int i = 0; i < tableau_.stages; ++i) {
      const auto row = static_cast<std::size_t>(i);
      stage_.q = from.q;
      stage_.v = from.v;
      for (std::size_t j = 0; j < row; ++j) {
        if (tableau_.a[row][j] == 0.0) continue;
        stage_.q += (h * tableau_.a[row][j]) * slope_q_[j];
        stage_.v += (h * tableau_.a[row][j]) * slope_v_[j];
      }
      stage_.t = tableau_.c[row] == 1.0 ? t1 : from.t + tableau_.c[row] * h;
      if (i == 0) {
        stage_.slider_force = from.slider_force;
        stage_.memory = from.memory;
      } else {
        slide(from, stage_);
      }
      slope_q_[row] = stage_.v;
      accelerate(tableau_.c[row] == 0.0 ? model::Side::right : model::Side::left, slope_v_[row]);
    }
    to.t = t1;
    to.q = from.q;
    to.v = from.v;
    for (std::size_t j = 0; j < slope_q_.size(); ++j) {
      if (tableau_.b[j] == 0.0) continue;
      to.q += (h * tableau_.b[j]) * slope_q_[j];
      to.v += (h * tableau_.b[j]) * slope_v_[j];
    }
    slide(from, to);
    if (!std::isfinite(to.v.sum()) || !std::isfinite(to.q.sum()))
      for (Index i = 0; i < to.q.size(); ++i)
        if (!std::isfinite(to.v[i]) || !std::isfinite(to.q[i])) return {StepOutcome::not_finite, i};
    return {};
  }

  bool embedded_difference(Vector& dq, Vector& dv) const override {
    if (tableau_.embedded_order == 0) return false;
    dq.setZero();
    dv.setZero();
    for (std::size_t j = 0; j < slope_q_.size(); ++j) {
      const double weight = h_ * (tableau_.b[j] - tableau_.embedded[j]);
      dq += weight * slope_q_[j];
      dv += weight * slope_v_[j];
    }
    return true;
  }

 private:
  void slide(const system::State& from, system::State& end) const {
    for (Index i = 0; i < system_.slider_count(); ++i) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const double travel = system_.relative_displacement(i, end.q) - system_.relative_displacement(i, from.q);
      end.slider_force[i] = std::clamp(from.slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
    }
    system_.set_stop_forces(end);
    system_.move_laws(from, end);
  }

  void accelerate(model::Side side, Vector& acceleration) {
    loads_.evaluate(stage_.t, force_, side);
    force_.noalias() -= system_.damping() * stage_.v;
    force_.noalias() -= system_.stiffness() * stage_.q;
    system_.add_slider_forces(stage_.slider_force, -1.0, force_);
    if (inverse_mass_.size() > 0)
      acceleration = force_.cwiseProduct(inverse_mass_);
    else
      acceleration = mass_factor_.solve(force_);
  }

  numerics::ButcherTableau tableau_;
  const system::LocallyNonlinear& system_;
  system::Loads loads_;
  system::State stage_;
  double h_ = 0.0;  // of the last attempt
  std::vector<Vector> slope_q_, slope_v_;
  Vector force_, inverse_mass_;
  Eigen::SimplicialLDLT<SparseMatrix> mass_factor_;
};

}  // namespace

std::unique_ptr<Stepper> make_runge_kutta_stepper(const RungeKutta& method, const system::LocallyNonlinear& system) {
  return std::make_unique<RungeKuttaStepper>(method, system);
}

}  // namespace rubato::integrate
