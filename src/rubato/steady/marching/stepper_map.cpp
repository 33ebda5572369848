#include <rubato/steady/marching/stepper_map.hpp>

#include <rubato/core/stopping.hpp>
#include <rubato/integrate/law_energy.hpp>
#include <rubato/integrate/stepper.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace rubato::steady {
namespace {

constexpr Index largest_known = 160;  // numbers in a state, beyond which a power of the step costs more than it saves

system::LoadTerm term_of(const Vector& weights, double angular_frequency, double phase) {
  system::LoadTerm term;
  term.law = model::HarmonicLaw{1.0, angular_frequency, phase};
  for (Index i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    term.rows.push_back(i);
    term.weights.push_back(weights[i]);
  }
  return term;
}

/// How far a law moves by a unit of each number of its memory: the change of its force over its stiffness, where
/// nothing has moved yet. Numbers that show neither there count as lengths.
Vector memory_lengths(const system::LocallyNonlinear& system) {
  Vector lengths = Vector::Ones(system.memory_size());
  for (Index j = 0; j < system.law_count(); ++j) {
    const model::Law& law = *system.laws()[static_cast<std::size_t>(j)].law;
    Vector memory = Vector::Zero(law.memory_size());
    model::LawPoint rest;
    rest.normal = 1e100;  // sticks: what its memory does then
    const model::LawAnswer at_rest = law.at(rest, memory.data());
    for (Index i = 0; i < memory.size(); ++i) {
      constexpr double small = 1e-6;
      memory[i] = small;
      const double length = std::abs((law.at(rest, memory.data()).force - at_rest.force) / (small * at_rest.by_u));
      memory[i] = 0.0;
      if (length > 0.0 && std::isfinite(length)) lengths[system.memory_of(j) + i] = length;
    }
  }
  for (Index b = 0; b < system.block_count(); ++b) {
    const model::BlockLaw& law = *system.blocks()[static_cast<std::size_t>(b)].law;
    for (Index i = 0; i < law.memory_size(); ++i)
      lengths[system.memory_of_block(b) + i] = 1.0 / law.limit_stiffness(i, true);  // its memory is a force
  }
  return lengths;
}

class StepperMap final : public PeriodMap {
 public:
  StepperMap(const integrate::Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request)
      : method_(method),
        structure_(system),
        request_(request),
        n_(system.size()),
        m_(system.slider_count()),
        memory_(system.memory_size()),
        carries_acceleration_(std::holds_alternative<integrate::GeneralizedAlpha>(method.formula) ||
                              std::holds_alternative<integrate::WilsonTheta>(method.formula)),
        memory_length_(memory_lengths(system)),
        from_(system.start()),
        to_(system.start()) {}

  Index size() const override { return (carries_acceleration_ ? 3 : 2) * n_ + m_ + memory_; }
  Index slip_start() const override { return 2 * n_; }
  Index slips() const override { return m_ + memory_; }
  Index lanes() const override { return 1; }

  bool prepare(std::span<const system::Excitation> excitations, int steps) override {
    omega_ = excitations[0].angular_frequency;
    period_ = excitations[0].period();
    steps_ = steps;
    writer_.reset();
    stepper_.reset();
    system_.emplace(with_excitation(structure_, excitations[0]));
    stepper_ = integrate::make_stepper(method_, *system_);
    return true;
  }

  bool advance(const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records, Index first) override {
    decode(from);
    if (records && first >= (*records)[0].steps) records = nullptr;
    if (records) {
      if (!writer_ || first == 0) writer_.emplace(*system_, request_);
      if (first == 0) writer_->write(from_, (*records)[0], 0, false);
    }
    const double h = period_ / steps_;
    system::State *now = &from_, *next = &to_;
    for (int j = 0; j < steps_; ++j) {
      stop_if_asked();
      const double t1 = j + 1 == steps_ ? period_ : h * (j + 1);
      if (stepper_->attempt(*now, h, t1, *next).outcome != integrate::StepOutcome::accepted) return false;
      std::swap(now, next);
      if (records) writer_->write(*now, (*records)[0], first + j + 1, true);
    }
    to.resize(size(), 1);
    write_state(*now, to, 0);
    return to.allFinite();
  }

