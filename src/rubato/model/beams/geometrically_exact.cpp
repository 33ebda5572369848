#include <rubato/model/beams/beam_forces.hpp>
#include <rubato/model/beams/geometrically_exact.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

constexpr int k = 6;

/// How a beam is strained, and by what forces of its section the nodes are moved.
class PlaneBeamElement : public Element, public BeamForces {
 public:
  PlaneBeamElement(std::string name, const PlaneNode& first, const PlaneNode& second,
                   const std::array<double, 3>& position, const std::array<double, 3>& other,
                   const PlaneSection& section)
      : Element(std::move(name)), section_(section), first_(first.q), second_(second.q) {
    places_.assign(first.place.begin(), first.place.end());
    places_.insert(places_.end(), second.place.begin(), second.place.end());
    const double dx = other[0] - position[0], dy = other[1] - position[1];
    length_ = std::hypot(dx, dy);
    direction_ = std::atan2(dy, dx) - 0.5 * (position[2] + other[2]);
    turn_ = other[2] - position[2];
  }

 protected:
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

  /// The forces of a section on the nodes.
  struct Stress {
    double normal, across, moment;
  };
  void forces(const Stress& stress, const double* stretch, const double* slide, double* force) const {
    const double normal = length_ * stress.normal, across = length_ * stress.across;
    for (int i = 0; i < k; ++i) force[i] = normal * stretch[i] + across * slide[i];
    force[2] -= stress.moment;
    force[5] += stress.moment;
  }
  static void write(const Stress& stress, double* forces) {
    forces[0] = stress.normal;
    forces[1] = stress.across;
    forces[2] = stress.moment;
  }
  /// Writes weight times L (E A stretch stretch^T + k G A slide slide^T) + E I/L of the angles.
  void material_tangent(double weight, const double* stretch, const double* slide, double* tangent) const {
    const double bending = weight * section_.bending / length_;
    const double axial = weight * length_ * section_.axial, shear = weight * length_ * section_.shear;
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j) tangent[i * k + j] = axial * stretch[i] * stretch[j] + shear * slide[i] * slide[j];
    tangent[2 * k + 2] += bending;
    tangent[5 * k + 5] += bending;
    tangent[2 * k + 5] -= bending;
    tangent[5 * k + 2] -= bending;
  }
  /// Second derivatives of the strains, through the mean angle: of p2 by half of each angle, and of both angles.
  void add_geometric(double weight, const Strain& now, const Stress& stress, double* tangent) const {
    const double normal = stress.normal, across = stress.across;
    const double by_x = 0.5 * weight * (-normal * now.s - across * now.c);
    const double by_y = 0.5 * weight * (normal * now.c - across * now.s);
    const double by_angle = -0.25 * weight * length_ * (normal * (1.0 + now.stretch) + across * now.slide);
    for (const int angle : {2, 5}) {
      add(tangent, 3, angle, by_x);
      add(tangent, 0, angle, -by_x);
      add(tangent, 4, angle, by_y);
      add(tangent, 1, angle, -by_y);
      for (const int other : {2, 5}) tangent[angle * k + other] += by_angle;
    }
  }

  PlaneSection section_;
  double length_ = 1.0;

 private:
  static void add(double* tangent, int i, int j, double value) {
    tangent[i * k + j] += value;
    tangent[j * k + i] += value;
  }

  Index first_, second_;
  double direction_ = 0.0, turn_ = 0.0;
};

class PlaneBeam final : public PlaneBeamElement {
 public:
  using PlaneBeamElement::PlaneBeamElement;
  std::unique_ptr<Element> clone() const override { return std::make_unique<PlaneBeam>(*this); }

  void force(const Motion& motion, double* force) const override {
    const Strain now = at(motion);
    double stretch[k], slide[k];
    slopes(now, stretch, slide);
    forces(stress(now), stretch, slide, force);
  }

  void tangent(const Motion& motion, double stiffness, double, double* force, double* tangent) const override {
    const Strain now = at(motion);
    const Stress elastic = stress(now);
    double stretch[k], slide[k];
    slopes(now, stretch, slide);
    forces(elastic, stretch, slide, force);
    material_tangent(stiffness, stretch, slide, tangent);
    add_geometric(stiffness, now, elastic, tangent);
  }

