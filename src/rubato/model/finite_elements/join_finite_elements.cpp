#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/finite_elements/freedoms.hpp>
#include <rubato/model/structure.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace rubato::model {
namespace {

// Diagonal entries with which programs hold a row in place: Abaqus writes 1e36.
constexpr double held_by_penalty = 1e35;

/// Which file tells the rows of a matrix.
const std::string& source_of(const FiniteElementMatrix& matrix, const FiniteElementFiles& files) {
  return matrix.labels.empty() && files.rows ? files.rows->file : matrix.file;
}

/// Joins the parts of a model.
class Joiner {
 public:
  explicit Joiner(FiniteElementFiles files) : files_(std::move(files)) {}

  FiniteElements join() {
    take_rows();
    match(files_.mass, "mass");
    if (files_.damping) match(*files_.damping, "damping");
    drop_held();
    require_unique_rows();
    place_nodes();
    require_diagonal(files_.stiffness, "stiffness",
                     "a row without stiffness; is the file cut off, or of another model?");
    require_diagonal(files_.mass, "mass",
                     "a mass of zero, which makes the mass matrix singular; give its part a density, or leave out the "
                     "elements without one");
    built_.stiffness = std::move(files_.stiffness);
    built_.mass = std::move(files_.mass);
    built_.damping = std::move(files_.damping);
    built_.mesh = std::move(files_.mesh);
    built_.rows = std::move(rows_);
    built_.where = files_.where;
    built_.freedoms = freedoms_of(built_, held_in_files_);
    return std::move(built_);
  }

 private:
  /// The rows of the stiffness matrix: as its file names them, as the table does, or three of each node of the mesh.
  void take_rows() {
    const FiniteElementMatrix& k = files_.stiffness;
    const auto n = static_cast<std::size_t>(k.values.rows());
    if (!k.labels.empty()) {
      rows_ = k.labels;
      return;
    }
    if (files_.rows) {
      rows_ = files_.rows->labels;
      if (rows_.size() != n)
        throw InvalidInput(k.where, fmt::format("\"{}\" has {} rows, and \"{}\" names {}; they are not of one export, "
                                                "or a file is cut off",
                                                k.file, n, files_.rows->file, rows_.size()));
      return;
    }
    if (!files_.mesh)
      throw InvalidInput(files_.where, fmt::format("[model]: \"{}\" does not tell what its rows are; give rows = "
                                                   "\"...\": the .dof file of CalculiX, or a table with the columns "
                                                   "row, node, direction",
                                                   k.file));
    if (!files_.mass.labels.empty()) refuse_mixed_names(k, files_.mass);
    const auto& nodes = files_.mesh->nodes;
    if (3 * nodes.size() != n)
      throw InvalidInput(files_.where,
                         fmt::format("[model]: \"{}\" does not tell what its {} rows are, and three of each of the {} "
                                     "nodes of the mesh are {}; give rows = \"...\": the .dof file of CalculiX, or a "
                                     "table with the columns row, node, direction",
                                     k.file, n, nodes.size(), 3 * nodes.size()));
    for (const std::int64_t node : nodes)
      for (int direction = 1; direction <= 3; ++direction) rows_.push_back({node, direction});
    built_.notes.push_back(
        fmt::format("no file names the rows: they are taken as x, y, z of the {} nodes of the mesh, "
                    "by rising number",
                    nodes.size()));
  }

