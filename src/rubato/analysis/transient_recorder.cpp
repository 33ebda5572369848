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
                                     const system::LocallyNonlinear& system, results::Sink& sink)
    : system_(system), observed_(plan.observed), sliders_(system), equilibrium_(system), acceleration_(system.size()) {
  using Quantity = ObservedBlocks::Quantity;
  const results::Block time{"time", "s", "time", "", {}};
  results::TableLayout layout{name, "", "time", {time}, attributes_of(plan, system)};
  observed_.add(layout, {Quantity::position, Quantity::velocity, Quantity::acceleration});
  sliders_.add(layout);
  rows_ = sink.open(layout);
  if (plan.energy)
    energy_rows_ = sink.open({name,
                              "energy",
                              "time",
                              {time, scalar("kinetic", "kinetic energy"), scalar("strain", "strain energy"),
                               scalar("slider_stored", "elastic energy of the sliders"),
                               scalar("damper_dissipated", "dissipated by the dampers since the start"),
                               scalar("slider_dissipated", "dissipated by slip since the start"),
                               scalar("load_work", "work of the loads since the start"),
                               scalar("residue", "what the method itself made (+) or lost (-)")},
                              {{"type", "energy"}}});
}

void TransientRecorder::record(const system::State& state, const Energy* energy, const Vector* acceleration) {
  if (acceleration)
    acceleration_ = *acceleration;
  else
    equilibrium_(state, acceleration_);
  row_.clear();
  row_.push_back(state.t);
  observed_.append({&state.q, &state.v, &acceleration_}, row_);
  sliders_.append(state, row_);
  rows_->append(row_);
  ++count_;
  if (!energy_rows_ || !energy) return;
  const double ledger[] = {state.t,
                           energy->kinetic,
                           energy->strain,
                           energy->slider_stored,
                           energy->damper_dissipated,
                           energy->slider_dissipated,
                           energy->load_work,
                           energy->residue()};
  energy_rows_->append(ledger);
}

}  // namespace rubato::analysis
