#include <rubato/model/laws/jenkins.hpp>

#include <algorithm>

namespace rubato::model {
namespace {

class OneSidedSpring final : public Law {
 public:
  OneSidedSpring(double stiffness, double gap) : stiffness_(stiffness), gap_(gap) {}

  LawAnswer advance(const LawPoint&, const double*, const LawPoint& to, double*) const override {
    // At the gap with the slope of either side: with that beyond it nothing that it holds floats.
    return to.u == gap_ ? LawAnswer{0.0, stiffness_, 0.0} : at(to, nullptr);
  }
  LawAnswer at(const LawPoint& point, const double*) const override {
    if (!(point.u > gap_)) return {};
    return {stiffness_ * (point.u - gap_), stiffness_, 0.0};
  }
  double stored_energy(double u, const double*) const override {
    const double depth = std::max(0.0, u - gap_);
    return 0.5 * stiffness_ * depth * depth;
  }
  double dissipated(const LawPoint&, const double*, const LawPoint&, const double*) const override { return 0.0; }
  double largest_stiffness() const override { return stiffness_; }

 private:
  double stiffness_, gap_;
};

}  // namespace

std::shared_ptr<const Law> make_one_sided_spring(double stiffness, double gap) {
  return std::make_shared<OneSidedSpring>(stiffness, gap);
}

}  // namespace rubato::model
