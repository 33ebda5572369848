#include <rubato/integrate/contact_problem.hpp>
#include <rubato/integrate/law_problem.hpp>
#include <rubato/integrate/methods/alpha_step.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace rubato::integrate {
namespace {

/// A combination of the state at the start of a step: q q0 + v v0 + a A0.
struct Combination {
  double q = 0.0, v = 0.0, a = 0.0;
};

/// C = a M + b K to round-off, entry by entry.
struct Rayleigh {
  double on_mass = 0.0, on_stiffness = 0.0;
};

std::optional<Rayleigh> find_rayleigh(const system::LocallyNonlinear& system) {
  const SparseMatrix &m = system.mass(), &c = system.damping(), &k = system.stiffness();
  const double mm = m.squaredNorm(), kk = k.squaredNorm(), mk = m.cwiseProduct(k).sum();
  const double mc = m.cwiseProduct(c).sum(), kc = k.cwiseProduct(c).sum();
  const double determinant = mm * kk - mk * mk;
  if (!(determinant > 1e-8 * mm * kk)) return std::nullopt;  // K = 0, or as good as proportional to M
  const Rayleigh found{(kk * mc - mk * kc) / determinant, (mm * kc - mk * mc) / determinant};
  const SparseMatrix sum = found.on_mass * m + found.on_stiffness * k;
  const SparseMatrix rest = c - sum;
  constexpr double round_off = 64 * std::numeric_limits<double>::epsilon();
  for (Index column = 0; column < rest.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(rest, column); entry; ++entry) {
      const double size = std::abs(found.on_mass * m.coeff(entry.row(), column)) +
                          std::abs(found.on_stiffness * k.coeff(entry.row(), column));
      if (!(std::abs(entry.value()) <= round_off * size)) return std::nullopt;
    }
  return found;
}

/// For many coordinates. The contact problem is solved between the forward and the backward substitution, with the
/// coordinates of the sliders eliminated last, so that friction costs no second solve. A substitution is a chain of
/// operations that wait for each other, so the products with the matrices are made row by row during the forward one
/// (each entry of the symmetric matrices is read once) and the state is advanced during the backward one: what is read
/// is still near, and the work hides in the waiting. Rayleigh damping needs no product of
/// its own, nor does a diagonal mass.
class SparseAlphaStep final : public AlphaStep {
 public:
  SparseAlphaStep(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system)
      : p_(parameters),
        system_(system),
        n_(system.size()),
        m_(system.contact_count()),
        sliders_(system.slider_count()),
        rayleigh_(find_rayleigh(system)) {
    std::vector<Index> last;
    for (const auto& ends : system.contacts())
      for (const Index end : {ends.first, ends.second})
        if (end != ground) last.push_back(end);
    for (const auto& share : system.shares()) last.push_back(share.coordinate);
    std::sort(last.begin(), last.end());
    last.erase(std::unique(last.begin(), last.end()), last.end());
    factor_.analyse(SparseMatrix(system.mass() + system.damping() + system.stiffness()), last);
    k_ = factor_.last_count();
    const Index offset = n_ - k_;
    for (const auto& ends : system.contacts()) {
      first_.push_back(ends.first == ground ? ground : factor_.permuted(ends.first) - offset);
      second_.push_back(ends.second == ground ? ground : factor_.permuted(ends.second) - offset);
    }
    shares_ = system.shares();
    for (auto& share : shares_) share.coordinate = factor_.permuted(share.coordinate) - offset;
    order_.resize(static_cast<std::size_t>(n_));
    place_.resize(static_cast<std::size_t>(n_));
    for (Index i = 0; i < n_; ++i) {
      order_[static_cast<std::size_t>(i)] = static_cast<int>(factor_.original(i));
      place_[static_cast<std::size_t>(i)] = static_cast<int>(factor_.permuted(i));
    }
    if (system.has_diagonal_mass()) mass_ = system.mass().diagonal();
    gather_products();
    if (system.has_laws()) laws_.emplace(system);
    right_.resize(n_);
    last_.resize(k_);
    push_.resize(k_);
    trial_.resize(m_);
    penetration_.resize(m_);
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
    for (const auto& [contact, place, weight] : shares_) joins(place, contact) += weight;
    if (m_ == 0) return true;
    const Matrix per_force = end * (joins.transpose() * inverse * joins);
    if (laws_)
      laws_->reset(p_.beta * h * h * per_force, p_.gamma * h * per_force);
    else
      contact_.reset(p_.beta * h * h * per_force, p_.gamma * h * per_force, system_.sliders(), system_.stops());
    return true;
  }

