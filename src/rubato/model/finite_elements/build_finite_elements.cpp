#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_sections.hpp>
#include <rubato/model/finite_elements/build_finite_elements.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace rubato::model {
namespace {

using numerics::Parameters;

class Builder {
 public:
  Builder(const ModelDescription& description, const Parameters& parameters, const Vector& before)
      : description_(description), files_(*description.finite_elements), parameters_(parameters), before_(before) {}

  BuiltFiniteElements build() {
    refuse_foreign_parts();
    is_supported_.assign(files_.rows.size(), 0);
    added_ = Vector::Zero(static_cast<Index>(files_.rows.size()));
    for (const SupportDescription& support : description_.structure.supports) take_support(support);
    for (const PointMassDescription& mass : description_.structure.masses) take_mass(mass);
    number();
    take_nodes();
    take_matrices();
    return std::move(built_);
  }

 private:
  void refuse_foreign_parts() const {
    const auto refuse = [](const Location& where, const char* key) {
      throw InvalidInput(where,
                         fmt::format("[[{}]] does not go with [model] yet; model it in the program that made the "
                                     "matrices, or join a [[coordinate]], [[mass]] or [[spring]] to its nodes",
                                     key));
    };
    const StructureDescription& parts = description_.structure;
    if (!parts.nodes.empty()) refuse(parts.nodes.front().where, "node");
    if (!parts.beams.empty()) refuse(parts.beams.front().where, "beam");
    if (!parts.trusses.empty()) refuse(parts.trusses.front().where, "truss");
  }

