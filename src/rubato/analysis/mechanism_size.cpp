#include <rubato/analysis/mechanism_size.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>

namespace rubato::analysis {

MechanismSize size_of(const system::Mechanism& mechanism) {
  const model::Mechanism& model = mechanism.model();
  const auto rows = [&](int joint) { return joint < 0 ? 0 : model.joints[static_cast<std::size_t>(joint)]->rows(); };
  MechanismSize size;
  size.coordinates = mechanism.size();
  size.constraints = mechanism.constraint_count();
  for (const auto& lock : model.locks) size.constraints -= rows(lock.joint);
  for (const auto& friction : model.frictions) size.constraints -= rows(friction.sticking_joint);
  for (const auto& drive : model.drives) size.drives += rows(drive.joint);
  const auto equations = mechanism.equations();
  size.redundant = static_cast<Index>(integrate::make_consistent(*equations, mechanism.start()).redundant.size());
  return size;
}

}  // namespace rubato::analysis
