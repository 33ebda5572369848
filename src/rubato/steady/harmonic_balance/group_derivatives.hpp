#pragma once

#include <rubato/steady/harmonic_balance/sample_angles.hpp>

#include <vector>

namespace rubato::steady {

/// How the Fourier coefficients of the forces of a group of laws change with those of its displacements, by the slopes
/// of the steps between the samples of a period.
///
/// At a sample a force depends on the displacements there and at the sample before, which makes sums over the samples
/// of their slopes: of dF_k by U_l only k - l and k + l matter (Toeplitz and Hankel blocks). What it owes to the memory
/// is carried along. The memory of what sticks moves with the displacements, S + G u with a constant S, and what slips
/// forgets it; so that a period has few different S, and each adds one product of two vectors. Where the memory is
/// never at rest (what slips round a circle), S is carried from sample to sample and its share in the forces analysed.
class GroupDerivatives {
 public:
  /// @param numbers  d   @param memory  m
  GroupDerivatives(Index numbers, Index memory, bool depends_on_rate)
      : d_(numbers), memory_(memory), depends_on_rate_(depends_on_rate) {}

  /// Of one step: rows by the displacements and the rates at its end, at its start, by the memory there [4 d + m];
  /// columns of the forces, then of the memory at its end [d + m].
  Index step_rows() const { return 4 * d_ + memory_; }

  void prepare(SampleAngles& angles, double angular_frequency);
  /// The slopes of the memory at the first sample, where it was at rest before, by those of that step.
  void start_from_rest(const Matrix& step);
  /// Carries the slopes of the memory along a period that has not closed.
  void carry(const Matrix& steps);
  /// Closes the slopes of the memory over a period and finds the derivatives.
  /// @param steps  of the period, one below another
  /// @param least  what is forgotten a period less than this is kept for ever [-]
  void close(const Matrix& steps, double least);
  /// The slopes of the memory at the end of a period by that at its start [m x m].
  Matrix by_start(const Matrix& steps) const;

  /// dF_k of number i by the mean and the parts of each order of each number [orders x d unknowns]
  const ComplexMatrix& forces(Index i) const { return by_[static_cast<std::size_t>(i)]; }
  /// dF_0 of each number [d unknowns x d]
  const Matrix& means() const { return mean_by_; }
  /// Of a number: its mean, then the real and the imaginary part of each order.
  Index unknowns() const { return 1 + 2 * angles_->orders().count; }

 private:
  enum class Kind : char { holds, forgets, changes };
  Kind kind_of(const Matrix& steps, Index i) const;
  void find_shift(const Matrix& steps);
  void add_motion(Index sample, Index number, double by_u, double by_rate, Index row, Matrix& of_memory) const;
  void step(const Matrix& steps, Index i, Matrix& of_memory);
  void add_direct_slopes(const Matrix& steps);
  void add_direct_slopes(const Matrix& steps, Index i, Index j);
  Matrix take_pieces(const Matrix& steps, Matrix of_memory);
  Matrix take_samples(const Matrix& steps, Matrix of_memory);
  void add_memory();

  Index d_, memory_;
  bool depends_on_rate_;
  SampleAngles* angles_ = nullptr;
  double angular_frequency_ = 0.0;
  Matrix shift_;                   ///< G [m x d]
  Matrix of_memory_;               ///< S by the unknowns, then by its own start [m x d unknowns + m]
  std::vector<ComplexMatrix> by_;  ///< of each F_k
  Matrix mean_by_;
  std::vector<double> samples_;
  Vector now_;
  // What the memory adds: of each force by S, sums over the samples of a piece, the mean in the first row
  // [1 + orders x m pieces], and the S of the pieces [m pieces x d unknowns + m].
  std::vector<ComplexMatrix> weights_;
  Matrix pieces_;
  bool are_samples_ = false;  ///< the weights are of unknowns themselves
};

}  // namespace rubato::steady
