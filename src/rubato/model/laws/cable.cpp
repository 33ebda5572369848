#include <rubato/model/laws/law_values.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

/// f = max(0, k (u - length)): a spring that only pulls its ends together.
class Cable final : public Law {
 public:
  Cable(double stiffness, double length) : stiffness_(stiffness), length_(length) {}

  LawAnswer advance(const LawPoint&, const double*, const LawPoint& to, double*) const override {
    // Just taut with the slope of either side: with that of a taut one nothing that it holds floats.
    return to.u == length_ ? LawAnswer{0.0, stiffness_, 0.0} : at(to, nullptr);
  }
  LawAnswer at(const LawPoint& point, const double*) const override {
    if (point.u == length_) return {0.0, (point.rate > 0.0 ? 1.0 : point.rate < 0.0 ? 0.0 : 0.5) * stiffness_, 0.0};
    if (!(point.u > length_)) return {std::isnan(point.u) ? point.u : 0.0};
    return {stiffness_ * (point.u - length_), stiffness_, 0.0};
  }
  double stored_energy(double u, const double*) const override {
    const double stretch = std::max(0.0, u - length_);
    return 0.5 * stiffness_ * stretch * stretch;
  }
  double dissipated(const LawPoint&, const double*, const LawPoint&, const double*) const override { return 0.0; }
  double largest_stiffness() const override { return stiffness_; }

  /// It becomes taut, or slack.
  double guard(const LawPoint& from, const double*, const LawPoint& to, double near) const override {
    const double stretch = from.u - length_;
    const bool is_there = std::abs(stretch) <= near * std::abs(from.rate);
    const bool is_taut = is_there ? from.rate > 0.0 : stretch > 0.0;
    return is_taut ? to.u - length_ : length_ - to.u;
  }

 private:
  double stiffness_, length_;
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { stiffness, length };
  const LawValues value(description, parameters, part);
  value.must_be_positive(stiffness);
  return std::make_shared<Cable>(value[stiffness], value[length]);
}

}  // namespace

LawKind cable();
LawKind cable() {
  using Type = LawKey::Type;
  return {"cable",
          "a cable",
          "A spring that only pulls: f = max(0, stiffness (u - length))",
          {{"stiffness", Type::number, "N/m", {}, "of the taut cable"},
           {"length", Type::number, "m", 0.0, "the u up to which it is slack; on a strut its length without load"}},
          make};
}

}  // namespace rubato::model
