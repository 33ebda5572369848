#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/time_law.hpp>

#include <string>
#include <vector>

namespace rubato::model {

/// The law of time of a load of a description.
struct LoadLaw {
  const TimeLawDescription* law = nullptr;  ///< lives in the description
  int derivative = 0;  ///< of the law, by which the load acts: 2 for the ground where its displacement is given
  std::string part;    ///< "the force on \"tip\"", for messages
  Location where;
};

/// The laws of all loads, in the order in which a model built from the description has these loads: forces, distributed
/// forces, the motion of the ground, coordinates that move. Whoever wants to know what may load a model asks here.
/// Gravity has no law (it is constant), nor has what is held in static states only.
std::vector<LoadLaw> load_laws(const ModelDescription& description);

/// Which derivative of what is given of the ground its acceleration is.
int acceleration_order(BaseMotionDescription::Of of);

/// The derivative of a harmonic law with respect to t.
/// @param order  0, 1 or 2
HarmonicLaw derivative(const HarmonicLaw& law, int order);

/// Whether a formula of t is the same at all times, and so a static load. Throws nothing: a faulty formula is not.
bool is_constant(const TimeFormulaDescription& formula, const numerics::Parameters& parameters);

}  // namespace rubato::model
