#include <rubato/results/columns/observed_columns.hpp>

#include <array>
#include <utility>

namespace rubato::results {
namespace {

struct Names {
  const char *variable, *unit, *description;
};

// By quantity: position, velocity, acceleration.
constexpr std::array<Names, 3> of_displacement{{{"position", "m", "displacement of each coordinate"},
                                                {"velocity", "m/s", "velocity of each coordinate"},
                                                {"acceleration", "m/s2", "acceleration of equilibrium"}}};
constexpr std::array<Names, 3> of_rotation{
    {{"angle", "rad", "rotation of each rotational coordinate"},
     {"angular_velocity", "rad/s", "angular velocity of each rotational coordinate"},
     {"angular_acceleration", "rad/s2", "angular acceleration of equilibrium"}}};

std::vector<std::string> labels_of(const std::vector<Observed>& observed) {
  std::vector<std::string> labels;
  for (const Observed& one : observed) labels.push_back(one.label);
  return labels;
}

}  // namespace

void add_blocks(const std::vector<Observed>& observed, const ColumnNames& of_displacements,
                const ColumnNames& of_rotations, std::vector<Block>& blocks) {
  const auto add_kind = [&](bool is_rotation, const ColumnNames& names, const char* dimension) {
    std::vector<std::string> labels;
    for (const Observed& one : observed)
      if (one.is_rotation == is_rotation) labels.push_back(one.label);
    if (!labels.empty()) blocks.push_back({names.variable, names.unit, names.description, dimension, labels});
  };
  add_kind(false, of_displacements, "coordinate");
  add_kind(true, of_rotations, "rotation");
}

const std::vector<ObservedColumns::Quantity> ObservedColumns::of_motion{Quantity::position, Quantity::velocity,
                                                                        Quantity::acceleration};

ObservedColumns::ObservedColumns(const std::vector<Observed>& observed, std::vector<Quantity> quantities)
    : quantities_(std::move(quantities)), workspace_(quantities_.size()) {
  for (const Observed& one : observed) (one.is_rotation ? rotations_ : displacements_).push_back(one);
}

void ObservedColumns::add(TableLayout& layout) const {
  const auto add_kind = [&](const std::vector<Observed>& observed, const std::array<Names, 3>& names,
                            const char* dimension) {
    if (observed.empty()) return;
    const std::vector<std::string> labels = labels_of(observed);
    for (const Quantity quantity : quantities_) {
      const Names& name = names[static_cast<std::size_t>(quantity)];
      layout.blocks.push_back({name.variable, name.unit, name.description, dimension, labels});
    }
  };
  add_kind(displacements_, of_displacement, "coordinate");
  add_kind(rotations_, of_rotation, "rotation");
}

void ObservedColumns::append(const system::State& state, std::vector<double>& row) {
  std::array<const Vector*, 3> found{};
  for (std::size_t i = 0; i < quantities_.size(); ++i) found[i] = &values(quantities_[i], state, workspace_[i]);
  for (const auto* observed : {&displacements_, &rotations_})
    for (std::size_t i = 0; i < quantities_.size(); ++i)
      for (const Observed& one : *observed) row.push_back(one.of(*found[i]));
}

const Vector& ObservedColumns::values(Quantity quantity, const system::State& state, Vector& /*workspace*/) {
  switch (quantity) {
    case Quantity::velocity:
      return state.v;
    case Quantity::acceleration:
      return state.acceleration;
    case Quantity::position:
      break;
  }
  return state.q;
}

}  // namespace rubato::results
