#include <rubato/model/laws/law_slopes.hpp>
#include <rubato/model/laws/law_values.hpp>
#include <rubato/model/laws/turning_points.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

/// The sliders of Segalman 2005, eqs. 17 to 26: springs that slip at the deflections phi, with the stiffness rho(phi) =
/// R phi^chi for phi < phi_max and S at phi_max.
class Sliders {
 public:
  Sliders(double stiffness, double slip_force, double chi, double beta)
      : stiffness_(stiffness), slip_force_(slip_force), chi_(chi) {
    const double share = beta + (chi + 1.0) / (chi + 2.0);
    longest_ = slip_force * (1.0 + beta) / (stiffness * share);
    spread_ = slip_force * (chi + 1.0) / share;
    last_ = slip_force * beta / (longest_ * share);
  }

  double stiffness() const { return stiffness_; }
  double slip_force() const { return slip_force_; }
  double longest() const { return longest_; }
  /// The force of first loading [N]; the integral of rho min(phi, r).
  double force(double r) const {
    if (r >= longest_) return slip_force_;
    return stiffness_ * r - spread_ * power(r, 2.0) / ((chi_ + 1.0) * (chi_ + 2.0));
  }
  double slope(double r) const {
    if (r >= longest_) return 0.0;
    return stiffness_ - spread_ / longest_ * power(r, 1.0) / (chi_ + 1.0);
  }
  /// What first loading to r <= phi_max dissipates [J].
  double loss(double r) const { return spread_ * longest_ * power(r, 3.0) / ((chi_ + 2.0) * (chi_ + 3.0)); }
  /// How densely they lie, over R phi_max^chi.
  double density(double r) const { return power(r, 0.0); }

  /// Energy of the sliders between a and b, deflected by c + s phi [J].
  double energy(double a, double b, double c, double s) const {
    const auto moment = [&](double j) { return (power(b, 1.0 + j) - power(a, 1.0 + j)) / (chi_ + 1.0 + j); };
    return 0.5 * spread_ *
           (c * c / longest_ * moment(0.0) + 2.0 * c * s * moment(1.0) + longest_ * s * s * moment(2.0));
  }
  /// Of those beyond r, which have not slipped.
  double energy_beyond(double r, double deflection) const {
    return energy(r, longest_, deflection, 0.0) + 0.5 * last_ * deflection * deflection;
  }

 private:
  /// (r / phi_max)^(chi + j)
  double power(double r, double j) const { return r > 0.0 ? std::pow(r / longest_, chi_ + j) : 0.0; }

  double stiffness_, slip_force_, chi_;
  double longest_;  // phi_max [m]
  double spread_;   // R phi_max^(chi + 2) [N]
  double last_;     // S [N/m]
};

/// A joint that slips in ever larger parts before it slips as a whole: sliders of all lengths side by side. Between
/// turns the force is a function of the travel, by Masing's rules: F of first loading, T_r -+ 2 F(|u - u_r|/2) after a
/// turn, and a branch that passes an earlier turn goes on as if the smaller loop had not been. No slider is computed.
class Iwan final : public Law, public LawSlopes {
 public:
  explicit Iwan(const Sliders& sliders) : sliders_(sliders) {}

