#include <rubato/steady/undamped_resonance.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr double driven = 1e-12;  // of |phi| |f|: a load that gives less is none on this motion

// The work that sliders take from a motion: the sum of |b^T phi| limit.
double friction_along(const system::LocallyNonlinear& system, const Vector& limits, const Vector& motion) {
  double taken = 0.0;
  for (Index i = 0; i < system.slider_count(); ++i)
    taken += std::abs(system.relative_displacement(i, motion)) * limits[i];
  return taken;
}

// Those of the motions that no damper resists: a constant load drives the others at a bounded speed. A motion is known
// to `shape_error` of its mass norm: a mass that stands still in it seems to move so much, and its damper to resist.
Matrix undamped(const SparseMatrix& damping, const SparseMatrix& mass, const Matrix& motions) {
  const Matrix resistance = motions.transpose() * (damping * motions);
  const Matrix moduli = motions.cwiseAbs();
  const double terms = (moduli.transpose() * (damping.cwiseAbs() * moduli)).trace();
  const double norm = std::sqrt((motions.transpose() * (mass * motions)).trace());
  const Vector errors = shape_error * norm * Vector(mass.diagonal()).cwiseSqrt().cwiseInverse();
  const double of_errors = errors.dot(damping.cwiseAbs() * errors);
  const Eigen::SelfAdjointEigenSolver<Matrix> parts(resistance);
  const Index count = (parts.eigenvalues().array().abs() <= round_off_of_terms * terms + of_errors).count();
  return motions * parts.eigenvectors().leftCols(count);
}

}  // namespace

UndampedResonance::UndampedResonance(const system::LocallyNonlinear& system)
    : system_(system), stiffness_(system, StuckSliders(static_cast<std::size_t>(system.slider_count()), false)) {}

bool drives(const Vector& motion, const ComplexVector& load) {
  const double given = std::abs((motion.transpose().cast<Complex>() * load)(0));
  return given > driven * motion.cwiseAbs().dot(load.cwiseAbs());
}

const Matrix& UndampedResonance::rigid_motions() {
  if (!rigid_) {
    stiffness_.factorise(0.0);
    rigid_ = stiffness_.free_motions();
  }
  return *rigid_;
}

Matrix UndampedResonance::motions_at(double w) {
  if (w > 0.0) {
    stiffness_.factorise(w);
    return stiffness_.free_motions();
  }
  if (!at_rest_) {
    at_rest_ = rigid_motions();
    if (at_rest_->cols() > 0) at_rest_ = undamped(system_.damping(), system_.mass(), *at_rest_);
  }
  return *at_rest_;
}

bool UndampedResonance::is_carried_off(const Vector& load) {
  const Matrix& motions = rigid_motions();
  for (Index c = 0; c < motions.cols(); ++c)
    if (drives(motions.col(c), load.cast<Complex>())) return true;
  return false;
}

bool UndampedResonance::is_driven_beyond_friction(double w, const ComplexVector& load, const Vector& limits) {
  if (load.isZero(0.0)) return false;
  Matrix motions = motions_at(w);
  if (motions.cols() == 0) return false;
  // Of several motions at one frequency each by itself, and what the load drives of them together, in both phases.
  const Index count = motions.cols();
  if (count > 1) {
    Matrix shares(count, 2);
    shares << motions.transpose() * load.real(), motions.transpose() * load.imag();
    const Matrix together = motions * shares;
    motions.conservativeResize(Eigen::NoChange, count + 2);
    motions.rightCols(2) = together;
  }
  for (Index c = 0; c < motions.cols(); ++c) {
    const Vector motion = motions.col(c);
    if (!drives(motion, load)) continue;
    const double given = std::abs((motion.transpose().cast<Complex>() * load)(0));
    const double taken = friction_along(system_, limits, motion);
    if (w == 0.0 ? given > taken : std::numbers::pi * given >= 4.0 * taken) return true;
  }
  return false;
}

bool UndampedResonance::is_driven_beyond_friction(const system::Excitation& excitation) {
  if (excitation.constant.size() > 0 &&
      is_driven_beyond_friction(0.0, excitation.constant.cast<Complex>(), excitation.limits))
    return true;
  return std::any_of(excitation.harmonics.begin(), excitation.harmonics.end(), [&](const system::LoadHarmonic& load) {
    return is_driven_beyond_friction(load.order * excitation.angular_frequency, load.amplitude, excitation.limits);
  });
}

void make_unbounded(const SteadyRequest& request, Index sliders, SteadyResponse& response) {
  constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const auto observed = static_cast<Index>(request.observed.size());
  response.status = SteadyStatus::unbounded;
  response.residual = response.error = infinity;
  response.amplitude = response.rms = Vector::Constant(observed, infinity);
  response.velocity_amplitude = response.acceleration_amplitude =
      Vector::Constant(request.rates ? observed : 0, infinity);
  response.mean = Vector::Constant(observed, nan);
  response.harmonics = ComplexMatrix::Constant(observed, static_cast<Index>(request.harmonics.size()), {infinity, nan});
  response.dissipated = response.slip_share = response.offset = Vector::Constant(sliders, nan);
  response.viscous_work = response.input_work = nan;
  response.transitions = 0;
  response.drift.resize(0);
}

}  // namespace rubato::steady
