#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/time_law.hpp>

#include <vector>

namespace rubato::system {

/// A time law on some coordinates: f += weights * law(t).
struct LoadTerm {
  /// Where it comes from: a force, or a support that is displaced, which pulls by its stiffness, or that moves, which
  /// pulls by its damping and mass and not in a static state.
  enum class Source { force, displaced_support, moving_support };
  std::vector<Index> rows;
  std::vector<double> weights;  ///< harmonic laws of equal frequency and phase share a term: their amplitude is in here
  model::TimeLaw law;
  Source source = Source::force;
};

/// The external loads f(t) [n] [N]. Holds the workspace of its formulas: each thread takes a copy.
class Loads {
 public:
  Loads() = default;
  /// Joins the harmonic terms of equal frequency and phase into one; the law of a harmonic term has amplitude 1 then.
  explicit Loads(std::vector<LoadTerm> terms);

  const std::vector<LoadTerm>& terms() const { return terms_; }
  /// Only harmonic terms: loads whose response has a closed form.
  bool are_harmonic() const;

  /// Writes f(t); allocates nothing.
  void evaluate(double t, Vector& f, model::Side side = model::Side::right) const;
  /// The same without what moving supports make: what acts in a static state.
  void evaluate_static(double t, Vector& f, model::Side side) const;
  /// The same of forces alone.
  void evaluate_forces(double t, Vector& f, model::Side side) const;

  /// Times in (from, to) at which a table has a row: kinks and jumps, sorted, without doubles.
  std::vector<double> breakpoints(double from, double to) const;

 private:
  void evaluate_up_to(LoadTerm::Source last, double t, Vector& f, model::Side side) const;

  std::vector<LoadTerm> terms_;
};

}  // namespace rubato::system