  void encode(const system::State& state, LaneArray& states, Index lane) override {
    system::State start = state;
    start.t = 0.0;
    write_state(integrate::consistent_start(*system_, std::move(start)), states, lane);
  }

  void displace(const Vector& by, LaneArray& states, Index lane) override {
    states.col(lane).segment(0, n_) += by.array();
  }

  double observed_size(const LaneArray& differences, Index lane) const override {
    double size = 0.0;
    for (const auto& observed : request_.observed)
      size = std::max(size, std::hypot(observed.of(differences.col(lane).segment(0, n_)),
                                       observed.of(differences.col(lane).segment(n_, n_))));
    return size;
  }

  Matrix linear_update() override {
    if (size() > largest_known) return {};
    const Matrix step = propagator();
    if (step.size() == 0) return {};
    const Matrix inverse = resolvent_of_power(step, steps_);
    if (inverse.size() == 0) return {};
    Matrix update = Matrix::Identity(size(), size());
    // In a state the slips and the memory stand between v and A.
    const auto row_of = [&](Index i) { return i < 2 * n_ ? i : i + slips(); };
    for (Index j = 0; j < inverse.cols(); ++j)
      for (Index i = 0; i < inverse.rows(); ++i) update(row_of(i), row_of(j)) = inverse(i, j);
    return update;
  }

 private:
  void write_state(const system::State& state, LaneArray& states, Index lane) const {
    auto x = states.col(lane);
    x.segment(0, n_) = state.q;
    x.segment(n_, n_) = state.v / omega_;
    for (Index i = 0; i < m_; ++i)
      x[2 * n_ + i] = system_->relative_displacement(i, state.q) - state.slider_force[i] / stiffness(i);
    x.segment(2 * n_ + m_, memory_) = state.memory.cwiseProduct(memory_length_);
    if (carries_acceleration_) x.segment(2 * n_ + slips(), n_) = state.auxiliary_acceleration / (omega_ * omega_);
  }

  // A state that an extrapolation has put beyond a limit slips back to it.
  void decode(const LaneArray& states) {
    const auto x = states.col(0);
    from_.t = 0.0;
    from_.q = x.segment(0, n_);
    from_.v = omega_ * x.segment(n_, n_);
    for (Index i = 0; i < m_; ++i) {
      const double limit = system_->sliders()[static_cast<std::size_t>(i)].limit;
      const double trial = stiffness(i) * (system_->relative_displacement(i, from_.q) - x[2 * n_ + i]);
      from_.slider_force[i] = std::clamp(trial, -limit, limit);
    }
    system_->set_stop_forces(from_);
    from_.memory = x.segment(2 * n_ + m_, memory_).matrix().cwiseQuotient(memory_length_);
    system_->set_law_forces(from_, model::Side::right);
    if (carries_acceleration_) from_.auxiliary_acceleration = omega_ * omega_ * x.segment(2 * n_ + slips(), n_);
  }

  // The step without sliders and loads on unit states.
  Matrix propagator() const {
    system::LocallyNonlinear::Parts parts;
    parts.mass = structure_.mass();
    parts.damping = structure_.damping();
    parts.stiffness = structure_.stiffness();
    parts.coordinates = structure_.coordinates();
    const system::LocallyNonlinear linear(std::move(parts));
    const auto stepper = integrate::make_stepper(method_, linear);
    const double units[] = {1.0, omega_, omega_ * omega_}, h = period_ / steps_;
    const Index width = carries_acceleration_ ? 3 : 2;
    system::State from = linear.start(), to = from;
    Matrix result(width * n_, width * n_);
    for (Index c = 0; c < width; ++c)
      for (Index k = 0; k < n_; ++k) {
        from.t = 0.0;
        from.q = from.v = Vector::Zero(n_);
        if (carries_acceleration_) from.auxiliary_acceleration = Vector::Zero(n_);
        (c == 0 ? from.q : c == 1 ? from.v : from.auxiliary_acceleration)[k] = units[c];
        to = from;
        auto column = result.col(c * n_ + k);
        if (stepper->attempt(from, h, h, to).outcome != integrate::StepOutcome::accepted) return {};
        column.segment(0, n_) = to.q;
        column.segment(n_, n_) = to.v / omega_;
        if (carries_acceleration_) column.segment(2 * n_, n_) = to.auxiliary_acceleration / (omega_ * omega_);
      }
    return result;
  }

