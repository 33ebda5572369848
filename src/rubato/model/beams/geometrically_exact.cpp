#include <rubato/model/beams/geometrically_exact.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

constexpr int k = 6;

class PlaneBeam final : public Element {
 public:
  PlaneBeam(std::string name, const PlaneNode& first, const PlaneNode& second, const std::array<double, 3>& position,
            const std::array<double, 3>& other, const PlaneSection& section)
      : Element(std::move(name)), first_(first.q), second_(second.q), section_(section) {
    places_.assign(first.place.begin(), first.place.end());
    places_.insert(places_.end(), second.place.begin(), second.place.end());
    const double dx = other[0] - position[0], dy = other[1] - position[1];
    length_ = std::hypot(dx, dy);
    direction_ = std::atan2(dy, dx) - 0.5 * (position[2] + other[2]);
    turn_ = other[2] - position[2];
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<PlaneBeam>(*this); }

  void force(const Motion& motion, double* force) const override { forces(at(motion), force); }

  void tangent(const Motion& motion, double stiffness, double, double* force, double* tangent) const override {
    const Strain now = at(motion);
    forces(now, force);
    double stretch[k], slide[k];
    slopes(now, stretch, slide);
    const double inverse = 1.0 / length_, bending = stiffness * section_.bending * inverse;
    const double axial = stiffness * length_ * section_.axial, shear = stiffness * length_ * section_.shear;
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j) tangent[i * k + j] = axial * stretch[i] * stretch[j] + shear * slide[i] * slide[j];
    tangent[2 * k + 2] += bending;
    tangent[5 * k + 5] += bending;
    tangent[2 * k + 5] -= bending;
    tangent[5 * k + 2] -= bending;
    // Second derivatives of the strains, through the mean angle: of p2 by half of each angle, and of both angles.
    const double normal = section_.axial * now.stretch, across = section_.shear * now.slide;
    const double by_x = 0.5 * stiffness * (-normal * now.s - across * now.c);
    const double by_y = 0.5 * stiffness * (normal * now.c - across * now.s);
    const double by_angle = -0.25 * stiffness * length_ * (normal * (1.0 + now.stretch) + across * now.slide);
    for (const int angle : {2, 5}) {
      add(tangent, 3, angle, by_x);
      add(tangent, 0, angle, -by_x);
      add(tangent, 4, angle, by_y);
      add(tangent, 1, angle, -by_y);
      for (const int other : {2, 5}) tangent[angle * k + other] += by_angle;
    }
  }

  double stored_energy(const Motion& motion) const override {
    const Strain now = at(motion);
    return 0.5 * length_ *
           (section_.axial * now.stretch * now.stretch + section_.shear * now.slide * now.slide +
            section_.bending * now.bend * now.bend);
  }

 private:
  struct Strain {
    double c, s, stretch, slide, bend;
  };
  Strain at(const Motion& motion) const {
    const double* a = motion.q + first_;
    const double* b = motion.q + second_;
    const double inverse = 1.0 / length_, dx = (b[0] - a[0]) * inverse, dy = (b[1] - a[1]) * inverse;
    const double mean = direction_ + 0.5 * (a[2] + b[2]), c = std::cos(mean), s = std::sin(mean);
    return {c, s, c * dx + s * dy - 1.0, -s * dx + c * dy, (b[2] - a[2] - turn_) * inverse};
  }
  void slopes(const Strain& now, double* stretch, double* slide) const {
    const double inverse = 1.0 / length_, c = now.c * inverse, s = now.s * inverse;
    const double half_slide = 0.5 * now.slide, half_stretch = -0.5 * (1.0 + now.stretch);
    const double of_stretch[k] = {-c, -s, half_slide, c, s, half_slide};
    const double of_slide[k] = {s, -c, half_stretch, -s, c, half_stretch};
    std::copy(of_stretch, of_stretch + k, stretch);
    std::copy(of_slide, of_slide + k, slide);
  }
  void forces(const Strain& now, double* force) const {
    double stretch[k], slide[k];
    slopes(now, stretch, slide);
    const double normal = length_ * section_.axial * now.stretch, across = length_ * section_.shear * now.slide;
    for (int i = 0; i < k; ++i) force[i] = normal * stretch[i] + across * slide[i];
    const double moment = section_.bending * now.bend;
    force[2] -= moment;
    force[5] += moment;
  }
  static void add(double* tangent, int i, int j, double value) {
    tangent[i * k + j] += value;
    tangent[j * k + i] += value;
  }

  Index first_, second_;
  PlaneSection section_;
  double length_ = 1.0, direction_ = 0.0, turn_ = 0.0;
};

}  // namespace

std::unique_ptr<Element> make_plane_beam(std::string name, const PlaneNode& first, const PlaneNode& second,
                                         const std::array<double, 3>& position, const std::array<double, 3>& other,
                                         const PlaneSection& section) {
  return std::make_unique<PlaneBeam>(std::move(name), first, second, position, other, section);
}

}  // namespace rubato::model
