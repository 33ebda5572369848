#pragma once

#include <rubato/steady/dynamic_stiffness.hpp>

#include <memory>
#include <optional>

namespace rubato::steady {

/// S(omega) x = f of a large structure for many frequencies in a range: in a basis of its modes up to twice the highest
/// frequency and of residual vectors, which carry what the modes left out answer. The basis begins with the modes; a
/// solution x = V y of V^T S V y = V^T f leaves the residual r = f - S x, and
///
///   z = Phi ((Lambda - omega^2 + i omega C)^-1 - (Lambda + s)^-1) Phi^T r + (K + s M)^-1 r
///
/// (the modes, and the static answer of the rest) is its error but for a factor of omega^2 / omega_left_out^2 <= 1/4.
/// Where z is too large it joins the basis, so that a sweep adds vectors at its first points and few later (residual
/// vectors: Dickens, Nakagawa and Wittbrodt 1997; enriched where the error says so). s is 0, or positive where K is
/// singular.
///
/// A workspace: one a thread. What it answers depends, below the tolerance, on what it was asked since it was made or
/// told to forget.
class ModalStiffness {
 public:
  /// @param highest    of the frequencies [rad/s], > 0
  /// @param tolerance  relative error of the largest entry of x at which a solution is accepted [-]
  ModalStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck, double highest, double tolerance);
  ~ModalStiffness();
  ModalStiffness(ModalStiffness&&) noexcept;
  ModalStiffness& operator=(ModalStiffness&&) noexcept;

  /// False where the modes needed are too many to be worth it (400, or a third of all), or were not all found.
  bool is_usable() const;
  Index mode_count() const;
  Index basis_size() const;
  /// Leaves the modes alone in the basis.
  void forget();

  /// Nothing where the frequency is beyond the highest, or the tolerance was not reached: near a resonance without
  /// damping. `uncertainty` is the estimate of the error, z.
  std::optional<StiffnessSolution> solve(double angular_frequency, const ComplexVector& force, ComplexVector& x);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace rubato::steady