  StepReport solve(const system::State& from, const double* load, system::State& to) override {
    right_.setZero();
    add_loads(load);
    add_to_contacts(-p_.alpha_f, from.slider_force, right_.data() + (n_ - k_));
    switch (products_) {
      case 1:
        eliminate<1>(from);
        break;
      case 2:
        eliminate<2>(from);
        break;
      default:
        eliminate<3>(from);
    }
    if (m_ > 0) {
      factor_.last_solution(right_, last_);
      if (laws_) {
        set_free_motion(from);
        const StepReport report = laws_->solve(from, to);
        if (report.outcome != StepOutcome::accepted) return report;
      } else if (const StepReport report = solve_contacts(from, to); report.outcome != StepOutcome::accepted) {
        return report;
      }
      push_.setZero();
      add_to_contacts(1.0 - p_.alpha_f, to.slider_force, push_.data());
      factor_.subtract_from_last(push_, right_);
    }
    return advance(from, to);
  }

 private:
  StepReport solve_contacts(const system::State& from, system::State& to) {
    for (Index i = 0; i < sliders_; ++i) {
      const double travel = free_travel(first_[static_cast<std::size_t>(i)], from) -
                            free_travel(second_[static_cast<std::size_t>(i)], from);
      trial_[i] = from.slider_force[i] + system_.sliders()[static_cast<std::size_t>(i)].stiffness * travel;
    }
    for (Index i = sliders_; i < m_; ++i) {
      const auto& stop = system_.stops()[static_cast<std::size_t>(i - sliders_)];
      const Index first = first_[static_cast<std::size_t>(i)], second = second_[static_cast<std::size_t>(i)];
      penetration_[i] =
          system_.relative_displacement(i, from.q) - stop.gap + (free_travel(first, from) - free_travel(second, from));
      trial_[i] =
          stop.stiffness * penetration_[i] + stop.damping * (free_velocity(first, from) - free_velocity(second, from));
    }
    if (!contact_.solve(trial_.data(), from.slider_force.data(), to.slider_force.data(), penetration_.data())) {
      if (std::isfinite(trial_.sum())) return {StepOutcome::not_converged, contact_.worst()};
      return {StepOutcome::not_finite, -1};
    }
    return {};
  }

  /// What the contacts do without forces at the end of the step.
  void set_free_motion(const system::State& from) {
    for (Index i = 0; i < m_; ++i) {
      const Index first = first_[static_cast<std::size_t>(i)], second = second_[static_cast<std::size_t>(i)];
      laws_->free_displacement()[i] =
          system_.relative_displacement(i, from.q) + (free_travel(first, from) - free_travel(second, from));
      laws_->free_velocity()[i] = free_velocity(first, from) - free_velocity(second, from);
    }
    for (const auto& [contact, place, weight] : shares_) {
      laws_->free_displacement()[contact] += weight * free_travel(place, from);
      laws_->free_velocity()[contact] += weight * free_velocity(place, from);
    }
  }

