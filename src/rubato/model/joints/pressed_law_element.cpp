#include <rubato/model/joints/law_element.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace rubato::model {
namespace {

/// A coordinate with what its slopes are made of, where it is.
struct CoordinateSlopes {
  static constexpr std::size_t most = SpaceCoordinate::tangent_size;

  LawCoordinate u;
  std::vector<Index> places;
  std::array<double, most> slope{}, rate_slope{};  ///< du/dq and du'/dq [k]
  std::array<double, most * most> curvature{};     ///< d2u/dq2 [k x k]

  explicit CoordinateSlopes(const LawCoordinate& u_)
      : u(u_), places(std::visit([](const auto& of) { return of.places(); }, u_)) {}

  std::size_t size() const { return places.size(); }
  void find_slope(const Motion& motion) {
    std::visit([&](const auto& of) { of.slope(motion.q, slope.data()); }, u);
  }
  void find_all(const Motion& motion) {
    find_slope(motion);
    std::visit([&](const auto& of) { of.curvature(motion.q, 1.0, curvature.data()); }, u);
    const std::size_t k = size();
    for (std::size_t i = 0; i < k; ++i) {  // du'/dq = v curvature
      rate_slope[i] = 0.0;
      for (std::size_t j = 0; j < k; ++j) rate_slope[i] += motion.v[places[j]] * curvature[j * k + i];
    }
  }
};

/// A law, what presses on it, what presses on that, and so on: down to what no motion changes, or a stop.
class PressedLawElement final : public Element {
 public:
  explicit PressedLawElement(const MechanismLaw& law) : Element(law.name), law_(law) {
    const MechanismLaw* last = &law_;
    for (const MechanismLaw* one = last; one; one = one->pressing.get()) {
      links_.emplace_back(one->u);
      last = one;
    }
    if (last->stop) {
      stop_ = last->stop;
      stop_index_ = last->normal.stop;
      links_.emplace_back(std::visit([](const auto& s) { return LawCoordinate(s); }, stop_->s.of));
    }
    for (const CoordinateSlopes& link : links_) places_.insert(places_.end(), link.places.begin(), link.places.end());
    row_.resize(places_.size());
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<PressedLawElement>(law_); }
  bool has_kinks() const override { return true; }
  bool has_symmetric_tangent() const override { return false; }
  Role role() const override { return Role::law; }

  void force(const Motion& motion, double* force) const override {
    std::fill(force, force + places_.size(), 0.0);
    const double applied = law_.answer(motion).force;
    links_.front().find_slope(motion);
    for (std::size_t i = 0; i < links_.front().size(); ++i) force[i] = applied * links_.front().slope[i];
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    const std::size_t k = places_.size();
    std::fill(force, force + k, 0.0);
    std::fill(tangent, tangent + k * k, 0.0);
    for (CoordinateSlopes& link : links_) link.find_all(motion);
    const double applied = find_row(motion, stiffness, damping);
    const CoordinateSlopes& own = links_.front();
    for (std::size_t i = 0; i < own.size(); ++i) {
      force[i] = applied * own.slope[i];
      for (std::size_t j = 0; j < k; ++j) tangent[i * k + j] = own.slope[i] * row_[j];
      for (std::size_t j = 0; j < own.size(); ++j)
        tangent[i * k + j] += stiffness * applied * own.curvature[i * own.size() + j];
    }
  }

 private:
  /// The force, and row_: its slopes by q and by v with their weights, down the chain of what presses.
  double find_row(const Motion& motion, double stiffness, double damping) const {
    const LawAnswer first = law_.answer(motion);
    double weight = 1.0;  // of a change of what presses in the force
    std::size_t at = 0, i = 0;
    for (const MechanismLaw* law = &law_; law; law = law->pressing.get(), ++i) {
      const LawAnswer answer = i == 0 ? first : law->answer(motion);
      add_slopes(links_[i], answer, weight, stiffness, damping, at);
      weight *= answer.by_normal;
    }
    if (stop_) add_slopes(links_[i], pressing_force(*stop_, stop_index_, motion), weight, stiffness, damping, at);
    return first.force;
  }

  void add_slopes(const CoordinateSlopes& link, const LawAnswer& answer, double weight, double stiffness,
                  double damping, std::size_t& at) const {
    const double of_slope = stiffness * answer.by_u + damping * answer.by_rate, of_rate = stiffness * answer.by_rate;
    for (std::size_t i = 0; i < link.size(); ++i)
      row_[at++] = weight * (of_slope * link.slope[i] + of_rate * link.rate_slope[i]);
  }

  MechanismLaw law_;
  std::shared_ptr<const Lock> stop_;
  Index stop_index_ = -1;
  mutable std::vector<CoordinateSlopes> links_;
  mutable std::vector<double> row_;  // over places_
};

}  // namespace

std::unique_ptr<Element> make_pressed_law_element(const MechanismLaw& law) {
  return std::make_unique<PressedLawElement>(law);
}

}  // namespace rubato::model
