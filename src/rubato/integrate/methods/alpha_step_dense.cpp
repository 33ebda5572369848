#include <rubato/integrate/contact_problem.hpp>
#include <rubato/integrate/law_problem.hpp>
#include <rubato/integrate/methods/alpha_step.hpp>

#include <Eigen/Cholesky>

#include <cmath>
#include <optional>

namespace rubato::integrate {
namespace {

constexpr int contacts_in_place = 2;  // so many are solved for without a vector of their own

/// Everything that is linear is multiplied by S^-1 once per step size, so that a step is three small products.
template <int N>
class DenseAlphaStep final : public AlphaStep {
  using Column = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  using Wide = Eigen::Matrix<double, N, Eigen::Dynamic>;

 public:
  DenseAlphaStep(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system)
      : p_(parameters),
        system_(system),
        n_(system.size()),
        m_(system.contact_count()),
        sliders_(system.slider_count()) {
    terms_ = static_cast<Index>(system.loads().terms().size());
    for (const auto& ends : system.contacts()) {
      first_.push_back(ends.first);
      second_.push_back(ends.second);
    }
    for (const auto& slider : system.sliders()) stiffness_.push_back(slider.stiffness);
    trial_.resize(m_);
    penetration_.resize(m_);
    if (system.has_laws()) laws_.emplace(system);
    a1_.resize(n_);
    qs_.resize(n_);
    vs_.resize(n_);
    qc_.resize(n_);
    vc_.resize(n_);
  }

  bool prepare(double h) override {
    h_ = h;
    const Matrix mass(system_.mass()), damping(system_.damping()), stiffness(system_.stiffness());
    const double end = 1.0 - p_.alpha_f;
    const Matrix effective = (1.0 - p_.alpha_m) * mass + end * (p_.gamma * h * damping + p_.beta * h * h * stiffness);
    const Eigen::LLT<Matrix> factor(effective);
    if (factor.info() != Eigen::Success) return false;
    on_q_ = -factor.solve(stiffness);
    on_v_ = -factor.solve(damping);
    on_a_ = -p_.alpha_m * factor.solve(mass);
    Matrix pattern = Matrix::Zero(n_, terms_), joins = Matrix::Zero(n_, m_);
    for (Index i = 0; i < terms_; ++i) {
      const auto& term = system_.loads().terms()[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < term.rows.size(); ++k) pattern(term.rows[k], i) += term.weights[k];
    }
    for (Index i = 0; i < m_; ++i) {
      if (first_[static_cast<std::size_t>(i)] != ground) joins(first_[static_cast<std::size_t>(i)], i) += 1.0;
      if (second_[static_cast<std::size_t>(i)] != ground) joins(second_[static_cast<std::size_t>(i)], i) -= 1.0;
    }
    for (const auto& share : system_.shares()) joins(share.coordinate, share.contact) += share.weight;
    // Eigen touches the first entry of what it solves for, and a model without loads or sliders has none.
    on_load_.resize(n_, terms_);
    on_contact_.resize(n_, m_);
    if (terms_ > 0) on_load_ = factor.solve(pattern);
    if (m_ > 0) on_contact_ = factor.solve(joins);
    const Matrix per_force = end * joins.transpose() * Matrix(on_contact_);
    if (laws_)
      laws_->reset(p_.beta * h * h * per_force, p_.gamma * h * per_force);
    else
      contact_.reset(p_.beta * h * h * per_force, p_.gamma * h * per_force, system_.sliders(), system_.stops());
    return true;
  }

