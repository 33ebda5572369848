#pragma once

#include <rubato/core/error.hpp>
#include <rubato/core/types.hpp>
#include <rubato/model/quantity.hpp>
#include <rubato/numerics/formula.hpp>

#include <string>
#include <vector>

// Cyclic symmetry: a finite element model that is one of N equal sectors of a disk.
namespace rubato::model {

struct Model;
struct FiniteElements;

/// [cyclic]
struct CyclicDescription {
  long sectors = 0;                    ///< N
  std::vector<Quantity> axis, origin;  ///< [3] [-], [3] [m]
  std::string left, right;             ///< node sets of the sides
  Location where, sectors_where, axis_where, origin_where, left_where, right_where;
};

/// A sector in the travelling wave of a nodal diameter k (Thomas, Int. J. Numer. Meth. Eng. 14 (1979) 81):
///
///   x_(j+1) = exp(i k alpha) x_j in axes that turn with the sectors,  alpha = 2 pi/N,
///   x_right = exp(i k alpha) R x_left,   x = T_k y,   A_k = T_k^H A T_k  (Hermitian)
///
/// y are all coordinates but those of the right side, R turns components by alpha about the axis.
class CyclicSector {
 public:
  /// Pairs the nodes of both sides. Which of them is left, and which right, is decided by which rotation fits.
  /// Throws InvalidInput where sides do not pair, a node lies on the axis, or a node is held otherwise than its
  /// partner.
  CyclicSector(const CyclicDescription& description, const FiniteElements& elements, const Model& model,
               const numerics::Parameters& parameters);

  Index sectors() const { return sectors_; }
  Index largest_diameter() const { return sectors_ / 2; }
  Index size() const { return own_.cols(); }  ///< of y
  Index pairs() const { return pairs_; }
  double largest_distance() const { return largest_distance_; }  ///< of a turned node from its partner [m]
  bool is_exchanged() const { return is_exchanged_; }            ///< the set called left lies at the right

  /// Whether A_k is real: k = 0 and N/2.
  bool is_real(Index diameter) const { return diameter == 0 || 2 * diameter == sectors_; }
  /// A_k of a symmetric A [n x n], where it is real; else [Re -Im; Im Re] [2 m x 2 m], each of whose eigenvalues is
  /// one of A_k, twice.
  SparseMatrix reduced(const SparseMatrix& matrix, Index diameter) const;
  /// T_k y [n].
  Eigen::VectorXcd expanded(const Eigen::VectorXcd& y, Index diameter) const;

 private:
  Index sectors_ = 0, pairs_ = 0;
  double largest_distance_ = 0.0;
  bool is_exchanged_ = false;
  SparseMatrix own_, turned_;  // T_k = own + exp(i k alpha) turned [n x m]
};

}  // namespace rubato::model
