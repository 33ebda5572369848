#pragma once

#include <rubato/core/error.hpp>
#include <rubato/integrate/equilibrium/equilibrium.hpp>
#include <rubato/integrate/equilibrium/free_motions.hpp>
#include <rubato/integrate/kinds/march_kind.hpp>
#include <rubato/integrate/kinds/nonlinear_part.hpp>
#include <rubato/model/description.hpp>
#include <rubato/model/time_law.hpp>
#include <rubato/system/moving_supports.hpp>
#include <rubato/system/system.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rubato::system {
class LocallyNonlinear;
class Mechanism;
}  // namespace rubato::system

namespace rubato::integrate {

/// Tells the kinds of system apart where each needs something of its own.
class KindVisitor {
 public:
  virtual ~KindVisitor() = default;
  virtual void structure(const system::LocallyNonlinear& system) = 0;
  virtual void mechanism(const system::Mechanism& mechanism) = 0;
};

inline constexpr double standstill = 1e-6;  ///< [m/s], [rad/s]: what moves no faster stands

/// What a study asks of an equilibrium, and where it says so.
struct StaticRequest {
  const std::string& title;  ///< heads the messages
  const Location& where;
  const model::StaticDescription& description;
};

/// The same of modes.
struct ModesRequest {
  const std::string& title;
  const Location& where;
  const model::ModesDescription& description;
  const numerics::Parameters& parameters;
};

/// m q'' + c q' + k q = amplitude cos(angular_frequency t + phase), from rest.
struct HarmonicOscillator {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;             ///< [kg], [N s/m], [N/m]
  double amplitude = 0.0, angular_frequency = 0.0, phase = 0.0;  ///< [N], [rad/s], [rad]
};

/// A system as analyses see it: what they ask of its equations, which each kind of system finds in its own way. Const;
/// a workspace is made in each call.
///
/// Functions throw InvalidInput at the place of what is wrong.
class SystemKind {
 public:
  virtual ~SystemKind() = default;

  virtual const system::System& system() const = 0;
  /// At t = 0 as given: one with constraints need not fulfil them.
  virtual const system::State& start() const = 0;
  /// A characteristic size for error measures [m sqrt(kg)]; 0: it has none.
  virtual double reference() const = 0;
  /// Null where no support moves.
  virtual const system::MovingSupports* supports() const { return nullptr; }
  /// Whether joints hold it: it is a mechanism.
  virtual bool is_constrained() const = 0;
  virtual void show(KindVisitor& visitor) const = 0;
  /// The structure, for analyses that only structures have; null where it is none.
  virtual const system::LocallyNonlinear* structure() const { return nullptr; }
  /// How much it is and how much it may move, in a line: "5 coordinates, 2 sliders".
  virtual std::string summary() const = 0;
  /// The same for another thread, where the system has workspaces; null: it is shared.
  virtual std::unique_ptr<const SystemKind> for_thread() const { return nullptr; }

  // What it is made of
  /// Sliders, then stops, then other laws, then frictions and locks of joints.
  virtual std::vector<NonlinearPart> nonlinear_parts() const = 0;
  /// Shows what acts as a function of time: loads, motions that are prescribed (and their accelerations, which loads
  /// follow), laws that say by which formula they do.
  virtual void for_each_time_law(const std::function<void(const model::TimeLaw&)>& show) const = 0;

  /// All of the system, where it is no more than that.
  virtual std::optional<HarmonicOscillator> oscillator() const { return std::nullopt; }
  /// Its transients.
  virtual const MarchKind& marches() const = 0;

  // Statics
  /// The displacements that a study holds; refuses keys that do not go with the kind.
  virtual std::vector<model::Held> held_displacements(const StaticRequest& request) const = 0;
  /// Where the search for an equilibrium begins. What that took is told in `warnings`.
  virtual system::State static_start(const Location& where, std::vector<std::string>& warnings) const = 0;
  /// Whether the search is short, and the equilibrium one that the study decides: where there is none, planning refuses
  /// the study. Else the search belongs to the run, and may fail there.
  virtual bool finds_equilibrium_at_once() const = 0;
  /// The equilibrium under the loads at t = 0, near a given state where there are several.
  virtual Equilibrium find_equilibrium(const system::State& start, std::span<const model::Held> held) const = 0;

  // Modes
  /// How many of the lowest are asked for, or how many there are where it is left to Rubato, at most 20. Refuses keys
  /// and models for which there are no modes.
  virtual Index mode_count(const ModesRequest& request) const = 0;
  /// 1, or 2 where there are sliders: all removed, and all of them springs.
  virtual Index limit_count() const { return 1; }
  /// A state whose motion is stopped. That its loads would move it is told in `warnings`.
  virtual system::State held_still(const system::State& state, std::vector<std::string>& warnings) const = 0;
  /// The lowest free motions about a state at rest, in one of the limits.
  virtual FreeMotions free_motions(const system::State& state, Index limit, Index count) const = 0;
  /// What a drive prescribes takes no part in modes: the names of all drives.
  virtual std::vector<std::string> drives() const { return {}; }
};

}  // namespace rubato::integrate
