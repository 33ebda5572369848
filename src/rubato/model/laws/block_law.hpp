#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/laws/law.hpp>

namespace rubato::model {

/// So many relative displacements may belong to one law: two along a plane and one across it.
inline constexpr Index largest_block = 3;

/// What a law of several numbers sees of them.
struct BlockPoint {
  double u[largest_block] = {};     ///< [m]
  double rate[largest_block] = {};  ///< du/dt [m/s]
};

/// A force for each number, with its slopes by all of them; they need not be symmetric. Forces resist, as those of
/// model::Law do.
struct BlockAnswer {
  double force[largest_block] = {};                   ///< [N]
  double by_u[largest_block][largest_block] = {};     ///< force i by u j [N/m]
  double by_rate[largest_block][largest_block] = {};  ///< force i by du/dt j [N s/m]
};

/// A law of d numbers that are told apart by their places, with a memory of its own: model::Law of a vector. Immutable.
/// In a step all numbers go in a straight line.
class BlockLaw {
 public:
  virtual ~BlockLaw() = default;

  virtual Index size() const = 0;
  /// How many numbers its history takes; all of them are zero before anything has happened.
  virtual Index memory_size() const = 0;

  /// The forces at the end of a step that goes straight from one point to another, with their slopes by the
  /// displacements and rates at `to` (the consistent tangent).
  /// @param next  the memory at `to`; must not be `memory`
  virtual BlockAnswer advance(const BlockPoint& from, const double* memory, const BlockPoint& to,
                              double* next) const = 0;
  /// The forces where nothing moves on, with the slopes of small motions that go on as the rates say; from rest, those
  /// of loading and unloading together.
  virtual BlockAnswer at(const BlockPoint& point, const double* memory) const = 0;

  /// Elastic energy [J].
  virtual double stored_energy(const double* u, const double* memory) const = 0;
  /// What a step dissipates [J], by a formula of its own; `next` as advance() wrote it.
  virtual double dissipated(const BlockPoint& from, const double* memory, const BlockPoint& to,
                            const double* next) const = 0;

  /// Force i by u i in small motions from rest: with everything that rubs stuck and all that may touch closed, or
  /// without friction and closed where it is at rest [N/m].
  virtual double limit_stiffness(Index i, bool is_stuck) const = 0;
  /// Of the last number the dashpot across the ends while they are closed [N s/m].
  virtual double closed_damping() const { return 0.0; }
  /// The last number at which the ends meet [m].
  virtual double clearance() const = 0;
  /// V of a second end that moves on steadily, as a belt or a disc does: V t is added to the first number, V to its
  /// rate, and what moves it does the work V T; 0: it does not move [m/s]
  virtual double sliding_velocity() const { return 0.0; }
  /// What it does at a point; `slips_backwards` of a law of one direction only.
  virtual Law::Contact contact(const BlockPoint& point, const double* memory) const = 0;
};

/// Of a law of several numbers that knows the slopes of its steps, for what it does over many of them: LawSlopes of a
/// block.
class BlockSlopes {
 public:
  virtual ~BlockSlopes() = default;

  /// The slopes of what BlockLaw::advance() gives.
  /// @param slopes  rows by the displacements and the rates at `to`, at `from`, by the memory; columns of the forces,
  ///                then of the memory at `to` [4 d + m x d + m], all zero at first
  /// @return false where it does not know them
  virtual bool slopes(const BlockPoint& from, const double* memory, const BlockPoint& to, Matrix& slopes) const = 0;
};

}  // namespace rubato::model
