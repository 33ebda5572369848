#include <rubato/integrate/estimators/damping_memory.hpp>
#include <rubato/integrate/estimators/error_space.hpp>
#include <rubato/integrate/estimators/load_scale.hpp>
#include <rubato/integrate/estimators/mass_norm.hpp>

namespace rubato::integrate {
namespace {

class StructureSpace final : public ErrorSpace {
 public:
  StructureSpace(const system::LocallyNonlinear& system, double duration,
                 const std::vector<numerics::StepBound>& bounds)
      : system_(system), norm_(system), duration_(duration), bounds_(bounds), memory_(system, duration) {}

  Index size() const override { return system_.size(); }
  const Vector& times_mass(const Vector& x) override { return norm_.times(x); }
  double displacement(const system::State& state) override { return norm_(state.q); }
  ResponseScales scales(const system::State& state, const Vector& acceleration, double duration) override {
    ResponseScales all = response_scales(system_, state, acceleration, duration);
    if (!has_started_) all.reached = reached_by(system_, state.v, duration);
    has_started_ = true;
    return all;
  }
  /// Of what the loads promise a tenth: a promise may be ten times too large, as that of a record far above resonance,
  /// and without it a response that grows from nothing would be measured by nothing.
  double least_size() override {
    constexpr double share = 0.1;
    return share * promised();
  }
  /// An acceleration brings no more than the loads do, however large it is at the start.
  double promised_size(const ResponseScales& scales) override {
    return scales.size(promised() > 0.0 ? promised() : HUGE_VAL);
  }
  bool has_stops() const override { return system_.stop_count() > 0 || system_.block_count() > 0; }
  bool touches(const system::State& state) const override {
    if ((state.slider_force.segment(system_.slider_count(), system_.stop_count()).array() > 0.0).any()) return true;
    for (Index b = 0; b < system_.block_count(); ++b) {
      const Index across = system_.blocks()[static_cast<std::size_t>(b)].law->size() - 1;
      if (state.slider_force[system_.row_of_block(b) + across] > 0.0) return true;
    }
    return false;
  }
  bool is_damped() const override { return system_.damping().nonZeros() > 0; }
  double remembered_squared(const Vector& x) override { return memory_.squared(x); }
  double decaying_squared(const Vector& x) override { return memory_.decaying_squared(x); }

 private:
  double promised() {
    if (promised_ < 0.0) promised_ = size_under_loads(system_, duration_, bounds_);
    return promised_;
  }

  const system::LocallyNonlinear& system_;
  MassNorm norm_;
  double duration_, promised_ = -1.0;
  std::vector<numerics::StepBound> bounds_;
  bool has_started_ = false;  // later the displacement itself tells how far velocities lead
  DampingMemory memory_;
};

}  // namespace

std::unique_ptr<ErrorSpace> make_error_space(const system::LocallyNonlinear& system, double duration,
                                             const std::vector<numerics::StepBound>& bounds) {
  return std::make_unique<StructureSpace>(system, duration, bounds);
}

}  // namespace rubato::integrate
