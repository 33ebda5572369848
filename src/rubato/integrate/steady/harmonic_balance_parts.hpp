#pragma once

#include <rubato/integrate/steady/harmonic_balance.hpp>
#include <rubato/integrate/steady/harmonic_balance_equations.hpp>
#include <rubato/integrate/steady/periodic_solver.hpp>
#include <rubato/integrate/steady/undamped_resonance.hpp>

#include <optional>
#include <utility>

// What the parts of HarmonicBalanceSolver share; nobody else includes this.
namespace rubato::integrate {

struct HarmonicBalanceSolver::Implementation {
  Implementation(const system::LocallyNonlinear& s, SteadyRequest r, HarmonicBalanceOptions o);

  /// A point solved, from which the next is predicted.
  struct Past {
    double angular_frequency = 0.0;
    SliderSeries series;
  };

  void forget();
  void take_loads(const Excitation& excitation);
  bool condense(const Excitation& excitation, int stride, int places, bool with_mean);
  bool condense_one(CondensedHarmonic& harmonic, double angular_frequency, int order);
  bool is_driven_beyond_friction(const Excitation& excitation);
  int orders_to_probe(const Excitation& excitation, const Orders& orders) const;
  void predict(double angular_frequency, const Orders& orders, bool with_mean);
  bool newton(const Excitation& excitation, bool has_solution, SteadyResponse& response);
  template <class Apply>
  bool follow(double parameter, double step, int& iterations, Apply&& apply);
  bool lower_the_limits(const Excitation& excitation, int& iterations);
  bool add_orders(int& iterations);
  void start_stuck();
  double truncation_error(int probes);
  void recover();
  void fill(const Excitation& excitation, SteadyResponse& response);
  void fill_without_answer(const Excitation& excitation, SteadyResponse& response);
  bool walks(const Excitation& excitation, SteadyStart start, SteadyResponse& response);
  void load_on(int order, ComplexVector& load) const;

  const system::LocallyNonlinear& system;
  SteadyRequest request;
  HarmonicBalanceOptions options;
  CondensedStructure structure;
  double highest_frequency = 0.0;
  Vector stiffness;

  Matrix patterns;                                   ///< orthonormal [n x e]
  std::vector<std::pair<int, ComplexVector>> loads;  ///< order and shares in the patterns; order 0: static
  Excitation last_loads;                             ///< those that `loads` came from

  int harmonics_stride = 0;
  std::vector<CondensedHarmonic> harmonics;  ///< place 0: mean; place 1 + i: order i
  std::vector<HarmonicBalanceEquations> equations;
  SliderSeries series, start_series;
  Vector offsets, remembered_offsets;
  std::vector<Past> past;  ///< newest first
  std::vector<const Past*> usable;
  int count_wanted = 1;

  Excitation last;              ///< the point solved last, for its waveform
  ComplexMatrix column_forces;  ///< forces on the driven columns of each place [m + e x places]
  ComplexMatrix observed;       ///< [o x count]: X_k
  ComplexVector moved;          ///< of all columns, at one place
  double largest_moved = 0.0;   ///< of them
  Vector observed_mean;
  ComplexMatrix left_out, forces_left_out, force_change;
  TurningPoints turning;
  bool has_answer = false;                     ///< of the point solved last
  std::optional<UndampedResonance> resonance;  ///< made where it is asked for
  std::optional<bool> may_walk;                ///< springs leave a motion free that sliders see; nothing: not yet known
  std::unique_ptr<PeriodicSolver> walking;     ///< the last point, where it drifts
};

}  // namespace rubato::integrate
