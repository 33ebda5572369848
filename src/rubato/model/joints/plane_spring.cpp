#include <rubato/model/joints/plane_spring.hpp>

namespace rubato::model {
namespace {

/// A linear force on the difference of two coordinates.
class CoordinateElement final : public Element {
 public:
  CoordinateElement(std::string name, const NodeNumber& first, const NodeNumber& second, double stiffness, double rest,
                    double damping)
      : Element(std::move(name)),
        first_(first),
        second_(second),
        stiffness_(stiffness),
        rest_(rest),
        damping_(damping) {
    places_ = {first.place, second.place};
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<CoordinateElement>(*this); }

  void force(const Motion& motion, double* force) const override {
    force[0] = stiffness_ * stretch(motion) + damping_ * (motion.v[first_.place] - motion.v[second_.place]);
    force[1] = -force[0];
  }
  void tangent(const Motion& motion, double stiffness, double damping, double* out, double* tangent) const override {
    force(motion, out);
    tangent[0] = tangent[3] = stiffness * stiffness_ + damping * damping_;
    tangent[1] = tangent[2] = -tangent[0];
  }
  double stored_energy(const Motion& motion) const override {
    return 0.5 * stiffness_ * stretch(motion) * stretch(motion);
  }
  Role role() const override { return damping_ > 0.0 ? Role::damper : Role::elastic; }

 private:
  double stretch(const Motion& motion) const {
    return (first_.q < 0 ? 0.0 : motion.q[first_.q]) - (second_.q < 0 ? 0.0 : motion.q[second_.q]) - rest_;
  }

  NodeNumber first_, second_;
  double stiffness_, rest_, damping_;
};

}  // namespace

std::unique_ptr<Element> make_coordinate_spring(std::string name, const NodeNumber& first, const NodeNumber& second,
                                                double stiffness, double rest) {
  return std::make_unique<CoordinateElement>(std::move(name), first, second, stiffness, rest, 0.0);
}

std::unique_ptr<Element> make_coordinate_damper(std::string name, const NodeNumber& first, const NodeNumber& second,
                                                double damping) {
  return std::make_unique<CoordinateElement>(std::move(name), first, second, 0.0, 0.0, damping);
}

}  // namespace rubato::model
