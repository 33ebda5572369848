#include <rubato/steady/harmonic_balance/condensed_structure_routes.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::steady {
namespace {

constexpr Index most_state_space = 60;  // coordinates: the eigenproblem takes 25 (2n)^3 operations, unsymmetric
constexpr Index most_dense = 300;       // coordinates, where C is sparse
constexpr Index least_points = 20;      // of a sweep, for which a basis is worth its making
constexpr double direct_fill = 10.0;    // entries of a factor a row: below (chains) it costs little
constexpr double full = 0.05;           // part of C that is not zero, from which it counts as a full matrix

// kT, or what the structure itself has at the ends of the slider, or anywhere: stiffer springs would take the digits of
// the rest of Z.
double holding_stiffness_of(const std::vector<model::Share>& column, double stiffness, const Vector& diagonal) {
  double of_structure = 0.0;
  for (const auto& [place, weight] : column)
    if (weight != 0.0) of_structure = std::max(of_structure, diagonal[place] / (weight * weight));
  if (!(of_structure > 0.0) && diagonal.size() > 0) of_structure = diagonal.maxCoeff();
  return of_structure > 0.0 ? std::min(stiffness, of_structure) : stiffness;
}

}  // namespace

double contact_stiffness(const system::LocallyNonlinear& system, Index contact) {
  if (contact < system.first_law())
    return system.stops()[static_cast<std::size_t>(contact - system.slider_count())].stiffness;
  if (contact >= system.first_block()) {
    const Index block = system.block_at(contact);
    return system.blocks()[static_cast<std::size_t>(block)].law->limit_stiffness(contact - system.row_of_block(block),
                                                                                 true);
  }
  const Index law = contact - system.first_law();
  const Vector memory = Vector::Zero(system.memory_size());
  const model::Law& one = *system.laws()[static_cast<std::size_t>(law)].law;
  return one.at({}, memory.data() + system.memory_of(law)).by_u + one.sticking_stiffness();
}

namespace {

// That of a law which does not resist at rest: any will do.
double holding_stiffness_of_law(const system::LocallyNonlinear& system, Index contact, const Vector& diagonal) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double at_rest = contact_stiffness(system, contact);
  const double held = holding_stiffness_of(system.column(contact), at_rest > 0.0 ? at_rest : infinity, diagonal);
  return std::isfinite(held) ? held : 1.0;
}

}  // namespace

CondensedStructure::CondensedStructure(const system::LocallyNonlinear& system,
                                       const std::vector<SteadyRequest::Observed>& observed, const LinearSweep& sweep) {
  const Index n = system.size(), sliders = system.slider_count(), m = system.contact_count();
  columns_ =
      std::make_unique<Columns>(Columns{system, Vector(m), Vector(m), Matrix::Zero(n, m), Matrix(n, 0), observed});
  const Vector diagonal = system.stiffness().diagonal();
  for (Index i = 0; i < m; ++i) {
    const std::vector<model::Share> column = system.column(i);
    for (const auto& [place, weight] : column) columns_->sliders(place, i) += weight;
    if (i < sliders) {
      columns_->slider_stiffness[i] = system.sliders()[static_cast<std::size_t>(i)].stiffness;
      columns_->holding_stiffness[i] = holding_stiffness_of(column, columns_->slider_stiffness[i], diagonal);
    } else {
      columns_->slider_stiffness[i] = columns_->holding_stiffness[i] = holding_stiffness_of_law(system, i, diagonal);
    }
  }
  const auto entries = static_cast<double>(system.damping().nonZeros());
  const bool is_small = n <= most_dense || entries > full * static_cast<double>(n) * static_cast<double>(n);
  factorisation_ = is_small ? dense_factorisation(*columns_) : sparse_factorisation(*columns_);
  if (is_small) route_ = real_modes(*columns_);
  if (!route_ && n <= most_state_space) route_ = complex_modes(*columns_);
  if (!is_small && sweep.points >= least_points && sweep.highest > 0.0)
    route_ = reduced_modes(*columns_, sweep.highest);
}

CondensedStructure::~CondensedStructure() = default;
CondensedStructure::CondensedStructure(CondensedStructure&&) noexcept = default;

Index CondensedStructure::slider_count() const { return columns_->sliders.cols(); }
Index CondensedStructure::load_count() const { return columns_->loads.cols(); }
Index CondensedStructure::observed_count() const { return static_cast<Index>(columns_->observed.size()); }

const Vector& CondensedStructure::holding_stiffness() const { return columns_->holding_stiffness; }

void CondensedStructure::set_loads(const Matrix& patterns) {
  columns_->loads = patterns;
  if (route_) route_->set_loads();
  factorisation_->set_loads();
}

CondensedStructure::Route& CondensedStructure::route(double w, double held) {
  return route_ && held == 0.0 && route_->reaches(w) ? *route_ : *factorisation_;
}

CondensedStructure::Outcome CondensedStructure::condense(double w, double held, ComplexMatrix& receptance) {
  return route(w, held).condense(w, held, receptance);
}

void CondensedStructure::expand(double w, double held, const ComplexVector& forces, ComplexVector& position) {
  route(w, held).expand(w, held, forces, position);
}

double CondensedStructure::highest_frequency() const {
  return (route_ ? *route_ : *factorisation_).highest_frequency();
}

}  // namespace rubato::steady
