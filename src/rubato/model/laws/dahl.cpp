#include <rubato/model/laws/law_slopes.hpp>
#include <rubato/model/laws/law_values.hpp>
#include <rubato/model/laws/relaxation.hpp>

#include <cmath>

namespace rubato::model {
namespace {

/// df/du = sigma (1 - f sgn(du/dt) / Fc): Dahl 1968, with the exponent 1. Between turns of u the force is an
/// exponential of the travel, which advance() follows exactly; its memory is f [N].
class Dahl final : public Law, public LawSlopes {
 public:
  Dahl(double stiffness, double slip_force) : stiffness_(stiffness), limit_(slip_force) {}

  Index memory_size() const override { return 1; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    const double travel = to.u - from.u, way = direction(travel, to.rate);
    next[0] = limit_ * Relaxation{memory[0] / limit_, way}.at(length(travel));
    return {next[0], slope(next[0], way), 0.0};
  }

  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    double next = 0.0;
    const double by_u = advance(from, memory, to, &next).by_u, kept = std::exp(-length(to.u - from.u));
    for (const int row : {0, 5}) {
      slopes[row] = by_u;
      slopes[row + 2] = -by_u;
      slopes[row + 4] = kept;
    }
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    return {memory[0], slope(memory[0], direction(0.0, point.rate)), 0.0};
  }

  /// What it would give back as the spring that it is at f = 0.
  double stored_energy(double, const double* memory) const override { return 0.5 * memory[0] * memory[0] / stiffness_; }

  /// Its power is f^2 |du/dt| / Fc.
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double*) const override {
    const double travel = to.u - from.u, way = direction(travel, to.rate), x = length(travel);
    return limit_ * limit_ / stiffness_ * Relaxation{memory[0] / limit_, way}.square(x);
  }

  /// Where the force and the motion are opposite.
  double largest_stiffness() const override { return 2.0 * stiffness_; }
  bool is_odd() const override { return true; }

  /// Another formula holds once the motion turns.
  bool is_exact_between_guards() const override { return true; }
  double guard(const LawPoint& from, const double*, const LawPoint& to, double) const override {
    return from.rate > 0.0 ? to.rate : from.rate < 0.0 ? -to.rate : 1.0;
  }

 private:
  static double direction(double travel, double rate) {
    const double way = travel != 0.0 ? travel : rate;
    return way > 0.0 ? 1.0 : way < 0.0 ? -1.0 : 0.0;
  }
  /// Of a travel, where 1 is that in which the distance to Fc falls to 1/e.
  double length(double travel) const { return stiffness_ * std::abs(travel) / limit_; }
  double slope(double force, double way) const { return stiffness_ * (1.0 - way * force / limit_); }

  double stiffness_;  // sigma [N/m]
  double limit_;      // Fc [N]
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { stiffness, slip_force };
  const LawValues value(description, parameters, part);
  value.must_be_positive(stiffness);
  value.must_be_positive(slip_force);
  return std::make_shared<Dahl>(value[stiffness], value[slip_force]);
}

}  // namespace

LawKind dahl();
LawKind dahl() {
  using Type = LawKey::Type;
  return {"dahl",
          "a Dahl element",
          "Friction that gives way before it slips: df/du = stiffness (1 - f sgn(du/dt) / slip_force)",
          {{"stiffness", Type::number, "N/m", {}, "sigma, the slope of f against u at f = 0"},
           {"slip_force", Type::number, "N", {}, "Fc, which a long slip comes near to"}},
          make};
}

}  // namespace rubato::model
