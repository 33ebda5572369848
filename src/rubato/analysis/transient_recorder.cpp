#include <rubato/analysis/transient_recorder.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rubato::analysis {
namespace {

using Attributes = std::vector<std::pair<std::string, std::string>>;

Attributes attributes_of(const TransientPlan& plan, const system::LocallyNonlinear& system) {
  Attributes attributes{{"type", "transient"}, {"method", plan.method.name}};
  if (plan.step > 0.0) attributes.emplace_back("step", fmt::format("{} s", plan.step));
  if (plan.automatic) attributes.emplace_back("step", summary(*plan.automatic));
  attributes.emplace_back("duration", fmt::format("{} s", plan.duration));
  if (system.slider_count() > 0) {
    std::vector<double> stiffness, limit;
    for (const Index i : SliderBlocks(system).order()) {
      const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
      stiffness.push_back(slider.stiffness);
      limit.push_back(slider.limit);
    }
    attributes.emplace_back("slider_stiffness", fmt::format("{}", fmt::join(stiffness, ", ")));
    attributes.emplace_back("slider_limit", fmt::format("{}", fmt::join(limit, ", ")));
  }
  return attributes;
}

results::Block scalar(const std::string& variable, const std::string& description) {
  return {variable, "J", description, "", {}};
}

}  // namespace

TransientRecorder::TransientRecorder(const std::string& name, const TransientPlan& plan,
                                     const system::LocallyNonlinear& system, integrate::Balance& balance,
                                     results::Sink& sink)
    : system_(system), observed_(plan.observed), sliders_(system), stops_(system), balance_(balance) {
  using Quantity = ObservedBlocks::Quantity;
  const results::Block time{"time", "s", "time", "", {}};
  results::TableLayout layout{name, "", "time", {time}, attributes_of(plan, system)};
  observed_.add(layout, {Quantity::position, Quantity::velocity, Quantity::acceleration});
  sliders_.add(layout);
  stops_.add(layout);
  if (system.supports()) add_reactions(layout);
  rows_ = sink.open(layout);
  if (!plan.energy) return;
  results::TableLayout energy{name, "energy", "time", {time}, {{"type", "energy"}}};
  auto& blocks = energy.blocks;
  blocks.push_back(scalar("kinetic", "kinetic energy"));
  blocks.push_back(scalar("strain", "strain energy"));
  blocks.push_back(scalar("slider_stored", "elastic energy of the sliders"));
  if (system.stop_count() > 0) blocks.push_back(scalar("stop_stored", "elastic energy of the stops"));
  blocks.push_back(scalar("damper_dissipated", "dissipated by the dampers since the start"));
  blocks.push_back(scalar("slider_dissipated", "dissipated by slip since the start"));
  if (system.stop_count() > 0) blocks.push_back(scalar("stop_dissipated", "dissipated by the stops since the start"));
  blocks.push_back(scalar("load_work", "work of the loads since the start"));
  if (system.supports())
    blocks.push_back(scalar("drive_work", "work of the forces that move supports since the start"));
  blocks.push_back(scalar("residue", "what the method itself made (+) or lost (-)"));
  energy_rows_ = sink.open(energy);
}

/// Forces of displacements, then moments of rotations.
void TransientRecorder::add_reactions(results::TableLayout& layout) const {
  const system::MovingSupports& supports = *system_.supports();
  for (const bool is_rotation : {false, true}) {
    std::vector<std::string> names;
    for (Index i = 0; i < supports.size(); ++i)
      if (supports.is_rotation(i) == is_rotation) names.push_back(supports.names()[static_cast<std::size_t>(i)]);
    if (names.empty()) continue;
    if (is_rotation)
      layout.blocks.push_back({"reaction_moment", "N m", "moment that turns the support", "turning_support", names});
    else
      layout.blocks.push_back({"reaction", "N", "force that moves the support", "moving_support", names});
  }
}

void TransientRecorder::append_supports(const system::State& state) {
  const system::MovingSupports& supports = *system_.supports();
  const auto side = model::Side::right;
  supports.extend(state.t, side, state.q, q_, 0);
  supports.extend(state.t, side, state.v, v_, 1);
  supports.extend(state.t, side, state.acceleration, a_, 2);
  supports.reaction(state.t, side, q_, v_, a_, reaction_);
  observed_.append({&q_, &v_, &a_}, row_);
  sliders_.append(state, row_);
  stops_.append(state, row_);
  for (const bool is_rotation : {false, true})
    for (Index i = 0; i < supports.size(); ++i)
      if (supports.is_rotation(i) == is_rotation) row_.push_back(reaction_[i]);
}

void TransientRecorder::record(const system::State& state, const Energy* energy, bool is_balanced) {
  shown_ = state;
  if (!is_balanced) balance_.find_shown_acceleration(shown_);
  row_.clear();
  row_.push_back(state.t);
  if (system_.supports()) {
    append_supports(shown_);
  } else {
    observed_.append({&state.q, &state.v, &shown_.acceleration}, row_);
    sliders_.append(state, row_);
    stops_.append(state, row_);
  }
  rows_->append(row_);
  ++count_;
  if (!energy_rows_ || !energy) return;
  row_ = {state.t, energy->kinetic, energy->strain, energy->slider_stored};
  if (system_.stop_count() > 0) row_.push_back(energy->stop_stored);
  row_.push_back(energy->damper_dissipated);
  row_.push_back(energy->slider_dissipated);
  if (system_.stop_count() > 0) row_.push_back(energy->stop_dissipated);
  row_.push_back(energy->load_work);
  if (system_.supports()) row_.push_back(energy->drive_work);
  row_.push_back(energy->residue());
  energy_rows_->append(row_);
}

}  // namespace rubato::analysis
