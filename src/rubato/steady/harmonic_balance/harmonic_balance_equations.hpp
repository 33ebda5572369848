#pragma once

#include <rubato/numerics/gmres.hpp>
#include <rubato/steady/harmonic_balance/condensed_structure.hpp>
#include <rubato/steady/harmonic_balance/group_by_samples.hpp>
#include <rubato/steady/harmonic_balance/hysteresis_loop.hpp>
#include <rubato/steady/harmonic_balance/law_by_samples.hpp>
#include <rubato/steady/harmonic_balance/small_lu.hpp>

#include <span>
#include <vector>

namespace rubato::steady {

/// One harmonic of the condensed structure under its loads.
struct CondensedHarmonic {
  double angular_frequency = -1.0;  ///< k w; < 0: not yet condensed
  double held = 0.0;                ///< part of the sliders' springs in Z
  ComplexMatrix receptance;         ///< G, columns of sliders and loads
  ComplexVector load;               ///< on the load columns [e]
  ComplexVector linear;             ///< P^T Q under the loads alone [p]
};

/// A Fourier series of each slider: of its displacement, its force or what is balanced.
struct SliderSeries {
  Orders orders;
  bool has_mean = false;
  Vector mean;                 ///< [m]
  ComplexMatrix coefficients;  ///< a column a slider [count x m]

  void resize(const Orders& new_orders, bool with_mean, Index sliders);  ///< keeps what both have
};

/// The balance for the sliders that have a limit and for other laws, and Newton's method for it:
///
///   U_k - U_k(linear) + R_k (F_k - held h U_k) = 0,   F = law of 1/kT + c at W = U + c F
///
/// A slider of stiffness kT at the displacement u does what one of the compliance 1/kT + c does at w = u + c fc: its
/// slip is the same. The unknown is W, truncated; with c = 0 it is U. However stiff a contact is, an added compliance c
/// keeps what the force does to W finite (an augmented Lagrangian), and which c is chosen bears on the truncation
/// alone. With a = 1/(1 + held h c) and the net force N = F - held h U = (F - held h a W)/a, all in W,
///
///   a W_k - U_k(linear) + (R_k - c a) N_k(W) = 0
///
/// Other laws are balanced in U itself, by samples of their force (LawBySamples); in what follows they count as
/// sliders. The force of one follows from its own displacement, or from those of its group (GroupBySamples). Linear
/// parts may be raised from a small share of the loads to all of them (set_load_factor).
///
/// The Jacobian a + (R - c a) dN is that of all unknowns, but its two factors are not: R joins the sliders of one
/// order, dN the orders of one slider. A large one is therefore factorised seldom; the systems between are solved by
/// products with the two factors (GMRES), with the last factorisation as its preconditioner: loops that have changed
/// little since then change few of its eigenvalues.
class HarmonicBalanceEquations {
 public:
  /// @param stiffness  kT of each slider   @param holding  h, of which a part may be held in Z [m] [N/m]
  /// @param system     of whose contacts they are, in its order
  HarmonicBalanceEquations(const Vector& stiffness, const Vector& holding, const system::LocallyNonlinear& system);

  /// @param harmonics  place 0: the mean (unused without it); place 1 + i: order i, at least as many as unknown orders
  /// @param added      c of each slider [m] [m/N]
  void join(const std::vector<CondensedHarmonic>& harmonics, const Vector& added);
  /// @param limits   of laws infinite   @param offsets  what a slider that never slips should have as fc - kT u [m] [N]
  void set(const Vector& limits, const Vector& offsets);
  /// How many samples a period the forces of laws are found by; those of orders left out by `finer` times as many.
  void set_samples(int samples) { samples_ = samples; }
  static constexpr int finer = 4;
  /// The share of the loads that acts [-].
  void set_load_factor(double factor) { load_factor_ = factor; }
  /// The share of a spring of the contact's stiffness, and the rest of its law, in the forces of groups [-]: from 1,
  /// where the balance is linear, contacts that open and close are released bit by bit.
  void set_stuck_share(double share) { stuck_share_ = share; }
  const Vector& added_compliance() const { return added_; }

