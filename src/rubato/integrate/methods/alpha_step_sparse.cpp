#include <rubato/integrate/contact_problem.hpp>
#include <rubato/integrate/methods/alpha_step.hpp>
#include <rubato/numerics/ordered_ldlt.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

/// For many coordinates. Everything a step touches lies in the order of elimination, the coordinates of the sliders
/// last: the contact problem is solved between the forward and the backward substitution, so friction costs no second
/// solve.
class SparseAlphaStep final : public AlphaStep {
 public:
  SparseAlphaStep(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system)
      : p_(parameters), system_(system), n_(system.size()), m_(system.slider_count()) {
    std::vector<Index> last;
    for (const auto& slider : system.sliders())
      for (const Index end : {slider.first, slider.second})
        if (end != ground) last.push_back(end);
    std::sort(last.begin(), last.end());
    last.erase(std::unique(last.begin(), last.end()), last.end());
    SparseMatrix pattern = system.mass() + system.damping() + system.stiffness();
    factor_.analyse(pattern, last);
    k_ = factor_.last_count();
    const Index offset = n_ - k_;
    for (const auto& slider : system.sliders()) {
      first_.push_back(slider.first == ground ? ground : factor_.permuted(slider.first) - offset);
      second_.push_back(slider.second == ground ? ground : factor_.permuted(slider.second) - offset);
    }
    order_last_ = std::vector<Index>(static_cast<std::size_t>(k_));
    for (Index i = 0; i < k_; ++i) order_last_[static_cast<std::size_t>(i)] = factor_.original(offset + i);
    gather_products();
    right_.resize(n_);
    last_.resize(k_);
    push_.resize(k_);
    trial_.resize(m_);
  }

  bool prepare(double h) override {
    h_ = h;
    const double end = 1.0 - p_.alpha_f;
    const SparseMatrix effective =
        (1.0 - p_.alpha_m) * system_.mass() +
        SparseMatrix(end * (p_.gamma * h * system_.damping() + p_.beta * h * h * system_.stiffness()));
    if (!factor_.factorise(effective)) return false;
    const Matrix inverse = factor_.last_inverse();
    Matrix joins = Matrix::Zero(k_, m_);
    for (Index i = 0; i < m_; ++i) {
      if (first_[static_cast<std::size_t>(i)] != ground) joins(first_[static_cast<std::size_t>(i)], i) += 1.0;
      if (second_[static_cast<std::size_t>(i)] != ground) joins(second_[static_cast<std::size_t>(i)], i) -= 1.0;
    }
    if (m_ > 0) contact_.reset(p_.beta * h * h * end * (joins.transpose() * inverse * joins), system_.sliders());
    return true;
  }

  StepReport solve(const system::State& from, const double* load, system::State& to) override {
    const double h = h_, end = 1.0 - p_.alpha_f, bh2 = p_.beta * h * h;
    const double* const q0 = from.q.data();
    const double* const v0 = from.v.data();
    const double* const a0 = from.auxiliary_acceleration.data();
    double* const qs = to.q.data();
    double* const vs = to.v.data();
    // The combinations that the products need, in one pass; `to.auxiliary` serves as their memory until A1 is known.
    const double q_from_a = h * h * (0.5 - p_.beta), v_from_a = h * (1.0 - p_.gamma);
    for (Index i = 0; i < n_; ++i) {
      qs[i] = q0[i] + h * v0[i] + q_from_a * a0[i];
      vs[i] = v0[i] + v_from_a * a0[i];
      combined_[static_cast<std::size_t>(i)] = {end * qs[i] + p_.alpha_f * q0[i], end * vs[i] + p_.alpha_f * v0[i],
                                                p_.alpha_m * a0[i]};
    }
    apply_products();
    add_loads(load);
    for (Index i = 0; i < m_ && p_.alpha_f != 0.0; ++i) {
      const double pull = p_.alpha_f * from.slider_force[i];
      if (first_[static_cast<std::size_t>(i)] != ground) right_[n_ - k_ + first_[static_cast<std::size_t>(i)]] -= pull;
      if (second_[static_cast<std::size_t>(i)] != ground)
        right_[n_ - k_ + second_[static_cast<std::size_t>(i)]] += pull;
    }
    factor_.forward(right_);
    if (m_ > 0) {
      factor_.last_solution(right_, last_);
      for (Index i = 0; i < m_; ++i) {
        const double travel = travel_of(first_[static_cast<std::size_t>(i)], qs, q0, bh2) -
                              travel_of(second_[static_cast<std::size_t>(i)], qs, q0, bh2);
        trial_[i] = from.slider_force[i] + system_.sliders()[static_cast<std::size_t>(i)].stiffness * travel;
      }
      if (!contact_.solve(trial_.data(), from.slider_force.data(), to.slider_force.data())) {
        if (std::isfinite(trial_.sum())) return {StepOutcome::not_converged, contact_.worst()};
        return {StepOutcome::not_finite, -1};
      }
      push_.setZero();
      for (Index i = 0; i < m_; ++i) {
        const double push = end * to.slider_force[i];
        if (first_[static_cast<std::size_t>(i)] != ground) push_[first_[static_cast<std::size_t>(i)]] += push;
        if (second_[static_cast<std::size_t>(i)] != ground) push_[second_[static_cast<std::size_t>(i)]] -= push;
      }
      factor_.subtract_from_last(push_, right_);
    }
    factor_.backward(right_);
    const double v_from_a1 = h * p_.gamma;
    double* const a1 = to.auxiliary_acceleration.data();
    double sum = 0.0;
    for (Index i = 0; i < n_; ++i) {
      const double now = right_[place_[static_cast<std::size_t>(i)]];
      a1[i] = now;
      qs[i] += bh2 * now;
      vs[i] += v_from_a1 * now;
      sum += now;
    }
    if (!std::isfinite(sum))
      for (Index i = 0; i < n_; ++i)
        if (!std::isfinite(a1[i])) return {StepOutcome::not_finite, i};
    return {};
  }

