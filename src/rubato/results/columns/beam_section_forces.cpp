#include <rubato/core/error.hpp>
#include <rubato/results/columns/beam_section_forces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rubato::results {
namespace {

struct Component {
  const char *variable, *unit, *description;
};
constexpr std::array<Component, model::BeamForces::in_plane> of_plane{
    {{"normal_force", "N", "force along each part of a beam, + pulls"},
     {"shear_force", "N", "force across each part of a beam, along its y"},
     {"bending_moment", "N m", "moment about z in the middle of each part of a beam"}}};
constexpr std::array<Component, model::BeamForces::in_space> of_space{
    {{"normal_force", "N", "force along each part of a beam, + pulls"},
     {"shear_force_y", "N", "force across each part of a beam, along its y"},
     {"shear_force_z", "N", "force across each part of a beam, along its z"},
     {"torsion", "N m", "moment about the axis of each part of a beam"},
     {"bending_moment_y", "N m", "moment about y in the middle of each part of a beam"},
     {"bending_moment_z", "N m", "moment about z in the middle of each part of a beam"}}};

std::span<const Component> components(bool in_plane) {
  return in_plane ? std::span<const Component>(of_plane) : std::span<const Component>(of_space);
}

}  // namespace

BeamSectionForces::BeamSectionForces(const system::Mechanism& mechanism, const model::SectionForcesDescription& wanted,
                                     const std::string& title)
    : motion_(mechanism), in_plane_(mechanism.model().dimension == 2) {
  std::vector<std::string> known;
  for (const auto& part : mechanism.model().beam_parts)
    if (known.empty() || known.back() != part.beam) known.push_back(part.beam);
  for (const auto& beam : wanted.beams)
    if (std::find(known.begin(), known.end(), beam.first) == known.end())
      throw InvalidInput(beam.where, fmt::format("{}section_forces names \"{}\", which is no beam{}", title, beam.first,
                                                 suggestion(beam.first, known)));
  if (wanted.of_all && known.empty())
    throw InvalidInput(wanted.where, title + "section_forces are those of beams, and there are none; remove the key");
  for (const std::string& beam : known)
    if (wanted.of_all ||
        std::any_of(wanted.beams.begin(), wanted.beams.end(), [&](const auto& one) { return one.first == beam; }))
      take(mechanism, beam);
  values_.resize(parts_.size() * components(in_plane_).size());
}

void BeamSectionForces::take(const system::Mechanism& mechanism, const std::string& beam) {
  for (const auto& part : mechanism.model().beam_parts) {
    if (part.beam != beam) continue;
    Part& taken = parts_.emplace_back();
    taken.name = part.name;
    for (std::size_t i = part.first; i < part.first + part.count; ++i) {
      elements_.push_back(mechanism.model().elements[i]->clone());
      if (const auto* forces = dynamic_cast<const model::BeamForces*>(elements_.back().get()))
        taken.forces.push_back(forces);
    }
  }
}

void BeamSectionForces::add(TableLayout& layout) const {
  if (parts_.empty()) return;
  std::vector<std::string> names;
  for (const Part& part : parts_) names.push_back(part.name);
  for (const Component& component : components(in_plane_))
    layout.blocks.push_back({component.variable, component.unit, component.description, "beam_part", names});
}

void BeamSectionForces::append(const system::State& state, std::vector<double>& row) {
  const model::Motion& motion = motion_.go_to(state, model::Side::left);
  const std::size_t count = components(in_plane_).size();
  std::array<double, model::BeamForces::in_space> forces{};
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for (const auto* part : parts_[i].forces) {
      part->section_forces(motion, forces.data());
      for (std::size_t c = 0; c < count; ++c) values_[i * count + c] += forces[c];
    }
  for (std::size_t c = 0; c < count; ++c)
    for (std::size_t i = 0; i < parts_.size(); ++i) row.push_back(values_[i * count + c]);
}

}  // namespace rubato::results
