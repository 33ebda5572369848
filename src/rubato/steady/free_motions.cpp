#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/free_motions.hpp>

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <limits>

namespace rubato::steady {
namespace {

constexpr Index largest = 300;       // coordinates: all modes are sought
constexpr double round_off = 1e-12;  // of a motion

Matrix rigid_motions(const system::LocallyNonlinear& system) {
  if (system.size() > largest) return Matrix(system.size(), 0);
  const numerics::SymmetricModes modes = numerics::all_modes(system.stiffness(), system.mass());
  return modes.shapes.leftCols((modes.eigenvalues.array() == 0.0).count());
}

}  // namespace

Matrix kernel_of(const Matrix& map, const Matrix& motions) {
  if (motions.cols() == 0 || map.rows() == 0) return motions;
  const Eigen::FullPivLU<Matrix> lu(map);
  const Index count = motions.cols() > 0 ? lu.dimensionOfKernel() : 0;
  if (count == 0) return Matrix(motions.rows(), 0);
  const Eigen::HouseholderQR<Matrix> basis(lu.kernel());
  return motions * (basis.householderQ() * Matrix::Identity(motions.cols(), count));
}

Matrix free_motions(const system::LocallyNonlinear& system, const Matrix& rigid) {
  const Matrix unseen = unseen_motions(system, rigid);
  const double damping = std::max(system.damping().norm(), std::numeric_limits<double>::min());
  Matrix resisted(system.size(), unseen.cols());
  for (Index k = 0; k < unseen.cols(); ++k)
    resisted.col(k) = system.damping() * unseen.col(k) / (damping * unseen.col(k).norm());
  return kernel_of((resisted.array().abs() < round_off).select(0.0, resisted), unseen);
}

Matrix unseen_motions(const system::LocallyNonlinear& system, const Matrix& rigid) {
  Matrix seen(system.contact_count(), rigid.cols());
  for (Index k = 0; k < rigid.cols(); ++k)
    for (Index i = 0; i < seen.rows(); ++i)
      seen(i, k) = system.relative_displacement(i, rigid.col(k)) / rigid.col(k).norm();
  return kernel_of((seen.array().abs() < round_off).select(0.0, seen), rigid);
}

Matrix unseen_motions(const system::LocallyNonlinear& system) { return unseen_motions(system, rigid_motions(system)); }

Matrix free_motions(const system::LocallyNonlinear& system) { return free_motions(system, rigid_motions(system)); }

}  // namespace rubato::steady
