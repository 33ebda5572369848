#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::steady {

/// Of a motion that repeats: the sliders that do not slip, by what their forces fc = kT u + offset reach in a period.
/// Their offsets are free: with all of them changed the structure lies elsewhere, and moves as before. Sliders that
/// slip go along, their forces unchanged.
struct StuckOffsets {
  std::vector<Index> sliders;
  std::vector<double> offset, wanted, lowest, highest;  ///< fc - kT u now and as it should be; fc [m] [N]

  /// @param least, most  of u in a period [m]
  void add(Index slider, double stiffness, double least, double most, double offset_now, double offset_wanted);
};

struct OffsetShift {
  Vector displacement;  ///< of the structure [n] [m]
  Vector force;         ///< of the sliders that do not slip [N]
  Vector offset;        ///< likewise [N]
  bool is_zero() const { return offset.size() == 0; }
};

/// To the offsets that are wanted, or the nearest with which none of the sliders slips: a slider has another offset
/// than the wanted one only where its force reaches its limit, and would pass it without. Unique, since the forces that
/// the offsets make fall by less than they grow (a box-constrained linear complementarity problem with a symmetric
/// semi-definite matrix).
/// @param limits  of all sliders [m] [N]
/// @param margin  share of a limit by which forces stay below it and below which nothing is moved [-]
OffsetShift shift_to_wanted_offsets(const system::LocallyNonlinear& system, const Vector& limits,
                                    const StuckOffsets& offsets, double margin);

}  // namespace rubato::steady
