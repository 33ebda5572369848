#include <rubato/analysis/static_equilibrium.hpp>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

using Factor = Eigen::SimplicialLDLT<SparseMatrix>;

// A pivot that is small against the diagonal entry it came from raises the suspicion of a mechanism. A frame that turns
// freely leaves 2e-16 with 60 elements and 4e-10 with 33,000: elimination sums up roundings of ever stiffer elements.
constexpr double small_pivot = 1e-8;
// The motion that goes with it decides: its energy over the sum of the absolute terms of that energy. The same free
// frame has 1e-17 with any number of elements; well supported it has 1e-6 with 60 and 3e-12 with 33,000.
constexpr double no_energy = 16.0 * std::numeric_limits<double>::epsilon();
constexpr double shift = 1e-12;  // of the inverse iteration; larger ones leave bending in the motion of a fine mesh

/// Energy of the sliders and their forces for given displacements.
class Sliders {
 public:
  explicit Sliders(const system::LocallyNonlinear& system) : system_(system), force(system.slider_count()) {}

  /// Forces at q; returns the elastic energy less the friction work, the potential whose derivative they are.
  double load(const Vector& q) {
    double energy = 0.0;
    for (Index i = 0; i < force.size(); ++i) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const double trial = slider.stiffness * system_.relative_displacement(i, q);
      force[i] = std::clamp(trial, -slider.limit, slider.limit);
      energy += (std::abs(trial) <= slider.limit ? 0.5 * trial * trial
                                                 : slider.limit * (std::abs(trial) - 0.5 * slider.limit)) /
                slider.stiffness;
    }
    return energy;
  }
  std::vector<char> sticking(const Vector& q) const {
    std::vector<char> set(system_.sliders().size());
    for (std::size_t i = 0; i < set.size(); ++i)
      set[i] = std::abs(system_.sliders()[i].stiffness * system_.relative_displacement(static_cast<Index>(i), q)) <=
               system_.sliders()[i].limit;
    return set;
  }

 private:
  const system::LocallyNonlinear& system_;

 public:
  Vector force;  ///< fc [m]
};

class StaticSolver {
 public:
  StaticSolver(const system::LocallyNonlinear& system, std::span<const model::Held> held)
      : system_(system), held_(held), sliders_(system), load_(system.size()), place_(system.size()) {
    system::Loads loads = system.loads();
    loads.evaluate(0.0, load_, model::Side::left);
    for (const auto& force : system.held_forces()) load_[force.coordinate] += force.value;
    std::fill(place_.begin(), place_.end(), 0);
    result_.state = system.start();
    result_.state.t = 0.0;
    result_.state.q.setZero();
    for (const auto& displacement : held) {
      result_.state.q[displacement.coordinate] = displacement.value;
      place_[static_cast<std::size_t>(displacement.coordinate)] = ground;
    }
    for (Index i = 0; i < system.size(); ++i) {
      if (place_[static_cast<std::size_t>(i)] == ground) continue;
      place_[static_cast<std::size_t>(i)] = static_cast<Index>(free_.size());
      free_.push_back(i);
    }
  }

  StaticEquilibrium solve() {
    std::vector<char> set(system_.sliders().size(), 1);
    // Each slider changes its state a few times at most; the energy falls with every step.
    const int most = 20 + 10 * static_cast<int>(set.size());
    for (int iteration = 0; iteration < most; ++iteration) {
      if (!factorise(set)) {
        const bool all_stick = std::find(set.begin(), set.end(), 0) == set.end();
        result_.outcome = all_stick ? StaticOutcome::mechanism : StaticOutcome::gives_way;
        return std::move(result_);
      }
      step();
      std::vector<char> next = sliders_.sticking(result_.state.q);
      if (next == set) {
        for (int refinement = 0; refinement < 2; ++refinement) step();
        finish();
        return std::move(result_);
      }
      set = std::move(next);
    }
    result_.outcome = StaticOutcome::not_settled;
    return std::move(result_);
  }