  StepReport solve(const system::State& from, const double* load, system::State& to) override {
    const Eigen::Map<const Column> q0(from.q.data(), n_), v0(from.v.data(), n_),
        a0(from.auxiliary_acceleration.data(), n_);
    const double h = h_, end = 1.0 - p_.alpha_f;
    qs_ = q0 + h * v0 + (h * h * (0.5 - p_.beta)) * a0;
    vs_ = v0 + (h * (1.0 - p_.gamma)) * a0;
    if (p_.alpha_f == 0.0) {
      a1_.noalias() = on_q_ * qs_;
      a1_.noalias() += on_v_ * vs_;
    } else {
      qc_ = end * qs_ + p_.alpha_f * q0;
      vc_ = end * vs_ + p_.alpha_f * v0;
      a1_.noalias() = on_q_ * qc_;
      a1_.noalias() += on_v_ * vc_;
    }
    if (p_.alpha_m != 0.0) a1_.noalias() += on_a_ * a0;
    for (Index i = 0; i < terms_; ++i) a1_ += load[i] * on_load_.col(i);
    if (p_.alpha_f != 0.0)
      for (Index i = 0; i < m_; ++i) a1_ -= (p_.alpha_f * from.slider_force[i]) * on_contact_.col(i);

    const double bh2 = p_.beta * h * h;
    if (laws_) {
      set_free_motion();
      const StepReport report = laws_->solve(from, to);
      if (report.outcome != StepOutcome::accepted)
        return std::isfinite(a1_.sum()) ? report : StepReport{StepOutcome::not_finite, worst()};
      for (Index i = 0; i < m_; ++i) a1_ -= (end * to.slider_force[i]) * on_contact_.col(i);
    } else if (m_ > 0) {
      double in_place[contacts_in_place];
      double* const trial = m_ <= contacts_in_place ? in_place : trial_.data();
      for (Index i = 0; i < sliders_; ++i) {
        const Index a = first_[static_cast<std::size_t>(i)], b = second_[static_cast<std::size_t>(i)];
        double travel = 0.0;  // u_free - u0
        if (a != ground) travel += qs_[a] - q0[a] + bh2 * a1_[a];
        if (b != ground) travel -= qs_[b] - q0[b] + bh2 * a1_[b];
        trial[i] = from.slider_force[i] + stiffness_[static_cast<std::size_t>(i)] * travel;
      }
      for (Index i = sliders_; i < m_; ++i) {
        const auto& stop = system_.stops()[static_cast<std::size_t>(i - sliders_)];
        const Index a = first_[static_cast<std::size_t>(i)], b = second_[static_cast<std::size_t>(i)];
        const double hg = h * p_.gamma;
        penetration_[i] = -stop.gap;
        double rate = 0.0;
        if (a != ground) penetration_[i] += qs_[a] + bh2 * a1_[a], rate += vs_[a] + hg * a1_[a];
        if (b != ground) penetration_[i] -= qs_[b] + bh2 * a1_[b], rate -= vs_[b] + hg * a1_[b];
        trial[i] = stop.stiffness * penetration_[i] + stop.damping * rate;
      }
      if (!contact_.solve(trial, from.slider_force.data(), to.slider_force.data(), penetration_.data())) {
        if (!std::isfinite(a1_.sum())) return {StepOutcome::not_finite, worst()};
        return {StepOutcome::not_converged, contact_.worst()};
      }
      for (Index i = 0; i < m_; ++i) a1_ -= (end * to.slider_force[i]) * on_contact_.col(i);
    }
    Eigen::Map<Column>(to.auxiliary_acceleration.data(), n_) = a1_;
    Eigen::Map<Column>(to.q.data(), n_) = qs_ + bh2 * a1_;
    Eigen::Map<Column>(to.v.data(), n_) = vs_ + (h * p_.gamma) * a1_;
    if (!std::isfinite(a1_.sum())) return {StepOutcome::not_finite, worst()};
    return {};
  }

 private:
  /// What the contacts do without forces at the end of the step.
  void set_free_motion() {
    const double bh2 = p_.beta * h_ * h_, hg = h_ * p_.gamma;
    for (Index i = 0; i < m_; ++i) {
      const Index a = first_[static_cast<std::size_t>(i)], b = second_[static_cast<std::size_t>(i)];
      double u = 0.0, rate = 0.0;
      if (a != ground) u += qs_[a] + bh2 * a1_[a], rate += vs_[a] + hg * a1_[a];
      if (b != ground) u -= qs_[b] + bh2 * a1_[b], rate -= vs_[b] + hg * a1_[b];
      laws_->free_displacement()[i] = u;
      laws_->free_velocity()[i] = rate;
    }
    for (const auto& [contact, place, weight] : system_.shares()) {
      laws_->free_displacement()[contact] += weight * (qs_[place] + bh2 * a1_[place]);
      laws_->free_velocity()[contact] += weight * (vs_[place] + hg * a1_[place]);
    }
  }

  Index worst() const {
    for (Index i = 0; i < n_; ++i)
      if (!std::isfinite(a1_[i])) return i;
    return -1;
  }

  GeneralizedAlpha p_;
  const system::LocallyNonlinear& system_;
  Index n_, m_, sliders_, terms_ = 0;
  double h_ = 0.0;
  std::vector<Index> first_, second_;
  std::vector<double> stiffness_;
  Square on_q_, on_v_, on_a_;  // S^-1 times -K, -C, -alpha_m M
  Wide on_load_, on_contact_;  // S^-1 times the patterns of the loads, and B
  Column a1_, qs_, vs_, qc_, vc_;
  ContactProblem contact_;
  std::optional<LawProblem> laws_;  // in its place where there are others than sliders and stops
  Vector trial_, penetration_;
};

}  // namespace

std::unique_ptr<AlphaStep> make_dense_alpha_step(const GeneralizedAlpha& parameters,
                                                 const system::LocallyNonlinear& system) {
  switch (system.size()) {
    case 1:
      return std::make_unique<DenseAlphaStep<1>>(parameters, system);
    case 2:
      return std::make_unique<DenseAlphaStep<2>>(parameters, system);
    case 3:
      return std::make_unique<DenseAlphaStep<3>>(parameters, system);
    case 4:
      return std::make_unique<DenseAlphaStep<4>>(parameters, system);
    case 5:
      return std::make_unique<DenseAlphaStep<5>>(parameters, system);
    case 6:
      return std::make_unique<DenseAlphaStep<6>>(parameters, system);
    case 7:
      return std::make_unique<DenseAlphaStep<7>>(parameters, system);
    case 8:
      return std::make_unique<DenseAlphaStep<8>>(parameters, system);
    default:
      return std::make_unique<DenseAlphaStep<Eigen::Dynamic>>(parameters, system);
  }
}

}  // namespace rubato::integrate
