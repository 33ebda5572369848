#pragma once

#include <rubato/analysis/study_input.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <memory>
#include <string>

namespace rubato::testing {

/// A study and what an analysis of it needs; keeps everything alive.
struct PreparedStudy {
  model::StudyDescription study;
  numerics::Parameters overrides, parameters;
  system::LocallyNonlinear system;
  std::shared_ptr<const integrate::SystemKind> kind;  ///< of a copy of it

  explicit PreparedStudy(const std::string& text, const numerics::Parameters& settings = {})
      : study(io::read_study_text(text, "study.toml")),
        overrides(settings),
        parameters(model::evaluate_parameters(study.parameters, settings)),
        system(system::assemble(model::build(study.model, parameters, model::NegativeLoad::zero))),
        kind(integrate::StructureKind(system).for_thread()) {}
  analysis::StudyInput input() const { return {study, overrides, parameters, *kind}; }
};

}  // namespace rubato::testing
