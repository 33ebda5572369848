#include <rubato/core/error.hpp>
#include <rubato/numerics/rotations.hpp>
#include <rubato/system/mechanism.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::system {
namespace {

void require_mass(const Vector& diagonal, const std::vector<std::string>& names) {
  for (Index i = 0; i < diagonal.size(); ++i)
    if (!(diagonal[i] > 0.0))
      throw InvalidInput(fmt::format("\"{}\" is free and has no inertia ({}); give it a mass or an inertia, or fix it",
                                     names[static_cast<std::size_t>(i)], diagonal[i]));
}

using numerics::Rotation;
using numerics::Vector3;

Rotation rotation_in(const Vector& q, Index first) { return {q[first], q[first + 1], q[first + 2], q[first + 3]}; }

/// The entries of some places; 0 of those that are fixed.
Vector3 part_of(const Vector& x, const std::array<Index, 3>& place) {
  Vector3 part = Vector3::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    if (place[i] != ground) part[static_cast<Index>(i)] = x[place[i]];
  return part;
}

void put(const Vector3& part, const std::array<Index, 3>& place, Vector& x) {
  for (std::size_t i = 0; i < 3; ++i)
    if (place[i] != ground) x[place[i]] = part[static_cast<Index>(i)];
}

}  // namespace

Mechanism::Mechanism(model::Mechanism model) : model_(std::move(model)) {
  const Index n = size();
  std::vector<Eigen::Triplet<double>> entries;
  weight_ = Vector::Zero(n);
  const auto add = [&](Index row_node, std::size_t row_axis, Index column_node, std::size_t column_axis, double value) {
    const Index row = model_.nodes[static_cast<std::size_t>(row_node)].place[row_axis];
    const Index column = model_.nodes[static_cast<std::size_t>(column_node)].place[column_axis];
    if (row == ground) return;
    if (!model::is_rotation(column_axis)) weight_[row] += value * model_.gravity[static_cast<Index>(column_axis)];
    if (column != ground) entries.emplace_back(row, column, value);
  };
  for (const auto& mass : model_.masses) {
    add(mass.node, mass.axis, mass.other_node, mass.other_axis, mass.value);
    if (mass.node == mass.other_node && mass.axis == mass.other_axis) continue;
    add(mass.other_node, mass.other_axis, mass.node, mass.axis, mass.value);
  }
  mass_.resize(n, n);
  mass_.setFromTriplets(entries.begin(), entries.end());
  diagonal_ = mass_.diagonal();
  require_mass(diagonal_, coordinates());
  has_diagonal_mass_ = mass_.nonZeros() == n;
  for (const auto& joint : model_.joints) {
    first_row_.push_back(constraint_count());
    for (const std::string& row : joint->row_names()) rows_.push_back(joint->name() + "." + row);
  }

  const Index numbers = model_.numbers_a_node();
  const Index of_nodes = static_cast<Index>(model_.nodes.size()) * numbers;
  start_.q.resize(of_nodes + static_cast<Index>(model_.turn_counters.size()));
  start_.v = Vector::Zero(n);
  number_.assign(static_cast<std::size_t>(n), 0);
  for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
    const auto& node = model_.nodes[i];
    const Index first = static_cast<Index>(i) * numbers;
    for (Index j = 0; j < numbers; ++j) start_.q[first + j] = node.numbers[static_cast<std::size_t>(j)];
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (node.place[axis] == ground) continue;
      start_.v[node.place[axis]] = node.velocity[axis];
      const bool turns = model_.dimension == 3 && model::is_rotation(axis);
      number_[static_cast<std::size_t>(node.place[axis])] =
          turns ? -1 : first + (model::is_rotation(axis) ? 2 : static_cast<Index>(axis));
    }
    const std::array<Index, 3> turned{node.place[3], node.place[4], node.place[5]};
    if (model_.dimension == 3 && turned != std::array<Index, 3>{ground, ground, ground})
      turns_.push_back({first + 3, turned});
  }
  start_.q.tail(start_.q.size() - of_nodes).setZero();
  count_turns(start_.q, start_.q);
  start_.slider_force.resize(0);
  start_.memory = Vector::Zero(model_.law_memory_size);
  start_.acceleration = start_.auxiliary_acceleration = Vector::Zero(n);
  start_.multiplier = Vector::Zero(constraint_count());
  for (const auto& lock : model_.locks)
    start_.phase.push_back(lock.is_met_at_start ? model::lock_engaged : model::lock_open);
  start_.rubbing.assign(model_.frictions.size(), model::friction_free);
  start_.stuck_at = Vector::Zero(static_cast<Index>(model_.frictions.size()));
}

