#include <rubato/integrate/energy_ledger.hpp>

#include <algorithm>
#include <utility>

namespace rubato::integrate {

EnergyLedger::EnergyLedger(std::vector<std::unique_ptr<EnergyPart>> parts) {
  const auto is_of = [](const std::string& name) {
    return [&](const Account& account) { return account.name == name; };
  };
  for (auto& part : parts) {
    for (const Account& account : part->accounts())
      if (std::none_of(accounts_.begin(), accounts_.end(), is_of(account.name))) accounts_.push_back(account);
    parts_.push_back({std::move(part), {}});
  }
  std::stable_sort(accounts_.begin(), accounts_.end(),
                   [](const Account& a, const Account& b) { return a.kind < b.kind; });
  for (Part& part : parts_)
    for (const Account& account : part.of->accounts())
      part.columns.push_back(static_cast<std::size_t>(
          std::find_if(accounts_.begin(), accounts_.end(), is_of(account.name)) - accounts_.begin()));
  sums_.assign(accounts_.size(), 0.0);
  flow_ = sums_;
  row_.assign(accounts_.size() + 1, 0.0);
}

void EnergyLedger::find_stored(const system::State& state) {
  std::fill(row_.begin(), row_.end(), 0.0);
  for (Part& part : parts_) part.of->add_stored(state, {row_.data(), part.columns.data()});
}

void EnergyLedger::find_flow(const system::State& before, const system::State& after) {
  std::fill(flow_.begin(), flow_.end(), 0.0);
  for (Part& part : parts_) part.of->add_flow(before, after, {flow_.data(), part.columns.data()});
}

void EnergyLedger::start(const system::State& state) {
  for (Part& part : parts_) part.of->start(state);
  std::fill(sums_.begin(), sums_.end(), 0.0);
  find_stored(state);
  start_ = 0.0;
  for (const double stored : row_) start_ += stored;
}

void EnergyLedger::add_step(const system::State& before, const system::State& after) {
  find_flow(before, after);
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += flow_[i];
  for (Part& part : parts_) part.of->keep(after);
}

std::span<const double> EnergyLedger::at(const system::State& before, const system::State& now) {
  if (&before == &now)
    std::fill(flow_.begin(), flow_.end(), 0.0);
  else
    find_flow(before, now);
  find_stored(now);
  double& residue = row_.back();
  for (std::size_t i = 0; i < accounts_.size(); ++i) {
    const Account::Kind kind = accounts_[i].kind;
    if (kind != Account::Kind::stored) row_[i] = sums_[i] + flow_[i];
    residue += kind == Account::Kind::work ? -row_[i] : row_[i];
  }
  residue -= start_;
  return row_;
}

}  // namespace rubato::integrate
