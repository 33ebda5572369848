#pragma once

#include <rubato/numerics/kkt_factor.hpp>

#include <span>
#include <vector>

namespace rubato::system {

/// The matrix of a step of a constrained system,
///
///   [ S   G^T ]
///   [ G   -E  ]     S [n x n]: mass M, and with it damping and stiffness;  G [c x n]
///
/// whose E, a share of 1e-10 of what each row of G sees through the diagonal of M, lets constraints repeat each other.
/// A solution then has the multipliers of least norm, of all that make the same forces; iterations remove what else E
/// changes. A workspace: nothing is allocated after analyse().
///
/// It is written anew by begin(), what the equations add to values() and add_to_row(), and end().
class SaddleMatrix {
 public:
  using Entry = numerics::KktFactor::Entry;

  /// @param mass          M [n x n], symmetric, with a positive diagonal
  /// @param rows          c
  /// @param entries       places beside M and the diagonals that may be occupied: (i, j) of S, (n + row, j) of G
  /// @param is_symmetric  whether all that is added is
  void analyse(const SparseMatrix& mass, Index rows, std::vector<Entry> entries, bool is_symmetric);

  bool is_symmetric() const { return factor_.is_symmetric(); }
  /// Where an entry lies among the values; of the half that a symmetric matrix does not keep the spare place.
  int slot(Index i, Index j) const { return factor_.slot(i, j); }
  int spare_slot() const { return factor_.spare_slot(); }
  double* values() { return factor_.values(); }

  /// Zero but for M times a weight.
  void begin(double mass);
  /// An entry of G: what the row sees through M grows.
  void see(int row, Index place, double value) {
    row_seen_[static_cast<std::size_t>(row)] += value * value * inverse_mass_[static_cast<std::size_t>(place)];
  }
  /// Rows that say nothing now: their multipliers become zero.
  void open_rows(Index first, Index count);
  /// Writes E.
  /// @param weight  of the mass that E is a share over
  void end(double weight);

  bool factorise() { return factor_.factorise(); }
  /// (x, y) is overwritten by the solution.
  void solve(Vector& x, Vector& y) { factor_.solve(x.data(), y.data()); }
  /// How many matrices were written.
  int count() const { return count_; }
  /// Whether the last factors are those of a matrix that is positive definite on the motions that G leaves (where it is
  /// symmetric).
  bool is_positive() const { return factor_.negative_pivots() <= static_cast<Index>(row_seen_.size()); }

  /// Rows that repeat those before them, as the last factors found: what is left of them after the elimination of
  /// everything that they join is round-off.
  /// @param left  the share of a row that counts as nothing; E is 1e-10. Rows at an angle leave its square.
  std::vector<Index> redundant_rows(double left) const;
  /// The row that E lets stay apart most after a correction of the multipliers, and by how much [m], [rad].
  /// @param correction  as solve() wrote it [c]
  Index worst_leak(const Vector& correction, double& apart) const;
  /// How far constraints are apart, each in the motion that closes it alone, by the diagonal of M [m sqrt(kg)]; rows
  /// as the last matrix had them.
  /// @param constraint  g [c]
  double gap_norm(const Vector& constraint) const;
  /// How many rows are all but redundant, so that E is a tenth or more of their pivots: they repeat other rows, always
  /// or in this configuration.
  int nearly_redundant_rows() const;
  /// The inverse of an entry of the diagonal of M [1/kg].
  double inverse_mass(Index place) const { return inverse_mass_[static_cast<std::size_t>(place)]; }

 private:
  numerics::KktFactor factor_;
  Index size_ = 0;  // n
  std::vector<int> mass_slot_, row_slot_;
  std::vector<double> mass_value_, inverse_mass_;  // M by entry; of its diagonal [n]
  double share_of_rows_ = 0.0;                     // E over row_seen_
  std::vector<double> row_seen_;                   // G M^-1 G^T of a row by the diagonal of M; 0: it is open [c]
  int count_ = 0;
};

}  // namespace rubato::system
