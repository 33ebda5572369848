#include <rubato/core/error.hpp>
#include <rubato/system/eliminate_supports.hpp>

#include <Eigen/Cholesky>

#include <utility>

namespace rubato::system {
namespace {

/// Where a coordinate of all goes: among the free ones, or among those that are given.
class Split {
 public:
  Split(Index n, std::span<const model::Prescribed> motions) : place_(static_cast<std::size_t>(n), 0) {
    for (const auto& motion : motions) place_[static_cast<std::size_t>(motion.coordinate)] = ground;
    for (Index& place : place_) place = place == ground ? -1 - given_++ : free_++;
  }
  Index free() const { return free_; }
  Index given() const { return given_; }
  bool is_free(Index i) const { return place_[static_cast<std::size_t>(i)] >= 0; }
  /// Among the free ones.
  Index among_free(Index i) const { return place_[static_cast<std::size_t>(i)]; }
  Index among_given(Index i) const { return -1 - place_[static_cast<std::size_t>(i)]; }
  /// Free ones first.
  Index among_all(Index i) const { return is_free(i) ? among_free(i) : free_ + among_given(i); }

 private:
  std::vector<Index> place_;
  Index free_ = 0, given_ = 0;
};

SparseMatrix made_of(const SparseMatrix& matrix, Index rows, Index columns, const auto& place) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index column = 0; column < matrix.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const auto [i, j] = place(entry.row(), column);
      if (i >= 0 && j >= 0) entries.emplace_back(i, j, entry.value());
    }
  SparseMatrix out(rows, columns);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

SparseMatrix free_part(const SparseMatrix& matrix, const Split& split) {
  return made_of(matrix, split.free(), split.free(), [&](Index i, Index j) {
    return std::pair(split.is_free(i) ? split.among_free(i) : -1, split.is_free(j) ? split.among_free(j) : -1);
  });
}

/// Rows of what is given, columns of all.
SparseMatrix given_rows(const SparseMatrix& matrix, const Split& split) {
  return made_of(matrix, split.given(), split.free() + split.given(), [&](Index i, Index j) {
    return std::pair(split.is_free(i) ? -1 : split.among_given(i), split.among_all(j));
  });
}

/// Keeps what loads the free coordinates; returns the terms on those that are given.
std::vector<LoadTerm> split_loads(std::vector<ModelLoad>& loads, const Split& split) {
  std::vector<LoadTerm> on_given;
  for (ModelLoad& load : loads) {
    LoadTerm of_free{{}, {}, load.term.law, load.term.source};
    LoadTerm of_given = of_free;
    for (std::size_t i = 0; i < load.term.rows.size(); ++i) {
      const Index row = load.term.rows[i];
      LoadTerm& to = split.is_free(row) ? of_free : of_given;
      to.rows.push_back(split.is_free(row) ? split.among_free(row) : split.among_given(row));
      to.weights.push_back(load.term.weights[i]);
    }
    load.term = std::move(of_free);
    if (!of_given.rows.empty()) on_given.push_back(std::move(of_given));
  }
  std::erase_if(loads, [](const ModelLoad& load) { return load.term.rows.empty(); });
  return on_given;
}

/// What a support that moves by a law pulls at the free coordinates.
void add_pull(const SparseMatrix& matrix, const Split& split, Index coordinate, ModelLoad load,
              std::vector<ModelLoad>& loads) {
  for (SparseMatrix::InnerIterator entry(matrix, coordinate); entry; ++entry) {
    if (!split.is_free(entry.row()) || entry.value() == 0.0) continue;
    load.term.rows.push_back(split.among_free(entry.row()));
    load.term.weights.push_back(-entry.value());
  }
  if (!load.term.rows.empty()) loads.push_back(std::move(load));
}

Vector free_entries(const Vector& all, const Split& split) {
  if (all.size() == 0) return all;
  Vector out(split.free());
  for (Index i = 0; i < all.size(); ++i)
    if (split.is_free(i)) out[split.among_free(i)] = all[i];
  return out;
}

}  // namespace

