#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

namespace rubato::integrate {

std::unique_ptr<const SystemKind> assemble_kind(const model::ModelDescription& model,
                                                const numerics::Parameters& parameters) {
  if (model::is_mechanism(model))
    return std::make_unique<MechanismKind>(
        std::make_unique<const system::Mechanism>(model::build_mechanism(model, parameters)));
  return std::make_unique<StructureKind>(
      std::make_unique<const system::LocallyNonlinear>(system::assemble(model::build(model, parameters))));
}

}  // namespace rubato::integrate
