#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>
#include <rubato/numerics/ordered_factor.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace rubato::system {
namespace {

bool is_diagonal(const SparseMatrix& matrix) {
  for (Index column = 0; column < matrix.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      if (entry.row() != column && entry.value() != 0.0) return false;
  return true;
}

}  // namespace

LocallyNonlinear::LocallyNonlinear(Parts parts) : parts_(std::move(parts)) {
  const Index n = size();
  assert(parts_.damping.rows() == n && parts_.stiffness.rows() == n);
  State& start = parts_.start;
  if (start.q.size() == 0) start.q = Vector::Zero(n);
  if (start.v.size() == 0) start.v = Vector::Zero(n);
  for (const auto& slider : parts_.sliders) contacts_.push_back({slider.first, slider.second});
  for (const auto& stop : parts_.stops) contacts_.push_back({stop.first, stop.second});
  for (const auto& law : parts_.laws) {
    for (const model::Share& share : law.shares) shares_.push_back({contact_count(), share.coordinate, share.weight});
    contacts_.push_back({law.first, law.second});
    memory_start_.push_back(memory_size_);
    memory_size_ += law.law->memory_size();
    has_laws_of_time_ = has_laws_of_time_ || law.law->depends_on_time() || law.normal.formula;
  }
  order_laws();
  place_blocks();
  if (start.memory.size() == 0) start.memory = Vector::Zero(memory_size_);
  assert(start.memory.size() == memory_size_);
  if (start.slider_force.size() == 0) start.slider_force = Vector::Zero(contact_count());
  assert(start.slider_force.size() == contact_count());
  set_stop_forces(start);
  set_law_forces(start, model::Side::right);
  if (start.auxiliary_acceleration.size() == 0) start.auxiliary_acceleration = Vector::Zero(n);
  parts_.mass.makeCompressed();
  parts_.damping.makeCompressed();
  parts_.stiffness.makeCompressed();
  has_diagonal_mass_ = is_diagonal(parts_.mass);
}

void LocallyNonlinear::order_laws() {
  const auto count = static_cast<std::size_t>(law_count());
  normal_contact_.assign(count, -1);
  for (std::size_t j = 0; j < count; ++j) {
    const model::LawBetween& law = parts_.laws[j];
    if (!law.law->takes_normal()) continue;
    has_normals_ = true;
    if (law.normal.stop >= 0) normal_contact_[j] = slider_count() + law.normal.stop;
    if (law.normal.law >= 0) normal_contact_[j] = first_law() + law.normal.law;
    assert(normal_contact_[j] < contact_count());
  }
  if (!has_normals_) {
    law_order_.resize(count);
    std::iota(law_order_.begin(), law_order_.end(), Index{0});
    return;
  }
  std::vector<char> is_placed(count, 0);
  const auto is_ready = [&](std::size_t j) {
    const Index by = normal_contact_[j] - first_law();
    return is_placed[j] == 0 && (by < 0 || is_placed[static_cast<std::size_t>(by)] != 0);
  };
  for (std::size_t placed = 0; placed < count; ++placed) {
    std::size_t next = 0;
    while (next < count && !is_ready(next)) ++next;
    if (next == count) {
      const auto left = static_cast<std::size_t>(std::find(is_placed.begin(), is_placed.end(), 0) - is_placed.begin());
      throw InvalidInput(fmt::format("what presses on \"{}\" depends on itself, by the normal forces of other laws",
                                     parts_.laws[left].name));
    }
    is_placed[next] = 1;
    law_order_.push_back(static_cast<Index>(next));
  }
}

void LocallyNonlinear::place_blocks() {
  for (const model::BlockBetween& block : parts_.blocks) {
    block_row_.push_back(contact_count());
    block_memory_.push_back(memory_size_);
    memory_size_ += block.law->memory_size();
    for (Index i = 0; i < block.law->size(); ++i) {
      for (const model::Share& share : block.columns[static_cast<std::size_t>(i)])
        shares_.push_back({contact_count(), share.coordinate, share.weight});
      contacts_.push_back({});
    }
  }
  first_share_.assign(contacts_.size() + 1, 0);
  for (const ContactShare& share : shares_) ++first_share_[static_cast<std::size_t>(share.contact) + 1];
  std::partial_sum(first_share_.begin(), first_share_.end(), first_share_.begin());
}

Index LocallyNonlinear::block_at(Index contact) const {
  const auto after = std::upper_bound(block_row_.begin(), block_row_.end(), contact);
  return static_cast<Index>(after - block_row_.begin()) - 1;
}

model::BlockPoint LocallyNonlinear::block_point(Index b, const State& state) const {
  model::BlockPoint point;
  const Index first = row_of_block(b), size = parts_.blocks[static_cast<std::size_t>(b)].law->size();
  for (Index i = 0; i < size; ++i) {
    point.u[i] = relative_displacement(first + i, state.q);
    point.rate[i] = relative_displacement(first + i, state.v);
  }
  if (const double velocity = parts_.blocks[static_cast<std::size_t>(b)].law->sliding_velocity()) {
    point.u[0] += velocity * state.t;
    point.rate[0] += velocity;
  }
  return point;
}

double LocallyNonlinear::normal_force(Index j, const State& state, const Vector& contact_force,
                                      model::Side side) const {
  const model::LawBetween& law = parts_.laws[static_cast<std::size_t>(j)];
  if (!law.law->takes_normal()) return 0.0;
  const Index by = normal_contact(j);
  if (by < 0) return law.normal.at(state.t, side);
  if (by >= first_law()) return contact_force[by];
  if (contact_force[by] > 0.0) return contact_force[by];
  const model::Stop& stop = parts_.stops[static_cast<std::size_t>(by - slider_count())];
  return std::min(0.0, stop.stiffness * (relative_displacement(by, state.q) - stop.gap));
}

bool LocallyNonlinear::has_friction() const {
  return slider_count() > 0 || block_count() > 0 ||
         std::any_of(parts_.laws.begin(), parts_.laws.end(),
                     [](const model::LawBetween& law) { return law.law->sticking_stiffness() > 0.0; });
}

void LocallyNonlinear::add_slider_forces(const Vector& slider_force, double factor, Vector& out) const {
  for (Index i = 0; i < contact_count(); ++i) {
    const Ends& ends = contacts_[static_cast<std::size_t>(i)];
    if (ends.first != ground) out[ends.first] += factor * slider_force[i];
    if (ends.second != ground) out[ends.second] -= factor * slider_force[i];
  }
  for (const ContactShare& share : shares_)
    out[share.coordinate] += factor * share.weight * slider_force[share.contact];
}

std::vector<model::Share> LocallyNonlinear::column(Index contact) const {
  std::vector<model::Share> column;
  const Ends& ends = contacts_[static_cast<std::size_t>(contact)];
  if (ends.first != ground) column.push_back({ends.first, 1.0});
  if (ends.second != ground) column.push_back({ends.second, -1.0});
  for (const ContactShare& share : shares_)
    if (share.contact == contact) column.push_back({share.coordinate, share.weight});
  return column;
}

bool LocallyNonlinear::is_of_rotations(Index contact) const {
  const std::vector<model::Share> joined = column(contact);
  return std::all_of(joined.begin(), joined.end(),
                     [&](const model::Share& share) { return is_rotation(share.coordinate); });
}

void LocallyNonlinear::set_stop_forces(State& state) const {
  for (Index j = 0; j < stop_count(); ++j) state.slider_force[slider_count() + j] = stop_force(j, state.q, state.v);
}

void LocallyNonlinear::find_law_forces(const State& state, model::Side side, Vector& contact_force) const {
  for (const Index j : law_order_) {
    const Index i = first_law() + j;
    const model::LawPoint point{relative_displacement(i, state.q), relative_displacement(i, state.v), state.t, side,
                                has_normals_ ? normal_force(j, state, contact_force, side) : 0.0};
    contact_force[i] =
        parts_.laws[static_cast<std::size_t>(j)].law->at(point, state.memory.data() + memory_of(j)).force;
  }
  for (Index b = 0; b < block_count(); ++b) {
    const model::BlockLaw& law = *parts_.blocks[static_cast<std::size_t>(b)].law;
    const model::BlockAnswer answer = law.at(block_point(b, state), state.memory.data() + memory_of_block(b));
    std::copy_n(answer.force, law.size(), contact_force.data() + row_of_block(b));
  }
}

void LocallyNonlinear::add_law_breakpoints(double from, double to, std::vector<double>& times) const {
  for (const auto& law : parts_.laws) {
    numerics::add_switches(law.law->breakpoints(from, to), from, to, times);
    if (law.normal.formula && law.normal.formula->has_switches())
      numerics::add_switches(law.normal.formula->switches(from, to), from, to, times);
  }
}

void LocallyNonlinear::move_laws(const State& before, State& state) const {
  for (const Index j : law_order_)
    state.slider_force[first_law() + j] =
        parts_.laws[static_cast<std::size_t>(j)]
            .law
            ->advance(law_point(j, before, model::Side::right), before.memory.data() + memory_of(j),
                      law_point(j, state, model::Side::left), state.memory.data() + memory_of(j))
            .force;
  for (Index b = 0; b < block_count(); ++b) {
    const model::BlockLaw& law = *parts_.blocks[static_cast<std::size_t>(b)].law;
    const Index place = memory_of_block(b);
    const model::BlockAnswer answer = law.advance(block_point(b, before), before.memory.data() + place,
                                                  block_point(b, state), state.memory.data() + place);
    std::copy_n(answer.force, law.size(), state.slider_force.data() + row_of_block(b));
  }
}

SparseMatrix LocallyNonlinear::with_contacts(const SparseMatrix& matrix,
                                             const std::vector<double>& coefficients) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const std::vector<model::Share> joined = column(static_cast<Index>(i));
    for (const model::Share& row : joined)
      for (const model::Share& other : joined)
        entries.emplace_back(row.coordinate, other.coordinate, row.weight * other.weight * coefficients[i]);
  }
  SparseMatrix added(size(), size());
  added.setFromTriplets(entries.begin(), entries.end());
  return SparseMatrix(matrix + added);
}

