#pragma once

#include <rubato/integrate/exact/flow_derivative.hpp>
#include <rubato/integrate/exact/taylor_piece.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <span>
#include <vector>

namespace rubato::steady {

/// A periodic solution of the exact flow: its pieces over a period, or over the half of it that the other half mirrors
/// with the opposite sign. Everything that is said of it is found on the polynomials themselves, to round-off.
class Orbit {
 public:
  explicit Orbit(const system::LocallyNonlinear& system) : system_(system) {}

  void clear() { count_ = 0; }
  void add(const integrate::TaylorPiece& piece, double start, double length,
           const std::vector<integrate::SliderState>& states);
  bool slips(Index slider) const;
  /// Takes a slider that only touches its limit for one that sticks throughout.
  void take_as_stuck(Index slider);
  /// Carries the derivative of the flow along what is stored.
  void carry(integrate::FlowDerivative& derivative) const;

  /// Smallest and largest u = x_first - x_second of a slider over what is stored [m].
  void displacement_range(Index slider, double& low, double& high) const;

  /// Fills the measures of a response: amplitudes, mean, rms, harmonics, works, shares, offsets.
  /// @param half  what is stored is half a period
  void measure(const system::Excitation& excitation, const SteadyRequest& request, bool half,
               SteadyResponse& response) const;

  Waveform waveform(const system::Excitation& excitation, bool half, int points) const;

 private:
  struct Piece {
    double start = 0.0, length = 0.0;  // [s]
    double turn = 0.0;                 // length times the fastest rate
    Index terms = 0;                   // of the polynomials that matter over the length
    Matrix q;                          // coefficients, the first `terms` columns [n x degree + 1]
    Vector offset, limit;              // of the slider forces [m] [N]
    std::vector<integrate::SliderState> states;
  };
  /// Coefficients of x_first - x_second in a piece, in `storage`.
  std::span<double> difference(const Piece& piece, Index first, Index second, std::span<double> storage) const;
  std::span<double> observe(const Piece& piece, const SteadyRequest::Observed& what, std::span<double> storage) const;
  void measure_ranges(const SteadyRequest& request, bool half, SteadyResponse& response) const;
  void measure_integrals(const system::Excitation& excitation, const SteadyRequest& request, bool half,
                         SteadyResponse& response) const;
  void measure_sliders(double period, bool half, SteadyResponse& response) const;

  const system::LocallyNonlinear& system_;
  std::vector<Piece> pieces_;
  std::size_t count_ = 0;                           // of the pieces in use: their memory is kept
  mutable Eigen::ArrayXXd positions_, velocities_;  // at the nodes of a quadrature, by columns of coordinate
};

}  // namespace rubato::steady