  /// W at which sliders are displaced by U under forces F, and the other way round from W and the loops at it.
  SliderSeries balanced(const SliderSeries& displacement, const SliderSeries& force) const;
  void displacement_and_force(const SliderSeries& balanced, SliderSeries& displacement, SliderSeries& force) const;

  struct Outcome {
    bool has_converged = false;
    double residual = 0.0;  ///< relative to the displacements
    int iterations = 0;
  };
  /// Continuation from a series that does not solve the balance: it shall leave a part of what this one leaves.
  void keep_residual(const SliderSeries& series);
  void leave(double part) { left_part_ = part; }
  /// Improves a series; what it holds after a failure is the best found.
  Outcome solve(SliderSeries& series, double tolerance, int most_iterations);

  /// Makes what follows independent of what was solved before.
  void forget() { has_factor_ = false; }

  /// The loops and forces at the solution found.
  const std::vector<HysteresisLoop>& loops() const { return loops_; }
  const std::vector<LawBySamples>& laws() const { return laws_; }
  const std::vector<GroupBySamples>& groups() const { return groups_; }
  bool has_laws() const { return !laws_.empty() || !groups_.empty(); }
  /// What each law of the system dissipates over a period, the blocks behind the scalar ones [J].
  Vector dissipated() const;
  const std::vector<Index>& active() const { return active_; }
  /// N of a slider at the series evaluated last; place as in the harmonics [N]
  Complex net_force(Index place, Index slider) const {
    return place == 0 ? Complex(mean_force_[slider]) : force_(place - 1, slider);
  }
  bool any_slips() const;

  /// Estimates what orders left out (from `first` place of the harmonics on) would change: their own displacements
  /// [orders left out x m] and the change of the forces of those kept [count x m], with what the rest of the residual
  /// does to them.
  /// Where there are laws sampling() goes before, whose finer samples count here too.
  void truncation(const SliderSeries& series, std::size_t first, std::size_t end, ComplexMatrix& left_out,
                  ComplexMatrix& forces_left_out, ComplexMatrix& force_change);

  /// What finer samples of the laws change of the forces, as above; their orders reach to place `end` of the harmonics.
  void sampling(const SliderSeries& series, std::size_t end, ComplexMatrix& force_change);

 private:
  struct Iterates;

  double evaluate(const SliderSeries& series);
  /// Where the law of a contact behind the sliders is: alone, or a number of a group.
  struct Seat {
    std::size_t law = 0, group = 0;
    Index number = -1;  ///< of the group; -1: alone
  };
  const Seat& seat(Index j) const { return seats_[static_cast<std::size_t>(j - sliders_)]; }
  bool is_grouped(Index j) const { return j >= sliders_ && seat(j).number >= 0; }
  const LawBySamples& law(Index j) const { return laws_[seat(j).law]; }
  const GroupBySamples& group(Index j) const { return groups_[seat(j).group]; }
  /// The contacts on whose displacements the force of a contact depends: itself alone, or its group.
  std::span<const Index> partners(Index j) const {
    return is_grouped(j) ? std::span<const Index>(members_[seat(j).group])
                         : std::span<const Index>(&own_[static_cast<std::size_t>(j)], 1);
  }
  void pass(Index j, const SliderSeries& series);
  /// What a stuck share makes of a force, or of its derivative, that a spring would make.
  template <class Value>
  Value shared(Index j, Value of_law, Value of_spring) const {
    if (stuck_share_ == 0.0 || !is_grouped(j)) return of_law;
    return stuck_share_ == 1.0 ? of_spring : (1.0 - stuck_share_) * of_law + stuck_share_ * of_spring;
  }
  // Of a contact, by the unknowns of another of its partners.
  Complex force_of(Index j, int k) const;
  double mean_force_of(Index j) const;
  void derivative_of(Index i, Index j, int k, int l, Complex& by_real, Complex& by_imaginary) const;
  void mean_derivative_of(Index i, Index j, int l, double& by_real, double& by_imaginary) const;
  Complex derivative_by_mean_of(Index i, Index j, int k) const;
  double mean_derivative_by_mean_of(Index i, Index j) const;
  /// The change of the forces kept where the unknowns change by `change`, added to force_change.
  void add_force_change(const SliderSeries& series, const Vector& change, ComplexMatrix& force_change) const;
  /// dF of every slider by its own unknowns, at the loops evaluated last.
  void differentiate(const SliderSeries& series);
  void differentiate(const SliderSeries& series, Index o, Index p, Index j, Index from);
  void factorise(const SliderSeries& series);
  void fill_diagonal(const SliderSeries& series, Vector& diagonal) const;
  void fill_jacobian(const SliderSeries& series, Matrix& jacobian) const;
  void multiply_by_jacobian(const SliderSeries& series, const Vector& x, Vector& y);
  void solve_linear(const SliderSeries& series, double tolerance, Vector& x);
  bool is_large(const SliderSeries& series) const;
  Index rows_per_slider(const SliderSeries& series) const {
    return (series.has_mean ? 1 : 0) + 2 * series.orders.count;
  }

