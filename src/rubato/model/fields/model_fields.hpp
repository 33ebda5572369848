#pragma once

#include <rubato/model/fields/finite_element_fields.hpp>
#include <rubato/model/fields/law_fields.hpp>
#include <rubato/model/fields/load_fields.hpp>
#include <rubato/model/fields/mechanism_fields.hpp>
#include <rubato/model/fields/structure_fields.hpp>

// The tables of a model, each once: a visitor that reads, describes or walks them needs nothing else.
namespace rubato::model {

void fields(auto& visit, Like<ModelDescription> auto& model) {
  visit.where(model.where);
  visit.tables("coordinate", model.coordinates, "a mass that moves along one direction");
  visit.table("matrices", model.matrices, {.says = "full matrices instead of coordinates, springs and dampers"});
  visit.template rows<FiniteElementFileDescription>("model", model.finite_elements,
                                                    "a finite element model from the files of another program");
  visit.template rows<ReductionDescription>("reduction", model.finite_elements,
                                            "what is made of [model]: the degrees of freedom that the study names, and "
                                            "a few modes of the rest");
  visit.template rows<CyclicDescription>("cyclic", model.finite_elements, "[model] is one of equal sectors of a disk");
  visit.tables("spring", model.springs, "a linear spring between two coordinates, or one and the ground");
  visit.tables("damper", model.dampers, "a dashpot between two coordinates, or one and the ground");
  visit.table("damping", model.damping, {.says = "added to the dashpots; not beside a damping matrix"});
  visit.tables("slider", model.sliders, "Jenkins elements: a spring in series with a Coulomb limit");
  visit.tables("stop", model.stops, "one-sided stops: force max(0, k (u - gap) + c du/dt) while u > gap");
  for (const LawKind& kind : law_kinds())
    visit.tables_like(kind.table, model.laws, law_description(kind), kind.meaning);
  visit.tables("contact", model.contacts,
               "friction along a plane, |T| <= mu N, under a spring across it that only pushes, N >= 0");
  visit.held_or_moving("force", "held", model.held_forces, Held::force, model.forces,
                       "a load on a coordinate: harmonic, a formula of t, or a table; or held in static states");
  visit.tables("distributed_force", model.distributed_forces, "an even force per length along a beam or truss");
  visit.held_or_moving("displacement", "value", model.displacements, Held::displacement, model.prescribed,
                       "a displacement that is held in static states and then released, or that moves by a law of t");
  visit.table("base_motion", model.base_motion, {.says = "the ground moves; coordinates are relative to it"});
  visit.tables("node", model.structure.nodes, "a point that beams, trusses, masses and supports name");
  visit.tables("material", model.structure.materials, "what elements are made of");
  visit.tables("section", model.structure.sections, "the cross-section of elements");
  visit.tables("beam", model.structure.beams, "a straight beam between two nodes");
  visit.tables("truss", model.structure.trusses, "a straight bar between two nodes that resists stretching only");
  visit.template rows<NodeFileDescription>("nodes", model.structure, "nodes from a file, added to [[node]]");
  visit.template rows<BeamFileDescription>("beams", model.structure, "beams from a file, added to [[beam]]");
  visit.tables("mass", model.structure.masses, "a point mass, an inertia, or both on a node");
  visit.tables("support", model.structure.supports, "holds degrees of freedom of a node");
  visit.table("gravity", model.gravity, {.says = "acts on elements and masses of nodes"});
  visit.tables("body", model.bodies, "a rigid body; makes the model a mechanism");
  visit.tables("joint", model.joints, "joins two nodes or bodies, or one and the ground; makes the model a mechanism");
  visit.tables("gear", model.gears, "a ratio between the angles or displacements of two joints");
  visit.tables("bushing", model.bushings,
               "stiffness and damping in all directions between two bodies, or one and the ground; makes the model a "
               "mechanism");
  visit.excludes("coordinate", "matrices");
  visit.excludes("model", "matrices");
  visit.requires_beside("reduction", "model");
  visit.requires_beside("cyclic", "model");
  visit.some_of({"coordinate", "matrices", "model", "node", "nodes", "body"});
}

}  // namespace rubato::model
