#pragma once

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/integrate/events.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/march_failure.hpp>

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rubato::system {
class LocallyNonlinear;
class MechanismEquations;
}  // namespace rubato::system

namespace rubato::integrate {

/// Tells marches apart by what they move, where what is shown of them differs.
class MarchVisitor {
 public:
  virtual ~MarchVisitor() = default;
  virtual void structure(const system::LocallyNonlinear& system) = 0;
  /// @param equations  those of the march: lent as long as it is there, and wherever they are left is well
  virtual void mechanism(system::MechanismEquations& equations) = 0;
};

/// A planned march of whatever system, ready to go, with what looks at its states needs: a workspace, one a run.
class March {
 public:
  virtual ~March() = default;

  virtual const system::State& state() const = 0;
  /// Lent, as long as this is there.
  virtual Balance& balance() = 0;
  /// Lent likewise.
  virtual std::vector<std::unique_ptr<EnergyPart>> energy_parts() = 0;
  virtual void show(MarchVisitor& visitor) = 0;
  /// What its parts did so far.
  virtual Events events() const = 0;
};

/// What else there is to tell of a march that ended.
struct MarchNotes {
  std::vector<std::pair<std::string, std::string>> statistics = {};
  std::vector<std::string> warnings = {};
  std::vector<std::string> findings = {};
  double known = 0.0;  ///< of the times of its events [s], for those who tell them one by one; 0: nobody should
};

/// One that takes steps.
class StepMarch : public March {
 public:
  /// Times at which steps end since a load, a drive or a law may have a kink there, rising [s].
  virtual std::vector<double> kinks() const { return {}; }
  /// Hears of every accepted step where someone looks at them; null: nobody does.
  virtual Observer* listener() { return nullptr; }
  /// After which progress is told.
  virtual long steps_a_report() const = 0;

  /// Why the march cannot begin; accepted: it can.
  virtual StepReport start_fault() const { return {}; }
  /// Goes on to `end` [s]; observer and log may be null.
  virtual AdaptiveReport go_to(double end, Observer* observer, TryLog* log) = 0;
  /// Why it ended before its time.
  virtual MarchFailure failure(const MarchReport& report) = 0;
  virtual MarchNotes notes(const AdaptiveReport& report) const = 0;
  /// What its steps leave of an energy by the round-off of places, at least [J].
  virtual double energy_round_off() { return 0.0; }
};

struct FlowReport {
  ExactEnd end = ExactEnd::reached;
  long transitions = 0;
  std::string worst;  ///< what changes without time passing
};

/// One that takes none: it knows the motion at any time.
class FlowMarch : public March {
 public:
  /// Of states that show the motion where nobody says how many [s].
  virtual double sample_interval() const = 0;
  /// Goes on to `end` [s], and shows the states at some times on the way, transitions and pieces.
  /// @param times      rising, from the present one to `end` [s]
  /// @param with_work  sum works, for the energy parts: what is done since the last call
  virtual FlowReport go_to(double end, std::span<const double> times, ExactVisitor& visitor, bool with_work) = 0;
};

}  // namespace rubato::integrate
