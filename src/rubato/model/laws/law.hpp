#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/time_law.hpp>
#include <rubato/numerics/formula.hpp>

#include <limits>
#include <vector>

namespace rubato::model {

/// What a law sees: a relative displacement, or the coordinate that a joint leaves free, and its rate.
struct LawPoint {
  double u = 0.0;            ///< [m] or [rad]
  double rate = 0.0;         ///< du/dt [m/s] or [rad/s]
  double t = 0.0;            ///< [s]
  Side side = Side::right;   ///< which limit to take of a law that jumps at t
  double normal = 0.0;       ///< what presses its ends together, across u [N]; they are apart where it is not positive
  double normal_rate = 0.0;  ///< d(normal)/dt [N/s], told where transitions are looked for
};

/// A force with its slopes. It resists: its ends are pushed together where u and the force are positive.
struct LawAnswer {
  double force = 0.0;      ///< f [N] or [N m]
  double by_u = 0.0;       ///< df/du [N/m]
  double by_rate = 0.0;    ///< df/d(du/dt) [N s/m]
  double by_normal = 0.0;  ///< df/d(normal) [-]
};

/// What acts: a formula of a relative motion, with a memory of its own. Immutable, and shared by threads: the memory is
/// a part of the state of a system and is handed in.
///
/// A law that takes a normal force is told it with every point; in a step it goes in a straight line against u.
///
/// Everything that integrates asks for advance() and at() alone: what a law does within a step, from its start, and
/// what small motions about a point do.
class Law {
 public:
  virtual ~Law() = default;

  /// How many numbers its history takes; all of them are zero before anything has happened.
  virtual Index memory_size() const { return 0; }

  /// The force at the end of a step in which u goes from one point to another without turning back.
  /// @param memory  at `from`
  /// @param next    the memory at `to`; must not be `memory`
  /// @return the force, with its slopes by the displacement and the rate at `to` (the consistent tangent)
  virtual LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const = 0;

  /// The force where nothing moves on, with the slopes of small motions that go on as the rate says; from rest, those
  /// of loading and unloading together.
  virtual LawAnswer at(const LawPoint& point, const double* memory) const = 0;

  /// Elastic energy [J].
  virtual double stored_energy(double u, const double* memory) const = 0;

  /// What a step dissipates [J], by a formula of its own; `next` as advance() wrote it.
  virtual double dissipated(const LawPoint& from, const double* memory, const LawPoint& to,
                            const double* next) const = 0;

  /// No slope by u is larger: what the step of explicit methods follows [N/m]. Infinite where it is not known.
  virtual double largest_stiffness() const { return std::numeric_limits<double>::infinity(); }

  /// Whether advance() is exact however long a step is, and however u moves within it, as long as guard() does not
  /// vanish: what Runge-Kutta pairs need to choose their steps, since neither of their two solutions sees an error of
  /// the memory.
  virtual bool is_exact_between_guards() const { return memory_size() == 0; }
  /// What is positive where a step goes on as it began, zero where it first does not (the motion turns, a slip begins
  /// or ends), and negative beyond. Steps that end at transitions end there; 1: nothing ever changes.
  /// @param from    the start of the step. Where it rests its rate has the sign with which it goes on; where a law
  ///                takes a normal force its rates are those that `near` later are reached.
  /// @param memory  at `from`
  /// @param near    what would be reached within this time has been [s]
  virtual double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const {
    (void)from;
    (void)memory;
    (void)to;
    (void)near;
    return 1.0;
  }

  /// Whether a normal force counts. Where such a law acts it is said what presses (model::NormalForce).
  virtual bool takes_normal() const { return false; }
  /// What law of friction it is: the slope by u while it sticks, which it has not while it slips or is open [N/m]. Zero
  /// of a law that does not stick. Small motions have a limit with it and one without, as those of sliders do.
  virtual double sticking_stiffness() const { return 0.0; }
  /// What a law that sticks does at a point; of others `none`.
  /// @param near  of a point whose rates are told: how it goes on, where what would be reached within this time has
  ///              been [s]. Zero: what the point alone says, one at its limit slips.
  enum class Contact : signed char { none, sticks, slips_forwards, slips_backwards, open };
  virtual Contact contact(const LawPoint& point, const double* memory, double near) const {
    (void)point;
    (void)memory;
    (void)near;
    return Contact::none;
  }

  virtual bool depends_on_rate() const { return false; }
  virtual bool depends_on_time() const { return false; }
  /// The formula by which it does: what swings in it bounds automatic steps. Null where there is none; of a law that
  /// swings by other means nothing is known, and the study must say how long steps may be.
  virtual const numerics::Formula* formula_of_time() const { return nullptr; }
  /// Whether the opposite motion makes the opposite force.
  virtual bool is_odd() const { return false; }
  /// Times in (from, to) at which a law that depends on time is not smooth, rising.
  virtual std::vector<double> breakpoints(double from, double to) const {
    (void)from;
    (void)to;
    return {};
  }
};

}  // namespace rubato::model
