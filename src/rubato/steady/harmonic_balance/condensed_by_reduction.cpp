#include <rubato/core/stopping.hpp>
#include <rubato/numerics/complex_ldlt.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/assembled_stiffness.hpp>
#include <rubato/steady/harmonic_balance/condensed_structure_routes.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubato::steady {
namespace {

using Outcome = CondensedStructure::Outcome;
using Columns = CondensedStructure::Columns;

constexpr double accepted = 1e-8;    // relative error of G, against the factorisation
constexpr double rounded = 1e-6;     // the same where the solutions are in the basis: digits the structure itself loses
constexpr double dependent = 1e-7;   // of a solution left outside the basis, in the norm of the diagonal
constexpr double beside = 1e-3;      // from a mode to where it is tested: on it round-off of the matrices is tested
constexpr double found = 1e-10;      // residual of a mode that needs no test
constexpr Index most_vectors = 600;  // of the basis,
constexpr double most_entries = 1e7;  // in numbers,
constexpr Index least_share = 3;      // and of all coordinates at most one in so many
constexpr std::size_t most_samples = 120;
constexpr int most_passes = 16, tested_a_pass = 3;
constexpr int most_builds = 3;
constexpr double first_orders = 4.0;  // of the loads, for which the basis is made first
constexpr double lowest_part = 0.01;  // of the highest frequency: where a structure that floats begins

/// G at one frequency, by factorisation.
struct Sample {
  double frequency;
  ComplexMatrix receptance;
  bool is_in_basis = false;  ///< with its solutions: G differs by round-off of the structure
};

/// Z(w)^-1 P by factorisation, once refined.
class ExactSolutions {
 public:
  explicit ExactSolutions(const system::LocallyNonlinear& system)
      : stiffness_(system, SparseMatrix(system.size(), system.size())) {
    factor_.analyse(stiffness_.pattern());
  }

  /// False where Z is singular.
  bool solve(double w, const ComplexMatrix& forces, ComplexMatrix& positions) {
    stiffness_.assemble(w, 0.0);
    if (factor_.factorise(stiffness_.matrix(), stiffness_.scale()) > 0) return false;
    positions = forces;
    factor_.solve(positions);
    ComplexMatrix rest = forces - stiffness_.matrix() * positions;
    factor_.solve(rest);
    positions += rest;
    return positions.allFinite() &&
           rest.cwiseAbs().maxCoeff() <= nearly_singular * std::max(positions.cwiseAbs().maxCoeff(), 1e-300);
  }

 private:
  AssembledStiffness stiffness_;
  numerics::ComplexLdlt factor_;
};

/// Vectors V, orthonormal in the units of the diagonal, and what K, M and C are among them.
class Basis {
 public:
  Basis(const system::LocallyNonlinear& system, double highest)
      : stiffness_(system.stiffness()),
        mass_(system.mass()),
        damping_(system.damping()),
        weights_(Vector(stiffness_.diagonal()).cwiseAbs() + highest * highest * Vector(mass_.diagonal()).cwiseAbs()) {
    if (!(weights_.minCoeff() > 0.0)) weights_.array() += 1e-12 * weights_.maxCoeff();
    vectors_.resize(weights_.size(), 0);
  }

  Index size() const { return vectors_.cols(); }
  const Matrix& vectors() const { return vectors_; }
  const Matrix& stiffness() const { return reduced_[0]; }
  const Matrix& mass() const { return reduced_[1]; }
  const Matrix& damping() const { return reduced_[2]; }

  void add(const ComplexMatrix& positions) {
    const Index before = size();
    for (Index c = 0; c < positions.cols(); ++c) {
      const double length = positions.col(c).norm();
      add(positions.col(c).real(), length);
      add(positions.col(c).imag(), length);
    }
    const Index added = size() - before;
    if (added == 0) return;
    const SparseMatrix* const full[] = {&stiffness_, &mass_, &damping_};
    for (std::size_t i = 0; i < reduced_.size(); ++i) {
      const Matrix rows = vectors_.transpose() * (*full[i] * vectors_.rightCols(added));
      reduced_[i].conservativeResize(size(), size());
      reduced_[i].rightCols(added) = rows;
      reduced_[i].bottomRows(added) = rows.transpose();
    }
  }

  /// Of K phi = omega^2 M phi for some shapes: the residual in the units of the diagonal, relative [k].
  Vector residuals(const Matrix& shapes, const Vector& squares) const {
    const Matrix force = stiffness_ * shapes - mass_ * (shapes * squares.asDiagonal());
    Vector out(squares.size());
    for (Index j = 0; j < out.size(); ++j)
      out[j] = std::sqrt((force.col(j).array().square() / weights_.array()).sum() /
                         (shapes.col(j).array().square() * weights_.array()).sum());
    return out;
  }

