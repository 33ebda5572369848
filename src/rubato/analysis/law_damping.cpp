#include <rubato/analysis/law_damping.hpp>
#include <rubato/integrate/equilibrium/easiest_motion.hpp>

#include <fmt/format.h>

#include <vector>

namespace rubato::analysis {
namespace {

/// The coordinates of the motion that a stiffness does not resist; empty where it resists all.
std::vector<Index> floating(const SparseMatrix& given) {
  SparseMatrix diagonal(given.rows(), given.cols());
  diagonal.setIdentity();
  const SparseMatrix stiffness = given + 0.0 * diagonal;  // all of its diagonal is there
  numerics::OrderedFactor factor;
  factor.analyse(stiffness);
  int factorisations = 0;
  std::vector<Index> moving;
  integrate::factorise_resisting(stiffness, numerics::Pivots::positive, factor, factorisations, moving);
  return moving;
}

}  // namespace

std::optional<std::string> warning_of_modal_damping(const StudyInput& input) {
  const system::LocallyNonlinear& system = input.system;
  if (input.mechanism || system.law_count() == 0 || system.size() == 0 ||
      !std::holds_alternative<model::ModalDamping>(input.study.model.damping))
    return std::nullopt;
  const std::vector<Index> moving = floating(system.stiffness());
  if (moving.empty() || !floating(system.free_stiffness()).empty()) return std::nullopt;
  return fmt::format(
      "damping: modal_ratio belongs to the modes of the structure without its laws, where nothing resists a motion of "
      "\"{}\"{}: that motion is not damped; give it a [[damper]], or write the elastic part of the law as a [[spring]]",
      system.coordinates()[static_cast<std::size_t>(moving.front())],
      moving.size() > 1 ? fmt::format(" and {} more", moving.size() - 1) : "");
}

}  // namespace rubato::analysis
