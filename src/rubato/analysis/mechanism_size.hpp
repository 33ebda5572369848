#pragma once

#include <rubato/system/mechanism.hpp>

namespace rubato::analysis {

/// How much a mechanism may move, in the configuration from which it starts.
struct MechanismSize {
  Index coordinates = 0;
  Index constraints = 0;  ///< rows of joints and drives; those of locks that are open and of friction count nothing
  Index redundant = 0;    ///< of these, what repeats others: the rank is less by so many
  Index drives = 0;       ///< of the rows
  /// What Gruebler and Kutzbach count, coordinates less rows, corrected by the rank; drives hold what they drive.
  Index freedoms() const { return coordinates - (constraints - redundant); }
};

MechanismSize size_of(const system::Mechanism& mechanism);

}  // namespace rubato::analysis
