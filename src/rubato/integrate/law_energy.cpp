#include <rubato/integrate/law_energy.hpp>

#include <algorithm>

namespace rubato::integrate {

double dissipated_by_law(const system::LocallyNonlinear& system, Index law, const system::State& before,
                         const system::State& after) {
  const Index memory = system.memory_of(law);
  return system.laws()[static_cast<std::size_t>(law)].law->dissipated(
      system.law_point(law, before, model::Side::right), before.memory.data() + memory,
      system.law_point(law, after, model::Side::left), after.memory.data() + memory);
}

double dissipated_by_block(const system::LocallyNonlinear& system, Index block, const system::State& before,
                           const system::State& after) {
  const Index memory = system.memory_of_block(block);
  return system.blocks()[static_cast<std::size_t>(block)].law->dissipated(
      system.block_point(block, before), before.memory.data() + memory, system.block_point(block, after),
      after.memory.data() + memory);
}

std::vector<Account> accounts_of_laws() {
  return {{Account::Kind::stored, "law_stored", "elastic energy of the laws"},
          {Account::Kind::dissipated, "law_dissipated", "dissipated by the laws since the start"}};
}

bool has_sliding_blocks(const system::LocallyNonlinear& system) {
  return std::any_of(system.blocks().begin(), system.blocks().end(),
                     [](const model::BlockBetween& block) { return block.law->sliding_velocity() != 0.0; });
}

std::vector<Account> LawEnergy::accounts() const {
  std::vector<Account> accounts = accounts_of_laws();
  if (slides_)
    accounts.push_back(
        {Account::Kind::work, "sliding_work", "work of what moves the contacts that slide since the start"});
  return accounts;
}

void LawEnergy::add_stored(const system::State& state, Entries row) {
  for (Index j = 0; j < system_.law_count(); ++j)
    row[0] += system_.laws()[static_cast<std::size_t>(j)].law->stored_energy(
        system_.relative_displacement(system_.first_law() + j, state.q), state.memory.data() + system_.memory_of(j));
  for (Index b = 0; b < system_.block_count(); ++b)
    row[0] += system_.blocks()[static_cast<std::size_t>(b)].law->stored_energy(
        system_.block_point(b, state).u, state.memory.data() + system_.memory_of_block(b));
}

void LawEnergy::add_flow(const system::State& before, const system::State& after, Entries row) {
  for (Index j = 0; j < system_.law_count(); ++j) row[1] += dissipated_by_law(system_, j, before, after);
  for (Index b = 0; b < system_.block_count(); ++b) row[1] += dissipated_by_block(system_, b, before, after);
  if (!slides_) return;
  for (Index b = 0; b < system_.block_count(); ++b) {
    const double velocity = system_.blocks()[static_cast<std::size_t>(b)].law->sliding_velocity();
    const Index along = system_.row_of_block(b);
    // As the work of loads is summed; the force as the step has it from one end to the other.
    row[2] += 0.5 * velocity * (after.t - before.t) * (before.slider_force[along] + after.slider_force[along]);
  }
}

}  // namespace rubato::integrate
