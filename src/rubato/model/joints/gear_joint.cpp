#include <rubato/model/joints/gear_joint.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace rubato::model {
namespace {

class Gear final : public Joint {
 public:
  Gear(std::string name, const FreeCoordinate& first, const FreeCoordinate& second, double ratio, double offset)
      : Joint(std::move(name)), sides_{Side{first, 1.0, {}}, Side{second, -ratio, {}}}, offset_(offset) {
    row_names_ = {first.is_angle() ? "gear_moment" : "gear_force"};
    // Both joints may share a part, whose coordinates stand once.
    for (Side& side : sides_)
      for (const Index place : side.s.places()) {
        const auto found = std::find(places_.begin(), places_.end(), place);
        side.local.push_back(static_cast<std::size_t>(found - places_.begin()));
        if (found == places_.end()) places_.push_back(place);
      }
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Gear>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    std::fill(jacobian, jacobian + places_.size(), 0.0);
    g[0] = -offset_;
    std::array<double, FreeCoordinate::most_places> slope;
    for (const Side& side : sides_) {
      g[0] += side.share * side.s.value(motion.q);
      side.s.slope(motion.q, slope.data());
      for (std::size_t i = 0; i < side.local.size(); ++i) jacobian[side.local[i]] += side.share * slope[i];
    }
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    const std::size_t k = places_.size();
    std::fill(curvature, curvature + k * k, 0.0);
    std::array<double, most * most> own;
    for (const Side& side : sides_) {
      side.s.curvature(motion.q, side.share * multiplier[0], own.data());
      const std::size_t n = side.local.size();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) curvature[k * side.local[i] + side.local[j]] += own[n * i + j];
    }
  }
  void second_rate(const Motion& motion, double* out) const override {
    std::array<double, most * most> own;
    out[0] = 0.0;
    for (const Side& side : sides_) {
      side.s.curvature(motion.q, side.share, own.data());
      const std::size_t n = side.local.size();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          out[0] += motion.v[places_[side.local[i]]] * own[n * i + j] * motion.v[places_[side.local[j]]];
    }
  }
  bool has_symmetric_curvature() const override { return std::holds_alternative<PlaneCoordinate>(sides_.front().s.of); }

 private:
  static constexpr std::size_t most = FreeCoordinate::most_places;
  struct Side {
    FreeCoordinate s;
    double share;
    std::vector<std::size_t> local;  // where its coordinates stand among the places
  };
  std::array<Side, 2> sides_;
  double offset_;
};

}  // namespace

std::unique_ptr<Joint> make_gear(std::string name, const FreeCoordinate& first, const FreeCoordinate& second,
                                 double ratio, double offset) {
  return std::make_unique<Gear>(std::move(name), first, second, ratio, offset);
}

}  // namespace rubato::model
