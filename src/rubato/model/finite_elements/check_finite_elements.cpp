#include <rubato/model/finite_elements/check_finite_elements.hpp>
#include <rubato/model/finite_elements/freedoms.hpp>
#include <rubato/model/finite_elements/rigid_motions.hpp>
#include <rubato/model/structure.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

/// Three numbers; what is round-off beside `size` is 0.
std::string listed(const Axis& values, double size = 0.0) {
  const double least = 1e-10 * std::max(size, values.cwiseAbs().maxCoeff());
  std::vector<std::string> texts;
  for (Index i = 0; i < values.size(); ++i)
    texts.push_back(fmt::format("{:.6g}", std::abs(values[i]) < least ? 0.0 : values[i]));
  return fmt::format("({})", fmt::join(texts, ", "));
}

class Checker {
 public:
  explicit Checker(const FiniteElements& model) : model_(model) {}

  FiniteElementFindings check() {
    tell_matrices();
    judge_entries(model_.stiffness, "stiffness");
    judge_entries(model_.mass, "mass");
    doubt_equal_matrices();
    tell_held();
    tell_mass();
    if (!model_.positions.empty()) {
      judge_rigid_motions();
      judge_units();
    } else {
      fact(
          "no file tells where the nodes are: give mesh = \"...\" for the centre of gravity and the test of K by rigid "
          "motions");
    }
    for (const std::string& note : model_.notes) findings_.facts.push_back(note);
    return std::move(findings_);
  }

 private:
  void fact(std::string text) { findings_.facts.push_back(std::move(text)); }
  void doubt(const Location& where, std::string text) { findings_.doubts.push_back({where, std::move(text)}); }

  void tell_matrices() {
    std::array<std::size_t, 7> count{};
    for (const RowLabel& row : model_.rows) ++count[static_cast<std::size_t>(row.direction)];
    std::vector<std::string> directions;
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (count[axis + 1] > 0) directions.push_back(fmt::format("{} {}", count[axis + 1], axis_names[axis]));
    if (count[0] > 0) directions.push_back(fmt::format("{} generalized", count[0]));
    fact(fmt::format("{} rows ({}) of {} nodes", model_.rows.size(), fmt::join(directions, ", "),
                     std::count(model_.is_held.begin(), model_.is_held.end(), 0)));
    const auto tell = [&](const FiniteElementMatrix& matrix, const char* kind, const std::string& more) {
      std::string text = fmt::format("{}: {} entries from \"{}\" ({}){}", kind, matrix.values.nonZeros(), matrix.file,
                                     matrix.format, more);
      if (matrix.asymmetry > 0.0)
        text += fmt::format("; its triangles differ by {:.2g} of the diagonal", matrix.asymmetry);
      if (matrix.digits < 14)
        text += fmt::format(
            "; {} digits: elastic frequencies are good to about that many, and rigid motions come out "
            "near {:.0e} of the highest frequency instead of 0",
            matrix.digits, std::pow(10.0, -0.5 * matrix.digits));
      fact(text);
    };
    tell(model_.stiffness, "stiffness", "");
    tell(model_.mass, "mass", is_lumped() ? ", lumped (diagonal)" : ", consistent");
    if (model_.damping) tell(*model_.damping, "damping", "");
    // Who writes zeros into the mass matrix writes the pattern of the stiffness matrix.
    if (model_.mass.format == model_.stiffness.format && model_.mass.zeros > 0 &&
        model_.mass.given != model_.stiffness.given)
      doubt(
          model_.mass.where,
          fmt::format("\"{}\" has {} entries and \"{}\" has {}, and the program gave both those of the same places; is "
                      "a file cut off, or of another export?",
                      model_.mass.file, model_.mass.given, model_.stiffness.file, model_.stiffness.given));
    if (model_.mesh && !model_.mesh->sets.empty()) {
      std::vector<std::string> sets;
      for (const NodeSet& set : model_.mesh->sets) sets.push_back(fmt::format("{} ({})", set.name, set.nodes.size()));
      fact(fmt::format("node sets: {}", fmt::join(sets, ", ")));
    }
  }

  /// No entry of a matrix without negative eigenvalues is larger than the mean of its two diagonal entries, the
  /// geometric one: a digit that was lost in a file shows so.
  void judge_entries(const FiniteElementMatrix& matrix, const char* kind) {
    constexpr double round_off = 1e-6;
    const Vector diagonal = matrix.values.diagonal();
    double worst = 1.0 + round_off;
    Index row = -1, column = -1;
    for (Index j = 0; j < diagonal.size(); ++j)
      for (SparseMatrix::InnerIterator entry(matrix.values, j); entry && entry.row() < j; ++entry) {
        const double ratio = std::abs(entry.value()) / std::sqrt(diagonal[j] * diagonal[entry.row()]);
        if (!(ratio > worst)) continue;
        worst = ratio;
        row = entry.row();
        column = j;
      }
    if (row < 0) return;
    const auto name = [&](Index i) { return name_of(model_.rows[static_cast<std::size_t>(i)]); };
    doubt(matrix.where,
          fmt::format("entry ({}, {}) of the {} matrix \"{}\" is {:.6g}, and the diagonal has {:.6g} and {:.6g}: some "
                      "motion of the two has a negative {}; is a number wrong?",
                      name(row), name(column), kind, matrix.file, matrix.values.coeff(row, column), diagonal[row],
                      diagonal[column], kind));
  }

