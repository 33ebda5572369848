#include <rubato/analysis/residue_watch.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::analysis {
namespace {

/// " ("wall", "latch")", of parts that changed their state in an interval.
std::string names_between(const integrate::Events& events, double from, double to) {
  std::vector<std::string> names;
  for (const integrate::Event& event : events.all) {
    const std::string name = fmt::format("\"{}\"", events.parts[event.part]);
    if (event.t >= from && event.t <= to && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  constexpr std::size_t most = 3;
  if (names.empty()) return "";
  const std::size_t shown = std::min(names.size(), most);
  return fmt::format(", where {} changed{}", fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                     names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

}  // namespace

ResidueWatch::ResidueWatch(std::vector<integrate::Account> accounts) : accounts_(std::move(accounts)) {}

void ResidueWatch::note(double t, std::span<const double> energies) {
  const bool is_first = start_.empty();
  if (is_first) start_.assign(energies.begin(), energies.end());
  constexpr double of_sums = 1e-10;
  double residue = energies.back();
  for (std::size_t i = 0; i < accounts_.size(); ++i) {
    // The zero of what is stored lies anywhere, but that of kinetic energy.
    const double zero = accounts_[i].name == "kinetic" ? 0.0 : start_[i];
    round_off_ = std::fmax(round_off_, of_sums * std::abs(energies[i]));
    if (accounts_[i].name == "stop_dissipated" && energies[i] < 0.0) {  // which no stop does: steps passed over it
      residue -= energies[i];
      continue;
    }
    largest_ = std::fmax(largest_, std::abs(energies[i] - zero));
    if (accounts_[i].kind != integrate::Account::Kind::stored) flow_ = std::fmax(flow_, std::abs(energies[i]));
  }
  if (!(std::abs(residue) <= std::abs(residue_))) {
    residue_ = residue;
    at_ = t;
  }
  if (!is_first && std::abs(residue - last_) > rise_) {
    rise_ = std::abs(residue - last_);
    rise_from_ = last_t_;
    rise_to_ = t;
  }
  last_ = residue;
  last_t_ = t;
}

std::string ResidueWatch::time_of_rise() const {
  const std::string from = fmt::format("{:.6g}", rise_from_), to = fmt::format("{:.6g}", rise_to_);
  return from == to ? fmt::format("at t = {} s", to) : fmt::format("from t = {} to {} s", from, to);
}

std::string ResidueWatch::warning(double share, double round_off, const integrate::Events& events,
                                  const std::string& remedy) const {
  if (!(std::abs(residue_) > std::max({share * largest_, round_off_, round_off}))) return "";
  const std::string most = rise_ > 0.5 * std::abs(residue_) ? fmt::format(", most of it {}{}", time_of_rise(),
                                                                          names_between(events, rise_from_, rise_to_))
                                                            : "";
  return fmt::format(
      "the method {} energy: {:.3g} J at t = {:.6g} s, {:.2g} % of the largest energy, {:.3g} J{} "
      "(column residue of the energy table); {}",
      residue_ > 0.0 ? "made" : "lost", std::abs(residue_), at_, 100.0 * std::abs(residue_) / largest_, largest_, most,
      remedy);
}

}  // namespace rubato::analysis