  double stiffness(Index slider) const { return structure_.sliders()[static_cast<std::size_t>(slider)].stiffness; }

  integrate::Method method_;
  const system::LocallyNonlinear& structure_;
  const SteadyRequest& request_;
  Index n_, m_, memory_;
  bool carries_acceleration_;
  double omega_ = 1.0, period_ = 1.0;
  int steps_ = 1;
  std::optional<system::LocallyNonlinear> system_;
  std::unique_ptr<integrate::Stepper> stepper_;
  std::optional<RecordWriter> writer_;
  Vector memory_length_;
  system::State from_, to_;
};

}  // namespace

RecordWriter::RecordWriter(const system::LocallyNonlinear& system, const SteadyRequest& request)
    : system_(system), request_(request), equilibrium_(system), loads_(system.loads()) {
  acceleration_.resize(system.size());
  product_.resize(system.size());
  force_.resize(system.size());
}

void RecordWriter::write(const system::State& state, PeriodRecord& record, Index column, bool adds_work) {
  const bool has_accelerations = record.acceleration.rows() > 0;
  if (has_accelerations) equilibrium_(state, acceleration_);
  for (std::size_t i = 0; i < request_.observed.size(); ++i) {
    const auto row = static_cast<Index>(i);
    record.position(row, column) = request_.observed[i].of(state.q);
    record.velocity(row, column) = request_.observed[i].of(state.v);
    if (has_accelerations) record.acceleration(row, column) = request_.observed[i].of(acceleration_);
  }
  record.slider_force.col(column) = state.slider_force.head(system_.slider_count());
  for (Index i = 0; i < system_.slider_count(); ++i)
    record.displacement(i, column) = system_.relative_displacement(i, state.q);
  if (!record.has_works) return;
  for (Index j = 0; adds_work && j < system_.law_count(); ++j)
    record.law_work[j] += integrate::dissipated_by_law(system_, j, last_, state);
  for (Index b = 0; adds_work && b < system_.block_count(); ++b)
    record.law_work[system_.law_count() + b] += integrate::dissipated_by_block(system_, b, last_, state);
  if (system_.has_laws()) last_ = state;
  product_.noalias() = system_.damping() * state.v;
  loads_.evaluate(state.t, force_);
  if (adds_work) {
    travel_ = state.q - last_q_;
    record.viscous_work += 0.5 * travel_.dot(product_ + last_product_);
    record.input_work += 0.5 * travel_.dot(force_ + last_force_);
  }
  last_q_ = state.q;
  last_product_ = product_;
  last_force_ = force_;
}

system::LocallyNonlinear with_excitation(const system::LocallyNonlinear& system, const system::Excitation& excitation) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = system.mass();
  parts.damping = system.damping();
  parts.stiffness = system.stiffness();
  parts.sliders = system.sliders();
  for (std::size_t i = 0; i < parts.sliders.size(); ++i)
    parts.sliders[i].limit = excitation.limits[static_cast<Index>(i)];
  parts.stops = system.stops();
  parts.laws = system.laws();
  parts.blocks = system.blocks();
  parts.start = system.start();
  parts.coordinates = system.coordinates();
  std::vector<system::LoadTerm> terms;
  const auto add = [&](const Vector& weights, double angular_frequency, double phase) {
    system::LoadTerm term = term_of(weights, angular_frequency, phase);
    if (!term.rows.empty()) terms.push_back(std::move(term));
  };
  add(excitation.constant, 0.0, 0.0);
  for (const system::LoadHarmonic& harmonic : excitation.harmonics) {
    // Re(F exp(i phi)) = Re F cos(phi) + Im F cos(phi + pi/2)
    add(harmonic.amplitude.real(), harmonic.order * excitation.angular_frequency, 0.0);
    add(harmonic.amplitude.imag(), harmonic.order * excitation.angular_frequency, 0.5 * std::numbers::pi);
  }
  parts.loads = system::Loads(std::move(terms));
  return system::LocallyNonlinear(std::move(parts));
}

std::unique_ptr<PeriodMap> make_stepper_map(const integrate::Method& method, const system::LocallyNonlinear& system,
                                            const SteadyRequest& request) {
  return std::make_unique<StepperMap>(method, system, request);
}

}  // namespace rubato::steady
