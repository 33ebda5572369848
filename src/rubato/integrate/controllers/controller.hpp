#pragma once

#include <string>
#include <variant>

// A controller picks the next step from the error of the last. It knows no system, no method and no tolerance: errors
// reach it divided by the tolerance.
namespace rubato::integrate {

/// What an estimator says of one try.
struct ScaledError {
  double step = 0.0;   ///< h [s]
  double error = 0.0;  ///< over the tolerance [-]: at most 1 is acceptable
  int exponent = 1;    ///< the error is proportional to step^exponent on smooth problems
};

/// What a controller remembers between steps; a value that a checkpoint keeps.
struct ControlHistory {
  double last_error = 0.0;    ///< of the last accepted step, over the tolerance; 0: none since the start or a restart
  double last_step = 0.0;     ///< its length [s]
  bool was_rejected = false;  ///< the last try was
  double forgone = 0.0;       ///< steps that a longer one would have saved, were it taken when it was first possible
};

struct Decision {
  bool accepts = true;
  double next = 0.0;     ///< the next step, or the step of the next try [s]
  double forgone = 0.0;  ///< for the history
};

/// Accepts everything and keeps the step: the error is only watched.
struct FixedStep {};

/// The table of four actions (Cardona and Cassano 1991, section 4), p the exponent of the error (3 in the paper):
///
///   e > 1            reject, halve          1/16 <= e <= 1/2   accept, keep
///   1/2 < e <= 1     accept, h <- h (1/(2 e))^(1/p)       e < 1/16   accept, double
struct CardonaCassano {};

/// Proportional-integral control (Gustafsson 1991; Hairer and Wanner 1996, IV.2) that saves factorisations. With
/// D = e/h^p, which a smooth motion changes slowly,
///
///   factor = (aim/e)^(1/p) min(1, D_last/D)^(trend/p)     after an acceptance, without the trend after a start
///   factor = (aim/e)^(1/p)                                after a rejection
///
/// A step is kept while its error lies between `least` and 1 and does not rise so fast that factor < aim^(2/p). At p =
/// 2 that takes at most 1.25 times as many steps as would the aim, for an error that much smaller.
///
/// A new step costs a factorisation, and what lets it grow may be gone before that is paid: where modes beat, or at
/// every row of a table, the error falls for a few steps only. So a growth with an error above `at_once` waits until it
/// has been possible for as long as would have saved `patience` steps, that is until the sum of 1 - 1/factor reaches
/// it; then at most twice what was necessary is spent, whatever follows (Karlin, Manasse, Rudolph and Sleator 1988). A
/// factorisation was measured at 9 solves on long frames, 20 to 30 on matrices of 16 to 50 rows, 51 on a lattice.
struct PiControl {
  double aim = 0.64;    ///< of the error: the middle of the band in steps, so that it may waver to either side
  double least = 0.41;  ///< of the error of a step that is kept
  double trend = 0.4;
  double shrink_most = 0.2;
  double grow_most = 5.0;  ///< never directly after a rejection
  double at_once = 0.16;   ///< the error that lets a step grow at once: by a factor of 2 at p = 2
  double patience = 10.0;  ///< what a factorisation costs at least [solves]
};

using Controller = std::variant<FixedStep, CardonaCassano, PiControl>;

/// Accepts or rejects a try and picks the next step. An error that is not finite is rejected with the least factor.
Decision decide(const Controller& controller, const ScaledError& tried, const ControlHistory& history);

/// "fixed", "cardona_cassano" or "pi"
std::string name_of(const Controller& controller);

}  // namespace rubato::integrate