 private:
  SparseMatrix tangent(const std::vector<char>& set) const {
    std::vector<Eigen::Triplet<double>> entries;
    const SparseMatrix& k = system_.stiffness();
    entries.reserve(static_cast<std::size_t>(k.nonZeros()) + free_.size() + 4 * set.size());
    const auto add = [&](Index row, Index column, double value) {
      const Index i = place_[static_cast<std::size_t>(row)], j = place_[static_cast<std::size_t>(column)];
      if (i != ground && j != ground) entries.emplace_back(i, j, value);
    };
    for (Index column = 0; column < k.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(k, column); entry; ++entry) add(entry.row(), column, entry.value());
    for (std::size_t i = 0; i < set.size(); ++i) {
      const auto& slider = system_.sliders()[i];
      if (!set[i]) continue;
      if (slider.first != ground) add(slider.first, slider.first, slider.stiffness);
      if (slider.second != ground) add(slider.second, slider.second, slider.stiffness);
      if (slider.first == ground || slider.second == ground) continue;
      add(slider.first, slider.second, -slider.stiffness);
      add(slider.second, slider.first, -slider.stiffness);
    }
    const auto n = static_cast<Index>(free_.size());
    for (Index i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);  // the diagonal is always there
    SparseMatrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  bool factorise(const std::vector<char>& set) {
    if (free_.empty()) return true;
    const SparseMatrix matrix = tangent(set);
    factor_.compute(matrix);
    ++result_.factorisations;
    const Vector diagonal = matrix.diagonal();
    bool is_suspect = factor_.info() != Eigen::Success;
    if (!is_suspect) {
      const Vector pivots = factor_.vectorD();
      const auto& order = factor_.permutationP().indices();
      for (Index i = 0; i < diagonal.size(); ++i)
        is_suspect = is_suspect || !(std::abs(pivots[order[i]]) > small_pivot * std::abs(diagonal[i]));
    }
    if (!is_suspect) return true;
    const Vector motion = easiest_motion(matrix, diagonal);
    const double energy = motion.dot(matrix * motion);
    const double terms = motion.cwiseAbs().dot(matrix.cwiseAbs() * motion.cwiseAbs());
    if (factor_.info() == Eigen::Success && energy > no_energy * terms) {
      factor_.compute(matrix);
      ++result_.factorisations;
      if (factor_.info() == Eigen::Success) return true;
    }
    name_moving(motion, diagonal);
    return false;
  }

  /// The motion of least resistance, by inverse iteration with the matrix shifted by a share of its diagonal.
  Vector easiest_motion(SparseMatrix matrix, const Vector& diagonal) {
    const Vector scale = scale_of(diagonal);
    for (Index i = 0; i < scale.size(); ++i) matrix.coeffRef(i, i) += shift * scale[i];
    factor_.compute(matrix);
    ++result_.factorisations;
    Vector motion(scale.size());
    for (Index i = 0; i < motion.size(); ++i)  // meets every motion, and the same ones on every run
      motion[i] = (1.0 + 0.5 * std::sin(1.0 + 2.7 * static_cast<double>(i))) / std::sqrt(scale[i]);
    for (int iteration = 0; iteration < 4; ++iteration) {
      motion = factor_.solve(scale.cwiseProduct(motion).eval());
      motion /= motion.cwiseAbs().maxCoeff();
    }
    return motion;
  }

  static Vector scale_of(const Vector& diagonal) {
    return diagonal.cwiseAbs().cwiseMax(shift * std::max(diagonal.cwiseAbs().maxCoeff(), 1.0));
  }

  void name_moving(const Vector& motion, const Vector& diagonal) {
    // Metres and radians compare by the energy that moving one coordinate alone would take.
    const Vector share = scale_of(diagonal).cwiseSqrt().cwiseProduct(motion.cwiseAbs());
    for (Index i = 0; i < share.size(); ++i)
      if (!(share[i] <= 1e-3 * share.maxCoeff())) result_.moving.push_back(free_[static_cast<std::size_t>(i)]);
  }

  /// Residual f - K q - B fc of the free coordinates, at the forces that the sliders have at q.
  void step() {
    Vector& q = result_.state.q;
    const double before = energy(q);
    const Vector residual = unbalanced(q);
    if (free_.empty()) return;
    Vector right(static_cast<Index>(free_.size()));
    for (std::size_t i = 0; i < free_.size(); ++i) right[static_cast<Index>(i)] = residual[free_[i]];
    const Vector change = factor_.solve(right);
    const Vector from = q;
    for (double length = 1.0; length > 1e-6; length *= 0.5) {
      for (std::size_t i = 0; i < free_.size(); ++i)
        q[free_[i]] = from[free_[i]] + length * change[static_cast<Index>(i)];
      // Without sliders the full step is exact, and round-off must not shorten it.
      if (system_.slider_count() == 0 || energy(q) <= before + 1e-10 * std::abs(before)) return;
    }
  }

  Vector unbalanced(const Vector& q) {
    sliders_.load(q);
    Vector residual = load_ - system_.stiffness() * q;
    system_.add_slider_forces(sliders_.force, -1.0, residual);
    return residual;
  }

  double energy(const Vector& q) { return 0.5 * q.dot(system_.stiffness() * q) - load_.dot(q) + sliders_.load(q); }

  void finish() {
    const Vector residual = unbalanced(result_.state.q);
    result_.state.slider_force = sliders_.force;
    result_.reaction.resize(static_cast<Index>(held_.size()));
    for (std::size_t i = 0; i < held_.size(); ++i)
      result_.reaction[static_cast<Index>(i)] = -residual[held_[i].coordinate];
    result_.outcome = StaticOutcome::found;
  }

  const system::LocallyNonlinear& system_;
  std::span<const model::Held> held_;
  Sliders sliders_;
  Vector load_;
  std::vector<Index> place_, free_;  // place of a coordinate among the free ones, and back
  Factor factor_;
  StaticEquilibrium result_;
};

}  // namespace

StaticEquilibrium find_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held) {
  return StaticSolver(system, held).solve();
}

}  // namespace rubato::analysis