std::vector<double> LocallyNonlinear::law_slopes(double model::LawAnswer::*slope) const {
  std::vector<double> coefficients(contacts_.size(), 0.0);
  const Vector memory = Vector::Zero(memory_size_);
  for (Index j = 0; j < law_count(); ++j)
    coefficients[static_cast<std::size_t>(first_law() + j)] =
        parts_.laws[static_cast<std::size_t>(j)].law->at({}, memory.data() + memory_of(j)).*slope;
  return coefficients;
}

void LocallyNonlinear::set_block_limits(bool is_stuck, std::vector<double>& coefficients) const {
  for (Index b = 0; b < block_count(); ++b) {
    const model::BlockLaw& law = *parts_.blocks[static_cast<std::size_t>(b)].law;
    for (Index i = 0; i < law.size(); ++i)
      coefficients[static_cast<std::size_t>(row_of_block(b) + i)] = law.limit_stiffness(i, is_stuck);
  }
}

SparseMatrix LocallyNonlinear::free_stiffness() const {
  if (!has_laws()) return parts_.stiffness;
  std::vector<double> coefficients = law_slopes(&model::LawAnswer::by_u);
  set_block_limits(false, coefficients);
  return with_contacts(parts_.stiffness, coefficients);
}

SparseMatrix LocallyNonlinear::limit_damping(bool is_stuck) const {
  if (!has_laws()) return parts_.damping;
  std::vector<double> coefficients = law_slopes(&model::LawAnswer::by_rate);
  for (Index b = 0; b < block_count(); ++b) {
    const model::BlockLaw& law = *parts_.blocks[static_cast<std::size_t>(b)].law;
    const Index normal = law.size() - 1;
    if (law.limit_stiffness(normal, is_stuck) > 0.0)
      coefficients[static_cast<std::size_t>(row_of_block(b) + normal)] = law.closed_damping();
  }
  return with_contacts(parts_.damping, coefficients);
}