std::vector<Index> Mechanism::driven_rows() const {
  std::vector<Index> rows;
  for (const auto& drive : model_.drives) rows.push_back(first_row(drive.joint));
  return rows;
}

namespace {
bool is_spring_stop(const model::Lock& lock) { return !lock.is_rigid() && !lock.is_latch; }
}  // namespace

bool Mechanism::has_stops() const { return std::any_of(model_.locks.begin(), model_.locks.end(), is_spring_stop); }

bool Mechanism::touches(const State& state) const {
  for (std::size_t i = 0; i < model_.locks.size(); ++i)
    if (is_spring_stop(model_.locks[i]) && state.phase[i] == model::lock_engaged) return true;
  return false;
}

bool Mechanism::has_kinks() const {
  return std::any_of(model_.elements.begin(), model_.elements.end(),
                     [](const auto& element) { return element->has_kinks(); });
}

bool Mechanism::has_followed_reactions() const {
  return std::any_of(model_.frictions.begin(), model_.frictions.end(),
                     [](const model::JointFriction& friction) { return friction.follows_reaction(); }) ||
         std::any_of(model_.laws.begin(), model_.laws.end(),
                     [](const model::MechanismLaw& law) { return law.reaction.presses(); });
}

bool Mechanism::has_slip_directions() const {
  return std::any_of(model_.frictions.begin(), model_.frictions.end(),
                     [](const model::JointFriction& friction) { return friction.partner >= 0; });
}

std::unique_ptr<ConstrainedEquations> Mechanism::equations() const {
  return std::make_unique<MechanismEquations>(*this);
}

double Mechanism::largest_turn() const {
  // Beyond half a turn the shortest way to a rotation in space leads round the other side.
  constexpr double below_half = 2.0;
  return model_.dimension == 3 ? below_half : System::largest_turn();
}

void Mechanism::retract(const Vector& q, const Vector& dq, Vector& out) const {
  out = q;
  for (Index i = 0; i < dq.size(); ++i)
    if (const Index number = number_[static_cast<std::size_t>(i)]; number >= 0) out[number] += dq[i];
  for (const Turn& turn : turns_) {
    const Rotation turned =
        (rotation_in(q, turn.quaternion) * numerics::rotation_of(part_of(dq, turn.place))).normalized();
    out.segment<4>(turn.quaternion) << turned.w(), turned.x(), turned.y(), turned.z();
  }
  count_turns(q, out);
}

void Mechanism::count_turns(const Vector& before, Vector& q) const {
  Index place = q.size() - static_cast<Index>(model_.turn_counters.size());
  for (const model::TurnCounter& counter : model_.turn_counters) {
    const double angle = model::angle_of(counter.angle, model::pair_of(q.data(), counter.first, counter.second));
    q[place] = model::nearest_turn(angle, before[place]);
    ++place;
  }
}

void Mechanism::difference(const Vector& q, const Vector& to, Vector& dq) const {
  for (Index i = 0; i < size(); ++i)
    if (const Index number = number_[static_cast<std::size_t>(i)]; number >= 0) dq[i] = to[number] - q[number];
  for (const Turn& turn : turns_)
    put(numerics::vector_of(rotation_in(q, turn.quaternion).conjugate() * rotation_in(to, turn.quaternion)), turn.place,
        dq);
}

void Mechanism::to_travel(const Vector& travel, Vector& motion) const {
  for (const Turn& turn : turns_)
    put(numerics::inverse_tangent_of(part_of(travel, turn.place)) * part_of(motion, turn.place), turn.place, motion);
}

void Mechanism::coordinate_values(const Vector& q, Vector& out) const {
  out.resize(size());
  for (Index i = 0; i < size(); ++i)
    if (const Index number = number_[static_cast<std::size_t>(i)]; number >= 0) out[i] = q[number];
  for (const Turn& turn : turns_) put(numerics::vector_of(rotation_in(q, turn.quaternion)), turn.place, out);
}

double Mechanism::extent(const Vector& q) const {
  const Index dimension = model_.dimension, numbers = model_.numbers_a_node();
  Vector low = Vector::Constant(dimension, HUGE_VAL), high = -low;
  for (Index node = 0; node < static_cast<Index>(model_.nodes.size()); ++node) {
    low = low.cwiseMin(q.segment(node * numbers, dimension));
    high = high.cwiseMax(q.segment(node * numbers, dimension));
  }
  const double diagonal = (high - low).norm();
  return diagonal > 0.0 ? diagonal : 1.0;
}

void Mechanism::times_mass(const Vector& x, Vector& out) const {
  if (has_diagonal_mass_)
    out = diagonal_.cwiseProduct(x);
  else
    out.noalias() = mass_ * x;
}

}  // namespace rubato::system
