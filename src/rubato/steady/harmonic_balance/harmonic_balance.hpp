#pragma once

#include <rubato/steady/harmonic_balance/condensed_structure.hpp>
#include <rubato/steady/harmonic_balance/hysteresis_loop.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <memory>
#include <vector>

namespace rubato::steady {

struct HarmonicBalanceOptions {
  double tolerance = 1e-3;            ///< wanted relative error of the amplitudes by truncation [-]
  double residual_tolerance = 2e-12;  ///< of the balance, relative to the relative displacements [-]
  int most_harmonics = 127;           ///< highest order that may be balanced
  /// All orders up to this one are balanced, and those of the loads, whatever the error; 0: as many as the error asks
  /// for. Contacts are taken as stiff as they are.
  int orders = 0;
  LinearSweep sweep = {};  ///< of many points: large structures go by modes in a basis of their answers
};

/// Steady responses as truncated Fourier series (harmonic balance).
///
/// The structure is condensed exactly to the relative displacements u = B^T q of the sliders, harmonic by harmonic:
///
///   U_k - U_k(linear) + R_k F_k(U) = 0,   R_k = B^T Z(k w)^-1 B,   k = 0 (where the answer may have a mean), 1, 2, ...
///
/// and solved by Newton with the closed-form derivative of the slider forces (HysteresisLoop): no sampling, so that
/// truncation is the only error. Even orders and the mean are left out where loads and memory are half-wave symmetric.
///
/// Orders are added until the estimated error is below the tolerance. The estimate is what the first orders left out
/// would do: their own part in the observed coordinates and, through the Jacobian, the change of the orders kept.
///
/// Where the orders are given, they are all there is, and the error says what the others would do.
///
/// Contacts that are stiff beside the structure, rigid ones too, are balanced in u + c fc with a compliance c that
/// bears on the truncation alone (HarmonicBalanceEquations).
///
/// Where no series balances a structure of up to 300 coordinates within the tolerance, the motion over a period is
/// sought itself (PeriodicSolver): it may walk over sliders that alone hold it, which a series cannot, or stick and
/// slip too sharply.
///
/// Newton starts from an extrapolation of the points before, and begins again from nothing where that fails or becomes
/// dear. Where it fails then, the friction limits are lowered step by step from a value at which no slider slips, whose
/// answer is linear.
class HarmonicBalanceSolver final : public SteadySolver {
 public:
  /// Throws InvalidInput for options that are not positive.
  HarmonicBalanceSolver(const system::LocallyNonlinear& system, SteadyRequest request,
                        HarmonicBalanceOptions options = {});
  ~HarmonicBalanceSolver() override;

  void solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) override;
  Waveform waveform(int points) const override;
  void forget() override;
  SteadyDiscretisation discretisation() const override;
  void hold(const std::optional<SteadyDiscretisation>& held, bool with_error = true) override;

  /// The highest order balanced at the last point.
  int highest_order() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rubato::steady