 private:
  struct Combined {
    double q, v, a;
  };
  struct Coefficients {
    double stiffness, damping, mass;
  };

  // The products K qc + C vc + M ac in one pass over the common pattern, by rows of the elimination order.
  void gather_products() {
    SparseMatrix pattern = system_.mass() + system_.damping() + system_.stiffness();
    combined_.resize(static_cast<std::size_t>(n_));
    place_.resize(static_cast<std::size_t>(n_));
    for (Index i = 0; i < n_; ++i) place_[static_cast<std::size_t>(i)] = static_cast<int>(factor_.permuted(i));
    start_.assign(1, 0);
    for (Index row = 0; row < n_; ++row) {  // symmetric: its columns are its rows
      for (SparseMatrix::InnerIterator entry(pattern, row); entry; ++entry) {
        column_.push_back(static_cast<int>(entry.row()));
        coefficients_.push_back({system_.stiffness().coeff(entry.row(), row), system_.damping().coeff(entry.row(), row),
                                 system_.mass().coeff(entry.row(), row)});
      }
      start_.push_back(static_cast<int>(column_.size()));
    }
  }

  void apply_products() {
    for (Index i = 0; i < n_; ++i) {
      double sum = 0.0;
      for (int p = start_[static_cast<std::size_t>(i)]; p < start_[static_cast<std::size_t>(i) + 1]; ++p) {
        const Coefficients& c = coefficients_[static_cast<std::size_t>(p)];
        const Combined& x = combined_[static_cast<std::size_t>(column_[static_cast<std::size_t>(p)])];
        sum += c.stiffness * x.q + c.damping * x.v + c.mass * x.a;
      }
      right_[place_[static_cast<std::size_t>(i)]] = -sum;
    }
  }

  void add_loads(const double* load) {
    const auto& terms = system_.loads().terms();
    for (std::size_t i = 0; i < terms.size(); ++i)
      for (std::size_t k = 0; k < terms[i].rows.size(); ++k)
        right_[place_[static_cast<std::size_t>(terms[i].rows[k])]] += load[i] * terms[i].weights[k];
  }

  double travel_of(Index place, const double* qs, const double* q0, double bh2) const {
    if (place == ground) return 0.0;
    const Index i = order_last_[static_cast<std::size_t>(place)];
    return qs[i] - q0[i] + bh2 * last_[place];
  }

  GeneralizedAlpha p_;
  const system::LocallyNonlinear& system_;
  Index n_, m_, k_ = 0;
  double h_ = 0.0;
  numerics::OrderedLdlt factor_;
  std::vector<Index> first_, second_;  // of each slider, among the last k places
  std::vector<Index> order_last_;
  std::vector<int> place_, start_, column_;
  std::vector<Coefficients> coefficients_;
  std::vector<Combined> combined_;
  Vector right_, last_, push_, trial_;
  ContactProblem contact_;
};

}  // namespace

std::unique_ptr<AlphaStep> make_sparse_alpha_step(const GeneralizedAlpha& parameters,
                                                  const system::LocallyNonlinear& system) {
  return std::make_unique<SparseAlphaStep>(parameters, system);
}

std::unique_ptr<AlphaStep> make_alpha_step(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system) {
  constexpr Index dense_size = 64;  // beyond, a chain is faster sparse and a full matrix not much slower
  return system.size() <= dense_size ? make_dense_alpha_step(parameters, system)
                                     : make_sparse_alpha_step(parameters, system);
}

}  // namespace rubato::integrate