void eliminate_supports(LocallyNonlinear::Parts& parts, std::span<const model::Prescribed> motions, int first_law,
                        std::vector<ModelLoad>& loads) {
  const Split split(parts.mass.rows(), motions);
  const Index f = split.free(), p = split.given();
  MovingSupports::Parts supports;
  supports.motions.resize(motions.size());
  for (const auto& motion : motions)
    supports.motions[static_cast<std::size_t>(split.among_given(motion.coordinate))] = motion;
  supports.mass = given_rows(parts.mass, split);
  supports.damping = given_rows(parts.damping, split);
  supports.stiffness = given_rows(parts.stiffness, split);
  supports.own_mass = supports.mass.rightCols(p);
  supports.own_stiffness = supports.stiffness.rightCols(p);
  supports.loads = Loads(split_loads(loads, split));
  using Source = LoadTerm::Source;
  for (const auto& motion : motions) {
    const Index at = motion.coordinate;
    const int law = first_law + static_cast<int>(&motion - motions.data());
    add_pull(parts.stiffness, split, at, {{{}, {}, motion.displacement, Source::displaced_support}, law, 0}, loads);
    add_pull(parts.damping, split, at, {{{}, {}, motion.velocity, Source::moving_support}, law, 1}, loads);
    add_pull(parts.mass, split, at, {{{}, {}, motion.acceleration, Source::moving_support}, law, 2}, loads);
  }
  for (SparseMatrix* matrix : {&parts.mass, &parts.damping, &parts.stiffness}) *matrix = free_part(*matrix, split);
  const auto move_end = [&](Index& end) {
    if (end != ground) end = split.among_free(end);
  };
  const auto move_contact = [&](auto& contact) {
    move_end(contact.first);
    move_end(contact.second);
  };
  for (auto& slider : parts.sliders) move_contact(slider);
  for (auto& stop : parts.stops) move_contact(stop);
  for (auto& law : parts.laws) {
    move_contact(law);
    for (model::Share& share : law.shares) move_end(share.coordinate);
  }
  for (auto& block : parts.blocks)
    for (std::vector<model::Share>& column : block.columns)
      for (model::Share& share : column) move_end(share.coordinate);
  parts.start.q = free_entries(parts.start.q, split);
  parts.start.v = free_entries(parts.start.v, split);
  std::vector<std::string> names(static_cast<std::size_t>(f));
  supports.names.resize(static_cast<std::size_t>(p));
  std::vector<char> is_rotation(parts.is_rotation.empty() ? 0 : static_cast<std::size_t>(f));
  if (!is_rotation.empty()) supports.is_rotation.resize(static_cast<std::size_t>(p));
  for (std::size_t i = 0; i < parts.coordinates.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const bool is_free = split.is_free(at);
    const auto to = static_cast<std::size_t>(is_free ? split.among_free(at) : split.among_given(at));
    (is_free ? names : supports.names)[to] = std::move(parts.coordinates[i]);
    if (!is_rotation.empty()) (is_free ? is_rotation : supports.is_rotation)[to] = parts.is_rotation[i];
  }
  parts.coordinates = std::move(names);
  parts.is_rotation = std::move(is_rotation);
  for (auto* held : {&parts.held_forces, &parts.held_displacements}) {
    std::erase_if(*held, [&](const model::Held& one) { return !split.is_free(one.coordinate); });
    for (auto& one : *held) one.coordinate = split.among_free(one.coordinate);
  }
  parts.supports.emplace(std::move(supports));
}

SparseMatrix free_part(const SparseMatrix& matrix, std::span<const model::Prescribed> motions) {
  return free_part(matrix, Split(matrix.rows(), motions));
}

SparseMatrix relative_damping(const SparseMatrix& damping, const SparseMatrix& stiffness,
                              std::span<const model::Prescribed> motions) {
  const Split split(stiffness.rows(), motions);
  const Matrix held(free_part(stiffness, split));
  const Eigen::LDLT<Matrix> factor(held);
  constexpr double least = 1e-14;
  if (factor.info() != Eigen::Success || !(factor.rcond() > least))
    throw InvalidInput(
        "damping by modal_ratio is relative to the supports that a [[displacement]] moves, and without them the "
        "structure stands by nothing; take damping = { rayleigh = { mass = ..., stiffness = ... } }");
  Matrix rows = Matrix(given_rows(stiffness, split)).leftCols(split.free());
  Matrix relative(split.free(), stiffness.rows());  // T, in the order of all
  const Matrix follows = factor.solve(rows.transpose());
  for (Index i = 0; i < stiffness.rows(); ++i)
    relative.col(i) = split.is_free(i) ? Vector(Vector::Unit(split.free(), split.among_free(i)))
                                       : Vector(follows.col(split.among_given(i)));
  const Matrix all = relative.transpose() * (damping * relative);
  return all.sparseView(all.cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace rubato::system
