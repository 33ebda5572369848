#pragma once

#include <rubato/core/types.hpp>

#include <string>

namespace rubato::analysis {

/// Whether one of the models of a sweep runs away from its rest: its stiffness with all sliders stuck, and stops as
/// they are at rest, has a negative eigenvalue. Equations of a steady response have solutions then, too, which do not
/// last.
class NegativeStiffness {
 public:
  /// A stiffness that was the last one before costs nothing.
  /// @param where  "Omega = 3"
  void look_at(SparseMatrix stiffness, const std::string& where);
  /// Empty where none is negative.
  std::string warning() const;

 private:
  SparseMatrix last_;
  std::string where_;
};

}  // namespace rubato::analysis
