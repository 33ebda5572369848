#pragma once

#include <rubato/core/types.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// The stiffness of a structure's free coordinates with the slopes of its contacts, whose pattern is made once.
///
///   K + sum over contacts of slope b b^T,   b the column of B of a contact
class ContactTangent {
 public:
  /// @param place  of each coordinate among the free ones, `ground` where it is held
  /// @param free   how many of them are free
  ContactTangent(const system::LocallyNonlinear& system, const std::vector<Index>& place, Index free);

  /// @param slope  of each contact [N/m]
  /// @return the matrix, [free x free], which stays until the next call; all of its diagonal is there
  const SparseMatrix& with(const Vector& slope);

 private:
  Index slot(Index row, Index column) const;

  SparseMatrix matrix_;
  std::vector<double> alone_;  // values without contacts
  /// What the slope of a contact adds to a value.
  struct Term {
    Index slot, contact;
    double weight;
  };
  std::vector<Term> terms_;
};

}  // namespace rubato::integrate
