#pragma once

#include <rubato/steady/marching/time_marching.hpp>

#include <memory>
#include <vector>

// What the parts of TimeMarchingSolver share; nobody else includes this.
namespace rubato::steady {

inline bool is_repeating(SteadyStatus status) {
  return status == SteadyStatus::converged || status == SteadyStatus::subharmonic || status == SteadyStatus::drifting;
}

/// What is remembered of the points solved last at one place of the list.
struct TimeMarchingSolver::Place {
  system::Excitation excitation;
  Vector state, earlier;           // at the last point, and at the one before
  double earlier_frequency = 0.0;  // 0: there is none
  Vector offset;                   // of the sliders that never slipped
  double step_error = -1.0;        // times N^p; < 0: not known
};

struct TimeMarchingSolver::Engine {
  std::unique_ptr<PeriodMap> map;
  std::unique_ptr<OrbitExtrapolation> extrapolation;
  std::vector<Place> places;
  std::vector<PeriodRecord> records;
  int steps = 0;       // a period, of the states
  int next_steps = 0;  // that would have been enough
  Matrix rigid;        // motions along which the states may be moved

  explicit Engine(std::unique_ptr<PeriodMap> given)
      : map(std::move(given)), extrapolation(make_extrapolation(map->size())) {}
  void forget() {
    places.clear();
    extrapolation->forget();
    next_steps = 0;
  }
};

}  // namespace rubato::steady
