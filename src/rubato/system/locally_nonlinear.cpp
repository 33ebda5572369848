#include <rubato/system/locally_nonlinear.hpp>

#include <Eigen/SparseCholesky>

#include <cassert>

namespace rubato::system {
namespace {

bool is_diagonal(const SparseMatrix& matrix) {
  for (Index column = 0; column < matrix.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      if (entry.row() != column && entry.value() != 0.0) return false;
  return true;
}

}  // namespace

LocallyNonlinear::LocallyNonlinear(Parts parts) : parts_(std::move(parts)) {
  const Index n = size();
  assert(parts_.damping.rows() == n && parts_.stiffness.rows() == n);
  State& start = parts_.start;
  if (start.q.size() == 0) start.q = Vector::Zero(n);
  if (start.v.size() == 0) start.v = Vector::Zero(n);
  if (start.slider_force.size() == 0) start.slider_force = Vector::Zero(slider_count());
  if (start.auxiliary_acceleration.size() == 0) start.auxiliary_acceleration = Vector::Zero(n);
  parts_.mass.makeCompressed();
  parts_.damping.makeCompressed();
  parts_.stiffness.makeCompressed();
  has_diagonal_mass_ = is_diagonal(parts_.mass);
}

void LocallyNonlinear::add_slider_forces(const Vector& slider_force, double factor, Vector& out) const {
  for (Index i = 0; i < slider_count(); ++i) {
    const auto& slider = parts_.sliders[static_cast<std::size_t>(i)];
    if (slider.first != ground) out[slider.first] += factor * slider_force[i];
    if (slider.second != ground) out[slider.second] -= factor * slider_force[i];
  }
}

SparseMatrix LocallyNonlinear::stuck_stiffness() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& slider : parts_.sliders) {
    if (slider.first != ground) entries.emplace_back(slider.first, slider.first, slider.stiffness);
    if (slider.second != ground) entries.emplace_back(slider.second, slider.second, slider.stiffness);
    if (slider.first == ground || slider.second == ground) continue;
    entries.emplace_back(slider.first, slider.second, -slider.stiffness);
    entries.emplace_back(slider.second, slider.first, -slider.stiffness);
  }
  SparseMatrix stuck(size(), size());
  stuck.setFromTriplets(entries.begin(), entries.end());
  return SparseMatrix(parts_.stiffness + stuck);
}

struct EquilibriumAcceleration::Workspace {
  explicit Workspace(const LocallyNonlinear& s) : system(s), loads(s.loads()), force(s.size()) {
    if (system.has_diagonal_mass())
      inverse_mass = Vector(system.mass().diagonal()).cwiseInverse();
    else
      factor.compute(system.mass());
  }
  const LocallyNonlinear& system;
  Loads loads;
  Vector force, inverse_mass;
  Eigen::SimplicialLDLT<SparseMatrix> factor;
};

EquilibriumAcceleration::EquilibriumAcceleration(const LocallyNonlinear& system)
    : work_(std::make_unique<Workspace>(system)) {}
EquilibriumAcceleration::~EquilibriumAcceleration() = default;
EquilibriumAcceleration::EquilibriumAcceleration(EquilibriumAcceleration&&) noexcept = default;

void EquilibriumAcceleration::operator()(const State& state, Vector& acceleration, model::Side side) {
  Workspace& w = *work_;
  w.loads.evaluate(state.t, w.force, side);
  w.force.noalias() -= w.system.damping() * state.v;
  w.force.noalias() -= w.system.stiffness() * state.q;
  w.system.add_slider_forces(state.slider_force, -1.0, w.force);
  if (w.inverse_mass.size() > 0)
    acceleration = w.force.cwiseProduct(w.inverse_mass);
  else
    acceleration = w.factor.solve(w.force);
}

}  // namespace rubato::system
