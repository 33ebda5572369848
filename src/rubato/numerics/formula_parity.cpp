#include <rubato/numerics/formula_parity.hpp>

#include <cmath>
#include <vector>

namespace rubato::numerics {
namespace {

using Kind = FormulaTree::Kind;
using Node = FormulaTree::Node;

Parity sum(Parity a, Parity b) { return {a.is_even && b.is_even, a.is_odd && b.is_odd}; }
Parity product(Parity a, Parity b) {
  return {(a.is_even && b.is_even) || (a.is_odd && b.is_odd), (a.is_even && b.is_odd) || (a.is_odd && b.is_even)};
}
/// f(a) for an f of a known parity.
Parity chain(Parity f, Parity a) { return {a.is_even || (f.is_even && a.is_odd), f.is_odd && a.is_odd}; }
bool is_known(Parity a) { return a.is_even || a.is_odd; }

class Search {
 public:
  explicit Search(const Formula& formula) : formula_(formula), nodes_(formula.tree().nodes), parity_(nodes_.size()) {
    is_constant_.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      is_constant_[i] = node.kind != Kind::time && node.kind != Kind::other;
      for (const int part : {node.first, node.second, node.third})
        if (part >= 0) is_constant_[i] = is_constant_[i] && is_constant(part);
      parity_[i] = of(node);
    }
  }
  Parity whole() const { return parity_.back(); }

 private:
  bool is_constant(int node) const { return is_constant_[static_cast<std::size_t>(node)]; }
  double value_of(int constant) const { return formula_.part(constant, 0.0, 0).value; }
  Parity at(int node) const { return parity_[static_cast<std::size_t>(node)]; }

  Parity of(const Node& node) const {
    const Parity a = node.first >= 0 ? at(node.first) : Parity{}, b = node.second >= 0 ? at(node.second) : Parity{};
    switch (node.kind) {
      case Kind::constant:
        return {true, node.constant == 0.0};
      case Kind::time:
        return {true, false};
      case Kind::other:
        return {false, true};
      case Kind::negative:
      case Kind::direction:
        return a;
      case Kind::sum:
      case Kind::difference:
        return sum(a, b);
      case Kind::product:
      case Kind::quotient:
        return product(a, b);
      case Kind::power:
        return power(a, b, node.second);
      case Kind::function:
        return chain(node.function->parity, a);
      case Kind::magnitude:
        return {is_known(a), a.is_even && a.is_odd};
      case Kind::rounded:  // rint(-1/2) is 0, rint(1/2) is 1
        return {a.is_even, a.is_even && a.is_odd};
      case Kind::angle:  // a zero above what is negative is half a turn, whichever way it came
        return {a.is_even && b.is_even, a.is_odd && is_constant(node.second) && value_of(node.second) > 0.0};
      case Kind::least:
      case Kind::greatest:
        return {a.is_even && b.is_even, false};
      case Kind::less:
      case Kind::less_or_equal:
      case Kind::greater:
      case Kind::greater_or_equal:
        return {a.is_even && b.is_even, false};
      case Kind::equal:
      case Kind::unequal:
        return {(a.is_even && b.is_even) || (a.is_odd && b.is_odd), false};
      case Kind::both:
      case Kind::either:  // of a number nothing counts but whether it is zero
        return {is_known(a) && is_known(b), false};
      case Kind::choice:
        return is_known(a) ? sum(b, at(node.third)) : Parity{};
      default:
        return {};
    }
  }

  /// Whole powers keep a parity, or make it even.
  Parity power(Parity a, Parity b, int exponent) const {
    if (a.is_even && b.is_even) return {true, false};
    if (!a.is_odd || !is_constant(exponent)) return {};
    const double n = value_of(exponent);
    if (!std::isfinite(n) || n != std::rint(n)) return {};
    return std::fmod(n, 2.0) == 0.0 ? Parity{true, false} : Parity{false, true};
  }

  const Formula& formula_;
  const std::vector<Node>& nodes_;
  std::vector<Parity> parity_;
  std::vector<bool> is_constant_;
};

}  // namespace

Parity parity_of(const Formula& formula) { return Search(formula).whole(); }

}  // namespace rubato::numerics
