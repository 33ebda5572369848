#include <rubato/core/error.hpp>
#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/own_system.hpp>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <utility>

namespace rubato::system {
namespace {

/// The step of a central difference in a number of a vector: the error of rounding and that of the third derivative are
/// alike.
double step_for(const Vector& x) {
  const double share = std::cbrt(std::numeric_limits<double>::epsilon());
  const double size = x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0;
  return share * (size > 0.0 ? size : 1.0);
}

/// The columns of the derivative of `function`, which writes into a vector, by one of the vectors of a state.
template <class Function>
void differentiate(State& state, Vector& variable, Matrix& slopes, const Function& function) {
  const double step = step_for(variable);
  Vector above(slopes.rows()), below(slopes.rows());
  for (Index j = 0; j < variable.size(); ++j) {
    const double here = variable[j];
    variable[j] = here + step;
    const double high = variable[j];
    function(state, above);
    variable[j] = here - step;
    const double low = variable[j];
    function(state, below);
    variable[j] = here;
    slopes.col(j) = (above - below) / (high - low);
  }
}

class OwnEquations final : public ConstrainedEquations {
 public:
  explicit OwnEquations(const OwnSystem& of)
      : of_(of),
        n_(of.size()),
        c_(of.constraint_count()),
        stiffness_(n_, n_),
        damping_(n_, n_),
        curvature_(n_, n_),
        jacobian_(Matrix::Zero(c_, n_)) {
    std::vector<SaddleMatrix::Entry> entries;
    for (Index i = 0; i < n_; ++i)
      for (Index j = 0; j <= i; ++j) entries.emplace_back(i, j);
    for (Index r = 0; r < c_; ++r)
      for (Index j = 0; j < n_; ++j) entries.emplace_back(n_ + r, j);
    saddle_.analyse(of.mass(), c_, std::move(entries), false);
    for (Index i = 0; i < n_; ++i)
      for (Index j = 0; j < n_; ++j) slot_.push_back(saddle_.slot(i, j));
    for (Index r = 0; r < c_; ++r)
      for (Index j = 0; j < n_; ++j) {
        row_slot_.push_back(saddle_.slot(n_ + r, j));
        transposed_slot_.push_back(saddle_.slot(j, n_ + r));
      }
  }

  const ConstrainedSystem& system() const override { return of_; }

  void go_to(const State& state, model::Side side) override {
    state_ = &state;
    side_ = side;
  }

  void residual(Vector& force, Vector& constraint) override {
    force.resize(n_);
    of_.force(*state_, side_, force);
    require_size(force, n_, "force()");
    constraints(constraint);
  }

  void linearise(const Weights& weights, const Vector& multiplier, Vector& force, Vector& constraint) override {
    residual(force, constraint);
    saddle_.begin(weights.mass);
    double* const values = saddle_.values();
    if (weights.stiffness != 0.0 || weights.damping != 0.0) {
      of_.force_slopes(*state_, side_, stiffness_, damping_);
      if (c_ > 0 && weights.stiffness != 0.0) {
        of_.curvature(*state_, multiplier, curvature_);
        stiffness_ += curvature_;
      }
      std::size_t k = 0;
      for (Index i = 0; i < n_; ++i)
        for (Index j = 0; j < n_; ++j)
          values[slot_[k++]] += weights.stiffness * stiffness_(i, j) + weights.damping * damping_(i, j);
    }
    std::size_t k = 0;
    for (Index r = 0; r < c_; ++r)
      for (Index j = 0; j < n_; ++j, ++k) {
        values[row_slot_[k]] += jacobian_(r, j);
        values[transposed_slot_[k]] += jacobian_(r, j);
        saddle_.see(static_cast<int>(r), j, jacobian_(r, j));
      }
    for (Index r = 0; r < c_; ++r)
      if (!of_.is_active(r, *state_)) saddle_.open_rows(r, 1);
    saddle_.end(weights.constraint > 0.0 ? weights.constraint : weights.mass);
  }

  void constraints(Vector& constraint) override {
    constraint.resize(c_);
    if (c_ == 0) return;
    of_.constraint(*state_, constraint);
    require_size(constraint, c_, "constraint()");
    of_.jacobian(*state_, jacobian_);
    if (jacobian_.rows() != c_ || jacobian_.cols() != n_)
      throw InvalidInput(fmt::format("jacobian() writes {} x {} numbers for {} constraints on {} coordinates",
                                     jacobian_.rows(), jacobian_.cols(), c_, n_));
    for (Index r = 0; r < c_; ++r) {
      if (of_.is_active(r, *state_)) continue;
      constraint[r] = 0.0;
      jacobian_.row(r).setZero();
    }
  }

  void add_constraint_force(const Vector& multiplier, double factor, Vector& out) const override {
    if (c_ > 0) out.noalias() += factor * (jacobian_.transpose() * multiplier);
  }

  void constraint_rate(const Vector& v, Vector& out) override {
    out.resize(c_);
    if (c_ == 0) return;
    of_.constraint_time_rate(*state_, out);
    shut_open_rows(out);
    out.noalias() += jacobian_ * v;
  }

