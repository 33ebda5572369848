#include <rubato/model/joints/coordinate_force.hpp>
#include <rubato/model/joints/stop_element.hpp>

#include <variant>

namespace rubato::model {
namespace {

template <class Coordinate>
class StopElement final : public CoordinateForce<Coordinate> {
  using Base = CoordinateForce<Coordinate>;

 public:
  StopElement(const Lock& stop, const Coordinate& s, int index) : Base(stop.name, s), stop_(stop), index_(index) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<StopElement>(*this); }
  Element::Role role() const override { return Element::Role::law; }

 private:
  LawAnswer answer(const Motion&, double s, double rate, bool) const override {
    return {-stop_.stiffness * (s - stop_.at) - stop_.damping * rate, -stop_.stiffness, -stop_.damping};
  }
  bool depends_on_rate() const override { return stop_.damping > 0.0; }
  bool is_at_work(const Motion& motion) const override { return motion.phase[index_] != lock_open; }

  Lock stop_;
  int index_;
};

}  // namespace

std::unique_ptr<Element> make_stop_element(const Lock& stop, int index) {
  return std::visit(
      [&](const auto& s) -> std::unique_ptr<Element> {
        return std::make_unique<StopElement<std::decay_t<decltype(s)>>>(stop, s, index);
      },
      stop.s.of);
}

}  // namespace rubato::model
