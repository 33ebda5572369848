#include <rubato/model/joints/coordinate_force.hpp>
#include <rubato/model/joints/law_element.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

/// Of a law on which nothing presses that follows the motion.
template <class Coordinate>
class LawElement final : public CoordinateForce<Coordinate> {
  using Base = CoordinateForce<Coordinate>;

 public:
  LawElement(const MechanismLaw& law, const Coordinate& u) : Base(law.name, u), law_(law) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<LawElement>(*this); }
  bool has_kinks() const override { return true; }  // where the motion turns, and in formulas as far as is known
  Element::Role role() const override { return Element::Role::law; }

 private:
  LawAnswer answer(const Motion& motion, double, double, bool) const override {
    const LawAnswer law = law_.answer(motion);
    return {-law.force, -law.by_u, -law.by_rate};
  }
  bool depends_on_rate() const override { return law_.law->depends_on_rate(); }

  MechanismLaw law_;
};

}  // namespace

LawPoint MechanismLaw::point(const Motion& motion) const {
  LawPoint point{displacement(motion), rate(motion), motion.t, motion.side};
  if (law->takes_normal()) point.normal = normal_force(motion);
  return point;
}

LawAnswer MechanismLaw::answer(const Motion& motion) const {
  const LawHistory& laws = motion.laws;
  if (!laws.from) return law->at(point(motion), laws.memory + memory);
  return law->advance(laws.from[index], laws.memory + memory, point(motion), laws.next + memory);
}

double MechanismLaw::normal_force(const Motion& motion) const {
  if (pressing) return pressing->answer(motion).force;
  if (stop) return pressing_force(*stop, normal.stop, motion).force;
  if (reaction.presses()) return reaction.force(motion);
  return normal.at(motion.t, motion.side);
}

double PressingReaction::force(const Motion& motion) const {
  double squared = 0.0;
  for (int r = 0; r < rows; ++r) squared += motion.multiplier[multiplier + r] * motion.multiplier[multiplier + r];
  return std::sqrt(squared);
}

LawAnswer pressing_force(const Lock& stop, Index index, const Motion& motion) {
  if (motion.phase[index] == lock_open) return {std::min(0.0, stop.stiffness * stop.depth(motion))};
  return {stop.push(motion), stop.sign * stop.stiffness, stop.sign * stop.damping};
}

std::unique_ptr<Element> make_law_element(const MechanismLaw& law) {
  if (law.normal.depends_on_motion()) return make_pressed_law_element(law);
  return std::visit(
      [&](const auto& u) -> std::unique_ptr<Element> {
        return std::make_unique<LawElement<std::decay_t<decltype(u)>>>(law, u);
      },
      law.u);
}

}  // namespace rubato::model
