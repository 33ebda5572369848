#pragma once

#include <rubato/steady/linear/linear_response.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <memory>

namespace rubato::steady {

/// How a stop, a law or a row of a block resists where it is closed and sticks, or at rest [N/m].
double contact_stiffness(const system::LocallyNonlinear& system, Index contact);

/// A linear structure seen through a few columns P = [B | E | O]: the directions of the sliders and of other laws, the
/// patterns of the loads and the observed coordinates. All of the former are called sliders here: what their forces are
/// does not matter.
///
///   G(w) = P^T Z(w)^-1 P,   Z(w) = K + held sum of h b b^T - w^2 M + i w C        (b: the columns of B)
///
/// With held = 0 this is the structure without its sliders. Springs h in their place keep G finite where the structure
/// alone is in resonance, or not held at all (w = 0): those of the sliders (of laws at rest), but none stiffer than the
/// structure, so that Z keeps its digits beside rigid contacts.
///
/// Routes: real modes where they diagonalise C; the state-space modes (complex) of a small structure where they form a
/// basis; else a factorisation of Z for each w, sparse for large structures. These go by modes in a small basis where
/// many frequencies are wanted (see reduced_modes). Where the structure is in resonance the modes give way to the
/// factorisation.
class CondensedStructure {
 public:
  /// @param sweep  how many frequencies will be asked for
  CondensedStructure(const system::LocallyNonlinear& system, const std::vector<SteadyRequest::Observed>& observed,
                     const LinearSweep& sweep = {});
  ~CondensedStructure();
  CondensedStructure(CondensedStructure&&) noexcept;

  Index slider_count() const;
  Index load_count() const;
  Index observed_count() const;
  /// h of each slider [m] [N/m]
  const Vector& holding_stiffness() const;

  /// Replaces the patterns E [n x e].
  void set_loads(const Matrix& patterns);

  enum class Outcome {
    regular,
    near_resonance,  ///< G is right, and large: holding part of the sliders' springs gives better digits
    sliders_needed,  ///< Z is singular to round-off in a direction that moves sliders: hold part of their springs
    resonance,       ///< Z is singular to round-off in a direction that the loads drive, and nothing holds it
  };
  /// Writes the columns of sliders and loads of G(w) [p x (m + e)], w >= 0 [rad/s]; directions of resonance that
  /// nothing drives are left at rest.
  Outcome condense(double angular_frequency, double held, ComplexMatrix& receptance);

  /// Q = Z(w)^-1 P c [n], for the whole structure, with c [m + e].
  void expand(double angular_frequency, double held, const ComplexVector& column_forces, ComplexVector& position);

  /// A bound of the highest angular frequency that resonates, sliders stuck or not [rad/s]; 0 where it is unknown.
  double highest_frequency() const;

  struct Columns;  ///< P and what it came from
  struct Route;

 private:
  Route& route(double angular_frequency, double held);

  std::unique_ptr<Columns> columns_;
  std::unique_ptr<Route> route_, factorisation_;
};

}  // namespace rubato::steady