  /// 1 + held h c: N = part F - held h W
  double part(std::size_t place, Index j) const { return 1.0 + (*harmonics_)[place].held * holding_[j] * added_[j]; }
  double held(std::size_t place, Index j) const { return (*harmonics_)[place].held * holding_[j]; }

  Vector stiffness_, holding_;
  Index sliders_;
  std::vector<LawBySamples> laws_;
  std::vector<std::shared_ptr<const LawGroup>> group_laws_;
  std::vector<GroupBySamples> groups_;
  std::vector<std::vector<Index>> members_;  ///< contacts of each group, by its numbers
  std::vector<Seat> seats_;                  ///< of the contacts behind the sliders
  std::vector<Index> single_;                ///< laws of the system that laws_ are
  std::vector<Index> own_;                   ///< 0, 1, ...
  Index most_partners_ = 1, law_count_ = 0;
  SampleAngles coarse_angles_, fine_angles_;
  ComplexMatrix sampled_change_;  ///< of the forces by finer samples [count x m]
  int samples_ = 64;
  bool is_extended_ = false, is_fine_ = false;  ///< laws are evaluated for orders left out too, and at fine_angles_
  double load_factor_ = 1.0, stuck_share_ = 0.0;
  const std::vector<CondensedHarmonic>* harmonics_ = nullptr;
  Vector limits_, offsets_;
  std::vector<Index> active_;
  std::vector<Index> position_;  ///< of each contact among the active ones
  std::vector<HysteresisLoop> loops_;
  Vector added_, effective_;           ///< c, 1/(1/kT + c)
  std::vector<ComplexMatrix> joined_;  ///< R_k - c a of each place [m x m]
  ComplexMatrix force_;                ///< N_k [count x m]
  Vector mean_force_;                  ///< N_0
  Vector residual_, step_, left_;
  double left_part_ = 0.0;
  ComplexMatrix columns_;  ///< dN_k, of one partner after another [partners count x active rows]
  Matrix by_mean_;         ///< dN_0 [active rows x partners]
  Vector diagonal_;        ///< a [active rows]
  SmallLu factor_, own_factor_;
  bool is_regular_ = true, has_factor_ = false;
  std::vector<Index> factor_active_;
  Orders factor_orders_;
  numerics::Gmres gmres_;
  Vector preconditioned_, product_;
  ComplexMatrix changed_force_;
  SliderSeries trial_, best_;
  double displacement_ = 0.0, linear_ = 0.0;
};

}  // namespace rubato::steady
