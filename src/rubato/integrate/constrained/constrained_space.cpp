#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/system/constrained_equations.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::integrate {
namespace {

class ConstrainedSpace final : public ErrorSpace {
 public:
  /// @param equations  lent   @param own  the same where nobody lends them, else null
  ConstrainedSpace(system::ConstrainedEquations& equations, std::unique_ptr<system::ConstrainedEquations> own,
                   const system::State& start, double tolerance)
      : system_(equations.system()),
        start_(start.q),
        extent_(integrate::extent(system_)),
        least_(integrate::least_size(system_, tolerance)),
        round_off_(std::min(1e-12, 1e-5 * tolerance) * extent_),
        own_(std::move(own)),
        equations_(equations),
        product_(system_.size()),
        travel_(system_.size()),
        moved_(system_.start()),
        force_(system_.size()),
        constraint_(system_.constraint_count()) {}

  Index size() const override { return system_.size(); }
  const Vector& times_mass(const Vector& x) override {
    system_.times_mass(x, product_);
    return product_;
  }
  double displacement(const system::State& state) override {
    system_.difference(start_, state.q, travel_);
    return norm(travel_);
  }
  double least_size() override { return least_; }
  /// A hundredth of what Newton's method may leave, and little beside what the tolerance allows a march.
  double round_off() const override { return round_off_; }

  bool turns_freely() const override { return true; }
  bool has_stops() const override { return system_.has_stops(); }
  bool touches(const system::State& state) const override { return system_.touches(state); }

  /// No more than the system's own size: joints keep an acceleration from leading where it points.
  double promised_size(const ResponseScales& scales) override { return std::min(extent_, scales.size(extent_)); }

  ResponseScales scales(const system::State& state, const Vector& acceleration, double duration) override {
    const auto shape_of = [&](const Vector& x) -> ResponseScales::Shape {
      const double length = norm(x);
      if (!(length > 0.0)) return {};
      const double omega = std::max(1.0 / duration, frequency(state, x, length));
      return {length, omega, omega};
    };
    return {{}, shape_of(state.v), shape_of(acceleration), 0.0};
  }

  // Dampers of joints change with the configuration: errors are not taken to be forgotten.
  bool is_damped() const override { return false; }
  double remembered_squared(const Vector&) override { return 0.0; }
  double decaying_squared(const Vector&) override { return 0.0; }

 private:
  /// sqrt(x^T K x / x^T M x), K x from the forces at both ends of a small motion along x.
  double frequency(const system::State& state, const Vector& x, double length) {
    constexpr double small = 1e-6;
    const double way = small * extent_ / length;
    double work = 0.0;
    equations_.begin_step(state);
    for (const double sign : {1.0, -1.0}) {
      moved_ = state;
      system_.retract(state.q, (sign * way) * x, moved_.q);
      equations_.go_to_end(moved_, model::Side::right);
      equations_.residual(force_, constraint_);
      equations_.add_constraint_force(state.multiplier, 1.0, force_);
      work += sign * x.dot(force_);
    }
    const double quotient = work / (2.0 * way * length * length);
    return quotient > 0.0 ? std::sqrt(quotient) : 0.0;
  }

  const system::ConstrainedSystem& system_;
  Vector start_;
  double extent_, least_, round_off_;
  std::unique_ptr<system::ConstrainedEquations> own_;
  system::ConstrainedEquations& equations_;
  Vector product_, travel_;
  system::State moved_;
  Vector force_, constraint_;
};

}  // namespace

double extent(const system::ConstrainedSystem& system) {
  return system.reference() > 0.0 ? system.reference() : std::sqrt(system.mass().diagonal().sum());
}

double least_size(const system::ConstrainedSystem& system, double tolerance) {
  return std::clamp(1e-2 * std::sqrt(1e-4 / tolerance), 1e-2, 1.0) * extent(system);
}

std::unique_ptr<ErrorSpace> make_error_space(const system::ConstrainedSystem& system, const system::State& start,
                                             double tolerance) {
  auto own = system.equations();
  system::ConstrainedEquations& equations = *own;
  return std::make_unique<ConstrainedSpace>(equations, std::move(own), start, tolerance);
}

std::unique_ptr<ErrorSpace> make_error_space(system::ConstrainedEquations& equations, const system::State& start,
                                             double tolerance) {
  return std::make_unique<ConstrainedSpace>(equations, nullptr, start, tolerance);
}

}  // namespace rubato::integrate
