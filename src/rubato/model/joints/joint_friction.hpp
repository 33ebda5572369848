#pragma once

#include <rubato/model/joints/free_coordinate.hpp>
#include <rubato/model/joints/joint.hpp>

#include <string>
#include <utility>
#include <vector>

namespace rubato::model {

/// What the friction of a joint does now; kept in the state, changed by events only.
enum FrictionPhase : int {
  friction_free = 0,  ///< not known yet, or left out (static equilibrium, modes, the instant of an impact, while a
                      ///< rigid lock holds the joint): no force
  friction_sticks = 1,
  friction_slides_up = 2,    ///< s grows
  friction_slides_down = 3,  ///< s shrinks
  /// At rest, since other joints that stick hold it, while it gives all its friction against the way up. No event
  /// watches its rate, which is round-off.
  friction_at_limit_up = 4,
  friction_at_limit_down = 5,  ///< the same against the way down
};

/// Whether nothing moves in the joint.
inline bool is_at_rest(int phase) {
  return phase == friction_sticks || phase == friction_at_limit_up || phase == friction_at_limit_down;
}

/// Coulomb friction on the coordinate s of a joint, with the limit L = mu (preload + |pressing multipliers|), of an
/// angle times the radius of the pin, of a screw times radius/cos^2(lead angle) of its thread:
///
///   slides    the force -sign(s') L on s, sign(s') by the phase
///   sticks    the constraint s = where it stopped, until its multiplier reaches L
///   at limit  the force of sliding, while other frictions that stick hold s; until one of these lets go
///
/// The multipliers are those of the same instant.
///
/// Where a joint slides in two directions at once (a cylindrical one along its axis and around it, a planar one across
/// its axis) two frictions share one limit. Their slip velocity u = (arm s') of both, [m/s], is that of the surfaces
/// which rub, and
///
///   slides   the forces -u/|u| mu N arm on the two s; phase "slides up" of both, whatever the direction
///   sticks   both s = where they stopped, until the norm of both multipliers over their arms reaches mu N
///
/// The direction needs a floor where u passes through zero within a step that is not accepted: see slip_floor().
struct JointFriction {
  std::string name;  ///< of the joint
  std::string pin;   ///< of several that rub by themselves: "first" or "second"
  FreeCoordinate s;
  double coefficient = 0.0;    ///< mu [-]; of an angle mu times an arm [m]
  double preload = 0.0;        ///< [N]
  int joint = -1;              ///< whose parts rub, among the mechanism's joints; -1: of what constrains nothing
  int first_pressing_row = 0;  ///< among its rows
  int pressing_rows = 0;       ///< so many of them press with the norm of their multipliers
  int sticking_joint = -1;     ///< the constraint that holds it
  double arm = 1.0;            ///< of a slip velocity over the rate of s, 1 or of an angle the radius [m]
  int partner = -1;            ///< the other of two that share a limit; the first of both leads

  /// As results and messages call it.
  std::string label() const { return pin.empty() ? name : name + "." + pin; }
  bool follows_reaction() const { return pressing_rows > 0; }
};

/// The direction in which a joint slides, or is pulled with all its friction: +1, -1, or 0 if neither.
inline double sliding_direction(int phase) {
  if (phase == friction_slides_up || phase == friction_at_limit_up) return 1.0;
  return phase == friction_slides_down || phase == friction_at_limit_down ? -1.0 : 0.0;
}

/// While two frictions that share a limit slide, State::stuck_at holds of each a component of the floor w: of a slip
/// velocity u what points along w counts as |w| at least,
///
///   direction = normalised(max(u.d, |w|) d + u - (u.d) d),   d = w/|w|
///
/// Of a step from a slip velocity u0 w is this share of it, in the direction of u0, so that what reaches less than it
/// is the step in which it comes to rest; and from rest so much [m/s] that the direction is d.
inline constexpr double slip_floor_share = 1e-2;
inline constexpr double slip_floor_at_rest = 1e9;

/// s = where it stopped while the joint sticks; nothing while it slides. Row "friction_moment" [N m] of an angle,
/// "friction_force" [N] of a displacement.
/// @tparam Coordinate  has places, value, slope and curvature, as PlaneCoordinate has
template <class Coordinate>
class StickingJoint final : public Joint {
 public:
  /// @param friction  whose phase it follows, among the mechanism's
  StickingJoint(std::string name, Coordinate s, int friction)
      : Joint(std::move(name)), s_(std::move(s)), friction_(friction) {
    places_ = s_.places();
    row_names_ = {s_.is_angle() ? "friction_moment" : "friction_force"};
    curvature_.resize(places_.size() * places_.size());
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<StickingJoint>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    g[0] = 0.0;
    for (std::size_t i = 0; i < places_.size(); ++i) jacobian[i] = 0.0;
    if (!is_active(motion)) return;
    g[0] = s_.value(motion.q) - motion.stuck_at[friction_];
    s_.slope(motion.q, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    s_.curvature(motion.q, is_active(motion) ? multiplier[0] : 0.0, curvature);
  }
  void second_rate(const Motion& motion, double* out) const override {
    s_.curvature(motion.q, is_active(motion) ? 1.0 : 0.0, curvature_.data());
    const std::size_t k = places_.size();
    out[0] = 0.0;
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) out[0] += motion.v[places_[i]] * curvature_[i * k + j] * motion.v[places_[j]];
  }
  bool is_active(const Motion& motion) const override { return motion.rubbing[friction_] == friction_sticks; }
  bool has_symmetric_curvature() const override { return Coordinate::has_symmetric_curvature; }

 private:
  Coordinate s_;
  int friction_;
  mutable std::vector<double> curvature_;
};

}  // namespace rubato::model