  double stored_energy(const Motion& motion) const override {
    const Strain now = at(motion);
    return 0.5 * length_ *
           (section_.axial * now.stretch * now.stretch + section_.shear * now.slide * now.slide +
            section_.bending * now.bend * now.bend);
  }

  void section_forces(const Motion& motion, double* forces) const override { write(stress(at(motion)), forces); }

 private:
  Stress stress(const Strain& now) const {
    return {section_.axial * now.stretch, section_.shear * now.slide, section_.bending * now.bend};
  }
};

/// The section holds E A, k G A, E I times the retardation time.
class ViscousPlaneBeam final : public PlaneBeamElement {
 public:
  using PlaneBeamElement::PlaneBeamElement;
  std::unique_ptr<Element> clone() const override { return std::make_unique<ViscousPlaneBeam>(*this); }
  bool has_symmetric_tangent() const override { return false; }
  Role role() const override { return Role::damper; }

  void force(const Motion& motion, double* force) const override {
    double stretch[k], slide[k], v[k];
    slopes(at(motion), stretch, slide);
    velocities(motion, v);
    forces(stress(stretch, slide, v), stretch, slide, force);
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    const Strain now = at(motion);
    double stretch[k], slide[k], v[k];
    slopes(now, stretch, slide);
    velocities(motion, v);
    const Stress viscous = stress(stretch, slide, v);
    forces(viscous, stretch, slide, force);
    material_tangent(damping, stretch, slide, tangent);
    add_geometric(stiffness, now, viscous, tangent);
    // What the rates of the strains change by with the positions: the second derivatives times v.
    const double inverse = 1.0 / length_, dx = (v[3] - v[0]) * inverse, dy = (v[4] - v[1]) * inverse;
    const double mean = 0.5 * (v[2] + v[5]), c = now.c * mean * inverse, s = now.s * mean * inverse;
    const double along = 0.5 * (now.c * dy - now.s * dx - (1.0 + now.stretch) * mean);
    const double across = -0.5 * (now.c * dx + now.s * dy + now.slide * mean);
    const double of_stretch[k] = {s, -c, along, -s, c, along}, of_slide[k] = {c, s, across, -c, -s, across};
    const double axial = stiffness * length_ * section_.axial, shear = stiffness * length_ * section_.shear;
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j)
        tangent[i * k + j] += axial * stretch[i] * of_stretch[j] + shear * slide[i] * of_slide[j];
  }

  void section_forces(const Motion& motion, double* forces) const override {
    double stretch[k], slide[k], v[k];
    slopes(at(motion), stretch, slide);
    velocities(motion, v);
    write(stress(stretch, slide, v), forces);
  }

 private:
  void velocities(const Motion& motion, double* v) const {
    for (std::size_t i = 0; i < k; ++i) v[i] = motion.v[places_[i]];
  }
  Stress stress(const double* stretch, const double* slide, const double* v) const {
    double along = 0.0, across = 0.0;
    for (int i = 0; i < k; ++i) {
      along += stretch[i] * v[i];
      across += slide[i] * v[i];
    }
    return {section_.axial * along, section_.shear * across, section_.bending * (v[5] - v[2]) / length_};
  }
};

}  // namespace

std::unique_ptr<Element> make_plane_beam(std::string name, const PlaneNode& first, const PlaneNode& second,
                                         const std::array<double, 3>& position, const std::array<double, 3>& other,
                                         const PlaneSection& section) {
  return std::make_unique<PlaneBeam>(std::move(name), first, second, position, other, section);
}

std::unique_ptr<Element> make_viscous_plane_beam(std::string name, const PlaneNode& first, const PlaneNode& second,
                                                 const std::array<double, 3>& position,
                                                 const std::array<double, 3>& other, const PlaneSection& section,
                                                 double retardation_time) {
  const PlaneSection viscous{section.axial * retardation_time, section.shear * retardation_time,
                             section.bending * retardation_time};
  return std::make_unique<ViscousPlaneBeam>(std::move(name), first, second, position, other, viscous);
}

}  // namespace rubato::model