  /// Gives a matrix the rows of the stiffness matrix.
  void match(FiniteElementMatrix& matrix, const char* kind) {
    const FiniteElementMatrix& k = files_.stiffness;
    const auto n = static_cast<Index>(rows_.size());
    if (matrix.labels.empty()) {
      if (!k.labels.empty() && !files_.rows) refuse_mixed_names(matrix, k);
      // A table's rows are those of every matrix that names none.
      const std::vector<RowLabel>& rows = files_.rows ? files_.rows->labels : rows_;
      if (matrix.values.rows() != static_cast<Index>(rows.size()))
        throw InvalidInput(matrix.where,
                           fmt::format("the {} matrix \"{}\" has {} rows, and \"{}\" has {}; they are not of one "
                                       "export, or a file is cut off",
                                       kind, matrix.file, matrix.values.rows(), source_of(k, files_), rows.size()));
      matrix.labels = rows;
    }
    if (matrix.labels == rows_) return;
    std::vector<RowLabel> mine = matrix.labels, other = rows_;
    std::sort(mine.begin(), mine.end());
    std::sort(other.begin(), other.end());
    const bool may_lack_rows = &matrix != &files_.mass;
    if (may_lack_rows && mine != other && std::includes(other.begin(), other.end(), mine.begin(), mine.end())) {
      widen(matrix);
      return;
    }
    if (mine != other) {
      std::vector<RowLabel> missing, more;
      std::set_difference(other.begin(), other.end(), mine.begin(), mine.end(), std::back_inserter(missing));
      std::set_difference(mine.begin(), mine.end(), other.begin(), other.end(), std::back_inserter(more));
      const bool lacks = !missing.empty();
      const std::size_t count = lacks ? missing.size() : more.size();
      throw InvalidInput(matrix.where,
                         fmt::format("the {} matrix \"{}\" {} {} row{} {} \"{}\" {}, the first {}; they are not of one "
                                     "export, or a file is cut off",
                                     kind, matrix.file, lacks ? "lacks" : "has", count, count == 1 ? "" : "s",
                                     lacks ? "that" : "which", source_of(k, files_), lacks ? "has" : "lacks",
                                     name_of(lacks ? missing.front() : more.front())));
    }
    // Row i of the stiffness matrix is row order[i] of this one.
    std::vector<int> place(static_cast<std::size_t>(n)), by_label(static_cast<std::size_t>(n));
    std::iota(place.begin(), place.end(), 0);
    by_label = place;
    const auto sort_by = [](std::vector<int>& indices, const std::vector<RowLabel>& labels) {
      std::sort(indices.begin(), indices.end(), [&](int a, int b) {
        return labels[static_cast<std::size_t>(a)] < labels[static_cast<std::size_t>(b)];
      });
    };
    sort_by(place, matrix.labels);
    sort_by(by_label, rows_);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n);
    for (std::size_t i = 0; i < place.size(); ++i) permutation.indices()[place[i]] = by_label[i];
    SparseMatrix permuted;
    permuted = matrix.values.twistedBy(permutation);
    matrix.values = SparseMatrix(permuted.transpose());  // symmetric, and its rows are in order then
    matrix.labels = rows_;
  }

  [[noreturn]] static void refuse_mixed_names(const FiniteElementMatrix& silent, const FiniteElementMatrix& telling) {
    throw InvalidInput(silent.where,
                       fmt::format("\"{}\" does not tell what its rows are, and those of \"{}\" may be in "
                                   "another order; give rows = \"...\", the table of the rows of \"{}\"",
                                   silent.file, telling.file, silent.file));
  }

  /// Rows that a damping matrix lacks are zero.
  void widen(FiniteElementMatrix& matrix) const {
    std::map<RowLabel, int> places;
    for (std::size_t i = 0; i < rows_.size(); ++i) places.emplace(rows_[i], static_cast<int>(i));
    std::vector<Eigen::Triplet<double>> entries;
    const auto place = [&](Index i) { return places.at(matrix.labels[static_cast<std::size_t>(i)]); };
    for (Index j = 0; j < matrix.values.outerSize(); ++j)
      for (SparseMatrix::InnerIterator entry(matrix.values, j); entry; ++entry)
        entries.emplace_back(place(entry.row()), place(j), entry.value());
    const auto n = static_cast<Index>(rows_.size());
    matrix.values = SparseMatrix(n, n);
    matrix.values.setFromTriplets(entries.begin(), entries.end());
    matrix.labels = rows_;
  }

