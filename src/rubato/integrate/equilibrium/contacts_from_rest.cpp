#include <rubato/integrate/equilibrium/contacts_from_rest.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {
constexpr double from_far = 1e30;  // [m]: beside it no displacement turns the slip, nor does mu N/kT end it
}

ContactsFromRest::ContactsFromRest(const system::LocallyNonlinear& system)
    : system_(system), block_slopes_(static_cast<std::size_t>(system.block_count())) {
  slope_.setZero(system.contact_count());
  virgin_.setZero(system.memory_size());
  widened_.setZero(system.block_count());
  take_normals();
  is_symmetric_ = is_symmetric_ && system.block_count() == 0;
}

void ContactsFromRest::load(system::State& state) {
  for (Index i = 0; i < system_.first_law(); ++i) {
    const double u = system_.relative_displacement(i, state.q);
    double& force = state.slider_force[i];
    if (i < system_.slider_count()) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      force = std::clamp(slider.stiffness * u, -slider.limit, slider.limit);
      slope_[i] = std::abs(slider.stiffness * u) <= slider.limit ? slider.stiffness : 0.0;
    } else {
      const auto& stop = system_.stops()[static_cast<std::size_t>(i - system_.slider_count())];
      force = stop.stiffness * std::max(0.0, u - stop.gap);
      slope_[i] = u > stop.gap ? stop.stiffness : 0.0;
    }
  }
  for (const Index law : system_.law_order()) load_law(law, state);
  for (Index b = 0; b < system_.block_count(); ++b) load_block(b, state);
}

void ContactsFromRest::load_block(Index b, system::State& state) {
  const model::BlockLaw& law = *system_.blocks()[static_cast<std::size_t>(b)].law;
  const Index first = system_.row_of_block(b), memory = system_.memory_of_block(b);
  model::BlockPoint from, to;
  for (Index i = 0; i < law.size(); ++i) to.u[i] = system_.relative_displacement(first + i, state.q);
  for (double* u : {from.u, to.u}) u[law.size() - 1] -= widened_[b];
  // What slides on steadily has come from far: it slips.
  if (const double velocity = law.sliding_velocity(); velocity != 0.0) to.u[0] += std::copysign(from_far, velocity);
  model::BlockAnswer& answer = block_slopes_[static_cast<std::size_t>(b)];
  answer = law.advance(from, virgin_.data() + memory, to, state.memory.data() + memory);
  for (Index i = 0; i < law.size(); ++i) {
    state.slider_force[first + i] = answer.force[i];
    slope_[first + i] = answer.by_u[i][i];
  }
}

void ContactsFromRest::load_law(Index law, system::State& state) {
  const Index i = system_.first_law() + law, memory = system_.memory_of(law);
  const double u = system_.relative_displacement(i, state.q);
  model::LawPoint from{0.0, 0.0, 0.0, model::Side::left}, to{u, 0.0, 0.0, model::Side::left};
  if (system_.has_normals()) {
    from.normal = normal_at_rest_[law];
    to.normal = system_.normal_force(law, state, state.slider_force, model::Side::left);
  }
  const model::LawAnswer answer = system_.laws()[static_cast<std::size_t>(law)].law->advance(
      from, virgin_.data() + memory, to, state.memory.data() + memory);
  state.slider_force[i] = answer.force;
  slope_[i] = answer.by_u;
  by_normal_[law] = answer.by_normal;
}

/// What presses where nothing has moved, from where normal forces grow with the motion.
void ContactsFromRest::take_normals() {
  by_normal_.setZero(system_.law_count());
  normal_at_rest_.setZero(system_.law_count());
  if (!system_.has_normals()) return;
  system::State rest = system_.start();
  rest.t = 0.0;
  rest.q.setZero();
  rest.v.setZero();
  rest.memory.setZero();
  rest.slider_force.setZero();
  system_.set_stop_forces(rest);
  system_.set_law_forces(rest, model::Side::left);
  for (Index j = 0; j < system_.law_count(); ++j) {
    normal_at_rest_[j] = system_.normal_force(j, rest, rest.slider_force, model::Side::left);
    is_symmetric_ = is_symmetric_ && system_.normal_contact(j) < 0;
  }
}

}  // namespace rubato::integrate
