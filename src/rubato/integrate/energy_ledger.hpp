#pragma once

#include <rubato/system/state.hpp>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rubato::integrate {

/// A column of the energy ledger [J].
struct Account {
  enum class Kind {
    stored,      ///< in a state
    dissipated,  ///< since the start
    work         ///< done on the system since the start
  };
  Kind kind = Kind::stored;
  std::string name, description;
};

/// The accounts of one part of a system in a row of the ledger, by their place in EnergyPart::accounts().
class Entries {
 public:
  Entries(double* row, const std::size_t* columns) : row_(row), columns_(columns) {}
  double& operator[](std::size_t account) const { return row_[columns_[account]]; }

 private:
  double* row_;
  const std::size_t* columns_;
};

/// What a part of a system (its matrices, one kind of its laws, its supports) stores and dissipates, and the work that
/// it does. A workspace: one a march.
class EnergyPart {
 public:
  virtual ~EnergyPart() = default;

  /// Its columns. One that a part before it has too, by the same name, belongs to both.
  virtual std::vector<Account> accounts() const = 0;
  /// A march begins.
  virtual void start(const system::State& /*state*/) {}
  /// Adds what is stored in a state.
  virtual void add_stored(const system::State& state, Entries row) = 0;
  /// Adds what a step dissipates and what is done in it, and between it and the step that was kept last.
  virtual void add_flow(const system::State& before, const system::State& after, Entries row) = 0;
  /// The step that ends there is booked: add_flow() goes on from it.
  virtual void keep(const system::State& /*after*/) {}
};

/// Where the energy of a system is and where it went since the start of a run: the sums of what its parts book.
class EnergyLedger {
 public:
  explicit EnergyLedger(std::vector<std::unique_ptr<EnergyPart>> parts);

  /// What is stored, then what was dissipated, then works; of each kind in the order of the parts.
  const std::vector<Account>& accounts() const { return accounts_; }

  void start(const system::State& state);
  /// Adds a step to the sums.
  void add_step(const system::State& before, const system::State& after);
  /// The values of the accounts at `now`, which lies in the step after `before`, the last state booked; then the
  /// residue, what the method itself made: it closes the balance. Books nothing. `now` may be `before`. Valid until
  /// the next call.
  std::span<const double> at(const system::State& before, const system::State& now);

 private:
  struct Part {
    std::unique_ptr<EnergyPart> of;
    std::vector<std::size_t> columns;  // of its accounts
  };
  void find_flow(const system::State& before, const system::State& after);
  void find_stored(const system::State& state);

  std::vector<Part> parts_;
  std::vector<Account> accounts_;
  std::vector<double> sums_, flow_, row_;
  double start_ = 0.0;  // stored then
};

}  // namespace rubato::integrate
