#include <rubato/model/laws/law_values.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <cmath>

namespace rubato::model {
namespace {

/// f = mu N tanh(du/dt / v): Coulomb friction whose jump at rest is drawn out. Under any load it creeps.
class SmoothFriction final : public Law {
 public:
  SmoothFriction(double limit, double velocity) : limit_(limit), velocity_(velocity) {}

  LawAnswer advance(const LawPoint&, const double* memory, const LawPoint& to, double*) const override {
    return at(to, memory);
  }
  LawAnswer at(const LawPoint& point, const double*) const override {
    const double share = std::tanh(point.rate / velocity_), cosine = std::cosh(point.rate / velocity_);
    return {limit_ * share, 0.0, limit_ / velocity_ / (cosine * cosine)};
  }

  double stored_energy(double, const double*) const override { return 0.0; }

  /// The integral of f du/dt, with a rate that goes in a straight line: in two parts where it passes zero.
  double dissipated(const LawPoint& from, const double*, const LawPoint& to, const double*) const override {
    const double h = to.t - from.t;
    if (from.rate * to.rate >= 0.0) return h * mean_power(from.rate, to.rate);
    const double share = from.rate / (from.rate - to.rate);
    return h * (share * mean_power(from.rate, 0.0) + (1.0 - share) * mean_power(0.0, to.rate));
  }

  double largest_stiffness() const override { return 0.0; }
  bool depends_on_rate() const override { return true; }
  bool is_odd() const override { return true; }

 private:
  double mean_power(double from, double to) const {
    static const numerics::GaussLegendre<8> rule;
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double rate = from + rule.node[i] * (to - from);
      sum += rule.weight[i] * rate * std::tanh(rate / velocity_);
    }
    return limit_ * sum;
  }

  double limit_;     // mu N [N]
  double velocity_;  // at which it reaches tanh(1) of its limit [m/s]
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { friction_coefficient, normal_load, velocity };
  const LawValues value(description, parameters, part);
  value.must_not_be_negative(friction_coefficient);
  value.must_not_be_negative(normal_load);
  value.must_be_positive(velocity);
  return std::make_shared<SmoothFriction>(value[friction_coefficient] * value[normal_load], value[velocity]);
}

}  // namespace

LawKind smooth_friction();
LawKind smooth_friction() {
  using Type = LawKey::Type;
  return {
      "smooth_friction",
      "regularised friction",
      "f = mu N tanh(rate / velocity), for comparison: it never sticks, and creeps under any load",
      {{"friction_coefficient", Type::number, "", {}, "mu"},
       {"normal_load", Type::number, "N", {}, "N, constant"},
       {"velocity", Type::number, "m/s", {}, "at which it is tanh(1) = 0.76 of mu N; small against that of sliding"}},
      make};
}

}  // namespace rubato::model
