#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/model.hpp>
#include <rubato/model/places.hpp>

#include <string>

// Private to the model floor: the parts of build().
namespace rubato::model {

/// @param part  "the force on \"blade1\"", for messages
TimeLaw build_time_law(const TimeLawDescription& description, const numerics::Parameters& parameters,
                       const std::string& part);

/// A formula that says where something is. Throws InvalidInput where that has no finite value, rate and second rate at
/// t = 0.
/// @param part  "the displacement of \"base.y\""
numerics::Formula build_motion(const TimeFormulaDescription& description, const numerics::Parameters& parameters,
                               const std::string& part);
/// A table likewise, without jumps. Throws InvalidInput.
TableLaw build_motion(const TableDescription& description, const numerics::Parameters& parameters,
                      const std::string& part, const Location& where);

/// The motion of a coordinate with its derivatives.
Prescribed build_prescribed(const PrescribedDescription& description, Index coordinate,
                            const numerics::Parameters& parameters);

/// The name of a slider, stop or law in whose u a coordinate is; empty: none.
std::string contact_at(const Model& model, Index coordinate);

/// Whether the reaction of the joint on which a slider acts presses on it: normal_load = "reaction".
inline bool follows_own_reaction(const SliderDescription& slider) {
  return slider.normal_load.expression == "reaction";
}

/// What presses on a slider whose load is a formula of t. Throws InvalidInput.
/// @param part  "slider \"s1\""
NormalForce build_normal_formula(const SliderDescription& description, const numerics::Parameters& parameters,
                                 const std::string& part);

/// What presses on a slider whose load does not stay the same, among the stops and laws of a model that has all of
/// them. Throws InvalidInput.
/// @param all   names the sliders and contacts, which cannot press
/// @param part  "slider \"s1\""
NormalForce build_normal_force(const SliderDescription& description, const ModelDescription& all, const Model& model,
                               const numerics::Parameters& parameters, const std::string& part);

/// Adds sliders, stops, laws and contacts to a model that has all of its coordinates. Throws InvalidInput.
void build_laws(const ModelDescription& description, const numerics::Parameters& parameters, NegativeLoad negative_load,
                const Places& places, Model& model);

/// A contact as a law of several numbers. Throws InvalidInput.
BlockBetween build_contact(const ContactDescription& description, const Model& model, const Places& places,
                           const numerics::Parameters& parameters);

/// @param n  coordinates of the model
Damping build_damping(const DampingDescription& description, Index n, const numerics::Parameters& parameters);
/// Where damping is described; of no damping, nowhere.
Location where_of(const DampingDescription& description);

/// Throws InvalidInput where beams, masses or supports have no node to act on: a study without nodes would pass them
/// over.
void refuse_parts_without_nodes(const ModelDescription& description);

/// Throws InvalidInput for a mass matrix with a diagonal entry that is missing or not positive.
void require_masses(const MatricesDescription& matrices);
/// The matrices, symmetric to the last bit. Throws InvalidInput where their sizes differ.
FullMatrices build_matrices(const MatricesDescription& matrices);

/// The value of a quantity. Throws InvalidInput, with `what` and the remedy, where it is negative.
double at_least_zero(const Quantity& quantity, const numerics::Parameters& parameters, const std::string& what,
                     const std::string& remedy = "");

}  // namespace rubato::model
