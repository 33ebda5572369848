#include <rubato/integrate/estimators/error_space.hpp>
#include <rubato/integrate/estimators/mass_norm.hpp>

namespace rubato::integrate {
namespace {

class StructureSpace final : public ErrorSpace {
 public:
  explicit StructureSpace(const system::LocallyNonlinear& system)
      : system_(system), norm_(system), product_(system.size()) {}

  Index size() const override { return system_.size(); }
  const Vector& times_mass(const Vector& x) override { return norm_.times(x); }
  double displacement(const system::State& state) override { return norm_(state.q); }
  ResponseScales scales(const system::State& state, const Vector& acceleration, double duration) override {
    return response_scales(system_, state, acceleration, duration);
  }
  bool is_damped() const override { return system_.damping().nonZeros() > 0; }
  double damping(const Vector& x) override {
    product_.noalias() = system_.damping() * x;
    return x.dot(product_);
  }

 private:
  const system::LocallyNonlinear& system_;
  MassNorm norm_;
  Vector product_;
};

}  // namespace

std::unique_ptr<ErrorSpace> make_error_space(const system::LocallyNonlinear& system) {
  return std::make_unique<StructureSpace>(system);
}

}  // namespace rubato::integrate
