#pragma once

#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance_equations.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>
#include <rubato/steady/undamped_resonance.hpp>

#include <algorithm>
#include <optional>
#include <utility>

// What the parts of HarmonicBalanceSolver share; nobody else includes this.
namespace rubato::steady {

/// An answer whose error falls as one over its orders is twice as far off as from that with two thirds of the orders.
inline constexpr double caution = 2.0;

/// Orders that groups of laws begin with.
inline constexpr int fewest_for_groups = 8;

/// The orders a step adds: enough to pay for solving again.
inline int more(int count) { return count + std::max(1, count / 2); }
/// Orders to which a step adds about so many.
inline int fewer(int count) { return std::max(1, (2 * count + 2) / 3); }

/// Samples of laws in a period: some for each of the orders, and at least those wanted.
int samples_for(const Orders& orders, int wanted);

struct HarmonicBalanceSolver::Implementation {
  Implementation(const system::LocallyNonlinear& s, SteadyRequest r, HarmonicBalanceOptions o);

  /// Displacements and forces of the sliders.
  struct Motion {
    SliderSeries displacement, force;
    void resize(const Orders& orders, bool with_mean, Index sliders) {
      displacement.resize(orders, with_mean, sliders);
      force.resize(orders, with_mean, sliders);
    }
  };
  /// A point solved, from which the next is predicted.
  struct Past {
    double angular_frequency = 0.0;
    Motion motion;
  };
  /// How far Newton's method goes at a point: from what the points before left, briefly, or from nothing, and less far
  /// where the motion can be sought in another way.
  enum class Effort { brief, limited, full };

  void forget();
  void take_loads(const system::Excitation& excitation);
  bool condense(const system::Excitation& excitation, int stride, int places, bool with_mean);
  bool condense_one(CondensedHarmonic& harmonic, double angular_frequency, int order);
  bool is_driven_beyond_friction(const system::Excitation& excitation);
  int orders_to_probe(const system::Excitation& excitation, const Orders& orders) const;
  bool attempt(const system::Excitation& excitation, Effort effort, SteadyResponse& response);
  bool attempt_held(const system::Excitation& excitation, Effort effort, SteadyResponse& response);
  bool predict(double angular_frequency, const Orders& orders, bool with_mean);
  bool newton(const system::Excitation& excitation, bool has_start, bool has_solution, Effort effort,
              SteadyResponse& response);
  bool solve_from(bool has_start, bool has_solution, int& iterations);
  Vector slider_receptances() const;
  bool soften(const Vector& receptances);
  double return_to(const Motion& motion, const Vector& compliance);
  void forget_points();
  double change_since(const ComplexMatrix& before) const;
  /// Whether there are other contacts than sliders.
  bool has_laws() const { return equations.front().has_laws(); }
  bool has_solved_points() const { return !past.empty() || count_wanted > 1 || firmness > 0.0; }
  template <class Apply>
  bool follow(double parameter, double step, int& iterations, Apply&& apply);
  bool lower_the_limits(const system::Excitation& excitation, int& iterations);
  bool release(int& iterations);
  bool raise_the_loads(int& iterations);
  bool add_orders(int& iterations);
  void start_stuck();
  double truncation_error(int probes);
  double sampling_error(int probes);
  double relative_change(const ComplexMatrix& of_left_out, int probes) const;
  bool laws_close() const;
  bool laws_act_oddly() const;
  void recover();
  void fill(const system::Excitation& excitation, SteadyResponse& response);
  void fill_without_answer(const system::Excitation& excitation, SteadyResponse& response);
  bool can_be_shot(const system::Excitation& excitation, SteadyStart start);
  system::LocallyNonlinear with_contacts_up_to(double most) const;
  bool shoot(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response);
  void load_on(int order, ComplexVector& load) const;

  const system::LocallyNonlinear& system;
  SteadyRequest request;
  HarmonicBalanceOptions options;
  CondensedStructure structure;
  double highest_frequency = 0.0;
  Index sliders;     ///< the first of what is condensed to; behind them the laws
  Vector stiffness;  ///< of both; of laws that by which they are held
  Vector limits;     ///< of both at the point: none of laws
  bool laws_are_odd;
  int samples_wanted = 0;  ///< of laws; 0: by the orders

  Matrix patterns;                                   ///< orthonormal [n x e]
  std::vector<std::pair<int, ComplexVector>> loads;  ///< order and shares in the patterns; order 0: static
  system::Excitation last_loads;                     ///< those that `loads` came from

  int harmonics_stride = 0;
  std::vector<CondensedHarmonic> harmonics;  ///< place 0: mean; place 1 + i: order i
  std::vector<HarmonicBalanceEquations> equations;
  SliderSeries series;
  Motion guess;                                ///< of Newton's method
  double firmness = 0.0, firmness_used = 0.0;  ///< see soften; 0: none was found yet
  double residual = 0.0;
  Vector offsets, remembered_offsets;
  std::vector<Past> past;  ///< newest first
  std::vector<const Past*> usable;
  int count_wanted = 1;
  std::optional<SteadyDiscretisation> held_to;  ///< of all points, whatever its error
  bool held_with_error = true;
  int samples_used = 0;  ///< of laws, at the last balance

  system::Excitation last;      ///< the point solved last, for its waveform
  ComplexMatrix column_forces;  ///< forces on the driven columns of each place [m + e x places]
  ComplexMatrix observed;       ///< [o x count]: X_k
  ComplexVector moved;          ///< of all columns, at one place
  double largest_moved = 0.0;   ///< of them
  Vector observed_mean;
  ComplexMatrix left_out, forces_left_out, force_change;
  TurningPoints turning;
  bool can_condense = false;                   ///< the structure, at the point solved last
  bool has_answer = false;                     ///< some orders were balanced there
  std::optional<UndampedResonance> resonance;  ///< made where it is asked for
  std::optional<bool> may_walk;                ///< springs leave a motion free that sliders see; nothing: not yet known
  std::unique_ptr<system::LocallyNonlinear> shot_system;  ///< that of `shot`, where it is not the one given
  std::unique_ptr<PeriodicSolver> shot;                   ///< the last point, where no series balances it
  std::optional<std::pair<double, double>> fastest;       ///< natural frequency, sliders removed and stuck [rad/s]
};

}  // namespace rubato::steady
