#include <rubato/results/columns/contact_columns.hpp>

#include <algorithm>

namespace rubato::results {
namespace {

struct Names {
  const char *variable, *unit, *description;
};

}  // namespace

SliderColumns::SliderColumns(const system::LocallyNonlinear& system) : system_(system) {
  for (Index i = 0; i < system.slider_count(); ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    const Index end = slider.first == ground ? slider.second : slider.first;
    (system.is_rotation(end) ? of_rotations_ : of_displacements_).push_back(i);
  }
}

void SliderColumns::add(TableLayout& layout) const {
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

void SliderColumns::append(const system::State& state, std::vector<double>& row) {
  for (const auto* sliders : {&of_displacements_, &of_rotations_}) {
    for (const Index i : *sliders) row.push_back(state.slider_force[i]);
    for (const Index i : *sliders)
      row.push_back(system_.relative_displacement(i, state.q) -
                    state.slider_force[i] / system_.sliders()[static_cast<std::size_t>(i)].stiffness);
  }
}

void SliderColumns::add(const ColumnNames& of_displacements, const ColumnNames& of_rotations,
                        std::vector<Block>& blocks) const {
  const auto add_kind = [&](const std::vector<Index>& sliders, const ColumnNames& names, const char* dimension) {
    if (!sliders.empty())
      blocks.push_back({names.variable, names.unit, names.description, dimension, labels_of(sliders)});
  };
  add_kind(of_displacements_, of_displacements, "slider");
  add_kind(of_rotations_, of_rotations, "rotational_slider");
}

void SliderColumns::add(const ColumnNames& names, std::vector<Block>& blocks) const {
  const std::vector<Index> all = order();
  if (all.empty()) return;
  const char* dimension = of_rotations_.empty()       ? "slider"
                          : of_displacements_.empty() ? "rotational_slider"
                                                      : "any_slider";
  blocks.push_back({names.variable, names.unit, names.description, dimension, labels_of(all)});
}

std::vector<std::string> SliderColumns::labels_of(const std::vector<Index>& sliders) const {
  std::vector<std::string> labels;
  for (const Index i : sliders) labels.push_back(system_.sliders()[static_cast<std::size_t>(i)].name);
  return labels;
}

std::vector<Index> SliderColumns::order() const {
  std::vector<Index> order = of_displacements_;
  order.insert(order.end(), of_rotations_.begin(), of_rotations_.end());
  return order;
}

StopColumns::StopColumns(const system::LocallyNonlinear& system) : system_(system) {
  for (Index j = 0; j < system.stop_count(); ++j) {
    const auto& stop = system.stops()[static_cast<std::size_t>(j)];
    const Index end = stop.first == ground ? stop.second : stop.first;
    (system.is_rotation(end) ? of_rotations_ : of_displacements_).push_back(j);
  }
}

void add_stop_blocks(const std::vector<std::string>& stops, bool is_rotation, TableLayout& layout) {
  if (stops.empty()) return;
  const char* const overclosed = "how far a gap is overclosed, 0 where it is open";
  if (is_rotation) {
    layout.blocks.push_back(
        {"moment", "N m", "moment of a stop; -moment acts on the first coordinate", "rotational_stop", stops});
    layout.blocks.push_back({"penetration_angle", "rad", overclosed, "rotational_stop", stops});
  } else {
    layout.blocks.push_back({"force", "N", "force of a stop; -force acts on the first coordinate", "stop", stops});
    layout.blocks.push_back({"penetration", "m", overclosed, "stop", stops});
  }
}

void StopColumns::add(TableLayout& layout) const {
  for (const bool is_rotation : {false, true}) {
    std::vector<std::string> labels;
    for (const Index j : is_rotation ? of_rotations_ : of_displacements_)
      labels.push_back(system_.stops()[static_cast<std::size_t>(j)].name);
    add_stop_blocks(labels, is_rotation, layout);
  }
}

void StopColumns::append(const system::State& state, std::vector<double>& row) {
  const Index sliders = system_.slider_count();
  for (const auto* stops : {&of_displacements_, &of_rotations_}) {
    for (const Index j : *stops) row.push_back(state.slider_force[sliders + j]);
    for (const Index j : *stops) {
      const double gap = system_.stops()[static_cast<std::size_t>(j)].gap;
      row.push_back(std::max(0.0, system_.relative_displacement(sliders + j, state.q) - gap));
    }
  }
}

}  // namespace rubato::results
