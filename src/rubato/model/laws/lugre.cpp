#include <rubato/model/laws/law_resolution.hpp>
#include <rubato/model/laws/law_slopes.hpp>
#include <rubato/model/laws/law_values.hpp>
#include <rubato/model/laws/relaxation.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

struct LuGreValues {
  double bristle_stiffness;  ///< s0 [N/m]
  double bristle_damping;    ///< s1 [N s/m]
  double viscous_damping;    ///< s2 [N s/m]
  double coulomb_force;      ///< Fc [N]
  double static_force;       ///< Fs >= Fc [N]
  double stribeck_velocity;  ///< vs [m/s]
};

/// F = s0 z + s1 dz/dt + s2 v,  dz/dt = v - s0 |v| z / g(v),  g(v) = Fc + (Fs - Fc) exp(-(v/vs)^2): Canudas de Wit et
/// al. 1995, eqs. 1 to 5. Its memory is z, the deflection of the bristles [m].
///
/// Within a step u goes in a straight line, and z is exact for that speed: an exponential of the travel, which never
/// passes g/s0 however long the step. Where the motion ends in no time, as in static states, the speed is zero.
class LuGre final : public Law, public LawSlopes, public LawResolution {
 public:
  explicit LuGre(const LuGreValues& values) : c_(values) {}

