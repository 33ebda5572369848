#include <rubato/analysis/energy_ledger.hpp>

namespace rubato::analysis {

namespace {

double stored_in_stop(const system::LocallyNonlinear& system, Index stop, const system::State& state) {
  const Index i = system.slider_count() + stop;
  if (!(state.slider_force[i] > 0.0)) return 0.0;
  const auto& values = system.stops()[static_cast<std::size_t>(stop)];
  const double depth = system.relative_displacement(i, state.q) - values.gap;
  return depth > 0.0 ? 0.5 * values.stiffness * depth * depth : 0.0;
}

}  // namespace

SupportWork::SupportWork(const system::LocallyNonlinear& system, integrate::Balance& balance)
    : system_(system), balance_(balance) {}

void SupportWork::go_to(const system::State& state, model::Side side, End& end) {
  const system::MovingSupports& supports = *system_.supports();
  balanced_ = state;
  balance_.find_acceleration(balanced_, side);
  supports.extend(state.t, side, state.q, end.q, 0);
  supports.extend(state.t, side, state.v, end.v, 1);
  supports.extend(state.t, side, balanced_.acceleration, end.a, 2);
  supports.reaction(state.t, side, end.q, end.v, end.a, end.reaction);
  end.load.resize(supports.size());
  supports.loads().evaluate(state.t, end.load, side);
}

SupportWork::Work SupportWork::over(const system::State& before, const system::State& after) {
  go_to(before, model::Side::right, before_);
  go_to(after, model::Side::left, after_);
  const system::MovingSupports& supports = *system_.supports();
  const Index p = supports.size();
  const Vector travel = after_.q - before_.q, velocity = 0.5 * (before_.v + after_.v);
  const Vector own = travel.tail(p);
  Vector of_free = velocity;
  of_free.tail(p).setZero();
  Work work{};
  work.damper = velocity.tail(p).dot(supports.damping() * travel) + own.dot(supports.damping() * of_free);
  work.load = 0.5 * (before_.load + after_.load).dot(own);
  work.drive = 0.5 * (before_.reaction + after_.reaction).dot(own);
  return work;
}

Energy energy_of(const system::LocallyNonlinear& system, const system::State& state, Vector& product) {
  Energy energy;
  product.noalias() = system.mass() * state.v;
  energy.kinetic = 0.5 * state.v.dot(product);
  product.noalias() = system.stiffness() * state.q;
  energy.strain = 0.5 * state.q.dot(product);
  for (Index i = 0; i < system.slider_count(); ++i)
    energy.slider_stored +=
        0.5 * state.slider_force[i] * state.slider_force[i] / system.sliders()[static_cast<std::size_t>(i)].stiffness;
  for (Index j = 0; j < system.stop_count(); ++j) energy.stop_stored += stored_in_stop(system, j, state);
  if (const system::MovingSupports* supports = system.supports()) {
    Vector all;
    supports->extend(state.t, model::Side::right, state.v, all, 1);
    energy.kinetic += supports->kinetic(all);
    supports->extend(state.t, model::Side::right, state.q, all, 0);
    energy.strain += supports->strain(all);
  }
  return energy;
}

EnergyLedger::EnergyLedger(const system::LocallyNonlinear& system, integrate::Balance& balance)
    : system_(system), loads_(system.loads()), travel_(system.size()), product_(system.size()), force_(system.size()) {
  if (system.supports()) supports_.emplace(system, balance);
}

void EnergyLedger::start(const system::State& state) {
  const Energy now = energy_of(system_, state, product_);
  sums_ = {};
  sums_.start = now.stored();
}

EnergyLedger::Booking EnergyLedger::booking(const system::State& before, const system::State& after) {
  Booking booked{0.0, 0.0, 0.0, 0.0, 0.0};
  travel_ = before.v + after.v;
  product_.noalias() = system_.damping() * travel_;
  travel_ = after.q - before.q;
  booked.damper = 0.5 * product_.dot(travel_);
  loads_.evaluate_forces(before.t, force_, model::Side::right);
  booked.load = force_.dot(travel_);
  loads_.evaluate_forces(after.t, force_, model::Side::left);
  booked.load = 0.5 * (booked.load + force_.dot(travel_));
  for (Index i = 0; i < system_.slider_count(); ++i) {
    const double change = after.slider_force[i] - before.slider_force[i];
    const double slip =
        system_.relative_displacement(i, travel_) - change / system_.sliders()[static_cast<std::size_t>(i)].stiffness;
    booked.slider += 0.5 * (before.slider_force[i] + after.slider_force[i]) * slip;
  }
  for (Index j = 0; j < system_.stop_count(); ++j) {
    const Index i = system_.slider_count() + j;
    const double f0 = before.slider_force[i], f1 = after.slider_force[i];
    if (f0 > 0.0)
      booked.stop += 0.5 * (f0 + f1) * system_.relative_displacement(i, travel_) -
                     (stored_in_stop(system_, j, after) - stored_in_stop(system_, j, before));
  }
  if (supports_) {
    const SupportWork::Work work = supports_->over(before, after);
    booked.damper += work.damper;
    booked.load += work.load;
    booked.drive = work.drive;
  }
  return booked;
}

void EnergyLedger::add_step(const system::State& before, const system::State& after) {
  const Booking booked = booking(before, after);
  sums_.damper_dissipated += booked.damper;
  sums_.slider_dissipated += booked.slider;
  sums_.stop_dissipated += booked.stop;
  sums_.load_work += booked.load;
  sums_.drive_work += booked.drive;
}

Energy EnergyLedger::at(const system::State& before, const system::State& now) {
  const Booking part = &before == &now ? Booking{0.0, 0.0, 0.0, 0.0, 0.0} : booking(before, now);
  Energy energy = energy_of(system_, now, product_);
  energy.start = sums_.start;
  energy.damper_dissipated = sums_.damper_dissipated + part.damper;
  energy.slider_dissipated = sums_.slider_dissipated + part.slider;
  energy.stop_dissipated = sums_.stop_dissipated + part.stop;
  energy.load_work = sums_.load_work + part.load;
  energy.drive_work = sums_.drive_work + part.drive;
  return energy;
}

}  // namespace rubato::analysis
