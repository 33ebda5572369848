#pragma once

#include <rubato/numerics/expression.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::numerics {

/// A formula of named values that lie in an array of its owner and may change between evaluations, which parse nothing
/// and allocate nothing. `pi` is known.
///
/// An instance is a workspace: it must not be evaluated by two threads at once.
class BoundFormula {
 public:
  /// Throws InvalidInput as Expression does.
  /// @param text        the formula
  /// @param parameters  the names that it may use
  /// @param values      theirs, in the same order; must outlive the formula
  BoundFormula(const std::string& text, const Parameters& parameters, const double* values);
  BoundFormula(BoundFormula&&) noexcept;
  BoundFormula& operator=(BoundFormula&&) noexcept;
  ~BoundFormula();

  /// Its value; may be non-finite.
  double operator()() const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

/// Which of the parameters a formula uses (by place, rising). Throws InvalidInput as Expression does.
std::vector<std::size_t> parameters_used(const std::string& text, const Parameters& parameters, bool of_time = false);

}  // namespace rubato::numerics
