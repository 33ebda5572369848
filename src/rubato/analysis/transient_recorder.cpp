#include <rubato/analysis/transient_recorder.hpp>

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace rubato::analysis {
namespace {

results::TableLayout energy_layout(const std::string& name, const integrate::EnergyLedger& ledger) {
  results::TableLayout layout{name, "energy", "time", {{"time", "s", "time", "", {}}}, {{"type", "energy"}}};
  for (const auto& account : ledger.accounts())
    layout.blocks.push_back({account.name, "J", account.description, "", {}});
  layout.blocks.push_back({"residue", "J", "what the method itself made (+) or lost (-)", "", {}});
  return layout;
}

}  // namespace

TransientRecorder::TransientRecorder(const std::string& name, const TransientPlan& plan, results::ColumnGroups groups,
                                     integrate::Balance& balance, integrate::EnergyLedger* ledger, results::Sink& sink)
    : groups_(std::move(groups)), balance_(balance), ledger_(ledger) {
  results::TableLayout layout{
      name, "", "time", {{"time", "s", "time", "", {}}}, {{"type", "transient"}, {"method", plan.march.method.name}}};
  if (plan.march.step > 0.0) layout.attributes.emplace_back("step", fmt::format("{} s", plan.march.step));
  if (plan.march.automatic) layout.attributes.emplace_back("step", summary(*plan.march.automatic));
  layout.attributes.emplace_back("duration", fmt::format("{} s", plan.march.duration));
  for (const auto& group : groups_) {
    group->add(layout);
    if (group->has_sums()) summing_.push_back(group.get());
  }
  layout_ = layout;
  rows_ = sink.open(layout);
  if (plan.shows_every_step) {
    layout.table = "every_step";
    step_rows_ = sink.open(layout);
  }
  if (!ledger_) return;
  energy_rows_ = sink.open(energy_layout(name, *ledger_));
  residue_.emplace(ledger_->accounts());
}

void TransientRecorder::book(const system::State& before, const system::State& after) {
  if (ledger_) {
    ledger_->add_step(before, after);
    // The largest energy may lie between two rows.
    ++booked_;
    if (booked_ % 64 == 0 || std::has_single_bit(static_cast<unsigned long>(booked_)))
      residue_->note(after.t, ledger_->at(after, after));
  }
  for (results::ColumnGroup* group : summing_) group->book(before, after);
}

void TransientRecorder::show_step(const system::State& state) {
  shown_ = state;
  balance_.find_shown_acceleration(shown_);
  row_.assign(1, state.t);
  for (const auto& group : groups_) group->append_since(state, shown_, row_);
  extremes_.take(row_);
  if (step_rows_) step_rows_->append(row_);
}

void TransientRecorder::record(const system::State& before, const system::State& now, bool is_balanced) {
  shown_ = now;
  if (!is_balanced) balance_.find_shown_acceleration(shown_);
  row_.assign(1, now.t);
  for (const auto& group : groups_) group->append_since(before, shown_, row_);
  rows_->append(row_);
  extremes_.take(row_);
  ++count_;
  if (!ledger_) return;
  row_.assign(1, now.t);
  const auto energy = ledger_->at(before, now);
  residue_->note(now.t, energy);
  row_.insert(row_.end(), energy.begin(), energy.end());
  energy_rows_->append(row_);
}

}  // namespace rubato::analysis