  Index memory_size() const override { return 1; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    const Step step(c_, from, memory[0], to);
    next[0] = step.z;
    const End end(c_, to.rate, step.z);
    return {end.force, end.by_z * step.by_travel, end.by_rate};
  }

  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    const Step step(c_, from, memory[0], to);
    const End end(c_, to.rate, step.z);
    slopes[0] = end.by_z * step.by_travel;
    slopes[1] = end.by_rate;
    slopes[2] = -slopes[0];
    slopes[4] = end.by_z * step.kept;
    slopes[5] = step.by_travel;
    slopes[7] = -step.by_travel;
    slopes[9] = step.kept;
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    const double z = memory[0], way = sign(point.rate);
    const End end(c_, point.rate, z);
    return {end.force, end.by_z * (1.0 - way * c_.bristle_stiffness * z / limit(c_, point.rate)), end.by_rate};
  }

  double stored_energy(double, const double* memory) const override {
    return 0.5 * c_.bristle_stiffness * memory[0] * memory[0];
  }

  /// Its power is s0^2 |v| z^2 / g + s1 v dz/dt + s2 v^2.
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double* next) const override {
    const double h = to.t - from.t, travel = to.u - from.u, speed = h > 0.0 ? travel / h : 0.0;
    const double g = limit(c_, speed), stiffness = c_.bristle_stiffness;
    const Relaxation bristles{stiffness * memory[0] / g, sign(travel)};
    const double slip = g * g / stiffness * bristles.square(stiffness * std::abs(travel) / g);
    const double square = (from.rate * from.rate + from.rate * to.rate + to.rate * to.rate) / 3.0;
    return slip + c_.bristle_damping * speed * (next[0] - memory[0]) + c_.viscous_damping * h * square;
  }

  /// Where z and the motion are opposite.
  double largest_stiffness() const override {
    return c_.bristle_stiffness * (1.0 + c_.static_force / c_.coulomb_force);
  }
  bool depends_on_rate() const override { return true; }
  bool is_odd() const override { return true; }
  /// z depends on how the speed goes.
  bool is_exact_between_guards() const override { return false; }
  /// Where an implicit step is long it also lets go from rest at once: at the speed to which it then comes, g is below
  /// what holds. A tenth of Fs - Fc a step follows the weakening. Before that z takes the mean speed of a step: while
  /// the bristles yield, over a travel of g/s0, that errs by about x (dv/v)/6 of g with the travel x in it.
  double unresolved(const LawPoint& from, const LawPoint& to) const override {
    constexpr double weakened = 0.1, yielded = 0.005;
    const double both = std::abs(from.rate) + std::abs(to.rate);
    if (!(both > 0.0)) return 0.0;
    const double x = c_.bristle_stiffness * std::abs(to.u - from.u) / limit(c_, 0.5 * (from.rate + to.rate));
    const double yielding = std::sqrt(x * std::exp(-x) * std::abs(to.rate - from.rate) / (both * yielded));
    if (!(c_.static_force > c_.coulomb_force)) return yielding;
    const double before = weakening(from.rate), after = weakening(to.rate);
    const double between = from.rate * to.rate < 0.0 ? 0.0 : std::min(before, after);  // it passes rest
    return std::max(yielding, (std::max(before, after) - between) / weakened);
  }

 private:
  static double sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
  /// 0 at rest, 1 where Fs has fallen to Fc.
  double weakening(double rate) const { return -std::expm1(-std::pow(rate / c_.stribeck_velocity, 2)); }
  static double limit(const LuGreValues& c, double rate) {
    const double share = rate / c.stribeck_velocity;
    return c.coulomb_force + (c.static_force - c.coulomb_force) * std::exp(-share * share);
  }
  static double limit_slope(const LuGreValues& c, double rate) {
    return -2.0 * rate / (c.stribeck_velocity * c.stribeck_velocity) * (limit(c, rate) - c.coulomb_force);
  }

  /// z at the end of a step, with its slopes.
  struct Step {
    double z = 0.0;          ///< [m]
    double by_travel = 0.0;  ///< dz/d(travel) [-]
    double kept = 1.0;       ///< dz/dz at the start [-]

    Step(const LuGreValues& c, const LawPoint& from, double start, const LawPoint& to) {
      const double h = to.t - from.t, travel = to.u - from.u, speed = h > 0.0 ? travel / h : 0.0;
      const double g = limit(c, speed), way = sign(travel != 0.0 ? travel : to.rate), s0 = c.bristle_stiffness;
      const double x = s0 * std::abs(travel) / g;
      kept = std::exp(-x);
      z = g / s0 * Relaxation{s0 * start / g, way}.at(x);
      const double by_limit = start * kept * x / g - way / s0 * (std::expm1(-x) + x * kept);
      by_travel = kept * (1.0 - way * s0 * start / g) + (h > 0.0 ? by_limit * limit_slope(c, speed) / h : 0.0);
    }
  };

  /// The force of bristles at a speed, with its slopes.
  struct End {
    double force, by_z, by_rate;

    End(const LuGreValues& c, double rate, double z) {
      const double g = limit(c, rate), s0 = c.bristle_stiffness, s1 = c.bristle_damping;
      const double yield = s0 * std::abs(rate) / g;  // [1/s]
      const double yield_slope = s0 * (sign(rate) - std::abs(rate) * limit_slope(c, rate) / g) / g;
      force = s0 * z + s1 * (rate - yield * z) + c.viscous_damping * rate;
      by_z = s0 - s1 * yield;
      by_rate = s1 * (1.0 - yield_slope * z) + c.viscous_damping;
    }
  };

  LuGreValues c_;
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { bristle_stiffness, bristle_damping, viscous_damping, coulomb_force, static_force, stribeck_velocity };
  const LawValues value(description, parameters, part);
  for (const std::size_t key : {bristle_stiffness, coulomb_force, static_force, stribeck_velocity})
    value.must_be_positive(key);
  for (const std::size_t key : {bristle_damping, viscous_damping}) value.must_not_be_negative(key);
  if (value[static_force] < value[coulomb_force])
    value.refuse(static_force,
                 fmt::format("static_force is {} and coulomb_force {}: friction at rest is not below that "
                             "of sliding; swap them, or make them equal",
                             value[static_force], value[coulomb_force]));
  return std::make_shared<LuGre>(LuGreValues{value[bristle_stiffness], value[bristle_damping], value[viscous_damping],
                                             value[coulomb_force], value[static_force], value[stribeck_velocity]});
}

}  // namespace

LawKind lugre();
LawKind lugre() {
  using Type = LawKey::Type;
  return {"lugre",
          "a LuGre element",
          "Friction of bristles that falls with the speed: F = s0 z + s1 dz/dt + s2 v, dz/dt = v - s0 |v| z / g(v), "
          "g = Fc + (Fs - Fc) exp(-(v/vs)^2)",
          {{"bristle_stiffness", Type::number, "N/m", {}, "s0, the slope of F against u at rest"},
           {"bristle_damping", Type::number, "N s/m", 0.0, "s1, of the bristles while they deflect"},
           {"viscous_damping", Type::number, "N s/m", 0.0, "s2"},
           {"coulomb_force", Type::number, "N", {}, "Fc, of fast sliding"},
           {"static_force", Type::number, "N", {}, "Fs, of slow sliding, not below Fc"},
           {"stribeck_velocity", Type::number, "m/s", {}, "vs, at which exp(-1) = 0.37 of Fs - Fc is left"}},
          make};
}

}  // namespace rubato::model
