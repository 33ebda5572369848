#include <rubato/analysis/observed_blocks.hpp>

#include <algorithm>
#include <array>

namespace rubato::analysis {
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
                const ColumnNames& of_rotations, std::vector<results::Block>& blocks) {
  const auto add_kind = [&](bool is_rotation, const ColumnNames& names, const char* dimension) {
    std::vector<std::string> labels;
    for (const Observed& one : observed)
      if (one.is_rotation == is_rotation) labels.push_back(one.label);
    if (!labels.empty()) blocks.push_back({names.variable, names.unit, names.description, dimension, labels});
  };
  add_kind(false, of_displacements, "coordinate");
  add_kind(true, of_rotations, "rotation");
}

ObservedBlocks::ObservedBlocks(const std::vector<Observed>& observed) {
  for (const Observed& one : observed) (one.is_rotation ? rotations_ : displacements_).push_back(one);
}

void ObservedBlocks::add(results::TableLayout& layout, std::initializer_list<Quantity> quantities) const {
  const auto add_kind = [&](const std::vector<Observed>& observed, const std::array<Names, 3>& names,
                            const char* dimension) {
    if (observed.empty()) return;
    const std::vector<std::string> labels = labels_of(observed);
    for (const Quantity quantity : quantities) {
      const Names& name = names[static_cast<std::size_t>(quantity)];
      layout.blocks.push_back({name.variable, name.unit, name.description, dimension, labels});
    }
  };
  add_kind(displacements_, of_displacement, "coordinate");
  add_kind(rotations_, of_rotation, "rotation");
}

void ObservedBlocks::append(std::initializer_list<const Vector*> vectors, std::vector<double>& row) const {
  for (const auto* observed : {&displacements_, &rotations_})
    for (const Vector* values : vectors)
      for (const Observed& one : *observed) row.push_back(one.of(*values));
}

SliderBlocks::SliderBlocks(const system::LocallyNonlinear& system) : system_(system) {
  for (Index i = 0; i < system.slider_count(); ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    const Index end = slider.first == ground ? slider.second : slider.first;
    (system.is_rotation(end) ? of_rotations_ : of_displacements_).push_back(i);
  }
}

void SliderBlocks::add(results::TableLayout& layout) const {
  const auto add_kind = [&](const std::vector<Index>& sliders, const Names& force, const Names& slip,
                            const char* dimension) {
    if (sliders.empty()) return;
    const std::vector<std::string> labels = labels_of(sliders);
    layout.blocks.push_back({force.variable, force.unit, force.description, dimension, labels});
    layout.blocks.push_back({slip.variable, slip.unit, slip.description, dimension, labels});
  };
  add_kind(of_displacements_, {"force", "N", "slider force; -force acts on the first coordinate"},
           {"slip", "m", "slip, u - force/kT"}, "slider");
  add_kind(of_rotations_, {"moment", "N m", "slider moment; -moment acts on the first coordinate"},
           {"slip_angle", "rad", "slip, u - moment/kT"}, "rotational_slider");
}

void SliderBlocks::append(const system::State& state, std::vector<double>& row) const {
  for (const auto* sliders : {&of_displacements_, &of_rotations_}) {
    for (const Index i : *sliders) row.push_back(state.slider_force[i]);
    for (const Index i : *sliders)
      row.push_back(system_.relative_displacement(i, state.q) -
                    state.slider_force[i] / system_.sliders()[static_cast<std::size_t>(i)].stiffness);
  }
}

void SliderBlocks::add(const ColumnNames& of_displacements, const ColumnNames& of_rotations,
                       std::vector<results::Block>& blocks) const {
  const auto add_kind = [&](const std::vector<Index>& sliders, const ColumnNames& names, const char* dimension) {
    if (!sliders.empty())
      blocks.push_back({names.variable, names.unit, names.description, dimension, labels_of(sliders)});
  };
  add_kind(of_displacements_, of_displacements, "slider");
  add_kind(of_rotations_, of_rotations, "rotational_slider");
}

void SliderBlocks::add(const ColumnNames& names, std::vector<results::Block>& blocks) const {
  const std::vector<Index> all = order();
  if (all.empty()) return;
  const char* dimension = of_rotations_.empty()       ? "slider"
                          : of_displacements_.empty() ? "rotational_slider"
                                                      : "any_slider";
  blocks.push_back({names.variable, names.unit, names.description, dimension, labels_of(all)});
}

std::vector<std::string> SliderBlocks::labels_of(const std::vector<Index>& sliders) const {
  std::vector<std::string> labels;
  for (const Index i : sliders) labels.push_back(system_.sliders()[static_cast<std::size_t>(i)].name);
  return labels;
}

std::vector<Index> SliderBlocks::order() const {
  std::vector<Index> order = of_displacements_;
  order.insert(order.end(), of_rotations_.begin(), of_rotations_.end());
  return order;
}

StopBlocks::StopBlocks(const system::LocallyNonlinear& system) : system_(system) {
  for (Index j = 0; j < system.stop_count(); ++j) {
    const auto& stop = system.stops()[static_cast<std::size_t>(j)];
    const Index end = stop.first == ground ? stop.second : stop.first;
    (system.is_rotation(end) ? of_rotations_ : of_displacements_).push_back(j);
  }
}

void StopBlocks::add(results::TableLayout& layout) const {
  const auto add_kind = [&](const std::vector<Index>& stops, const Names& force, const Names& penetration,
                            const char* dimension) {
    if (stops.empty()) return;
    std::vector<std::string> labels;
    for (const Index j : stops) labels.push_back(system_.stops()[static_cast<std::size_t>(j)].name);
    layout.blocks.push_back({force.variable, force.unit, force.description, dimension, labels});
    layout.blocks.push_back({penetration.variable, penetration.unit, penetration.description, dimension, labels});
  };
  add_kind(of_displacements_, {"force", "N", "force of a stop; -force acts on the first coordinate"},
           {"penetration", "m", "how far a gap is overclosed, 0 where it is open"}, "stop");
  add_kind(of_rotations_, {"moment", "N m", "moment of a stop; -moment acts on the first coordinate"},
           {"penetration_angle", "rad", "how far a gap is overclosed, 0 where it is open"}, "rotational_stop");
}

void StopBlocks::append(const system::State& state, std::vector<double>& row) const {
  const Index sliders = system_.slider_count();
  for (const auto* stops : {&of_displacements_, &of_rotations_}) {
    for (const Index j : *stops) row.push_back(state.slider_force[sliders + j]);
    for (const Index j : *stops) {
      const double gap = system_.stops()[static_cast<std::size_t>(j)].gap;
      row.push_back(std::max(0.0, system_.relative_displacement(sliders + j, state.q) - gap));
    }
  }
}

}  // namespace rubato::analysis
