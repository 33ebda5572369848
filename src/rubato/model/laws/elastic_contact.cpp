#include <rubato/model/laws/elastic_contact.hpp>
#include <rubato/model/laws/only_transient.hpp>
#include <rubato/model/laws/slip_on_circle.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

using Pair = SlipOnCircle::Pair;

double dot(const Pair& a, const Pair& b) { return a[0] * b[0] + a[1] * b[1]; }
double length(const Pair& a) { return std::hypot(a[0], a[1]); }

/// Contacts that rub in one direction have a second one in which nothing ever happens: one formula serves both, and
/// hypot() of a number and zero is that number.
class ElasticContact final : public BlockLaw, public BlockSlopes, public OnlyTransient {
 public:
  explicit ElasticContact(const ContactValues& values) : v_(values), kt_(values.tangential_stiffness) {
    assert(values.directions >= 0 && values.directions < largest_block && values.normal_stiffness > 0.0);
  }

  Index size() const override { return v_.directions + 1; }
  Index memory_size() const override { return v_.directions; }
  double sliding_velocity() const override { return v_.sliding_velocity; }

  BlockAnswer advance(const BlockPoint& from, const double* memory, const BlockPoint& to, double* next) const override {
    BlockAnswer answer;
    const Index n = v_.directions;
    std::fill_n(next, n, 0.0);
    const double closed = closed_share(from, to), begin = pressing(from), end = pressing(to, closed);
    if (end < 0.0) return answer;
    answer.force[n] = end;
    answer.by_u[n][n] = v_.normal_stiffness + slope_of_share(from, to);  // at the gap with the slope of either side
    answer.by_rate[n][n] = closed * v_.normal_damping;
    if (n == 0) return answer;
    Pair by_pressing{};
    if (begin > 0.0)
      go_on(start(begin, memory), travel(from, to), begin, end, answer, by_pressing);
    else
      close(travel(from, to), std::min(across(from), 0.0), across(to), end, answer, by_pressing);
    for (Index i = 0; i < n; ++i) {
      answer.by_u[i][n] += by_pressing[idx(i)] * answer.by_u[n][n];
      answer.by_rate[i][n] = by_pressing[idx(i)] * answer.by_rate[n][n];
    }
    std::copy_n(answer.force, n, next);
    return answer;
  }

  // Of two directions only differences are known.
  bool slopes(const BlockPoint& from, const double* memory, const BlockPoint& to, Matrix& slopes) const override {
    const Index n = v_.directions;
    if (n > 1 || v_.normal_damping > 0.0) return false;
    const double begin = across(from), end = across(to), kn = v_.normal_stiffness;
    if (end < 0.0) return true;
    slopes(n, n) = kn;
    if (n == 0) return true;
    add_slopes(memory[0], travel(from, to)[0], begin, end, slopes.col(0));
    slopes.col(2) = slopes.col(0);
    return true;
  }

  BlockAnswer at(const BlockPoint& point, const double* memory) const override {
    BlockAnswer answer;
    const Index n = v_.directions;
    const double pressed = pressing(point), limit = v_.friction_coefficient * pressed;
    if (!(pressed > 0.0)) return answer;
    answer.force[n] = pressed;
    answer.by_u[n][n] = v_.normal_stiffness;
    answer.by_rate[n][n] = v_.normal_damping;
    if (!(limit > 0.0)) return answer;
    const Pair force = start(pressed, memory);
    const double size = length(force);
    // At its limit: it slips on, or comes back; from rest both.
    double slip = 0.0;
    if (!sticks(size, limit, terms_of_limit(point))) {
      double power = 0.0;
      for (Index i = 0; i < n; ++i) power += memory[i] * point.rate[i];
      slip = power > 0.0 ? 1.0 : power == 0.0 ? 0.5 : 0.0;
    }
    for (Index i = 0; i < n; ++i) {
      answer.force[i] = force[idx(i)];
      for (Index j = 0; j < n; ++j)
        answer.by_u[i][j] =
            kt_ * ((i == j ? 1.0 : 0.0) - (slip > 0.0 ? slip * force[idx(i)] * force[idx(j)] / (size * size) : 0.0));
      const double by_pressing = slip > 0.0 ? slip * v_.friction_coefficient * force[idx(i)] / size : 0.0;
      answer.by_u[i][n] = by_pressing * v_.normal_stiffness;
      answer.by_rate[i][n] = by_pressing * v_.normal_damping;
    }
    return answer;
  }

  double stored_energy(const double* u, const double* memory) const override {
    const double pressed = std::max(0.0, v_.normal_stiffness * (u[v_.directions] - v_.gap));
    double energy = 0.5 * pressed * pressed / v_.normal_stiffness;
    for (Index i = 0; i < v_.directions; ++i) energy += 0.5 * memory[i] * memory[i] / kt_;
    return energy;
  }

  double dissipated(const BlockPoint& from, const double* memory, const BlockPoint& to, const double*) const override {
    return damped(from, to) + rubbed(from, memory, to);
  }

