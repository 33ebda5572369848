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
};

struct Decision {
  bool accepts = true;
  double next = 0.0;  ///< the next step, or the step of the next try [s]
};

/// Accepts everything and keeps the step: the error is only watched.
struct FixedStep {};

/// The table of four actions (Cardona and Cassano 1991, section 4), p the exponent of the error (3 in the paper):
///
///   e > 1            reject, halve          1/16 <= e <= 1/2   accept, keep
///   1/2 < e <= 1     accept, h <- h (1/(2 e))^(1/p)       e < 1/16   accept, double
struct CardonaCassano {};

/// Proportional-integral control (Gustafsson 1991; Hairer and Wanner 1996, IV.2) with a dead band, since a step that is
/// kept keeps its factorisation. With D = e/h^p, which a smooth motion changes slowly,
///
///   factor = safety e^(-1/p) min(1, D_last/D)^(trend/p)     after an acceptance, without the trend after a start
///   factor = safety e^(-1/p)                                after a rejection
///
/// A factor between safety^2 and `keep` changes nothing: the error stays between (safety/keep)^p and 1. A wider band
/// saves factorisations and takes more steps, at most keep/safety times as many, for an error that much smaller.
struct PiControl {
  double safety = 0.9;
  double keep = 1.4;
  double trend = 0.4;
  double shrink_most = 0.2;
  double grow_most = 5.0;  ///< never directly after a rejection
};

using Controller = std::variant<FixedStep, CardonaCassano, PiControl>;

/// Accepts or rejects a try and picks the next step. An error that is not finite is rejected with the least factor.
Decision decide(const Controller& controller, const ScaledError& tried, const ControlHistory& history);

/// "fixed", "cardona_cassano" or "pi"
std::string name_of(const Controller& controller);

}  // namespace rubato::integrate