  void second_rate(Vector& out) override {
    out.resize(c_);
    if (c_ == 0) return;
    of_.second_rate(*state_, out);
    shut_open_rows(out);
  }

  void force_of_loads(Vector& out) override {
    out.resize(n_);
    of_.force_of_time(*state_, side_, out);
  }

 private:
  static void require_size(const Vector& written, Index size, const char* by) {
    if (written.size() != size)
      throw InvalidInput(fmt::format("{} writes {} numbers instead of {}", by, written.size(), size));
  }
  void shut_open_rows(Vector& values) const {
    for (Index r = 0; r < c_; ++r)
      if (!of_.is_active(r, *state_)) values[r] = 0.0;
  }

  const OwnSystem& of_;
  Index n_, c_;
  const State* state_ = nullptr;
  model::Side side_ = model::Side::left;
  Matrix stiffness_, damping_, curvature_, jacobian_;
  std::vector<int> slot_, row_slot_, transposed_slot_;
};

}  // namespace

OwnSystem::OwnSystem(std::vector<std::string> coordinates, const SparseMatrix& mass, Vector q, Vector v,
                     std::vector<std::string> rows, std::vector<int> phase)
    : coordinates_(std::move(coordinates)), rows_(std::move(rows)), mass_(mass) {
  const Index n = size();
  if (mass_.rows() != n || mass_.cols() != n || q.size() != n || v.size() != n)
    throw InvalidInput(
        fmt::format("a system of {} coordinates has a mass of {} x {}, q of {} and v of {} numbers; give {} of each", n,
                    mass_.rows(), mass_.cols(), q.size(), v.size(), n));
  const Vector diagonal = mass_.diagonal();
  for (Index i = 0; i < n; ++i)
    if (!(diagonal[i] > 0.0))
      throw InvalidInput(
          fmt::format("\"{}\" has no mass ({}); give it one", coordinates_[static_cast<std::size_t>(i)], diagonal[i]));
  const Matrix dense(mass_);
  if (!(dense - dense.transpose()).isZero(1e-12 * diagonal.maxCoeff()) ||
      Eigen::LLT<Matrix>(dense).info() != Eigen::Success)
    throw InvalidInput("the mass of a system must be symmetric and positive definite");
  reference_ = std::sqrt(diagonal.sum()) * q.cwiseAbs().maxCoeff();
  start_.q = std::move(q);
  start_.v = std::move(v);
  start_.acceleration = start_.auxiliary_acceleration = Vector::Zero(n);
  start_.multiplier = Vector::Zero(constraint_count());
  start_.phase = std::move(phase);
}

void OwnSystem::force_slopes(const State& state, model::Side side, Matrix& stiffness, Matrix& damping) const {
  State there = state;
  const auto evaluate = [&](const State& at, Vector& out) { force(at, side, out); };
  differentiate(there, there.q, stiffness, evaluate);
  differentiate(there, there.v, damping, evaluate);
}

void OwnSystem::force_of_time(const State&, model::Side, Vector& f) const { f.setZero(); }

void OwnSystem::constraint(const State&, Vector&) const {
  throw InvalidInput("a system of one's own with constraints must write constraint() and jacobian()");
}

void OwnSystem::jacobian(const State&, Matrix&) const {
  throw InvalidInput("a system of one's own with constraints must write constraint() and jacobian()");
}

void OwnSystem::curvature(const State& state, const Vector& multiplier, Matrix& stiffness) const {
  State there = state;
  Matrix G(constraint_count(), size());
  differentiate(there, there.q, stiffness, [&](const State& at, Vector& out) {
    jacobian(at, G);
    out.noalias() = G.transpose() * multiplier;
  });
}

void OwnSystem::constraint_time_rate(const State&, Vector& rate) const {
  if (!driven_rows().empty())
    throw InvalidInput("a system of one's own with constraints that depend on time must write constraint_time_rate()");
  rate.setZero();
}

void OwnSystem::second_rate(const State& state, Vector& rate) const {
  if (!driven_rows().empty())
    throw InvalidInput("a system of one's own with constraints that depend on time must write second_rate()");
  rate.setZero();
  const double speed = state.v.cwiseAbs().maxCoeff();
  if (!(speed > 0.0)) return;
  const double way = step_for(state.q) / speed;
  State there = state;
  Matrix G(constraint_count(), size());
  for (const double sign : {1.0, -1.0}) {
    there.q = state.q + sign * way * state.v;
    jacobian(there, G);
    rate += (0.5 * sign / way) * (G * state.v);
  }
}

GuardValue OwnSystem::guard(Index, const State&) const {
  throw InvalidInput("a system of one's own with guards must write guard() and pass()");
}

Passage OwnSystem::pass(Index, State&) const {
  throw InvalidInput("a system of one's own with guards must write guard() and pass()");
}

std::unique_ptr<ConstrainedEquations> OwnSystem::equations() const { return std::make_unique<OwnEquations>(*this); }

}  // namespace rubato::system
