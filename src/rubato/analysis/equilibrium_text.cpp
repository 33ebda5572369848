#include <rubato/analysis/equilibrium_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rubato::analysis {
namespace {

constexpr std::size_t most_names = 6;

/// '"a", "b" and 3 more'
std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most_names); ++i)
    list += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", names[i]);
  if (names.size() > most_names) list += fmt::format(" and {} more", names.size() - most_names);
  return list;
}

std::string not_converged(const integrate::Equilibrium& equilibrium) {
  const std::string left = equilibrium.worst.empty()
                               ? std::string()
                               : fmt::format(": {:.4g} {} is left on \"{}\"", equilibrium.residual,
                                             equilibrium.turns_worst ? "N m" : "N", equilibrium.worst);
  return fmt::format(
      "no equilibrium was found in {} iterations{}{}; look for a motion that nothing resists, or begin nearer to it",
      equilibrium.iterations, left,
      equilibrium.reached > 0.0
          ? fmt::format(" where the loads, raised by steps, pass {:.4g} of what is given", equilibrium.reached)
          : "");
}

std::string reason(const integrate::Equilibrium& equilibrium) {
  using integrate::EquilibriumOutcome;
  switch (equilibrium.outcome) {
    case EquilibriumOutcome::found:
      break;
    case EquilibriumOutcome::not_finite:
      return "the equilibrium is not finite; look at the loads at t = 0";
    case EquilibriumOutcome::floats:
      return fmt::format(
          "the structure is a mechanism: nothing resists a motion of {}; support it, join it, or hold a displacement",
          list_of(equilibrium.moving));
    case EquilibriumOutcome::gives_way:
      return fmt::format(
          "there is no equilibrium: where \"{}\" slip nothing else resists a motion of {}; lower the load, or support "
          "it",
          fmt::join(equilibrium.changing, "\", \""), list_of(equilibrium.moving));
    case EquilibriumOutcome::gives_way_on_the_way:
      if (equilibrium.reached == 0.0)
        return "no equilibrium was found that loads grown from zero lead to, not even under the smallest share of "
               "them; "
               "lower a friction_coefficient, give contacts a small gap or normal_load, or let a transient with "
               "damping "
               "find where it goes";
      return fmt::format(
          "there is no equilibrium that loads grown from zero lead to: at {:.4g} of them nothing resists a motion of "
          "{}; lower the loads, support it, or let a transient with damping find where it goes",
          equilibrium.reached, list_of(equilibrium.moving));
    case EquilibriumOutcome::contacts_unsettled:
      return "no equilibrium was found: which sliders slip and which stops are closed did not settle";
    case EquilibriumOutcome::lock_unsettled:
      return fmt::format(
          "no equilibrium was found: whether the lock of \"{}\" holds did not settle; let a transient come to rest "
          "there",
          fmt::join(equilibrium.changing, "\", \""));
    case EquilibriumOutcome::not_converged:
      return not_converged(equilibrium);
  }
  return {};
}

}  // namespace

std::string complaint(const integrate::Equilibrium& equilibrium) {
  const std::string told = reason(equilibrium);
  if (told.empty() || !equilibrium.leaves_out_friction) return told;
  return told + "; equilibria leave out the friction of joints, which this model has: let a transient come to rest";
}

bool is_certain(const integrate::Equilibrium& equilibrium) {
  using integrate::EquilibriumOutcome;
  return equilibrium.outcome == EquilibriumOutcome::not_finite || equilibrium.outcome == EquilibriumOutcome::floats ||
         equilibrium.outcome == EquilibriumOutcome::gives_way;
}

std::string warning_of_rounding(const integrate::Equilibrium& found) {
  constexpr double told = 1e-3;
  if (!(found.rounding > told)) return {};
  return fmt::format(
      "displacements may err by {:.2g} of the largest: the stiffness of elements that are so short beside the whole is "
      "known to the rounding of its entries only; take fewer, longer elements",
      found.rounding);
}

}  // namespace rubato::analysis