 private:
  void add(Vector v, double length) {
    const double whole = std::sqrt(v.dot(weights_.cwiseProduct(v)));
    if (!(v.norm() > dependent * length) || !(whole > 0.0) || !std::isfinite(whole)) return;
    v /= whole;
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan)
      const Vector heavy = weights_.cwiseProduct(v);
      v.noalias() -= vectors_ * (vectors_.transpose() * heavy).eval();
      const double rest = std::sqrt(v.dot(weights_.cwiseProduct(v)));
      if (!(rest > dependent)) return;
      v /= rest;
    }
    vectors_.conservativeResize(Eigen::NoChange, size() + 1);
    vectors_.col(size() - 1) = v;
  }

  SparseMatrix stiffness_, mass_, damping_;
  Vector weights_;
  Matrix vectors_;
  std::array<Matrix, 3> reduced_;
};

/// The modes of a structure in a basis of its own answers to the columns at some frequencies (rational Krylov vectors:
/// Grimme 1997). As all of P answers to all of P the error of G is the square of that of the basis. Frequencies are
/// added until G is that of the factorisation within `accepted`, at points over the range and beside those modes that
/// are known worst.
class ReducedModes final : public CondensedStructure::Route {
 public:
  ReducedModes(const Columns& columns, double highest) : columns_(columns), load_highest_(highest) {
    const auto n = static_cast<double>(columns.system.size());
    most_ = std::min({most_vectors, static_cast<Index>(most_entries / n), columns.system.size() / least_share});
  }

  void set_loads() override {
    if (columns_.loads.cols() == built_for_.cols() && columns_.loads == built_for_) return;
    built_for_ = columns_.loads;
    modes_.reset();
    lowest_ = highest_ = 0.0;
    if (columns_.loads.cols() == 0 || ++builds_ > most_builds || 4 * columns_.count() > most_) return;
    samples_.clear();
    driven_ = ComplexMatrix(columns_.system.size(), columns_.count());
    driven_ << columns_.sliders.cast<Complex>(), columns_.loads.cast<Complex>(), observed_columns();
    Basis basis(columns_.system, first_orders * load_highest_);
    ExactSolutions exact(columns_.system);
    std::unique_ptr<Route> reached;
    // The loads' own orders first; as far as the basis bears.
    for (const double orders : {first_orders, 8.0, 16.0, 32.0, 64.0}) {
      const double highest = orders * load_highest_;
      if (!cover(highest, basis, exact)) break;
      highest_ = highest;
      reached = std::move(modes_);
    }
    modes_ = std::move(reached);
  }

  bool reaches(double w) const override { return modes_ && w >= lowest_ && w <= highest_; }
  Outcome condense(double w, double held, ComplexMatrix& g) override { return modes_->condense(w, held, g); }
  void expand(double w, double held, const ComplexVector& forces, ComplexVector& position) override {
    modes_->expand(w, held, forces, position);
  }

 private:
  ComplexMatrix observed_columns() const {
    ComplexMatrix out = ComplexMatrix::Zero(columns_.system.size(), static_cast<Index>(columns_.observed.size()));
    for (std::size_t i = 0; i < columns_.observed.size(); ++i)
      columns_.observed[i].for_each(
          [&](Index coordinate, double weight) { out(coordinate, static_cast<Index>(i)) += weight; });
    return out;
  }

  static bool are_near(double one, double other) { return std::abs(one - other) <= 0.5 * beside * other; }
  bool is_sampled(double w) const {
    return std::any_of(samples_.begin(), samples_.end(), [&](const Sample& s) { return are_near(s.frequency, w); });
  }

  /// Where G has yet to be tested for frequencies up to `highest`.
  std::vector<double> untested(double highest) const {
    std::vector<double> out;
    const auto want = [&](double w) {
      const bool is_new = std::none_of(out.begin(), out.end(), [&](double other) { return are_near(other, w); });
      if (w >= lowest_ && w <= highest && is_new && !is_sampled(w)) out.push_back(w);
    };
    for (const double part : {1.0, 0.87, 0.74, 0.62, 0.5}) want(part * highest);
    if (highest_ == 0.0)
      for (const double part : {0.35, 0.25, 0.17, 0.1, 0.04}) want(part * highest);
    std::vector<std::pair<double, double>> doubtful;
    for (Index j = 0; j < squares_.size(); ++j)
      if (residuals_[j] > found && squares_[j] > 0.0) doubtful.emplace_back(residuals_[j], std::sqrt(squares_[j]));
    std::sort(doubtful.rbegin(), doubtful.rend());
    for (const auto& [residual, frequency] : doubtful) {
      if (out.size() >= 10 + tested_a_pass) break;
      want((1.0 + beside) * frequency);
    }
    return out;
  }

