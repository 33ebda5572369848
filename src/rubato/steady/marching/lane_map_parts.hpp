#pragma once

#include <rubato/integrate/stepper.hpp>
#include <rubato/steady/marching/lane_kernel.hpp>
#include <rubato/steady/marching/pack.hpp>
#include <rubato/steady/marching/period_map.hpp>

#include <variant>
#include <vector>

// What the parts of the lane map share; nobody else includes this.
namespace rubato::steady {

/// Points that move together.
template <class Real>
struct LaneGroup {
  Index first = 0, count = 0;
  LaneState<Real> state;
  std::vector<Real> samples;
};

/// A step of a given length, and the response of the method to unit harmonic loads.
struct PreparedLanes {
  LaneStep step;
  Matrix propagator;                     // E, whole
  Matrix end_force;                      // G1
  std::vector<int> orders;               // of the harmonics; 0: static
  std::vector<ComplexMatrix> responses;  // yp of unit loads on the coordinates, one an order [size x n]
  bool is_sound = false;
};

/// PeriodMap of small models: the step as a few matrices in modal coordinates, marched in the lanes of a pack.
class LaneMap final : public PeriodMap {
 public:
  LaneMap(const integrate::Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request);

  Index size() const override { return n_ * width_ + m_; }
  Index slip_start() const override { return 2 * n_; }
  Index slips() const override { return m_; }
  Index lanes() const override { return 16; }  // of the widest pack

  bool prepare(std::span<const system::Excitation> excitations, int steps) override;
  bool advance(const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records, Index first) override;
  void encode(const system::State& state, LaneArray& states, Index lane) override;
  void displace(const Vector& by, LaneArray& states, Index lane) override;
  double observed_size(const LaneArray& differences, Index lane) const override;
  Matrix linear_update() override;

 private:
  // Row of an outer state for number c of coordinate k.
  Index row_of(Index k, Index c) const { return c < 2 ? c * n_ + k : 2 * n_ + m_ + k; }
  system::LocallyNonlinear coordinates_with(std::vector<system::LoadTerm> terms) const;
  PreparedLanes prepare_step(int steps, const std::vector<int>& orders) const;
  void read_propagator(integrate::Stepper& stepper, double h, double quiet, PreparedLanes& result) const;
  bool read_response(int order, double h, const PreparedLanes& prepared, ComplexMatrix& response) const;
  Vector scaled(const system::State& state) const;
  template <class Real>
  void load(std::span<const system::Excitation> excitations, LaneGroup<Real>& group) const;
  template <class Real>
  void advance(LaneGroup<Real>& group, const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records,
               Index first);

  integrate::Method method_;
  Index n_, m_, width_;
  double unit_mass_ = 1.0, omega_ = 0.0;
  bool is_coupled_ = false;
  Matrix modes_, to_modes_;     // q = modes x, x = to_modes q, modes^T M modes = unit_mass I
  Matrix stiffness_, damping_;  // of the coordinates x, per unit of mass
  Matrix relative_, push_;      // u = relative x; acceleration of x by slider forces
  Vector slider_stiffness_;
  LaneObservation observation_;
  std::vector<PreparedLanes> prepared_;  // for this frequency
  std::size_t current_ = 0;
  std::vector<std::variant<LaneGroup<double>, LaneGroup<Pack<8>>, LaneGroup<Pack<16>>>> groups_;
  system::State start_;
  // For encoding: the system under the loads bound last, one a lane.
  std::vector<system::Excitation> excitations_;
  const system::LocallyNonlinear& system_;
};

}  // namespace rubato::steady
