#include <rubato/model/joints/coordinate_force.hpp>
#include <rubato/model/joints/law_element.hpp>

#include <vector>

namespace rubato::model {
namespace {

template <class Coordinate>
class LawElement final : public CoordinateForce<Coordinate> {
  using Base = CoordinateForce<Coordinate>;

 public:
  LawElement(const MechanismLaw& law, const Coordinate& u)
      : Base(law.name, u),
        law_(law.law),
        index_(law.index),
        memory_(law.memory),
        next_(static_cast<std::size_t>(law.law->memory_size())) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<LawElement>(*this); }
  bool has_kinks() const override { return true; }  // where the motion turns, and in formulas as far as is known
  Element::Role role() const override { return Element::Role::law; }

 private:
  LawAnswer answer(const Motion& motion, double u, double rate, bool) const override {
    const LawPoint here{u, rate, motion.t, motion.side};
    const double* const memory = motion.laws.memory + memory_;
    const LawAnswer law =
        motion.laws.from ? law_->advance(motion.laws.from[index_], memory, here, next_.data()) : law_->at(here, memory);
    return {-law.force, -law.by_u, -law.by_rate};
  }
  bool depends_on_rate() const override { return law_->depends_on_rate(); }

  std::shared_ptr<const Law> law_;
  Index index_, memory_;
  mutable std::vector<double> next_;  // its memory at the end of a step that is tried
};

}  // namespace

std::unique_ptr<Element> make_law_element(const MechanismLaw& law) {
  return std::visit(
      [&](const auto& u) -> std::unique_ptr<Element> {
        return std::make_unique<LawElement<std::decay_t<decltype(u)>>>(law, u);
      },
      law.u);
}

}  // namespace rubato::model
