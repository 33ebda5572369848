#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/model.hpp>

#include <string>
#include <vector>

// Private to the model floor: the part of build() that knows finite element models.
namespace rubato::model {

/// A finite element model behind the coordinates of a study, with what supports hold left out.
struct BuiltFiniteElements {
  Structure structure;                   ///< nodes with their places; no elements
  std::vector<std::string> coordinates;  ///< of the rows that are free [n]
  std::vector<char> is_rotation;         ///< [n]
  std::vector<std::string> fixed;        ///< names of degrees of freedom that are held, by the files or by a support
  /// Those without a row that may be held, and may as well follow others; empty unless the files leave it open.
  std::vector<std::string> doubtful;
  std::string doubt;      ///< why, for messages: what may be the case
  FullMatrices matrices;  ///< of the coordinates before and of these
};

/// Throws InvalidInput for parts of the study that do not go with such a model, and for faulty masses and supports.
/// @param before  masses of the coordinates before those of the nodes [kg]
BuiltFiniteElements build_finite_elements(const ModelDescription& description, const numerics::Parameters& parameters,
                                          const Vector& before);

}  // namespace rubato::model
