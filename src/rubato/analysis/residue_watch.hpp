#pragma once

#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/integrate/events.hpp>

#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Watches what a method makes or loses of the energy of a transient, from the rows of its ledger.
class ResidueWatch {
 public:
  explicit ResidueWatch(std::vector<integrate::Account> accounts);

  /// @param energies  of each account, then the residue [J]
  void note(double t, std::span<const double> energies);

  /// Whether nothing was dissipated and no load did work: what is stored says it all, however flows are summed.
  bool is_closed() const { return flow_ <= round_off_; }

  /// What is said of a residue that is larger than a share of the largest energy: when it came and from which parts.
  /// Empty where it is smaller.
  /// @param round_off  what says nothing [J]
  /// @param remedy     "take ..."
  std::string warning(double share, double round_off, const integrate::Events& events, const std::string& remedy) const;

 private:
  std::string time_of_rise() const;

  std::vector<integrate::Account> accounts_;
  std::vector<double> start_;
  double largest_ = 0.0;                                 // of what energies change by, and of kinetic energy [J]
  double flow_ = 0.0;                                    // the largest that was dissipated, or done by loads [J]
  double round_off_ = 0.0;                               // of sums of the energies themselves [J]
  double residue_ = 0.0, at_ = 0.0;                      // the largest, and when
  double last_ = 0.0, last_t_ = 0.0;                     // of the row before
  double rise_ = 0.0, rise_from_ = 0.0, rise_to_ = 0.0;  // the largest between two rows
};

}  // namespace rubato::analysis
