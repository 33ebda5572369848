#include "damper_problem.hpp"

namespace rubato::benchmarks {

DamperProblem::DamperProblem(const system::LocallyNonlinear& system) {
  const SparseMatrix &m = system.mass(), &c = system.damping(), &k = system.stiffness();
  const auto& term = system.loads().terms()[0];
  omega_ = std::get<model::HarmonicLaw>(term.law).angular_frequency;
  for (std::size_t i = 0; i < term.rows.size(); ++i) load_[term.rows[i] == 1 ? 0 : 1] += term.weights[i];
  m_disk_ = m.coeff(0, 0);
  k_disk_ = k.coeff(0, 0);
  k_join_ = k.coeff(0, 1);
  k_blade_ = k.coeff(1, 1);
  k_damper_ = k.coeff(4, 4);
  c_disk_ = c.coeff(0, 0);
  c_join_ = c.coeff(0, 1);
  c_blade_ = c.coeff(1, 1);
  c_damper_ = c.coeff(4, 4);
  kt_ = system.sliders()[0].stiffness;
  limit_ = system.sliders()[0].limit;
}

void DamperProblem::jacobian(const std::function<void(int, int, double)>& set) const {
  for (int i = 0; i < 5; ++i) set(i, 5 + i, 1.0);
  double on_damper = -k_damper_;
  for (int sector = 0; sector < 2; ++sector) {
    const int disk = 2 * sector, blade = disk + 1;
    const double kt = side_[sector] == 0 ? kt_ : 0.0;
    set(5 + disk, disk, -k_disk_ / m_disk_);
    set(5 + disk, blade, -k_join_ / m_disk_);
    set(5 + disk, 5 + disk, -c_disk_ / m_disk_);
    set(5 + disk, 5 + blade, -c_join_ / m_disk_);
    set(5 + blade, disk, -k_join_);
    set(5 + blade, blade, -k_blade_ - kt);
    set(5 + blade, 4, kt);
    set(5 + blade, 5 + disk, -c_join_);
    set(5 + blade, 5 + blade, -c_blade_);
    set(9, blade, kt);
    on_damper -= kt;
  }
  set(9, 4, on_damper);
  set(9, 9, -c_damper_);
}

void DamperProblem::change(int slider, const double* y) {
  ++transitions_;
  if (side_[slider] == 0) {
    side_[slider] = force(slider, y) > 0.0 ? 1 : -1;
    return;
  }
  offset_[slider] = side_[slider] * limit_ - kt_ * (y[2 * slider + 1] - y[4]);
  side_[slider] = 0;
}

}  // namespace rubato::benchmarks