  void doubt_equal_matrices() {
    const SparseMatrix& k = model_.stiffness.values;
    const SparseMatrix& m = model_.mass.values;
    if (k.nonZeros() != m.nonZeros() || SparseMatrix(k - m).norm() != 0.0) return;
    doubt(
        model_.mass.where,
        fmt::format("the mass matrix \"{}\" and the stiffness matrix \"{}\" are the same, so that all eigenvalues are "
                    "1: is a file named twice?",
                    model_.mass.file, model_.stiffness.file));
  }

  bool is_lumped() const { return model_.mass.values.nonZeros() == model_.mass.values.rows(); }

  void tell_held() {
    std::vector<std::int64_t> held;
    std::array<std::size_t, 6> partly{};
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      if (model_.is_held[i] != 0)
        held.push_back(model_.nodes[i]);
      else
        for (std::size_t axis = 0; axis < 6; ++axis) partly[axis] += is_held(model_.freedoms[i][axis]) ? 1 : 0;
    }
    std::vector<std::string> directions;
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (partly[axis] > 0)
        directions.push_back(
            fmt::format("{} at {} node{}", axis_names[axis], partly[axis], partly[axis] == 1 ? "" : "s"));
    if (!directions.empty()) fact(fmt::format("held in part, for lack of a row: {}", fmt::join(directions, ", ")));
    if (held.empty()) {
      if (model_.mesh && directions.empty()) fact("no node is held");
      return;
    }
    std::string set;
    for (const NodeSet& one : model_.mesh->sets) {
      std::vector<std::int64_t> sorted = one.nodes;
      std::sort(sorted.begin(), sorted.end());
      if (sorted == held) set = fmt::format(", those of {}", one.name);
    }
    if (set.empty()) set = fmt::format(" (the first is {})", held.front());
    fact(held.size() == 1 ? fmt::format("1 node is held: an element has it, and no row does{}", set)
                          : fmt::format("{} nodes are held: elements have them, and no row does{}", held.size(), set));
  }

  void tell_mass() {
    motions_ = rigid_motions(model_);
    inertia_ = model_.mass.values * motions_;
    const Matrix product = motions_.transpose() * inertia_;
    const Axis mass(product(0, 0), product(1, 1), product(2, 2));
    Index most = 0;
    mass_ = mass.maxCoeff(&most);
    if (!(mass_ > 0.0)) return;
    const bool is_even = mass.minCoeff() > mass_ * (1.0 - 1e-6);
    const bool is_any_held = std::any_of(model_.freedoms.begin(), model_.freedoms.end(), [](const auto& freedoms) {
      return std::any_of(freedoms.begin(), freedoms.end(), [](Freedom freedom) { return is_held(freedom); });
    });
    fact(fmt::format("mass of the rows {} kg{}",
                     is_even ? fmt::format("{:.9g}", mass_) : "along x, y, z " + listed(mass),
                     is_any_held ? " (without the share of held nodes)" : ""));
    if (!is_even && !is_any_held)
      doubt(model_.mass.where,
            fmt::format("the mass is {} kg along x, y and z, and nothing is held: are the rows of the "
                        "mass matrix in another order than \"{}\" says?",
                        listed(mass), model_.stiffness.file));
    doubt_uneven_solid(mass);
    if (model_.positions.empty()) return;
    Axis centre;
    for (Index k = 0; k < 3; ++k) {
      double moment = 0.0;
      for (std::size_t i = 0; i < model_.rows.size(); ++i)
        if (model_.rows[i].direction == most + 1) moment += inertia_(static_cast<Index>(i), most) * position(i)[k];
      centre[k] = moment / mass_;
    }
    const Matrix about = rigid_motions(model_, centre).rightCols(3);
    const Matrix turn = about.transpose() * (model_.mass.values * about);
    fact(fmt::format("centre of gravity {} m; inertia about it {} kg m2, products {}", listed(centre),
                     listed(turn.diagonal()),
                     listed(Axis(-turn(0, 1), -turn(1, 2), -turn(0, 2)), turn.diagonal().maxCoeff())));
  }

  /// Solids that hold their nodes in all directions or in none move as much mass along x as along y and z.
  void doubt_uneven_solid(const Axis& mass) {
    constexpr double even = 0.01;
    if (mass.minCoeff() > 0.0 && mass.minCoeff() > mass_ * (1.0 - even)) return;
    const bool has_other_rows = std::any_of(model_.rows.begin(), model_.rows.end(),
                                            [](const RowLabel& row) { return row.direction < 1 || row.direction > 3; });
    bool is_any_held = false;
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const auto& freedoms = model_.freedoms[i];
      if (is_partly_held(model_, i) || std::count(freedoms.begin(), freedoms.begin() + 3, Freedom::absent) > 0) return;
      is_any_held |= model_.is_held[i] != 0;
    }
    if (has_other_rows || !is_any_held) return;
    doubt(model_.mass.where,
          fmt::format("the mass is {} kg along x, y and z, and that of solids is the same along all: are \"{}\" and "
                      "\"{}\" exchanged, or the rows in another order?",
                      listed(mass), model_.mass.file, model_.stiffness.file));
  }

  Axis position(std::size_t row) const {
    const auto node = std::lower_bound(model_.nodes.begin(), model_.nodes.end(), model_.rows[row].node);
    const auto& at = model_.positions[static_cast<std::size_t>(node - model_.nodes.begin())];
    return {at[0], at[1], at[2]};
  }

  /// What rigid motions cost where no held node is near: nothing, or spin softening.
  void judge_rigid_motions() {
    const std::vector<Index> far = rows_far_from_held(model_);
    if (far.empty()) {
      if (model_.mesh)
        fact("the test of K by rigid motions says nothing: every node shares an element with a held one");
      return;
    }
    const RigidCost cost = rigid_cost(model_, motions_, far);
    const double digits = std::pow(10.0, 2 - std::min(model_.stiffness.digits, 14));
    if (const auto spin = spin_softening(model_, motions_, inertia_, far, digits)) {
      fact(
          fmt::format("the stiffness holds spin softening of {:.6g} rad/s about the direction {}: it is that of a "
                      "structure that turns, and -Omega^2 M is not to be added again",
                      spin->speed, listed(spin->axis)));
      return;
    }
    const double allowed = std::max(1e-6, digits);
    if (cost.worst <= allowed) {
      fact(
          fmt::format("rigid motions cost nothing away from held nodes ({:.1e} of what the entries of K sum up to, at "
                      "{} rows)",
                      cost.worst, far.size()));
      return;
    }
    doubt(model_.stiffness.where,
          fmt::format(
              "a rigid {} {} is resisted at {} by {:.2g} of what the entries of K sum up to, where no held node "
              "is near; are the rows in another order, is the mesh another one, or its unit of length, is the "
              "stiffness prestressed, or does it hold springs to the ground?",
              cost.motion < 3 ? "motion along" : "turn about", axis_names[static_cast<std::size_t>(cost.motion % 3)],
              name_of(model_.rows[static_cast<std::size_t>(cost.row)]), cost.worst));
  }

  void judge_units() {
    constexpr double lightest = 0.05, heaviest = 30000.0;  // foams of silica and osmium [kg/m3]
    const std::string advice =
        "; a study is in m, kg, N and s. In mm, t, N and s everything is consistent too, but all lengths are then in "
        "mm "
        "and all stresses in MPa, whatever the heads of columns say: export in SI units if that is not meant";
    bool has_material = false;
    if (model_.mesh)
      for (const MeshMaterial& material : model_.mesh->materials) {
        if (!material.density) continue;
        has_material = true;
        const double density = *material.density;
        const std::string looks = density > 1e-10 && density < 1e-7  ? ", as of a metal in t/mm3"
                                  : density > 1e-7 && density < 1e-4 ? ", as of a metal in kg/mm3"
                                                                     : "";
        if (!(density >= lightest && density <= heaviest))
          doubt(material.where,
                fmt::format("material \"{}\" has the density {:.6g}{}{}", material.name, density, looks, advice));
      }
    if (has_material || !(mass_ > 0.0)) return;
    Eigen::AlignedBox3d box;
    for (const auto& at : model_.positions) box.extend(Eigen::Vector3d(at[0], at[1], at[2]));
    const double density = mass_ / box.volume();
    // A structure fills its box by a share, so that only a very low or a high value tells.
    if (box.volume() > 0.0 && (density < 1e-3 || density > heaviest))
      doubt(model_.mass.where, fmt::format("the mass over the volume of the box about all nodes is {:.3g} kg/m3, which "
                                           "no structure has{}",
                                           density, advice));
  }

  const FiniteElements& model_;
  FiniteElementFindings findings_;
  Matrix motions_, inertia_;  // [n x 6]
  double mass_ = 0.0;
};

}  // namespace

FiniteElementFindings check_finite_elements(const FiniteElements& model) { return Checker(model).check(); }

std::string first_frequencies(const FiniteElements& model, Index most) {
  const Index count = std::min<Index>(most, model.stiffness.values.rows());
  const auto modes = numerics::lowest_modes(model.stiffness.values, model.mass.values, count);
  if (!modes.has_converged) return "";
  std::vector<std::string> texts;
  for (const double value : modes.eigenvalues)
    texts.push_back(value < 0.0 ? fmt::format("i {:.6g}", std::sqrt(-value) / (2.0 * std::numbers::pi))
                                : fmt::format("{:.10g}", std::sqrt(value) / (2.0 * std::numbers::pi)));
  return fmt::format("first frequencies of the matrices alone {} Hz", fmt::join(texts, ", "));
}

}  // namespace rubato::model