  /// Grows the basis until it answers right up to a frequency.
  bool cover(double highest, Basis& basis, ExactSolutions& exact) {
    for (int pass = 0; pass < most_passes; ++pass) {
      std::vector<double> next;
      bool is_test = false;
      if (basis.size() == 0) {
        next = {0.0, highest};
      } else {
        if (!reduce(basis, highest)) return false;
        // What is worse than before joins the basis itself.
        for (std::size_t i = samples_.size(); i-- > 0;) {
          if (samples_[i].frequency > highest || agrees(samples_[i])) continue;
          if (samples_[i].is_in_basis) return false;
          next.push_back(samples_[i].frequency);
          samples_.erase(samples_.begin() + static_cast<std::ptrdiff_t>(i));
        }
        is_test = next.empty();
        if (is_test) next = untested(highest);
      }
      if (samples_.size() + next.size() > most_samples) return false;
      const Index before = basis.size();
      for (double w : next) {
        ComplexMatrix positions;
        if (!exact.solve(w, driven_, positions)) {
          // It floats, or is in resonance there.
          w = w == 0.0 ? lowest_ = lowest_part * load_highest_ : (1.0 + beside) * w;
          if (!exact.solve(w, driven_, positions)) return false;
        }
        Sample sample{w, columns_.project(positions).leftCols(columns_.driven())};
        if (!modes_ || !agrees(sample)) {
          basis.add(positions);
          sample.is_in_basis = true;
        }
        samples_.push_back(std::move(sample));
        if (basis.size() > most_) return false;
      }
      if (is_test && basis.size() == before) return true;
    }
    return false;
  }

  bool reduce(const Basis& basis, double highest) {
    stop_if_asked();
    const numerics::SymmetricModes modes =
        numerics::all_modes(basis.stiffness().sparseView(), basis.mass().sparseView());
    if (!modes.has_converged) return false;
    modes_ = modes_in_basis(columns_, basis.vectors(), modes, basis.damping());
    if (!modes_) return false;
    const Index low = (modes.eigenvalues.array() <= highest * highest).count();
    squares_ = modes.eigenvalues.head(low);
    residuals_ = basis.residuals(basis.vectors() * modes.shapes.leftCols(low), squares_);
    return true;
  }

  bool agrees(const Sample& sample) {
    ComplexMatrix g;
    (void)modes_->condense(sample.frequency, 0.0, g);
    const ComplexMatrix& exact = sample.receptance;
    if (g.rows() != exact.rows() || g.cols() != exact.cols() || !g.allFinite()) return false;
    // Forces of sliders fall with the square of the order, and so may the digits of what answers to them.
    const double order = std::max(1.0, sample.frequency / (first_orders * load_highest_));
    const double allowed = std::max(sample.is_in_basis ? rounded : 0.0, accepted * order * order);
    // Each entry beside what its row and its column can reach.
    Vector size = exact.topRows(exact.cols()).diagonal().cwiseAbs().cwiseSqrt();
    for (Index j = 0; j < size.size(); ++j)
      if (!(size[j] > 0.0)) size[j] = std::sqrt(std::numeric_limits<double>::min());
    for (Index i = 0; i < exact.rows(); ++i) {
      const double reach = (exact.row(i).transpose().cwiseAbs().array() / size.array()).maxCoeff();
      if (((g.row(i) - exact.row(i)).transpose().cwiseAbs().array() > allowed * reach * size.array()).any())
        return false;
    }
    return true;
  }

  const Columns& columns_;
  double load_highest_;
  Index most_ = 0;
  Matrix built_for_;  ///< loads
  int builds_ = 0;
  double lowest_ = 0.0, highest_ = 0.0;
  ComplexMatrix driven_;
  std::vector<Sample> samples_;
  Vector squares_, residuals_;  ///< of the modes in the range
  std::unique_ptr<Route> modes_;
};

}  // namespace

std::unique_ptr<CondensedStructure::Route> reduced_modes(const Columns& columns, double highest) {
  return std::make_unique<ReducedModes>(columns, highest);
}

}  // namespace rubato::steady
