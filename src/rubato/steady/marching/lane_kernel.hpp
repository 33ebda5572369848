#pragma once

#include <rubato/core/types.hpp>

#include <vector>

namespace rubato::steady {

inline constexpr int largest_lane_model = 16;  ///< coordinates, and sliders

/// One step of a linear method on a structure with sliders, in states y = (q, v / omega, ...) that are interleaved,
/// `width` numbers a coordinate. With fc the slider forces, z = y - yp the part that they drive (yp: the response of
/// the method to the loads alone, repeating by itself), and w = z - G1 fc, a step is
///
///   w1 = E w0 + (E G1 + G0) fc0,   u1 = U w1 + up(t1) - W fc1,   fc1 = clamp(kT (u1 - slip0), -limit, limit)
///
/// where y1 = E y0 + G0 fc0 + G1 fc1 is the step of the method. E has `blocks` equal blocks on its diagonal: one a mode
/// where the damping couples none. The forces are found by sweeps of Gauss and Seidel, which contract by the compliance
/// of a step against that of the slider, about (omega h)^2.
struct LaneStep {
  int coordinates = 0, sliders = 0;
  int width = 2;                    ///< numbers a coordinate
  int blocks = 0, block = 0;        ///< blocks x block = coordinates x width
  int harmonics = 0;                ///< of the loads
  int steps = 0;                    ///< a period
  int sweeps = 1;                   ///< of Gauss and Seidel
  std::vector<double> propagator;   ///< E [blocks x block x block]
  std::vector<double> from_force;   ///< E G1 + G0 [size x m]
  std::vector<double> end_force;    ///< G1 [size x m]
  std::vector<double> relative;     ///< U [m x coordinates]
  std::vector<double> coupling;     ///< W [m x m]
  std::vector<double> stiffness;    ///< kT [m]
  std::vector<double> flexibility;  ///< 1 / kT [m]
  std::vector<double> share;        ///< 1 / (1 + kT W_ii) [m]
  std::vector<double> turn;         ///< cos, sin of k omega t_j for every sample and harmonic [steps + 1 x 2 harmonics]

  int size() const { return coordinates * width; }
};

/// What a record needs beyond the step: combinations of the coordinates.
struct LaneObservation {
  int observed = 0;
  bool has_rates = false, has_works = false;
  double angular_frequency = 0.0;
  std::vector<double> combination;  ///< of each observed [o x coordinates]
  std::vector<double> stiffness;    ///< of the coordinates, per unit of mass [n x n], for accelerations
  std::vector<double> damping;      ///< [n x n]
  std::vector<double> slider_push;  ///< acceleration of the coordinates by unit slider forces [n x m]
  double work_unit = 0.0;           ///< the mass of a coordinate [kg]

  /// Rows of a sample: positions, velocities, (accelerations), slider forces, displacements.
  int rows(int sliders) const { return observed * (has_rates ? 3 : 2) + 2 * sliders; }
};

/// The numbers of a lane (or of a pack of them).
template <class Real>
struct LaneState {
  std::vector<Real> w, force, slip;  ///< [size], [m], [m]
  std::vector<Real> limit;           ///< [m]
  std::vector<Real> load_relative;   ///< up: constant, then in phase and in quadrature of each harmonic [1 + 2H x m]
  std::vector<Real> load_state;      ///< yp: likewise [1 + 2H x size]
  std::vector<Real> load;            ///< loads per unit of mass: likewise [1 + 2H x coordinates]
  Real viscous_work = Real(0.0), input_work = Real(0.0);
};

/// Marches one period. With `observation` it writes steps + 1 samples to `samples` (the first only if
/// `writes_first`), and adds up the works.
template <class Real>
void march_period(const LaneStep& step, LaneState<Real>& state, const LaneObservation* observation, Real* samples);

}  // namespace rubato::steady
