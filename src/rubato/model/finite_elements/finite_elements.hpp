#pragma once

#include <rubato/core/error.hpp>
#include <rubato/core/types.hpp>

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// A finite element model as another program wrote it: matrices, what their rows are, and the mesh. io/finite_elements
// reads the files; join_finite_elements() checks that they belong together.
namespace rubato::model {

/// What a row of a matrix is: a direction of a node (1 x, 2 y, 3 z, 4 to 6 the rotations about them), or, with the
/// direction 0, a generalized coordinate of that number.
struct RowLabel {
  std::int64_t node = 0;
  int direction = 0;

  auto operator<=>(const RowLabel&) const = default;
};

/// `305.x`; of a generalized coordinate `305`.
std::string name_of(const RowLabel& row);

/// A symmetric matrix of a file.
struct FiniteElementMatrix {
  std::string file;
  Location where;                ///< of its key in the study
  std::string format;            ///< "CalculiX"
  std::vector<RowLabel> labels;  ///< of its rows [n]; empty where the file does not name them
  SparseMatrix values;           ///< [n x n], both triangles, symmetric to the last bit
  double asymmetry = 0.0;        ///< largest difference of mirrored entries over sqrt(a_ii a_jj) [-]
  int digits = 16;               ///< with which the file gives its entries, at most
  std::int64_t given = 0;        ///< entries of the file, zeros among them
  std::int64_t zeros = 0;        ///< of those

  // Matrices of Eigen are copied where they could be moved, and these are large.
  FiniteElementMatrix() = default;
  FiniteElementMatrix(const FiniteElementMatrix&) = default;
  FiniteElementMatrix& operator=(const FiniteElementMatrix&) = default;
  FiniteElementMatrix(FiniteElementMatrix&& other) noexcept { swap(other); }
  FiniteElementMatrix& operator=(FiniteElementMatrix&& other) noexcept {
    swap(other);
    return *this;
  }
  ~FiniteElementMatrix() = default;
  void swap(FiniteElementMatrix& other) noexcept {
    std::swap(file, other.file);
    std::swap(where, other.where);
    std::swap(format, other.format);
    std::swap(labels, other.labels);
    values.swap(other.values);
    std::swap(asymmetry, other.asymmetry);
    std::swap(digits, other.digits);
    std::swap(given, other.given);
    std::swap(zeros, other.zeros);
  }
};

/// A list of rows from a file of its own.
struct RowTable {
  std::string file;
  Location where;
  std::vector<RowLabel> labels;
  std::vector<std::array<double, 3>> positions;  ///< of the node of each row [m]; empty where the file has none
};

struct MeshElement {
  std::int64_t number = 0;
  std::string type;       ///< "C3D20"
  std::size_t first = 0;  ///< of its nodes in Mesh::element_nodes
  std::size_t count = 0;  ///< of its nodes
};

/// Nodes that a mesh gives a name.
struct NodeSet {
  std::string name;
  std::vector<std::int64_t> nodes;  ///< numbers in the order of the file, each once
};

/// A material as the mesh file has it, in its units.
struct MeshMaterial {
  std::string name;
  std::optional<double> young, density;
  Location where;
};

struct Mesh {
  std::string file;
  Location where;                                ///< of its key in the study
  std::vector<std::int64_t> nodes;               ///< numbers, rising [p]
  std::vector<std::array<double, 3>> positions;  ///< [p] [m]
  std::vector<MeshElement> elements;
  std::vector<std::size_t> element_nodes;  ///< places among the nodes, element by element
  std::vector<NodeSet> sets;
  std::vector<MeshMaterial> materials;
  /// The first keyword that ties nodes to others, so that the matrices lack rows of nodes that move; empty: none does.
  std::string tie;
  Location tie_where;

  /// The place of a node; nothing where the mesh does not have it.
  std::optional<std::size_t> place_of(std::int64_t node) const;
};

/// What the files of [model] hold.
struct FiniteElementFiles {
  FiniteElementMatrix stiffness, mass;
  std::optional<FiniteElementMatrix> damping;
  std::optional<RowTable> rows;
  std::optional<Mesh> mesh;
  Location where;
};

/// What the matrices have of a direction of a node.
enum class Freedom : char {
  absent,        ///< no row, and the elements of the node know no such motion
  free,          ///< a row
  held,          ///< no row, though an element of the node moves so
  held_in_files  ///< held by a large entry on the diagonal: its share of the mass is known
};
inline bool is_held(Freedom freedom) { return freedom == Freedom::held || freedom == Freedom::held_in_files; }

struct ReductionDescription;
struct CyclicDescription;

/// A finite element model whose parts belong together: all matrices have the same rows.
struct FiniteElements {
  FiniteElementMatrix stiffness, mass;
  std::optional<FiniteElementMatrix> damping;
  std::vector<RowLabel> rows;                    ///< [n]
  std::vector<std::int64_t> nodes;               ///< of the rows, and those that are held; rising [p]
  std::vector<std::array<double, 3>> positions;  ///< [p] [m]; empty where no file tells them
  std::vector<std::array<Index, 6>> places;      ///< row of each direction of a node, or `ground` [p]
  std::vector<char> is_held;                     ///< whether an element of the mesh has the node and no row does [p]
  std::vector<std::array<Freedom, 6>> freedoms;  ///< of each direction of a node [p]
  Matrix mass_of_held;  ///< what a unit motion of what a large diagonal holds along x, y, z costs each row [n x 3] [kg]
  std::optional<Mesh> mesh;
  std::vector<std::string> notes;                         ///< what was concluded from the files, for people
  std::shared_ptr<const ReductionDescription> reduction;  ///< null: none
  std::shared_ptr<const CyclicDescription> cyclic;        ///< null: it is the whole structure
  Location where;
};

/// Gives all matrices the rows of the stiffness matrix. Throws InvalidInput where the sizes differ, where a row has no
/// name, is named twice or belongs to a node that the mesh does not have, and where a row has no positive mass.
FiniteElements join_finite_elements(FiniteElementFiles files);

}  // namespace rubato::model
