#pragma once

#include <rubato/core/error.hpp>
#include <rubato/model/fields/key.hpp>
#include <rubato/model/finite_elements/cyclic.hpp>
#include <rubato/model/finite_elements/reduction.hpp>

#include <string>

// The keys of a finite element model.
namespace rubato::model {

/// [model]: which files hold it.
struct FiniteElementFileDescription {
  struct MatrixFile {
    std::string file;
    std::string matrix;  ///< its name within the file, of files that hold several; or empty
    Location where, matrix_where;
  };
  MatrixFile stiffness, mass, damping;
  std::string mesh, rows;
  std::string format;  ///< of all matrices; empty: each by its content
  Location where, mesh_where, rows_where;
};

void fields(auto& visit, Like<FiniteElementFileDescription> auto& model) {
  visit.where(model.where);
  visit.text("mesh", model.mesh,
             {.says = "nodes, elements and node sets: an input deck of CalculiX or Abaqus (.inp), without parts"});
  visit.where(model.mesh_where, "mesh");
  visit.text("stiffness", model.stiffness.file, {.required = true, .unit = "N/m", .says = "file of the matrix"});
  visit.where(model.stiffness.where, "stiffness");
  visit.text("mass", model.mass.file, {.required = true, .unit = "kg", .says = "file of the matrix"});
  visit.where(model.mass.where, "mass");
  visit.text("damping", model.damping.file, {.unit = "N s/m", .says = "file of the matrix", .unless = "none"});
  visit.where(model.damping.where, "damping");
  visit.text("rows", model.rows,
             {.says = "what the rows are, of matrices whose files do not tell: CalculiX's .dof, or a table with the "
                      "columns row, node, direction (1 to 6; or x, y, z, rx, ry, rz) and perhaps x, y, z"});
  visit.where(model.rows_where, "rows");
  visit.word("format", model.format,
             {{"matrix_market", "matrix_market"},
              {"coordinate", "coordinate"},
              {"abaqus", "abaqus"},
              {"abaqus_substructure", "abaqus_substructure"},
              {"dmig", "dmig"},
              {"op4", "op4"}},
             {.says = "of the matrices", .unless = "by the content of each"});
  visit.text("stiffness_name", model.stiffness.matrix,
             {.says = "which matrix of a DMIG or OP4 file", .unless = "the one that begins with K"});
  visit.where(model.stiffness.matrix_where, "stiffness_name");
  visit.text("mass_name", model.mass.matrix,
             {.says = "which matrix of a DMIG or OP4 file", .unless = "the one that begins with M"});
  visit.where(model.mass.matrix_where, "mass_name");
  visit.text("damping_name", model.damping.matrix,
             {.says = "which matrix of a DMIG or OP4 file", .unless = "the one that begins with B"});
  visit.where(model.damping.matrix_where, "damping_name");
}

void fields(auto& visit, Like<CyclicDescription> auto& cyclic) {
  visit.where(cyclic.where);
  visit.whole("sectors", cyclic.sectors, 0, {2, 10000, "from 2 to 10000"},
              {.required = true, .says = "N: sector j+1 is sector j turned by 2 pi/N about the axis"});
  visit.where(cyclic.sectors_where, "sectors");
  visit.quantities("axis", cyclic.axis, {.least = 3, .most = 3},
                   {.required = true, .says = "along which the disk turns"});
  visit.where(cyclic.axis_where, "axis");
  visit.quantities("origin", cyclic.origin, {.least = 3, .most = 3},
                   {.unit = "m", .says = "a point of the axis", .unless = "[0, 0, 0]"});
  visit.where(cyclic.origin_where, "origin");
  visit.text("left", cyclic.left, {.required = true, .says = "node set of one side, joined to the next sector"});
  visit.where(cyclic.left_where, "left");
  visit.text("right", cyclic.right, {.required = true, .says = "node set of the other side"});
  visit.where(cyclic.right_where, "right");
}

void fields(auto& visit, Like<ReductionDescription> auto& reduction) {
  constexpr long most_modes = 100000;
  visit.where(reduction.where);
  visit.word("method", reduction.method,
             {{"craig_bampton", ReductionMethod::craig_bampton},
              {"rubin", ReductionMethod::rubin},
              {"none", ReductionMethod::none}},
             {.says = "modes with the interface held, or free modes, each beside the statics of the interface; or all "
                      "degrees of freedom",
              .unless = "craig_bampton"});
  visit.whole("modes", reduction.modes, {0, most_modes, "from 0 to 100000"}, {.says = "how many are kept"});
  visit.where(reduction.modes_where, "modes");
  visit.quantity("error", reduction.error,
                 {.says = "of the frequencies wanted, over the frequency: so many modes are kept that estimates are "
                          "not larger; a number",
                  .unless = "1e-4 where `modes` is not given",
                  .range = Range::positive});
  visit.whole(
      "frequencies", reduction.frequencies, 6, {1, 1000, "from 1 to 1000"},
      {.says = "which the error is of: the lowest so many, without sliders and with stuck ones", .unless = "6"});
  visit.names("keep", reduction.keep, &reduction.keep_where, {},
              {.says = "nodes, node sets and degrees of freedom that stay as they are, besides those that parts of the "
                       "model and `observe` name"});
  visit.excludes("modes", "error");
  visit.check([&](auto& reader) {
    if (reduction.modes && reduction.error)
      throw InvalidInput(reduction.error->where, reader.what() +
                                                     ": modes and error both say how many modes are kept; "
                                                     "give one of them");
    if (reduction.modes && !(*reduction.modes >= 0 && *reduction.modes <= most_modes))
      throw InvalidInput(reduction.modes_where,
                         reader.what() + ": modes must be from 0 to 100000, got " + std::to_string(*reduction.modes));
    if (reduction.error && !reduction.error->expression.empty())
      throw InvalidInput(
          reduction.error->where,
          reader.what() + ": error takes a number: the size of the model must not change with parameters");
    if (reduction.error && !(reduction.error->value > 0.0 && reduction.error->value < 1.0))
      throw InvalidInput(reduction.error->where, reader.what() + ": error must lie between 0 and 1");
  });
}

}  // namespace rubato::model
