#pragma once

#include <rubato/model/model.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::system {

/// A load of a model by itself, before those of one frequency are joined: where it acts, and what it follows. Analyses
/// that vary parameters evaluate its law anew and keep the rest.
struct ModelLoad {
  LoadTerm term;
  int law = -1;        ///< its place among the laws of the model's loads (model::load_laws); -1: none, it is constant
  int derivative = 0;  ///< of what that law says, by which it acts: a support that moves pulls by damping (1), mass (2)
};

/// A system with its loads, each by itself.
struct AssembledModel {
  LocallyNonlinear system;
  std::vector<ModelLoad> loads;
};

/// The equations of a model, as assemble() makes them. Throws as that does.
AssembledModel assemble_with_loads(const model::Model& model);

}  // namespace rubato::system