  /// Of the friction.
  double rubbed(const BlockPoint& from, const double* memory, const BlockPoint& to) const {
    if (v_.directions == 0) return 0.0;
    const double closed = closed_share(from, to), begin = pressing(from), end = pressing(to, closed);
    const double rise = end - begin, mu = v_.friction_coefficient;
    const Pair force = start(begin, memory);
    double kept = 0.0;
    for (Index i = 0; i < v_.directions; ++i) kept += memory[i] * memory[i];
    // A load that jumps lets the spring go back to the limit that is left.
    const double let_go = 0.5 * (kept - dot(force, force)) / kt_;
    // The part of the step in which the ends are together, and what presses at its ends.
    const double met = begin < 0.0 && end > 0.0 ? 1.0 - closed : 0.0;
    const double parted = begin > 0.0 && end < 0.0 ? -begin / rise : 1.0;
    const double first = std::max(begin, 0.0), last = std::max(end, 0.0);
    if (!(first > 0.0 || last > 0.0)) return let_go;
    Pair du = travel(from, to);
    for (double& x : du) x *= parted - met;
    const Pair trial{force[0] + kt_ * du[0], force[1] + kt_ * du[1]};
    if (!(length(trial) > mu * last)) return let_go;
    if (!(mu > 0.0)) return let_go;
    if (!(first > 0.0))  // slips towards du from the instant at which the ends meet
      return let_go + 0.5 * mu * last * (length(du) - mu * last / kt_);
    const SlipOnCircle slip(force, du, first, last, kt_, mu, v_.directions);
    return let_go + slip.dissipated();
  }

  double limit_stiffness(Index i, bool is_stuck) const override {
    if (i < v_.directions) return is_stuck ? kt_ : 0.0;
    return is_stuck || v_.gap < 0.0 ? v_.normal_stiffness : 0.0;
  }

  double clearance() const override { return v_.gap; }
  double closed_damping() const override { return v_.normal_damping; }

  const char* why_no_steady_response() const override {
    return v_.normal_damping > 0.0
               ? "has a normal_damping, which steady responses do not carry yet; run a transient, or put a [[damper]] "
                 "beside it, which damps while it is open too"
               : "";
  }

  Law::Contact contact(const BlockPoint& point, const double* memory) const override {
    const double pressed = pressing(point), limit = v_.friction_coefficient * pressed;
    if (!(pressed > 0.0)) return Law::Contact::open;
    if (v_.directions == 0) return Law::Contact::slips_forwards;
    const Pair force{memory[0], v_.directions > 1 ? memory[1] : 0.0};
    if (sticks(length(force), limit, terms_of_limit(point))) return Law::Contact::sticks;
    return v_.directions == 1 && force[0] < 0.0 ? Law::Contact::slips_backwards : Law::Contact::slips_forwards;
  }

 private:
  static std::size_t idx(Index i) { return static_cast<std::size_t>(i); }

  /// @param terms  the largest of what the limit was a difference of, with whose round-off it comes
  static bool sticks(double size, double limit, double terms) {
    constexpr double round_off = 256.0 * std::numeric_limits<double>::epsilon();
    return size < limit - round_off * terms;
  }

  double terms_of_limit(const BlockPoint& point) const {
    const Index n = v_.directions;
    return v_.friction_coefficient * (v_.normal_stiffness * (std::abs(point.u[n]) + std::abs(v_.gap)) +
                                      v_.normal_damping * std::abs(point.rate[n]));
  }

  /// What the spring across would press with; below zero where the ends are apart.
  double across(const BlockPoint& point) const { return v_.normal_stiffness * (point.u[v_.directions] - v_.gap); }

  /// What presses; not above zero where the ends are apart, or where the dashpot would pull.
  /// @param closed  the share of the dashpot that counts
  double pressing(const BlockPoint& point, double closed = 1.0) const {
    const double spring = across(point);
    return spring > 0.0 ? spring + closed * v_.normal_damping * point.rate[v_.directions] : spring;
  }

  /// The share of the travel across that is beyond the gap, of a step in which the ends meet.
  double closed_share(const BlockPoint& from, const BlockPoint& to) const {
    const double begin = across(from), end = across(to);
    return begin < 0.0 && end >= 0.0 ? end / (end - begin) : 1.0;
  }

  /// By the displacement across, of the dashpot's part in such a step.
  double slope_of_share(const BlockPoint& from, const BlockPoint& to) const {
    const double begin = across(from), rise = across(to) - begin;
    if (!(begin < 0.0 && rise > 0.0)) return 0.0;
    return -v_.normal_stiffness * begin / (rise * rise) * v_.normal_damping * to.rate[v_.directions];
  }

  /// The work of the dashpot, and of what the spring loses where the dashpot holds it back from pushing.
  double damped(const BlockPoint& from, const BlockPoint& to) const {
    if (!(v_.normal_damping > 0.0)) return 0.0;
    const Index n = v_.directions;
    const double begin = across(from), end = across(to);
    if (!(begin > 0.0 || end > 0.0)) return 0.0;
    const auto dashpot = [&](const BlockPoint& point, double spring) {
      return std::max(v_.normal_damping * point.rate[n], -std::max(0.0, spring));
    };
    // Its force goes straight over the part of the way that is beyond the gap.
    const double way = (std::max(end, 0.0) - std::max(begin, 0.0)) / v_.normal_stiffness;
    return 0.5 * (dashpot(from, begin) + dashpot(to, end)) * way;
  }