  /// The places of a node, or of the nodes of a set.
  std::vector<std::size_t> nodes_called(const std::string& name, const Location& where, const std::string& role) const {
    std::int64_t number = 0;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), number);
    std::vector<std::string> known;
    if (fault == std::errc() && end == name.data() + name.size()) {
      const auto found = std::lower_bound(files_.nodes.begin(), files_.nodes.end(), number);
      if (found != files_.nodes.end() && *found == number)
        return {static_cast<std::size_t>(found - files_.nodes.begin())};
    }
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    if (files_.mesh)
      for (const NodeSet& set : files_.mesh->sets) {
        known.push_back(set.name);
        if (set.name != upper) continue;
        std::vector<std::size_t> places;
        for (const std::int64_t node : set.nodes) {
          const auto found = std::lower_bound(files_.nodes.begin(), files_.nodes.end(), node);
          if (found != files_.nodes.end() && *found == node)
            places.push_back(static_cast<std::size_t>(found - files_.nodes.begin()));
        }
        return places;
      }
    throw InvalidInput(where, fmt::format("{} \"{}\", which is no node and no node set of the model{}", role, name,
                                          suggestion(upper, known)));
  }

  void take_support(const SupportDescription& support) {
    if (support.fix.empty())
      throw InvalidInput(support.where, fmt::format("the support at node \"{}\" fixes nothing", support.node));
    const std::vector<std::size_t> nodes = nodes_called(support.node, support.node_where, "a support is at");
    for (std::size_t i = 0; i < support.fix.size(); ++i) {
      const auto axis = static_cast<std::size_t>(std::find(axis_names.begin(), axis_names.end(), support.fix[i]) -
                                                 axis_names.begin());
      const Location& where = i < support.fix_where.size() ? support.fix_where[i] : support.where;
      if (axis == axis_names.size())
        throw InvalidInput(where, fmt::format("the support at node \"{}\" fixes \"{}\"; a node has x, y, z, rx, ry, rz",
                                              support.node, support.fix[i]));
      bool holds = false;
      for (const std::size_t node : nodes) {
        const Index row = files_.places[node][axis];
        if (row == ground) continue;
        holds = true;
        is_supported_[static_cast<std::size_t>(row)] = 1;
      }
      if (!holds)
        throw InvalidInput(where, fmt::format("the support at node \"{}\" fixes {}, of which the matrices have no row: "
                                              "it is held already, or its elements have no such degree of freedom",
                                              support.node, support.fix[i]));
    }
  }

  void take_mass(const PointMassDescription& mass) {
    const std::string part = fmt::format("the mass on node \"{}\"", mass.node);
    if (!mass.mass && mass.inertia.empty())
      throw InvalidInput(mass.where, part + " needs \"mass\" [kg], \"inertia\" [kg m2] or both");
    if (!mass.inertia.empty() && mass.inertia.size() != 3)
      throw InvalidInput(mass.where, fmt::format("{}: inertia takes three numbers in space, about x, y and z, got {}",
                                                 part, mass.inertia.size()));
    for (const std::size_t node : nodes_called(mass.node, mass.node_where, "a mass is on"))
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const bool is_turn = is_rotation(axis);
        if (is_turn ? mass.inertia.empty() : !mass.mass) continue;
        const double value = is_turn ? positive(mass.inertia[axis - 3], parameters_, part + ": inertia")
                                     : positive(*mass.mass, parameters_, part + ": mass");
        const Index row = files_.places[node][axis];
        if (row != ground)
          added_[row] += value;
        else if (is_turn)
          throw InvalidInput(mass.where, fmt::format("{} has an inertia, and the node has no rotation {}: elements of "
                                                     "solids give their nodes translations only",
                                                     part, axis_names[axis]));
      }
  }

  void number() {
    Index next = before_.size();
    place_.assign(files_.rows.size(), ground);
    for (std::size_t i = 0; i < files_.rows.size(); ++i) {
      std::string name = name_of(files_.rows[i]);
      if (is_supported_[i] != 0) {
        built_.fixed.push_back(std::move(name));
        continue;
      }
      place_[i] = next++;
      built_.coordinates.push_back(std::move(name));
      const int direction = files_.rows[i].direction;
      built_.is_rotation.push_back(direction > 0 && is_rotation(static_cast<std::size_t>(direction) - 1) ? 1 : 0);
    }
    if (built_.coordinates.empty())
      throw InvalidInput(description_.structure.supports.front().where, "the supports hold every degree of freedom");
    size_ = next;
  }

  /// Why a node without a row need not be held: it may be tied to others, or lie inside a reduced model.
  std::string doubt() const {
    if (files_.mesh && !files_.mesh->tie.empty())
      return fmt::format("*{} (line {} of the mesh) may tie it to other nodes", files_.mesh->tie,
                         files_.mesh->tie_where.line);
    const bool is_reduced =
        std::any_of(files_.rows.begin(), files_.rows.end(), [](const RowLabel& row) { return row.direction == 0; });
    return is_reduced ? "the model is a reduced one, inside which nodes move without rows" : "";
  }

  void take_nodes() {
    built_.doubt = doubt();
    Structure& structure = built_.structure;
    structure.dimension = 3;
    for (std::size_t node = 0; node < files_.nodes.size(); ++node) {
      structure.names.push_back(std::to_string(files_.nodes[node]));
      const auto& at = files_.positions.empty() ? std::array<double, 3>{} : files_.positions[node];
      structure.positions.emplace_back(at[0], at[1], at[2]);
      std::array<Index, 6> places{};
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const Index row = files_.places[node][axis];
        places[axis] = row == ground ? ground : place_[static_cast<std::size_t>(row)];
        if (!files_.mesh || !is_held(files_.freedoms[node][axis])) continue;
        const bool is_doubtful = !built_.doubt.empty() && files_.freedoms[node][axis] == Freedom::held;
        (is_doubtful ? built_.doubtful : built_.fixed)
            .push_back(fmt::format("{}.{}", structure.names.back(), axis_names[axis]));
      }
      structure.places.push_back(places);
    }
  }

  SparseMatrix placed(const SparseMatrix& from, const Vector* diagonal_before, const Vector* added) const {
    SparseMatrix matrix(size_, size_);
    std::vector<int> count(static_cast<std::size_t>(size_), 1);
    for (Index j = 0; j < from.outerSize(); ++j)
      if (place_[static_cast<std::size_t>(j)] != ground)
        count[static_cast<std::size_t>(place_[static_cast<std::size_t>(j)])] = static_cast<int>(from.col(j).nonZeros());
    matrix.reserve(count);
    if (diagonal_before)
      for (Index i = 0; i < before_.size(); ++i) matrix.insert(i, i) = (*diagonal_before)[i];
    // Places rise with rows, so that entries come in order.
    for (Index j = 0; j < from.outerSize(); ++j) {
      const Index column = place_[static_cast<std::size_t>(j)];
      if (column == ground) continue;
      for (SparseMatrix::InnerIterator entry(from, j); entry; ++entry) {
        const Index row = place_[static_cast<std::size_t>(entry.row())];
        if (row == ground) continue;
        const double more = added && entry.row() == j ? (*added)[j] : 0.0;
        matrix.insert(row, column) = entry.value() + more;
      }
    }
    matrix.makeCompressed();
    return matrix;
  }

  void take_matrices() {
    FullMatrices& matrices = built_.matrices;
    matrices.mass = placed(files_.mass.values, &before_, &added_);
    matrices.stiffness = placed(files_.stiffness.values, nullptr, nullptr);
    matrices.damping = files_.damping ? placed(files_.damping->values, nullptr, nullptr) : SparseMatrix(size_, size_);
    take_inertia();
  }

  /// Of all rows, those too that supports or a large diagonal hold: they move with the others where the ground does.
  void take_inertia() {
    const auto n = static_cast<Index>(files_.rows.size());
    Eigen::Matrix<double, Eigen::Dynamic, 3> moved = Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(n, 3);
    for (Index i = 0; i < n; ++i)
      if (const int direction = files_.rows[static_cast<std::size_t>(i)].direction; direction >= 1 && direction <= 3)
        moved(i, direction - 1) = 1.0;
    const Eigen::Matrix<double, Eigen::Dynamic, 3> force =
        files_.mass.values * moved + added_.asDiagonal() * moved + files_.mass_of_held;
    built_.matrices.inertia.setZero(size_, 3);
    for (Index i = 0; i < n; ++i)
      if (const Index place = place_[static_cast<std::size_t>(i)]; place != ground)
        built_.matrices.inertia.row(place) = force.row(i);
  }

  const ModelDescription& description_;
  const FiniteElements& files_;
  const Parameters& parameters_;
  const Vector& before_;
  BuiltFiniteElements built_;
  std::vector<char> is_supported_;  // rows
  std::vector<Index> place_;        // coordinate of each row, or `ground`
  Vector added_;                    // to the diagonal of the mass matrix, by row
  Index size_ = 0;
};

}  // namespace

BuiltFiniteElements build_finite_elements(const ModelDescription& description, const Parameters& parameters,
                                          const Vector& before) {
  return Builder(description, parameters, before).build();
}

}  // namespace rubato::model
