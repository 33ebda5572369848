#pragma once

#include <rubato/analysis/pieces.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>

#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace rubato::analysis {

/// A part of a sweep that is solved in one go, beginning afresh: some lines, side by side, over some steps.
struct SweepPiece {
  long first_line = 0;
  int lines = 1;
  std::size_t first_step = 0, steps = 0;
};

/// What was counted over points, which are numbered line by line.
struct SweepCounts : StatusCounts {
  double iterations = 0.0;

  void add(const SweepCounts& other);
};

/// The tables of a frequency response; they know where each number goes.
struct SweepTables {
  ResponseTable main;
  LinearTable linear;
  WaveformTable waveforms;
};

/// Rows of a piece, table by table, in the order of lines and steps.
struct PieceResult {
  SweepPiece piece;
  bool is_whole = true;  ///< false: interrupted, and the rows are those of the points that were reached
  std::vector<double> main, linear, waveforms;
  SweepCounts counts;

  /// As one list of numbers, and back, for the journal. Throws InvalidInput for the list of another piece.
  std::vector<double> packed() const;
  static PieceResult unpacked(const SweepPiece& piece, const SweepTables& tables, std::span<const double> values);
};

/// Solves pieces of a sweep; what it answers for a piece does not depend on the pieces before. One a thread.
class PieceSolver {
 public:
  /// @param stop  asks to leave, also in the midst of a point, which is then not among the rows
  PieceSolver(const FrequencyResponsePlan& plan, const StudyInput& input, const steady::SteadySolvers& solvers,
              const SweepTables& tables, SweepProgress& progress, const std::atomic<bool>& stop);

  PieceResult solve(const SweepPiece& piece);
  /// How many points the solver of the first line takes side by side.
  int lanes();
  /// What is wrong with a point that no model can have; empty if nothing is.
  std::string reason(long line, std::size_t step);
  /// The sliders with a negative load at a point.
  std::vector<ParametricExcitation::NegativeLoad> negative_loads(long line, std::size_t step);
  /// How a mechanism leaves the small motions about its equilibrium at a point; empty where it does not.
  std::string excursion(long line, std::size_t step);
  /// How far what is observed drifts in a period at a point; empty where it does not [o] [m].
  Vector drift(long line, std::size_t step);

 private:
  struct Lane {
    std::unique_ptr<ParametricExcitation> drive;
    std::vector<double> values;  ///< of the swept parameters
    bool has_limits = false;     ///< the linear limits are those of no line before
    PieceResult result;
  };

  void solve_line(const SweepPiece& piece, PieceResult& result);
  bool solve_lanes(const SweepPiece& piece, PieceResult& result);
  void forget();
  void take_line(Lane& lane, long line);
  Lane& take_point(long line, std::size_t step);
  void march_without_period(Lane& lane, double point, steady::SteadyResponse& response);
  void solve_linear(const RowPlace& place, const system::Excitation& excitation, PieceResult& result);
  void require_structure(Lane& lane, double point);
  void take_drive(Lane& lane, double point);
  AboutRest::Excursion excursion_of_last() const;
  void finish_point(const Lane& lane, long line, std::size_t step, const system::Excitation& excitation,
                    steady::SteadyResponse& response, PieceResult& result);
  RowPlace place_of(const Lane& lane, std::size_t step) const;
  double point_value(std::size_t step) const;
  double point_number(long line, std::size_t step) const;
  Lane& lane(std::size_t index);

  const FrequencyResponsePlan& plan_;
  const StudyInput& input_;
  const steady::SteadySolvers& make_;
  const SweepTables& tables_;
  SweepProgress& progress_;
  const std::atomic<bool>& stop_;

  std::vector<Lane> lanes_;
  std::vector<system::Excitation> excitations_;
  std::vector<steady::SteadyResponse> responses_;
  std::unique_ptr<SteadyModel> model_;
  std::vector<double> structure_values_;  ///< the structural parameters that it was built with
  std::unique_ptr<steady::SteadySolver> solver_, free_, stuck_;
  steady::SteadyResponse free_response_, stuck_response_;
};

}  // namespace rubato::analysis