  /// So many turning points are remembered. Of more two loops that lie close are joined, with their lengths and the
  /// force as they are: what that changes is felt only while a later, larger motion passes them.
  static constexpr std::size_t most = 32;
  Index memory_size() const override { return most; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    Turns turns(memory);
    move(turns, to.u - from.u, to.u - from.u, nullptr);
    turns.write(next);
    return {force(turns), to.u == from.u ? slope(turns, to.rate) : sliders_.slope(turns.radius(turns.size() - 1))};
  }

  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    using Real = Sloped<most + 1>;  // by each radius, and by the travel
    TurningPoints<Real, most> turns(memory);
    const Turns start(memory);
    for (std::size_t k = 0; k < turns.size(); ++k) turns.number(k).slope[k] = 1.0;
    Real travel(to.u - from.u);
    travel.slope[most] = 1.0;
    move(turns, to.u - from.u, travel, nullptr);
    // The first travel of all adds to the first number of the memory, zero as it is.
    if (start.size() == 0 && turns.size() > 0) turns.number(0).slope[0] = turns.way(0);
    const auto add = [&](std::size_t row, const Real& of, double factor) {
      double* const slopes_of = slopes + row * (4 + most);
      slopes_of[0] += factor * of.slope[most];
      slopes_of[2] -= factor * of.slope[most];
      for (std::size_t i = 0; i < std::max<std::size_t>(start.size(), 1); ++i)
        slopes_of[4 + i] += factor * (start.size() == 0 ? 1.0 : start.way(i)) * of.slope[i];
    };
    for (std::size_t k = 0; k < turns.size(); ++k) {
      add(0, turns.number(k), (k == 0 ? 1.0 : 2.0) * turns.way(k) * sliders_.slope(turns.radius(k)));
      add(1 + k, turns.number(k), turns.way(k));
    }
    if (to.u == from.u) add_slopes_at_rest(start, to.rate, slopes);
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    const Turns turns(memory);
    return {force(turns), slope(turns, point.rate), 0.0};
  }

  double stored_energy(double, const double* memory) const override { return energy(Turns(memory)); }

  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double*) const override {
    Turns turns(memory);
    double lost = 0.0;
    move(turns, to.u - from.u, to.u - from.u, &lost);
    return lost;
  }

  double largest_stiffness() const override { return sliders_.stiffness(); }
  bool is_odd() const override { return true; }

  /// Another formula holds once the motion turns, closes a loop or slips as a whole.
  bool is_exact_between_guards() const override { return true; }
  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    const double way = from.rate > 0.0 ? 1.0 : from.rate < 0.0 ? -1.0 : 0.0;
    if (way == 0.0) return 1.0;
    Turns turns(memory);
    const double passed = near * std::abs(from.rate);
    move(turns, way * passed, way * passed, nullptr);
    return std::min(way * to.rate, passed + left_before_kink(turns) - way * (to.u - from.u));
  }

 private:
  using Turns = TurningPoints<double, most>;

  template <class Real>
  void move(TurningPoints<Real, most>& turns, double travel, Real left, double* lost) const {
    if (travel == 0.0) return;
    const double way = travel > 0.0 ? 1.0 : -1.0;
    left = way * left;
    if (turns.way() != way) {
      if (turns.is_full()) make_room(turns);
      turns.begin(way);
    }
    for (;;) {
      const std::size_t last = turns.size() - 1;
      const double begin = turns.radius(last);
      if (last == 0) {
        const double reached = begin + value_of(left), end = std::min(reached, sliders_.longest());
        if (lost) *lost += sliders_.loss(end) - sliders_.loss(begin) + sliders_.slip_force() * (reached - end);
        turns.number(0) = end < reached ? Real(end) : turns.number(0) + left;
        break;
      }
      const double most_here = turns.radius(last - 1);
      if (begin + 0.5 * value_of(left) < most_here) {
        turns.number(last) = turns.number(last) + 0.5 * left;
        if (lost) *lost += 2.0 * (sliders_.loss(turns.radius(last)) - sliders_.loss(begin));
        break;
      }
      if (lost) *lost += 2.0 * (sliders_.loss(most_here) - sliders_.loss(begin));
      left = left - 2.0 * (turns.number(last - 1) - turns.number(last));
      turns.close();
    }
    turns.tidy();
  }

  /// Joins the loops that lie closest. The little energy that this adds to what is stored is no loss of the joint's,
  /// and is left to the residue of the ledger.
  template <class Real>
  void make_room(TurningPoints<Real, most>& turns) const {
    double least = HUGE_VAL;
    std::size_t best = 1;
    for (std::size_t k = 1; k + 3 < most; ++k) {
      const double change = sliders_.density(turns.radius(k + 1)) * std::pow(turns.radius(k) - turns.radius(k + 3), 2);
      if (!(change < least)) continue;
      least = change;
      best = k;
    }
    const Real &a = turns.number(best), &b = turns.number(best + 1), &c = turns.number(best + 2),
               &d = turns.number(best + 3);
    const Real width = a - b + c - d;
    const double x = border(value_of(a), value_of(b), value_of(c), value_of(d));
    const double at_x = sliders_.slope(x), at_y = sliders_.slope(x - value_of(width));
    Real outer = a;
    if (at_y - at_x > 1e-9 * sliders_.stiffness())
      outer =
          (1.0 / (at_x - at_y)) * (sliders_.slope(value_of(a)) * a - sliders_.slope(value_of(b)) * b +
                                   sliders_.slope(value_of(c)) * c - sliders_.slope(value_of(d)) * d - at_y * width);
    outer += Real(x - value_of(outer));
    turns.join(best, outer, outer - width);
  }

  /// Of ranges from a to b and from c to d, a > b > c > d, joined: where they then begin. Their width, and so the place
  /// of all that did not slip in them, and the force stay as they are.
  double border(double a, double b, double c, double d) const {
    const double width = a - b + c - d;
    const double wanted = sliders_.force(a) - sliders_.force(b) + sliders_.force(c) - sliders_.force(d);
    double low = d + width, high = a, x = 0.5 * (low + high);
    for (int i = 0; i < 60; ++i) {
      const double error = sliders_.force(x) - sliders_.force(x - width) - wanted;
      (error > 0.0 ? low : high) = x;  // the force of first loading is concave
      double next = x - error / (sliders_.slope(x) - sliders_.slope(x - width));
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (std::abs(next - x) <= 4.0 * std::numeric_limits<double>::epsilon() * a) return next;
      x = next;
    }
    return x;
  }

  template <class Real>
  double force(const TurningPoints<Real, most>& turns) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < turns.size(); ++k)
      sum += (k == 0 ? 1.0 : 2.0) * turns.way(k) * sliders_.force(turns.radius(k));
    return sum;
  }

  /// Where a step has no travel, what a little more of it would do.
  void add_slopes_at_rest(const Turns& start, double rate, double* slopes) const {
    constexpr std::size_t row = 4 + most;
    const std::size_t n = start.size();
    slopes[0] = slope(start, rate);
    slopes[2] = -slopes[0];
    if (n == 0) slopes[4] = sliders_.stiffness();
    const bool turns = n > 0 && start.way() * rate < 0.0;
    const std::size_t moves = turns || n == 0 ? n : n - 1;
    if (moves >= most) return;
    double* const of = slopes + (1 + moves) * row;
    of[0] = moves == 0 ? 1.0 : 0.5;
    of[2] = -of[0];
    of[4 + moves] = 1.0;
  }

  /// That of motions in a direction; from rest the mean of both.
  double slope(const Turns& turns, double rate) const {
    if (turns.size() == 0 || turns.way() * rate < 0.0) return sliders_.stiffness();
    const double on = sliders_.slope(turns.radius(turns.size() - 1));
    return rate == 0.0 ? 0.5 * (sliders_.stiffness() + on) : on;
  }

  double energy(const Turns& turns) const {
    double sum = 0.0, within = 0.0, deflection = 0.0;  // c and e of the range of a direction
    for (std::size_t k = turns.size(); k-- > 0;) {
      const double inner = k + 1 < turns.size() ? turns.radius(k + 1) : 0.0;
      sum += sliders_.energy(inner, turns.radius(k), within, turns.way(k));
      deflection = within + turns.way(k) * turns.radius(k);
      within += 2.0 * turns.way(k) * turns.radius(k);
    }
    return turns.size() == 0 ? 0.0 : sum + sliders_.energy_beyond(turns.radius(0), deflection);
  }

  /// The travel until the last loop closes, or all slips.
  double left_before_kink(const Turns& turns) const {
    const std::size_t n = turns.size();
    if (n == 1) {
      const double left = sliders_.longest() - turns.radius(0);
      return left > 0.0 ? left : std::numeric_limits<double>::infinity();
    }
    return 2.0 * (turns.radius(n - 2) - turns.radius(n - 1));
  }

  Sliders sliders_;
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { stiffness, slip_force, chi, beta };
  const LawValues value(description, parameters, part);
  value.must_be_positive(stiffness);
  value.must_be_positive(slip_force);
  if (!(value[chi] > -1.0))
    value.refuse(chi, fmt::format("chi must be greater than -1, got {}: the joint would have no finite stiffness; "
                                  "bolted joints have -0.8 to 0",
                                  value[chi]));
  value.must_not_be_negative(beta);
  return std::make_shared<Iwan>(Sliders(value[stiffness], value[slip_force], value[chi], value[beta]));
}

}  // namespace

LawKind iwan();
LawKind iwan() {
  using Type = LawKey::Type;
  return {"iwan",
          "an Iwan element",
          "A joint that slips in ever larger parts before it slips as a whole: sliders of all lengths, as dense as "
          "phi^chi (four parameters)",
          {{"stiffness", Type::number, "N/m", {}, "kT, of small motions"},
           {"slip_force", Type::number, "N", {}, "Fs, at which it slips as a whole"},
           {"chi", Type::number, "", {}, "small cycles dissipate as amplitude^(chi + 3); greater than -1"},
           {"beta", Type::number, "", {}, "how abruptly it slips as a whole, not negative; 0: smoothly"}},
          make};
}

}  // namespace rubato::model
