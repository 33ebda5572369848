#pragma once

#include <rubato/numerics/formula.hpp>
#include <rubato/numerics/interval_series.hpp>

#include <vector>

namespace rubato::numerics {

/// What parts of a formula are, with their derivatives with respect to t, while t runs through an interval. Where a
/// branch changes within the interval, or may, both count and derivatives may be anything. A workspace.
class FormulaEnclosure {
 public:
  /// @param formula  must outlive the enclosure
  /// @param others   what further values are that change with what moves
  explicit FormulaEnclosure(const Formula& formula, double others = 0.0);

  int whole() const { return static_cast<int>(nodes_.size()) - 1; }
  /// The largest parts that depend on t and on nothing else that changes: the whole, or parts of it.
  std::vector<int> parts_of_time() const;

  /// Chooses the parts that are evaluated.
  void choose(const std::vector<int>& parts);
  /// How many operations an evaluation takes.
  std::size_t cost() const { return wanted_.size() + 1; }
  /// @param order  at most IntervalSeries::most
  void evaluate(const Interval& t, int order);
  const IntervalSeries& of(int part) const { return values_[static_cast<std::size_t>(part)]; }

 private:
  using Kind = FormulaTree::Kind;
  using Node = FormulaTree::Node;
  enum class Shape { constant, of_time, of_others };

  IntervalSeries value_of(const Node& node, const Interval& t, int n) const;
  IntervalSeries compared(const Node& node, int n) const;

  const std::vector<Node>& nodes_;
  double others_;
  std::vector<Shape> shapes_;
  std::vector<int> wanted_;  // what is not constant, what a node is made of before it
  std::vector<IntervalSeries> values_;
};

}  // namespace rubato::numerics
