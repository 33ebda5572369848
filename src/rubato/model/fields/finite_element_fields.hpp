#pragma once

#include <rubato/core/error.hpp>
#include <rubato/model/fields/key.hpp>

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

}  // namespace rubato::model
