#pragma once

#include <rubato/system/excitation.hpp>

#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace rubato::steady {

/// What is wanted of a steady response.
struct SteadyRequest {
  /// A coordinate, or the difference of two (`second` = ground: the first alone).
  struct Observed {
    Index first = 0, second = ground;
    std::vector<model::Share> shares = {};  ///< instead: a sum of coordinates times weights

    /// Shows the coordinates with their weights.
    template <class Show>
    void for_each(Show&& show) const {
      for (const model::Share& share : shares) show(share.coordinate, share.weight);
      if (!shares.empty()) return;
      if (first != ground) show(first, 1.0);
      if (second != ground) show(second, -1.0);
    }
    /// Its value in a motion of all coordinates [n].
    template <class Motion>
    auto of(const Motion& motion) const {
      std::decay_t<decltype(motion[0])> sum{};
      for_each([&](Index coordinate, double weight) { sum += weight * motion[coordinate]; });
      return sum;
    }
  };
  std::vector<Observed> observed;
  std::vector<int> harmonics = {1};  ///< orders over the fundamental, >= 1
  bool rates = true;                 ///< amplitudes of velocity and acceleration too
};

enum class SteadyStatus {
  converged,
  not_converged,   ///< the numbers are the best found
  subharmonic,     ///< it repeats after several periods only (see SteadyResponse::periods)
  quasi_periodic,  ///< bounded, and does not repeat
  unbounded,       ///< a resonance without damping: no finite response
  drifting,        ///< it repeats but for a displacement (see SteadyResponse::drift): it walks over its sliders
};

/// What a slider that never slips in the period remembers: its force is kT u + offset with any small enough offset.
enum class SteadyStart {
  unloaded,  ///< offset zero (or the nearest that does not slip): as if installed without force
  previous,  ///< the offset at the point solved before
  rest,      ///< the offset that a march from the system's own start at t = 0 ends with
};

/// A steady response at one point. Where a number is not finite the status says why.
struct SteadyResponse {
  SteadyStatus status = SteadyStatus::not_converged;
  double residual = 0.0;  ///< of the equations that the route solves, relative to the size of the response [-]
  double error = 0.0;     ///< estimated relative error of the amplitudes, against the largest observed [-]
  int iterations = 0;     ///< of Newton, or periods marched
  int periods = 1;        ///< after which it repeats

  Vector amplitude;                             ///< half peak to peak of each observed [o] [m]
  Vector velocity_amplitude;                    ///< [o] [m/s]; empty unless asked for
  Vector acceleration_amplitude;                ///< [o] [m/s2]; likewise
  Vector mean, rms;                             ///< over a period; rms about zero [o] [m]
  ComplexMatrix harmonics;                      ///< [o x orders asked for] [m]: x contains Re(c exp(i order omega t))
  Vector dissipated;                            ///< friction work of each slider over a period [m] [J]
  Vector slip_share;                            ///< part of the period in which each slider slips [m] [-]
  Vector offset;                                ///< fc - kT u where a slider never slips, else 0 [m] [N]
  Vector law_dissipated;                        ///< by each of the other laws, then each block [laws + blocks] [J]
  double viscous_work = 0.0, input_work = 0.0;  ///< over a period [J]
  long transitions = 0;                         ///< stick to slip and back, in a period
  /// Displacement of each observed over a period, where the status is drifting; else empty [o] [m]. The amplitudes are
  /// then those of one period with it, and where it is not zero there is no mean and no RMS.
  Vector drift;
};

/// Samples of a steady response at equal times over a period, the first at t = 0; of a drifting one, over the first.
struct Waveform {
  Vector time;                        ///< [p] [s]
  Matrix position, velocity;          ///< of each coordinate [n x p] [m], [m/s]
  Matrix slider_force, displacement;  ///< fc and u of each slider [m x p] [N], [m]
};

/// What a response that is found by a truncated series was found with. Coarser and finer ones differ by their error.
struct SteadyDiscretisation {
  int order = 0;                                              ///< the highest that is balanced
  int samples = 0;                                            ///< of laws, in a period; 0: as many as the orders ask
  double firmness = std::numeric_limits<double>::infinity();  ///< of contacts that are balanced softer than they are

  /// What both can be balanced with: the finer, but for contacts.
  void include(const SteadyDiscretisation& other);
  bool operator==(const SteadyDiscretisation&) const = default;
};

/// Finds steady responses of one structure, point after point. Holds its workspace and the last solutions, from which
/// it continues: one a thread. What it answers may depend, below its error, on the points before; `forget` makes the
/// next answer independent of them.
class SteadySolver {
 public:
  virtual ~SteadySolver() = default;
  virtual void solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) = 0;

  /// How many points of one frequency the solver takes side by side, in the lanes of the processor's vectors.
  virtual int lanes() const { return 1; }
  /// Solves points of one frequency that differ in loads and limits (up to lanes() of them). Each place in the list has
  /// a memory of its own, from which it continues.
  virtual void solve_lanes(std::span<const system::Excitation> excitations, SteadyStart start,
                           std::span<SteadyResponse> responses);
  /// Of the last point solved.
  virtual Waveform waveform(int points) const = 0;
  virtual void forget() = 0;

  /// That of the last point solved; of solvers that go by other ways than series nothing.
  virtual SteadyDiscretisation discretisation() const { return {}; }
  /// From now on all points are solved with this discretisation, whatever its error: answers are then as smooth over
  /// frequency and parameters as the motion is, which differences need. Errors are estimated only where `with_error`,
  /// else 0, and may exceed the tolerance. Nothing: each to the tolerance again.
  virtual void hold(const std::optional<SteadyDiscretisation>& /*held*/, bool /*with_error*/ = true) {}
};

/// Whether sliders are so near that what springs and inertia do at their ends, K u + w^2 M u, is known to 1e-8 of their
/// limits. Far away, where round-off is as large as a limit, any motion seems to be one that repeats.
/// @param displacements  u of every slider [m] [m]
bool are_slider_forces_resolved(const system::LocallyNonlinear& system, const system::Excitation& excitation,
                                const Vector& displacements);

}  // namespace rubato::steady