SparseMatrix LocallyNonlinear::free_damping() const { return limit_damping(false); }

SparseMatrix LocallyNonlinear::stuck_damping() const { return limit_damping(true); }

SparseMatrix LocallyNonlinear::stuck_stiffness() const {
  std::vector<double> coefficients;
  for (const auto& slider : parts_.sliders) coefficients.push_back(slider.stiffness);
  coefficients.resize(static_cast<std::size_t>(first_law()), 0.0);
  for (const auto& law : parts_.laws) coefficients.push_back(law.law->sticking_stiffness());
  if (block_count() == 0) return with_contacts(free_stiffness(), coefficients);
  coefficients.resize(contacts_.size());
  std::vector<double> without = law_slopes(&model::LawAnswer::by_u);
  for (std::size_t i = 0; i < without.size(); ++i) coefficients[i] += without[i];
  set_block_limits(true, coefficients);
  return with_contacts(parts_.stiffness, coefficients);
}

SparseMatrix LocallyNonlinear::closed_stiffness() const {
  std::vector<double> coefficients = law_slopes(&model::LawAnswer::by_u);
  std::size_t i = 0;
  for (const auto& slider : parts_.sliders) coefficients[i++] = slider.stiffness;
  for (const auto& stop : parts_.stops) coefficients[i++] = stop.stiffness;
  for (const auto& law : parts_.laws) {
    const double largest = law.law->largest_stiffness();
    if (std::isfinite(largest)) coefficients[i] = largest;
    ++i;
  }
  set_block_limits(true, coefficients);
  return with_contacts(parts_.stiffness, coefficients);
}