  /// The matrices of the products: stiffness first, then damping unless Rayleigh, then mass unless diagonal.
  void gather_products() {
    std::vector<const SparseMatrix*> matrices{&system_.stiffness()};
    if (!rayleigh_) matrices.push_back(&system_.damping());
    if (mass_.size() == 0) matrices.push_back(&system_.mass());
    products_ = static_cast<int>(matrices.size());
    SparseMatrix pattern = *matrices[0];
    for (const SparseMatrix* matrix : matrices) pattern = SparseMatrix(pattern + *matrix);
    combined_.resize(n_ * products_);
    const auto rows = static_cast<std::size_t>(n_), half = static_cast<std::size_t>(pattern.nonZeros()) / 2;
    start_.reserve(rows + 1);
    column_.reserve(half);
    coefficient_.reserve(half * static_cast<std::size_t>(products_));
    diagonal_.reserve(rows * static_cast<std::size_t>(products_));
    new_start_.reserve(rows + 1);
    new_column_.reserve(rows);
    start_.push_back(0);
    new_start_.push_back(0);
    std::vector<bool> is_known(rows, false);
    const auto meet = [&](Index coordinate) {
      if (is_known[static_cast<std::size_t>(coordinate)]) return;
      is_known[static_cast<std::size_t>(coordinate)] = true;
      new_column_.push_back(place_[static_cast<std::size_t>(coordinate)]);
    };
    for (const int row : order_) {  // symmetric: its columns are its rows
      meet(row);                    // also where no matrix has an entry on the diagonal
      for (SparseMatrix::InnerIterator entry(pattern, row); entry; ++entry) {
        meet(entry.row());
        if (factor_.permuted(entry.row()) <= factor_.permuted(row)) continue;
        column_.push_back(place_[static_cast<std::size_t>(entry.row())]);
        for (const SparseMatrix* matrix : matrices) coefficient_.push_back(matrix->coeff(entry.row(), row));
      }
      for (const SparseMatrix* matrix : matrices) diagonal_.push_back(matrix->coeff(row, row));
      start_.push_back(static_cast<int>(column_.size()));
      new_start_.push_back(static_cast<int>(new_column_.size()));
    }
  }

  /// What the products multiply, in their order; last what a diagonal mass does.
  std::array<Combination, 3> combinations() const {
    const double h = h_, end = 1.0 - p_.alpha_f;
    Combination stiffness{1.0, end * h, end * h * h * (0.5 - p_.beta)};
    const Combination damping{0.0, 1.0, end * h * (1.0 - p_.gamma)};
    Combination mass{0.0, 0.0, p_.alpha_m};
    if (!rayleigh_) return {stiffness, damping, mass};
    stiffness.v += rayleigh_->on_stiffness * damping.v;
    stiffness.a += rayleigh_->on_stiffness * damping.a;
    mass.v += rayleigh_->on_mass * damping.v;
    mass.a += rayleigh_->on_mass * damping.a;
    return {stiffness, mass, mass};
  }

  /// Completes each row of the right-hand side just before it is eliminated. The combinations of the state are made
  /// when the first row needs them, so that the state is read once and what was read is still near.
  template <int products>
  void eliminate(const system::State& from) {
    const std::array<Combination, 3> combine = combinations();
    const Combination on_mass = combine[rayleigh_ ? 1 : 2];
    const double* const q0 = from.q.data();
    const double* const v0 = from.v.data();
    const double* const a0 = from.auxiliary_acceleration.data();
    const int* const order = order_.data();
    const int* const start = start_.data();
    const int* const column = column_.data();
    const int* const new_start = new_start_.data();
    const int* const new_column = new_column_.data();
    const double* const coefficient = coefficient_.data();
    const double* const diagonal = diagonal_.data();
    double* const y = right_.data();
    const double* const mass = mass_.size() > 0 ? mass_.data() : nullptr;
    double* const x = combined_.data();
    factor_.forward(right_, [=](Index j) {
      for (int p = new_start[j]; p < new_start[j + 1]; ++p) {
        const Index place = new_column[p], i = order[place];
        for (int k = 0; k < products; ++k)
          x[products * place + k] = combine[k].q * q0[i] + combine[k].v * v0[i] + combine[k].a * a0[i];
      }
      const Index i = order[j];
      double own[products], sum = mass ? mass[i] * (on_mass.v * v0[i] + on_mass.a * a0[i]) : 0.0;
      for (int k = 0; k < products; ++k) {
        own[k] = x[products * j + k];
        sum += diagonal[products * j + k] * own[k];
      }
      for (int p = start[j]; p < start[j + 1]; ++p) {
        const Index other = column[p];
        double push = 0.0;
        for (int k = 0; k < products; ++k) {
          const double c = coefficient[static_cast<Index>(products) * p + k];
          sum += c * x[products * other + k];
          push += c * own[k];
        }
        y[other] -= push;
      }
      y[j] -= sum;
    });
  }