  /// Rows that a large number on the diagonal holds are not there.
  void drop_held() {
    const Vector diagonal = files_.stiffness.values.diagonal();
    std::vector<Index> kept;
    std::string first;
    for (Index i = 0; i < diagonal.size(); ++i) {
      if (diagonal[i] < held_by_penalty)
        kept.push_back(i);
      else if (first.empty())
        first = name_of(rows_[static_cast<std::size_t>(i)]);
    }
    const std::size_t dropped = rows_.size() - kept.size();
    built_.mass_of_held = Matrix::Zero(diagonal.size(), 3);
    if (dropped == 0) return;
    if (kept.empty())
      throw InvalidInput(files_.stiffness.where,
                         fmt::format("every row of \"{}\" is held by a large number on its diagonal ({} and more)",
                                     files_.stiffness.file, held_by_penalty));
    take_mass_of_held(kept);
    for (FiniteElementMatrix* matrix : {&files_.stiffness, &files_.mass, files_.damping ? &*files_.damping : nullptr}) {
      if (!matrix) continue;
      std::vector<int> place(rows_.size(), -1);
      for (std::size_t i = 0; i < kept.size(); ++i) place[static_cast<std::size_t>(kept[i])] = static_cast<int>(i);
      std::vector<Eigen::Triplet<double>> entries;
      for (Index j = 0; j < matrix->values.outerSize(); ++j)
        for (SparseMatrix::InnerIterator entry(matrix->values, j); entry; ++entry) {
          const int row = place[static_cast<std::size_t>(entry.row())], column = place[static_cast<std::size_t>(j)];
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, entry.value());
        }
      matrix->values = SparseMatrix(static_cast<Index>(kept.size()), static_cast<Index>(kept.size()));
      matrix->values.setFromTriplets(entries.begin(), entries.end());
    }
    std::vector<RowLabel> rows;
    for (const Index i : kept) rows.push_back(rows_[static_cast<std::size_t>(i)]);
    rows_ = std::move(rows);
    built_.notes.push_back(
        fmt::format("{} rows, the first {}, have a diagonal entry of {} or more: they count as held, "
                    "and are left out",
                    dropped, first, held_by_penalty));
  }

  /// Rows that are left out push those that stay where all nodes move alike.
  void take_mass_of_held(const std::vector<Index>& kept) {
    std::vector<char> stays(rows_.size(), 0);
    for (const Index i : kept) stays[static_cast<std::size_t>(i)] = 1;
    Matrix share = Matrix::Zero(static_cast<Index>(rows_.size()), 3);
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      if (stays[j] != 0) continue;
      held_in_files_.push_back(rows_[j]);
      const int direction = rows_[j].direction;
      if (direction < 1 || direction > 3) continue;
      for (SparseMatrix::InnerIterator entry(files_.mass.values, static_cast<Index>(j)); entry; ++entry)
        share(entry.row(), direction - 1) += entry.value();
    }
    std::sort(held_in_files_.begin(), held_in_files_.end());
    built_.mass_of_held.resize(static_cast<Index>(kept.size()), 3);
    for (std::size_t i = 0; i < kept.size(); ++i) built_.mass_of_held.row(static_cast<Index>(i)) = share.row(kept[i]);
  }

  void require_unique_rows() const {
    std::vector<RowLabel> sorted = rows_;
    std::sort(sorted.begin(), sorted.end());
    const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
    if (twin == sorted.end()) return;
    throw InvalidInput({files_.rows ? files_.rows->file : files_.stiffness.file, 0, 0},
                       fmt::format("two rows are called {}: each direction of a node has one row", name_of(*twin)));
  }

  void require_diagonal(const FiniteElementMatrix& matrix, const char* kind, const char* fault) const {
    const Vector diagonal = matrix.values.diagonal();
    for (Index i = 0; i < diagonal.size(); ++i)
      if (!(diagonal[i] > 0.0))
        throw InvalidInput(
            matrix.where,
            diagonal[i] < 0.0
                ? fmt::format("the {} matrix \"{}\" has {} on the diagonal of row {}, {}; it must be "
                              "positive",
                              kind, matrix.file, diagonal[i], i + 1, name_of(rows_[static_cast<std::size_t>(i)]))
                : fmt::format("the {} matrix \"{}\" has nothing on the diagonal of row {}, {}: {}", kind, matrix.file,
                              i + 1, name_of(rows_[static_cast<std::size_t>(i)]), fault));
  }

  /// Nodes of rows and held ones, with their places and positions.
  void place_nodes() {
    std::vector<std::int64_t> nodes;
    for (const RowLabel& row : rows_)
      if (row.direction > 0) nodes.push_back(row.node);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    if (files_.mesh) refuse_nodes_beyond_the_mesh(nodes);
    std::vector<std::int64_t> held = held_nodes(nodes);
    built_.nodes.resize(nodes.size() + held.size());
    std::merge(nodes.begin(), nodes.end(), held.begin(), held.end(), built_.nodes.begin());
    std::array<Index, 6> none{};
    none.fill(ground);
    built_.places.assign(built_.nodes.size(), none);
    built_.is_held.assign(built_.nodes.size(), 0);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (rows_[i].direction > 0)
        built_.places[place_of(rows_[i].node)][static_cast<std::size_t>(rows_[i].direction) - 1] =
            static_cast<Index>(i);
    for (const std::int64_t node : held) built_.is_held[place_of(node)] = 1;
    take_positions();
  }

  std::size_t place_of(std::int64_t node) const {
    return static_cast<std::size_t>(std::lower_bound(built_.nodes.begin(), built_.nodes.end(), node) -
                                    built_.nodes.begin());
  }

  void refuse_nodes_beyond_the_mesh(const std::vector<std::int64_t>& nodes) const {
    const auto& known = files_.mesh->nodes;
    std::vector<std::int64_t> strange;
    std::set_difference(nodes.begin(), nodes.end(), known.begin(), known.end(), std::back_inserter(strange));
    if (strange.empty()) return;
    const bool are_above = strange.front() > known.back();
    throw InvalidInput(
        files_.mesh->where,
        fmt::format("{} node{} of the matrices, the first {}, {} not in the mesh \"{}\"{}", strange.size(),
                    strange.size() == 1 ? "" : "s", strange.front(), strange.size() == 1 ? "is" : "are",
                    files_.mesh->file,
                    are_above ? ": the program made them for itself, as CalculiX does of beams, shells and elements of "
                                "type C3D8I; take solid elements without internal nodes, such as C3D20"
                              : "; is the mesh of another model?"));
  }

  /// Nodes of elements that have no row.
  std::vector<std::int64_t> held_nodes(const std::vector<std::int64_t>& nodes) const {
    std::vector<std::int64_t> held;
    if (!files_.mesh) return held;
    std::vector<char> is_used(files_.mesh->nodes.size(), 0);
    for (const std::size_t place : files_.mesh->element_nodes) is_used[place] = 1;
    for (std::size_t i = 0; i < is_used.size(); ++i)
      if (is_used[i] != 0 && !std::binary_search(nodes.begin(), nodes.end(), files_.mesh->nodes[i]))
        held.push_back(files_.mesh->nodes[i]);
    return held;
  }

  void take_positions() {
    if (files_.mesh) {
      for (const std::int64_t node : built_.nodes)
        built_.positions.push_back(files_.mesh->positions[*files_.mesh->place_of(node)]);
      return;
    }
    if (!files_.rows || files_.rows->positions.empty()) return;
    const RowTable& table = *files_.rows;
    std::vector<char> is_given(built_.nodes.size(), 0);
    built_.positions.resize(built_.nodes.size());
    for (std::size_t i = 0; i < table.labels.size(); ++i) {
      const std::size_t place = place_of(table.labels[i].node);
      if (table.labels[i].direction == 0 || place >= built_.nodes.size() || built_.nodes[place] != table.labels[i].node)
        continue;
      if (is_given[place] != 0 && built_.positions[place] != table.positions[i])
        throw InvalidInput(table.where,
                           fmt::format("the table \"{}\" gives node {} two places", table.file, table.labels[i].node));
      is_given[place] = 1;
      built_.positions[place] = table.positions[i];
    }
    const auto missing = std::find(is_given.begin(), is_given.end(), 0);
    if (missing != is_given.end())
      throw InvalidInput(table.where, fmt::format("the table \"{}\" does not tell where node {} is", table.file,
                                                  built_.nodes[static_cast<std::size_t>(missing - is_given.begin())]));
  }

  FiniteElementFiles files_;
  FiniteElements built_;
  std::vector<RowLabel> rows_;
  std::vector<RowLabel> held_in_files_;
};

}  // namespace

std::string name_of(const RowLabel& row) {
  if (row.direction == 0) return std::to_string(row.node);
  return fmt::format("{}.{}", row.node, axis_names[static_cast<std::size_t>(row.direction) - 1]);
}

std::optional<std::size_t> Mesh::place_of(std::int64_t node) const {
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), node);
  if (found == nodes.end() || *found != node) return std::nullopt;
  return static_cast<std::size_t>(found - nodes.begin());
}

FiniteElements join_finite_elements(FiniteElementFiles files) { return Joiner(std::move(files)).join(); }

}  // namespace rubato::model
