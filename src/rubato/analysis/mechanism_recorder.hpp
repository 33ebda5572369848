#pragma once

#include <rubato/analysis/beam_section_forces.hpp>
#include <rubato/analysis/joint_coordinates.hpp>
#include <rubato/analysis/joint_frictions.hpp>
#include <rubato/analysis/joint_laws.hpp>
#include <rubato/analysis/joint_reactions.hpp>
#include <rubato/analysis/mechanism_ledger.hpp>
#include <rubato/analysis/mechanism_plan.hpp>
#include <rubato/analysis/observed_blocks.hpp>
#include <rubato/integrate/mechanism/mechanism_balance.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/results/sink.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Turns states of a mechanism into rows: time, position, velocity and acceleration of what is observed, the coordinate
/// that each joint leaves free, the reactions and frictions of the joints, and the energy ledger in a table of its own.
///
/// Accelerations and reactions are those of equilibrium at the positions and velocities of the row: the multipliers of
/// a step carry what the constraints do to velocities that have drifted, over the length of that step.
class MechanismRecorder {
 public:
  MechanismRecorder(const std::string& name, const MechanismPlan& plan, integrate::MechanismBalance& balance,
                    results::Sink& sink);

  /// @param energy  null without a ledger
  /// @param is_balanced  acceleration and multipliers of the state are those to tell: between the ends of a step
  void record(const system::State& state, const MechanismEnergy* energy, bool is_balanced = false);
  long rows() const { return count_; }

 private:
  JointCoordinates joints_;
  ObservedBlocks observed_;
  JointReactions reactions_;
  JointFrictions frictions_;
  JointLaws laws_;
  BeamSectionForces beams_;
  integrate::MechanismBalance& balance_;
  system::State balanced_;
  Vector positions_, velocities_, accelerations_;
  std::vector<double> row_;
  std::unique_ptr<results::RowWriter> rows_, energy_rows_;
  long count_ = 0;
};

/// The locks that engaged and let go, and the joints that stuck and slipped, in a table `events`.
void write_events(const std::string& name, const std::vector<integrate::LockEvent>& events,
                  const system::Mechanism& mechanism, results::Sink& sink);

}  // namespace rubato::analysis