  StepReport advance(const system::State& from, system::State& to) {
    const double h = h_, q_from_a0 = h * h * (0.5 - p_.beta), q_from_a1 = h * h * p_.beta;
    const double v_from_a0 = h * (1.0 - p_.gamma), v_from_a1 = h * p_.gamma;
    const double* const q0 = from.q.data();
    const double* const v0 = from.v.data();
    const double* const a0 = from.auxiliary_acceleration.data();
    double* const q1 = to.q.data();
    double* const v1 = to.v.data();
    double* const a1 = to.auxiliary_acceleration.data();
    const int* const order = order_.data();
    double sum = 0.0;
    factor_.backward(right_, [=, &sum](Index j, double now) {
      const int i = order[j];
      q1[i] = q0[i] + (h * v0[i] + q_from_a0 * a0[i] + q_from_a1 * now);
      v1[i] = v0[i] + (v_from_a0 * a0[i] + v_from_a1 * now);
      a1[i] = now;
      sum += now;
    });
    if (!std::isfinite(sum))
      for (Index i = 0; i < n_; ++i)
        if (!std::isfinite(a1[i])) return {StepOutcome::not_finite, i};
    return {};
  }

  void add_loads(const double* load) {
    const auto& terms = system_.loads().terms();
    for (std::size_t i = 0; i < terms.size(); ++i)
      for (std::size_t k = 0; k < terms[i].rows.size(); ++k)
        right_[place_[static_cast<std::size_t>(terms[i].rows[k])]] += load[i] * terms[i].weights[k];
  }

  /// out += factor * B fc on the last k places.
  void add_to_contacts(double factor, const Vector& force, double* out) const {
    for (Index i = 0; i < m_; ++i) {
      const Index first = first_[static_cast<std::size_t>(i)], second = second_[static_cast<std::size_t>(i)];
      if (first != ground) out[first] += factor * force[i];
      if (second != ground) out[second] -= factor * force[i];
    }
    for (const auto& [contact, place, weight] : shares_) out[place] += factor * weight * force[contact];
  }

  /// Displacement over the step of one of the last k places without the contacts' new forces.
  double free_travel(Index place, const system::State& from) const {
    if (place == ground) return 0.0;
    const Index i = order_[static_cast<std::size_t>(n_ - k_ + place)];
    return h_ * from.v[i] + h_ * h_ * ((0.5 - p_.beta) * from.auxiliary_acceleration[i] + p_.beta * last_[place]);
  }

  /// Its velocity at the end of the step without them.
  double free_velocity(Index place, const system::State& from) const {
    if (place == ground) return 0.0;
    const Index i = order_[static_cast<std::size_t>(n_ - k_ + place)];
    return from.v[i] + h_ * ((1.0 - p_.gamma) * from.auxiliary_acceleration[i] + p_.gamma * last_[place]);
  }

  GeneralizedAlpha p_;
  const system::LocallyNonlinear& system_;
  Index n_, m_, sliders_, k_ = 0;
  double h_ = 0.0;
  std::optional<Rayleigh> rayleigh_;
  numerics::OrderedFactor factor_;
  std::vector<Index> first_, second_;                           // of each contact, among the last k places
  std::vector<system::LocallyNonlinear::ContactShare> shares_;  // likewise
  std::vector<int> order_, place_;                              // elimination place -> coordinate, and back
  Vector mass_;                                                 // its diagonal; empty if it is not diagonal
  int products_ = 0;
  std::vector<int> start_, column_;  // rows in the order of elimination, columns likewise, those beyond the diagonal
  std::vector<int> new_start_, new_column_;  // those that no earlier row has
  std::vector<double> diagonal_, coefficient_;
  Vector combined_, right_, last_, push_, trial_, penetration_;
  ContactProblem contact_;
  std::optional<LawProblem> laws_;  // in its place where there are others than sliders and stops
};

}  // namespace

std::unique_ptr<AlphaStep> make_sparse_alpha_step(const GeneralizedAlpha& parameters,
                                                  const system::LocallyNonlinear& system) {
  return std::make_unique<SparseAlphaStep>(parameters, system);
}

std::unique_ptr<AlphaStep> make_alpha_step(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system) {
  return system.size() <= largest_dense_size ? make_dense_alpha_step(parameters, system)
                                             : make_sparse_alpha_step(parameters, system);
}

}  // namespace rubato::integrate
