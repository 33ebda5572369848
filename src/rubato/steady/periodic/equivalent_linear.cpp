#include <rubato/steady/periodic/equivalent_linear.hpp>

#include <rubato/steady/assembled_stiffness.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr int most_rounds = 60;

// Stiffness (real) and damping (imaginary) of a slider for u = amplitude cos(theta): the first harmonic of its loop.
Complex equivalent_stiffness(double stiffness, double limit, double amplitude) {
  if (limit <= 0.0) return 0.0;
  const double slip = limit / stiffness;
  if (amplitude <= slip) return stiffness;
  const double turn = std::acos(1.0 - 2.0 * slip / amplitude);  // the angle from a reversal to slip
  return {stiffness / std::numbers::pi * (turn - 0.5 * std::sin(2.0 * turn)),
          4.0 * limit / (std::numbers::pi * amplitude) * (1.0 - slip / amplitude)};
}

// K - w^2 M + i w C with a complex stiffness of each slider; at w = 0 only its real part.
ComplexMatrix dynamic_stiffness(const system::LocallyNonlinear& system, double w, const ComplexVector& of_sliders) {
  ComplexMatrix dynamic =
      assembled_stiffness(Matrix(system.stiffness()), Matrix(system.mass()), Matrix(system.damping()), w);
  for (Index i = 0; i < system.slider_count(); ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    const Complex k = w > 0.0 ? of_sliders[i] : Complex(of_sliders[i].real(), 0.0);
    if (slider.first != ground) dynamic(slider.first, slider.first) += k;
    if (slider.second != ground) dynamic(slider.second, slider.second) += k;
    if (slider.first != ground && slider.second != ground) {
      dynamic(slider.first, slider.second) -= k;
      dynamic(slider.second, slider.first) -= k;
    }
  }
  return dynamic;
}

}  // namespace

bool equivalent_linear_state(const system::LocallyNonlinear& system, const system::Excitation& excitation, Vector& q,
                             Vector& v, Vector& slider_force) {
  const Index n = system.size(), m = system.slider_count();
  const double omega = excitation.angular_frequency;
  // The load that a slider sees most is taken as its fundamental.
  const auto main = std::max_element(excitation.harmonics.begin(), excitation.harmonics.end(),
                                     [](const system::LoadHarmonic& a, const system::LoadHarmonic& b) {
                                       return a.amplitude.norm() < b.amplitude.norm();
                                     });
  ComplexVector equivalent(m);
  for (Index i = 0; i < m; ++i)
    equivalent[i] = excitation.limits[i] > 0.0 ? system.sliders()[static_cast<std::size_t>(i)].stiffness : 0.0;

  const auto respond = [&](double w, const ComplexVector& load) {
    return ComplexVector(dynamic_stiffness(system, w, equivalent).partialPivLu().solve(load));
  };
  const auto displacement = [&](Index i, const auto& x) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    return (slider.first == ground ? Complex(0.0) : Complex(x[slider.first])) -
           (slider.second == ground ? Complex(0.0) : Complex(x[slider.second]));
  };

  ComplexVector response = ComplexVector::Zero(n);
  if (main != excitation.harmonics.end()) {
    for (int round = 0; round < most_rounds; ++round) {
      response = respond(main->order * omega, main->amplitude);
      if (!response.allFinite()) break;
      double change = 0.0;
      for (Index i = 0; i < m; ++i) {
        const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
        const Complex next =
            equivalent_stiffness(slider.stiffness, excitation.limits[i], std::abs(displacement(i, response)));
        change = std::max(change, std::abs(next - equivalent[i]) / slider.stiffness);
        equivalent[i] = 0.5 * (equivalent[i] + next);
      }
      if (change < 1e-4) break;
    }
  }
  q.setZero(n);
  v.setZero(n);
  slider_force.setZero(m);
  for (const system::LoadHarmonic& load : excitation.harmonics) {
    const double w = load.order * omega;
    const ComplexVector x = &load == &*main ? response : respond(w, load.amplitude);
    q += x.real();
    v -= w * x.imag();
    for (Index i = 0; i < m; ++i) slider_force[i] += (equivalent[i] * displacement(i, x)).real();
  }
  if (excitation.constant.cwiseAbs().maxCoeff() > 0.0) {
    const ComplexVector x = respond(0.0, excitation.constant.cast<Complex>());
    q += x.real();
    for (Index i = 0; i < m; ++i) slider_force[i] += (equivalent[i] * displacement(i, x)).real();
  }
  for (Index i = 0; i < m; ++i)
    slider_force[i] = std::clamp(slider_force[i], -excitation.limits[i], excitation.limits[i]);
  return q.allFinite() && v.allFinite() && slider_force.allFinite();
}

}  // namespace rubato::steady
