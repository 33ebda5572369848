#include <rubato/model/joints/contact_element.hpp>

#include <algorithm>

namespace rubato::model {
namespace {

/// Of the angles of the plane and of the part, among the places of a PlaneCoordinate.
constexpr std::size_t angle_of_plane = 2, angle_of_part = 5;

class ContactElement final : public Element {
 public:
  explicit ContactElement(const MechanismContact& contact) : Element(contact.name), contact_(contact) {
    places_ = contact_.numbers.front().places();
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<ContactElement>(*this); }
  bool has_kinks() const override { return true; }
  bool has_symmetric_tangent() const override {
    const bool is_flat = std::holds_alternative<PlaneCoordinate>(contact_.numbers.front().s);
    return is_flat && contact_.numbers.size() == 1 && contact_.law->closed_damping() == 0.0;
  }
  Role role() const override { return Role::law; }

  void force(const Motion& motion, double* force) const override {
    const std::size_t k = places_.size();
    std::fill(force, force + k, 0.0);
    const BlockAnswer answer = contact_.answer(motion);
    double slope[ContactNumber::most_places];
    for (std::size_t i = 0; i < contact_.numbers.size(); ++i) {
      if (answer.force[i] == 0.0) continue;
      contact_.numbers[i].slope(motion.q, slope);
      for (std::size_t a = 0; a < k; ++a) force[a] += answer.force[i] * slope[a];
    }
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    constexpr std::size_t most = ContactNumber::most_places;
    const std::size_t k = places_.size(), numbers = contact_.numbers.size();
    std::fill(force, force + k, 0.0);
    std::fill(tangent, tangent + k * k, 0.0);
    const BlockAnswer answer = contact_.answer(motion);
    double slope[largest_block][most], rate_slope[largest_block][most], curvature[most * most];
    for (std::size_t i = 0; i < numbers; ++i) {
      contact_.numbers[i].slope(motion.q, slope[i]);
      contact_.numbers[i].curvature(motion.q, 1.0, curvature);
      for (std::size_t a = 0; a < k; ++a) {
        force[a] += answer.force[i] * slope[i][a];
        rate_slope[i][a] = 0.0;  // du'/dq = v curvature
        for (std::size_t b = 0; b < k; ++b) rate_slope[i][a] += motion.v[places_[b]] * curvature[b * k + a];
      }
      if (answer.force[i] == 0.0) continue;
      for (std::size_t a = 0; a < k * k; ++a) tangent[a] += stiffness * answer.force[i] * curvature[a];
    }
    for (std::size_t i = 0; i < numbers; ++i)
      for (std::size_t j = 0; j < numbers; ++j) {
        const double of_slope = stiffness * answer.by_u[i][j] + damping * answer.by_rate[i][j];
        const double of_rate = stiffness * answer.by_rate[i][j];
        if (of_slope == 0.0 && of_rate == 0.0) continue;
        for (std::size_t a = 0; a < k; ++a)
          for (std::size_t b = 0; b < k; ++b)
            tangent[a * k + b] += slope[i][a] * (of_slope * slope[j][b] + of_rate * rate_slope[j][b]);
      }
  }

 private:
  MechanismContact contact_;
};

}  // namespace

std::vector<Index> ContactNumber::places() const {
  return std::visit([](const auto& of) { return of.places(); }, s);
}

double ContactNumber::value(const double* q) const {
  const double along = sign * std::visit([&](const auto& of) { return of.value(q); }, s);
  if (radius == 0.0) return along;
  const PlaneProjection& flat = std::get<PlaneCoordinate>(s).along;
  return along - radius * (q[flat.second.node.q + 2] - q[flat.first.node.q + 2]);
}

double ContactNumber::rate(const Motion& motion) const {
  const double along = sign * std::visit([&](const auto& of) { return of.rate(motion); }, s);
  if (radius == 0.0) return along;
  const PlaneProjection& flat = std::get<PlaneCoordinate>(s).along;
  return along - radius * (motion.v[flat.second.node.place[2]] - motion.v[flat.first.node.place[2]]);
}

void ContactNumber::slope(const double* q, double* slope) const {
  const auto k = static_cast<std::size_t>(std::visit(
      [&](const auto& of) {
        of.slope(q, slope);
        return std::decay_t<decltype(of)>::tangent_size;
      },
      s));
  for (std::size_t i = 0; i < k; ++i) slope[i] *= sign;
  if (radius == 0.0) return;
  slope[angle_of_plane] += radius;
  slope[angle_of_part] -= radius;
}

void ContactNumber::curvature(const double* q, double factor, double* curvature) const {
  std::visit([&](const auto& of) { of.curvature(q, sign * factor, curvature); }, s);
}

BlockPoint MechanismContact::point(const Motion& motion) const {
  BlockPoint point;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    point.u[i] = numbers[i].value(motion.q);
    point.rate[i] = numbers[i].rate(motion);
  }
  return point;
}

BlockAnswer MechanismContact::answer(const Motion& motion) const {
  const LawHistory& laws = motion.laws;
  if (!laws.block_from) return law->at(point(motion), laws.memory + memory);
  return law->advance(laws.block_from[index], laws.memory + memory, point(motion), laws.next + memory);
}

std::unique_ptr<Element> make_contact_element(const MechanismContact& contact) {
  return std::make_unique<ContactElement>(contact);
}

}  // namespace rubato::model
