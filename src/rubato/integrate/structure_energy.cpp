#include <rubato/integrate/law_energy.hpp>
#include <rubato/integrate/structure_energy.hpp>

namespace rubato::integrate {
namespace {

using Kind = Account::Kind;

double stored_in_stop(const system::LocallyNonlinear& system, Index stop, const system::State& state) {
  const Index i = system.slider_count() + stop;
  if (!(state.slider_force[i] > 0.0)) return 0.0;
  const auto& values = system.stops()[static_cast<std::size_t>(stop)];
  const double depth = system.relative_displacement(i, state.q) - values.gap;
  return depth > 0.0 ? 0.5 * values.stiffness * depth * depth : 0.0;
}

}  // namespace

StructureEnergy::StructureEnergy(const system::LocallyNonlinear& system)
    : system_(system), loads_(system.loads()), travel_(system.size()), product_(system.size()), force_(system.size()) {}

std::vector<Account> StructureEnergy::accounts() const {
  std::vector<Account> accounts{{Kind::stored, "kinetic", "kinetic energy"},
                                {Kind::stored, "strain", "strain energy"},
                                {Kind::stored, "slider_stored", "elastic energy of the sliders"},
                                {Kind::dissipated, "damper_dissipated", "dissipated by the dampers since the start"},
                                {Kind::dissipated, "slider_dissipated", "dissipated by slip since the start"},
                                {Kind::work, "load_work", "work of the loads since the start"}};
  if (system_.stop_count() > 0) {
    accounts.push_back({Kind::stored, "stop_stored", "elastic energy of the stops"});
    accounts.push_back({Kind::dissipated, "stop_dissipated", "dissipated by the stops since the start"});
  }
  return accounts;
}

void StructureEnergy::add_stored(const system::State& state, Entries row) {
  product_.noalias() = system_.mass() * state.v;
  row[kinetic] += 0.5 * state.v.dot(product_);
  product_.noalias() = system_.stiffness() * state.q;
  row[strain] += 0.5 * state.q.dot(product_);
  double in_sliders = 0.0, in_stops = 0.0;
  for (Index i = 0; i < system_.slider_count(); ++i)
    in_sliders +=
        0.5 * state.slider_force[i] * state.slider_force[i] / system_.sliders()[static_cast<std::size_t>(i)].stiffness;
  row[slider_stored] += in_sliders;
  if (system_.stop_count() == 0) return;
  for (Index j = 0; j < system_.stop_count(); ++j) in_stops += stored_in_stop(system_, j, state);
  row[stop_stored] += in_stops;
}

void StructureEnergy::add_flow(const system::State& before, const system::State& after, Entries row) {
  travel_ = before.v + after.v;
  product_.noalias() = system_.damping() * travel_;
  travel_ = after.q - before.q;
  row[damper_dissipated] += 0.5 * product_.dot(travel_);
  loads_.evaluate_forces(before.t, force_, model::Side::right);
  const double work_before = force_.dot(travel_);
  loads_.evaluate_forces(after.t, force_, model::Side::left);
  row[load_work] += 0.5 * (work_before + force_.dot(travel_));
  double by_sliders = 0.0, by_stops = 0.0;
  for (Index i = 0; i < system_.slider_count(); ++i) {
    const double change = after.slider_force[i] - before.slider_force[i];
    const double slip =
        system_.relative_displacement(i, travel_) - change / system_.sliders()[static_cast<std::size_t>(i)].stiffness;
    by_sliders += 0.5 * (before.slider_force[i] + after.slider_force[i]) * slip;
  }
  row[slider_dissipated] += by_sliders;
  if (system_.stop_count() == 0) return;
  for (Index j = 0; j < system_.stop_count(); ++j) {
    const Index i = system_.slider_count() + j;
    const double f0 = before.slider_force[i], f1 = after.slider_force[i];
    if (f0 > 0.0)
      by_stops += 0.5 * (f0 + f1) * system_.relative_displacement(i, travel_) -
                  (stored_in_stop(system_, j, after) - stored_in_stop(system_, j, before));
  }
  row[stop_dissipated] += by_stops;
}

SupportEnergy::SupportEnergy(const system::LocallyNonlinear& system, Balance& balance)
    : supports_(*system.supports()), balance_(balance) {}

namespace {
enum SupportPlace : std::size_t { kinetic, strain, damper_dissipated, load_work, drive_work };
}

std::vector<Account> SupportEnergy::accounts() const {
  return {{Kind::stored, "kinetic", ""},
          {Kind::stored, "strain", ""},
          {Kind::dissipated, "damper_dissipated", ""},
          {Kind::work, "load_work", ""},
          {Kind::work, "drive_work", "work of the forces that move supports since the start"}};
}

void SupportEnergy::add_stored(const system::State& state, Entries row) {
  supports_.extend(state.t, model::Side::right, state.v, after_.v, 1);
  row[kinetic] += supports_.kinetic(after_.v);
  supports_.extend(state.t, model::Side::right, state.q, after_.q, 0);
  row[strain] += supports_.strain(after_.q);
}

void SupportEnergy::go_to(const system::State& state, model::Side side, End& end) {
  balanced_ = state;
  balance_.find_acceleration(balanced_, side);
  supports_.extend(state.t, side, state.q, end.q, 0);
  supports_.extend(state.t, side, state.v, end.v, 1);
  supports_.extend(state.t, side, balanced_.acceleration, end.a, 2);
  supports_.reaction(state.t, side, end.q, end.v, end.a, end.reaction);
  end.load.resize(supports_.size());
  supports_.loads().evaluate(state.t, end.load, side);
}

void SupportEnergy::add_flow(const system::State& before, const system::State& after, Entries row) {
  go_to(before, model::Side::right, before_);
  go_to(after, model::Side::left, after_);
  const Index p = supports_.size();
  const Vector travel = after_.q - before_.q, velocity = 0.5 * (before_.v + after_.v);
  const Vector own = travel.tail(p);
  Vector of_free = velocity;
  of_free.tail(p).setZero();
  // Beyond what the free coordinates alone would dissipate.
  row[damper_dissipated] += velocity.tail(p).dot(supports_.damping() * travel) + own.dot(supports_.damping() * of_free);
  row[load_work] += 0.5 * (before_.load + after_.load).dot(own);
  row[drive_work] += 0.5 * (before_.reaction + after_.reaction).dot(own);
}

std::vector<std::unique_ptr<EnergyPart>> energy_parts(const system::LocallyNonlinear& system, Balance& balance) {
  std::vector<std::unique_ptr<EnergyPart>> parts;
  parts.push_back(std::make_unique<StructureEnergy>(system));
  if (system.has_laws()) parts.push_back(std::make_unique<LawEnergy>(system));
  if (system.supports()) parts.push_back(std::make_unique<SupportEnergy>(system, balance));
  return parts;
}

}  // namespace rubato::integrate
