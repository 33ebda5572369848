#pragma once

#include <rubato/core/types.hpp>

#include <array>

// Private to the model floor.
namespace rubato::model {

/// A friction force T that a straight piece of motion du carries out of the circle |T| <= mu N, N > 0 at the start and
/// linear: where it reaches the circle, how it then goes round it, and what that dissipates.
///
///   T = kT x du more until |T| = mu N at the share x of the piece; from there n = T/|T| by
///   mu N n' = kT (du - (n.du) n), whose solution is in elastic_contact.hpp
class SlipOnCircle {
 public:
  using Pair = std::array<double, 2>;

  /// @param force       T at the start, within the circle
  /// @param du          with |force + kT du| > mu end
  /// @param begin       N at the start, > 0
  /// @param end         N at the end, >= 0
  /// @param directions  1: second entries are zero
  SlipOnCircle(const Pair& force, const Pair& du, double begin, double end, double stiffness, double coefficient,
               Index directions);

  /// T at the end.
  Pair force() const { return {limit_ * n_[0], limit_ * n_[1]}; }
  /// Its derivatives by du_j and by N at the end.
  Pair by_travel(Index j) const;
  Pair by_normal() const { return change(0.0, 0.0, 1.0); }
  /// Over the piece [J].
  double dissipated() const;

 private:
  void leave_the_circle(const Pair& force);
  void go_round();
  Pair change(double by_x, double by_y, double by_end) const;
  double lag() const;

  Pair du_;
  double begin_, end_, stiffness_, mu_, limit_;
  bool is_line_;
  double share_ = 0.0, slope_ = 0.0;                          // x, and how fast |T|^2 - (mu N)^2 rises there
  Pair left_{}, direction_{}, n_{};                           // T at x, du/|du|, n at the end
  Pair begin_n_{};                                            // n at x
  double left_normal_ = 0.0, size_ = 0.0;                     // N at x, |du|
  double inverse_mean_ = 0.0, by_left_ = 0.0, by_end_ = 0.0;  // 1/L of N at x and at the end, with derivatives
  double path_ = 0.0, kept_ = 1.0;                            // kT (1 - x) |du|/(mu L), and exp of minus that
  double plus_ = 0.0, minus_ = 0.0;                           // 1 +- cos a at x
  double sine_ = 0.0, across_ = 1.0, carried_ = 1.0;          // sin a at the end; its change by w across du, by a at x
};

}  // namespace rubato::model
