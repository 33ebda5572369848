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

}  // namespace

Matrix kernel_of(const Matrix& map, const Matrix& motions) {
  const Eigen::FullPivLU<Matrix> lu(map);
  const Index count = motions.cols() > 0 ? lu.dimensionOfKernel() : 0;
  if (count == 0) return Matrix(motions.rows(), 0);
  const Eigen::HouseholderQR<Matrix> basis(lu.kernel());
  return motions * (basis.householderQ() * Matrix::Identity(motions.cols(), count));
}

Matrix free_motions(const system::LocallyNonlinear& system, const Matrix& rigid) {
  const Index n = system.size(), contacts = system.contact_count();
  if (rigid.cols() == 0) return Matrix(n, 0);
  const double damping = std::max(system.damping().norm(), std::numeric_limits<double>::min());
  Matrix resisted(contacts + n, rigid.cols());
  for (Index k = 0; k < rigid.cols(); ++k) {
    const Vector motion = rigid.col(k) / rigid.col(k).norm();
    for (Index i = 0; i < contacts; ++i) resisted(i, k) = system.relative_displacement(i, motion);
    resisted.col(k).tail(n) = system.damping() * motion / damping;
  }
  return kernel_of((resisted.array().abs() < round_off).select(0.0, resisted), rigid);
}

Matrix free_motions(const system::LocallyNonlinear& system) {
  if (system.size() > largest) return Matrix(system.size(), 0);
  const numerics::SymmetricModes modes = numerics::all_modes(system.stiffness(), system.mass());
  return free_motions(system, modes.shapes.leftCols((modes.eigenvalues.array() == 0.0).count()));
}

}  // namespace rubato::steady