SparseMatrix LocallyNonlinear::closed_damping() const {
  std::vector<double> coefficients = law_slopes(&model::LawAnswer::by_rate);
  std::size_t i = parts_.sliders.size();
  for (const auto& stop : parts_.stops) coefficients[i++] = stop.damping;
  for (Index b = 0; b < block_count(); ++b) {
    const model::BlockLaw& law = *parts_.blocks[static_cast<std::size_t>(b)].law;
    coefficients[static_cast<std::size_t>(row_of_block(b) + law.size() - 1)] = law.closed_damping();
  }
  return with_contacts(parts_.damping, coefficients);
}

struct EquilibriumAcceleration::Workspace {
  explicit Workspace(const LocallyNonlinear& s) : system(s), loads(s.loads()), force(s.size()) {
    if (system.has_diagonal_mass()) {
      inverse_mass = Vector(system.mass().diagonal()).cwiseInverse();
    } else {
      factor.analyse(system.mass());
      if (!factor.factorise(system.mass()))
        throw InvalidInput("the mass matrix is not positive definite: some motion of the coordinates has no mass");
    }
  }
  const LocallyNonlinear& system;
  Loads loads;
  Vector force, inverse_mass, contact_force;
  numerics::OrderedFactor factor;
};

EquilibriumAcceleration::EquilibriumAcceleration(const LocallyNonlinear& system)
    : work_(std::make_unique<Workspace>(system)) {}
EquilibriumAcceleration::~EquilibriumAcceleration() = default;
EquilibriumAcceleration::EquilibriumAcceleration(EquilibriumAcceleration&&) noexcept = default;

void EquilibriumAcceleration::operator()(const State& state, Vector& acceleration, model::Side side) {
  Workspace& w = *work_;
  w.loads.evaluate(state.t, w.force, side);
  w.force.noalias() -= w.system.damping() * state.v;
  w.force.noalias() -= w.system.stiffness() * state.q;
  if (w.system.has_laws_of_time()) {
    w.contact_force = state.slider_force;
    w.system.find_law_forces(state, side, w.contact_force);
    w.system.add_slider_forces(w.contact_force, -1.0, w.force);
  } else {
    w.system.add_slider_forces(state.slider_force, -1.0, w.force);
  }
  of_force(w.force, acceleration);
}

void EquilibriumAcceleration::of_force(const Vector& force, Vector& acceleration) {
  Workspace& w = *work_;
  if (w.inverse_mass.size() > 0)
    acceleration = force.cwiseProduct(w.inverse_mass);
  else
    w.factor.solve(force, acceleration);
}

}  // namespace rubato::system
