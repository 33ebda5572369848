#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/events.hpp>
#include <rubato/integrate/mechanism/law_guards.hpp>

#include <vector>

namespace rubato::integrate {

/// The laws of friction and the contacts of a mechanism that change in a march: they slip, stick, open and close. What
/// steps end at is told at that time, all else at the ends of steps.
class MechanismLawEvents final : public Observer {
 public:
  /// @param equations  lent; wherever they are left is well
  /// @param located    of a march whose steps end where laws change; null: of one that passes that
  /// @param touches    likewise of contacts
  MechanismLawEvents(system::MechanismEquations& equations, const system::State& start, LawGuards* located,
                     LawGuards* touches);

  bool accepted(const system::State& before, const system::State& after) override;
  /// Adds what happened to what else did.
  void add_to(Events& events) const;

 private:
  struct Watched {
    Index law = 0;  // or contact
    model::Law::Contact branch = model::Law::Contact::none;
  };
  void note(std::size_t part, model::Law::Contact now, double t);

  system::MechanismEquations& equations_;
  LawGuards *located_, *touches_;
  std::vector<Watched> watched_, contacts_;
  Events events_;
};

}  // namespace rubato::integrate
