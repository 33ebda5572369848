#pragma once

#include <rubato/analysis/observed.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/integrate/kinds/motions_about_rest.hpp>
#include <rubato/steady/steady_solver.hpp>
#include <rubato/system/assembled_model.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A mechanism about its static equilibrium, beside the equations of its small motions.
class AboutRest {
 public:
  /// How far a motion leaves what small motions are.
  struct Excursion {
    double turn = 0.0;      ///< largest turn from the equilibrium [rad]
    Index coordinate = -1;  ///< which makes it, among those of the mechanism
    int lock = -1;          ///< the first lock that it comes to, or that it leaves; -1: none
  };
  /// More than this is told: what is linear in the turns is then off by about its square.
  static constexpr double large_turn = 0.1;  ///< [rad]

  explicit AboutRest(integrate::MotionsAboutRest about);

  steady::SteadyRequest::Observed observed(const Observed& one) const;
  /// Adds where it rests to means and roots of mean squares.
  void place(const std::vector<Observed>& observed, steady::SteadyResponse& response) const;
  /// Makes that of the motions of the joints one of the mechanism's coordinates.
  void place(steady::Waveform& waveform) const;
  /// @param position  of the motions of the joints [r x p]
  Excursion excursion(const Matrix& position) const;
  /// The message that goes with it; empty: it is small.
  std::string told(const Excursion& excursion) const;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  integrate::SmallMotions motions_;  // without its parts
  std::vector<std::string> names_;
  std::vector<Index> turning_;  // coordinates that are rotations
  Matrix turns_;                // of them [turning x r]
  std::vector<std::string> warnings_;
};

/// What the solvers of steady responses are given: a structure, or a mechanism about its equilibrium.
struct SteadyModel {
  system::AssembledModel assembled;
  std::optional<AboutRest> about;

  const auto& system() const { return assembled.system; }
  /// What is asked of its solvers. @param asked  harmonics and rates
  steady::SteadyRequest request(const std::vector<Observed>& observed, steady::SteadyRequest asked) const;
};

/// A study's model for given values of all parameters. Negative normal loads of structures count as zero. Throws
/// InvalidInput, for a mechanism also where it has no equilibrium without its harmonic loads, or one that is not
/// stable, or loads without a potential.
SteadyModel build_steady_model(const model::StudyDescription& study, const numerics::Parameters& values);

/// Throws InvalidInput, at its place, for a harmonic force of a mechanism whose frequency is zero at these parameters:
/// it would move the equilibrium. To be asked at each of them, since a model that is kept has been asked at others.
void require_swinging_loads(const model::ModelDescription& model, const numerics::Parameters& values);

/// A study without the loads that swing: what its equilibrium depends on.
model::StudyDescription without_harmonic_loads(const model::StudyDescription& study);

/// Throws InvalidInput, at the place and with what to take instead, for what small motions of a mechanism cannot carry:
/// what follows t, laws of joints that are not linear, forces that turn with their body.
/// @param title  heads the messages
void refuse_beyond_small_motions(const StudyInput& input, const Location& where, const std::string& title);

}  // namespace rubato::analysis
