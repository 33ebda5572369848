#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_kind.hpp>
#include <rubato/numerics/formula_parity.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

/// A force by a formula of u, its rate and t, with exact slopes. What it does at rest is elastic, where it does not
/// depend on time.
class NonlinearSpring final : public Law {
 public:
  explicit NonlinearSpring(numerics::Formula force)
      : force_(std::move(force)),
        uses_rate_(force_.uses(1)),
        is_odd_(!force_.uses_time() && numerics::parity_of(force_).is_odd) {}

  LawAnswer advance(const LawPoint&, const double* memory, const LawPoint& to, double*) const override {
    return at(to, memory);
  }

  LawAnswer at(const LawPoint& point, const double*) const override {
    const double t = time_of(point);
    const std::array<double, 2> values{point.u, point.rate};
    const numerics::ValueAndSlope by_u = with_slope(0, t, values);
    return {by_u.value, by_u.slope, uses_rate_ ? with_slope(1, t, values).slope : 0.0};
  }

  double stored_energy(double u, const double*) const override { return depends_on_time() ? 0.0 : integral(0.0, u); }

  double dissipated(const LawPoint& from, const double*, const LawPoint& to, const double*) const override {
    if (!uses_rate_ && !depends_on_time()) return 0.0;
    static const numerics::GaussLegendre<6> rule;
    double work = 0.0;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double s = rule.node[i], u = from.u + s * (to.u - from.u);
      const double rate = from.rate + s * (to.rate - from.rate), t = from.t + s * (to.t - from.t);
      work += rule.weight[i] * (value(u, rate, t) - (depends_on_time() ? 0.0 : value(u, 0.0, t)));
    }
    return work * (to.u - from.u);
  }

  bool depends_on_rate() const override { return uses_rate_; }
  bool depends_on_time() const override { return force_.uses_time(); }
  const numerics::Formula* formula_of_time() const override { return force_.uses_time() ? &force_ : nullptr; }
  bool is_odd() const override { return is_odd_; }
  std::vector<double> breakpoints(double from, double to) const override {
    return force_.has_switches() ? force_.switches(from, to) : std::vector<double>{};
  }

 private:
  double value(double u, double rate, double t) const { return force_(t, std::array{u, rate}); }

  /// A formula that switches with time is taken just before or after, to which a step meets its time.
  double time_of(const LawPoint& point) const {
    constexpr double at_switch = 16.0 * std::numeric_limits<double>::epsilon();
    if (!force_.has_switches()) return point.t;
    return point.t * (point.side == Side::left ? 1.0 - at_switch : 1.0 + at_switch);
  }

  /// Exact, but where the formula has no finite slope (u sqrt(abs(u)) at zero, whose terms are 0 times infinity).
  numerics::ValueAndSlope with_slope(std::size_t i, double t, const std::array<double, 2>& at) const {
    const numerics::ValueAndSlope exact = force_.with_slope(i, t, at);
    if (std::isfinite(exact.slope)) return exact;
    constexpr double relative = 6e-6;  // the cube root of round-off
    const double step = relative * (1.0 + std::abs(at[i]));
    std::array<double, 2> before = at, after = at;
    before[i] -= step;
    after[i] += step;
    return {exact.value, (force_(t, after) - force_(t, before)) / (2.0 * step)};
  }

  /// The force at rest over u, by halves until they agree: formulas may have kinks.
  double integral(double from, double to, int depth = 0) const {
    static const numerics::GaussLegendre<8> rule;
    const double middle = 0.5 * (from + to);
    const auto over = [&](double a, double b) {
      double sum = 0.0;
      for (std::size_t i = 0; i < rule.node.size(); ++i)
        sum += rule.weight[i] * value(a + rule.node[i] * (b - a), 0.0, 0.0);
      return sum * (b - a);
    };
    const double left = over(from, middle), right = over(middle, to), whole = over(from, to);
    if (depth >= 40 || !(std::abs(left + right - whole) > 1e-13 * (std::abs(left) + std::abs(right))))
      return left + right;
    return integral(from, middle, depth + 1) + integral(middle, to, depth + 1);
  }

  numerics::Formula force_;  // of u, rate and t
  bool uses_rate_, is_odd_;
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  const Quantity& force = description.values.front();
  if (force.expression.empty() && force.value != 0.0)
    throw InvalidInput(force.where, fmt::format("{}: force is {} whatever the motion; give a formula of u, rate and t "
                                                "such as \"k*u + k3*u^3\", or a [[force]]",
                                                part, force.value));
  try {
    return std::make_shared<NonlinearSpring>(
        numerics::Formula(force.expression.empty() ? "0" : force.expression, parameters, true, {"u", "rate"}));
  } catch (const InvalidInput& error) {
    throw InvalidInput(force.where, fmt::format("{}: force: {}", part, error.what()));
  }
}

}  // namespace

LawKind nonlinear_spring();
LawKind nonlinear_spring() {
  return {"nonlinear_spring",
          "a nonlinear spring",
          "A force by a formula of u, rate and t, which is differentiated exactly",
          {{"force",
            LawKey::Type::formula,
            "N",
            {},
            "of u [m], rate [m/s], t [s] and the parameters, as \"k*u + k3*u^3\""}},
          make};
}

}  // namespace rubato::model