  Pair travel(const BlockPoint& from, const BlockPoint& to) const {
    Pair du{};
    for (Index i = 0; i < v_.directions; ++i) du[idx(i)] = to.u[i] - from.u[i];
    return du;
  }

  /// The force at the start of a step, within what presses then.
  Pair start(double pressed, const double* memory) const {
    Pair force{};
    std::copy_n(memory, v_.directions, force.begin());
    const double limit = v_.friction_coefficient * std::max(pressed, 0.0), size = length(force);
    if (!(size > limit)) return force;
    if (v_.directions == 1) return {std::copysign(limit, force[0]), 0.0};
    return {force[0] * (limit / size), force[1] * (limit / size)};
  }

  /// From where the ends meet within the step, or at its start.
  /// @param begin, end   of the spring across, begin not above zero
  /// @param pressed      what presses at the end
  /// @param by_pressing  set where T follows what presses
  void close(const Pair& du, double begin, double end, double pressed, BlockAnswer& answer, Pair& by_pressing) const {
    const Index n = v_.directions;
    const double rise = end - begin, touching = rise > 0.0 ? end / rise : 1.0;
    const double limit = v_.friction_coefficient * pressed, size = length(du), trial = kt_ * touching * size;
    if (trial <= limit) {
      for (Index i = 0; i < n; ++i) {
        answer.force[i] = kt_ * touching * du[idx(i)];
        answer.by_u[i][i] = kt_ * touching;
        if (rise > 0.0) answer.by_u[i][n] = v_.normal_stiffness * (-kt_ * du[idx(i)] * begin / (rise * rise));
      }
      return;
    }
    for (Index i = 0; i < n; ++i) {
      const double e = n == 1 ? std::copysign(1.0, du[0]) : du[idx(i)] / size;
      answer.force[i] = limit * e;
      by_pressing[idx(i)] = v_.friction_coefficient * e;
      for (Index j = 0; j < n && n > 1; ++j)
        answer.by_u[i][j] = limit * ((i == j ? 1.0 : 0.0) - e * du[idx(j)] / size) / size;
    }
  }

  /// Of the force in the one direction, which is the memory too: by u and d at the end (rows 0, 1), at the start (4,
  /// 5), by the memory (8).
  void add_slopes(double memory, double du, double begin, double end, Eigen::Ref<Vector> slopes) const {
    const double mu = v_.friction_coefficient, kn = v_.normal_stiffness, limit = mu * end;
    if (begin > 0.0) {
      const double first = mu * begin;
      const bool is_within = std::abs(memory) <= first;
      const double force = is_within ? memory : std::copysign(first, memory), trial = force + kt_ * du;
      if (std::abs(trial) > limit) {
        slopes[1] = std::copysign(mu * kn, trial);
        return;
      }
      slopes[0] = kt_;
      slopes[4] = -kt_;
      if (is_within)
        slopes[8] = 1.0;
      else
        slopes[5] = std::copysign(mu * kn, memory);
      return;
    }
    const double rise = end - begin, touching = rise > 0.0 ? end / rise : 1.0;
    if (kt_ * touching * std::abs(du) > limit) {
      slopes[1] = std::copysign(mu * kn, du);
      return;
    }
    slopes[0] = kt_ * touching;
    slopes[4] = -slopes[0];
    if (!(rise > 0.0)) return;
    slopes[1] = -kn * kt_ * du * begin / (rise * rise);
    slopes[5] = kn * kt_ * du * end / (rise * rise);
  }

  void go_on(const Pair& force, const Pair& du, double begin, double end, BlockAnswer& answer,
             Pair& by_pressing) const {
    const Index n = v_.directions;
    const Pair trial{force[0] + kt_ * du[0], force[1] + kt_ * du[1]};
    const double limit = v_.friction_coefficient * end;
    if (length(trial) <= limit) {
      for (Index i = 0; i < n; ++i) {
        answer.force[i] = trial[idx(i)];
        answer.by_u[i][i] = kt_;
      }
      return;
    }
    if (!(v_.friction_coefficient > 0.0)) return;
    if (n == 1) {
      answer.force[0] = std::copysign(limit, trial[0]);
      by_pressing[0] = std::copysign(v_.friction_coefficient, trial[0]);
      return;
    }
    const SlipOnCircle slip(force, du, begin, end, kt_, v_.friction_coefficient, n);
    for (Index i = 0; i < n; ++i) answer.force[i] = slip.force()[idx(i)];
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) answer.by_u[i][j] = slip.by_travel(j)[idx(i)];
    by_pressing = slip.by_normal();
  }

  ContactValues v_;
  double kt_;
};

}  // namespace

std::shared_ptr<const BlockLaw> make_elastic_contact(const ContactValues& values) {
  return std::make_shared<ElasticContact>(values);
}

}  // namespace rubato::model
