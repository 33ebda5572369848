#include <rubato/steady/marching/time_marching_parts.hpp>
#include <rubato/steady/stuck_offsets.hpp>

// The offsets of sliders that never slip, at the end of a march that repeats.
namespace rubato::steady {
// Puts the offsets of sliders that never slip to zero, or as near as they do not slip, and the structure to where it
// lies then: beside a slider far stiffer than itself it goes along, and the force hardly changes. Returns whether any
// was not.
bool TimeMarchingSolver::release_offsets(const Engine& engine, Index lane, const system::Excitation& excitation,
                                         const SteadyResponse& response, LaneArray& states) const {
  constexpr double margin = 1e-9;  // of the limit
  StuckOffsets stuck;
  for (Index i = 0; i < slider_stiffness_.size(); ++i) {
    const double limit = excitation.limits[i], stiffness = slider_stiffness_[i];
    if (limit == 0.0) continue;
    // What slips in a motion that repeats slips to and fro, over more than twice its limit. One that creeps away from
    // its limit in the march is on the way to where it does not slip.
    const auto u = engine.records[static_cast<std::size_t>(lane)].displacement.row(i);
    const double least = u.minCoeff(), most = u.maxCoeff();
    const bool slips = response.slip_share[i] > 0.0;
    if (slips && stiffness * (most - least) > 2.0 * limit) continue;
    const double offset = slips ? -stiffness * states(engine.map->slip_start() + i, lane) : response.offset[i];
    stuck.add(i, stiffness, least, most, offset, 0.0);
  }
  const OffsetShift shift = shift_to_wanted_offsets(system_, excitation.limits, stuck, margin);
  if (shift.is_zero()) return false;
  engine.map->displace(shift.displacement, states, lane);
  // What a slider remembers follows where it slips, so that its force stays what it was.
  Vector slip(slider_stiffness_.size());
  for (Index i = 0; i < slip.size(); ++i) slip[i] = system_.relative_displacement(i, shift.displacement);
  for (std::size_t a = 0; a < stuck.sliders.size(); ++a)
    slip[stuck.sliders[a]] = -shift.offset[static_cast<Index>(a)] / slider_stiffness_[stuck.sliders[a]];
  states.col(lane).segment(engine.map->slip_start(), slip.size()) += slip.array();
  return true;
}

}  // namespace rubato::steady
