#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/events.hpp>
#include <rubato/integrate/nearest_approach.hpp>
#include <rubato/integrate/structure_timeline.hpp>

#include <vector>

namespace rubato::integrate {

/// The contacts of a structure that change in a march: sliders that begin to slip and stick, stops that close and open,
/// and laws of friction that slip, stick, open and close, which are told at the ends of steps.
///
/// What steps end at is told at that time. All else is told at the end of a step, as the law of the step has it: a
/// slider has slipped in a step if its force is its limit at the end, and a stop is closed if it pushes there. So
/// sticking may be told one step late: the slider came to rest in a step that took it further on the whole. A slider
/// that slips one way in a step and the other way in the next has stuck between.
class ContactEvents final : public Observer {
 public:
  /// Stops that are closed at the start are told as if they closed then.
  /// @param located  of a march whose steps end at transitions; null: of one that passes them
  ContactEvents(const system::LocallyNonlinear& system, const system::State& start,
                StructureTimeline* located = nullptr);

  bool accepted(const system::State& before, const system::State& after) override;
  /// A slider is known to have changed.
  void note_slider(double t, Index slider, bool sticks);

  const Events& events() const { return events_; }
  /// Stops that never closed, and how near they came to it.
  std::vector<std::string> never_reached() const;

 private:
  /// A slider, a stop, a law that sticks and slips, or a block by its first row.
  struct Watched {
    Index contact = 0;
    double slips_up = 0.0, slips_down = 0.0;  ///< at these forces or beyond; a stop is closed at the first [N]
    int branch = 0;  ///< as StructureTimeline::branch() has it; of a law as model::Law::Contact has it
  };
  int branch_of(const Watched& one, const system::State& state) const {
    const double force = state.slider_force[one.contact];
    return (force >= one.slips_up ? 1 : 0) - (force <= one.slips_down ? 1 : 0);
  }
  int branch_of_law(Index contact, const system::State& state) const;
  void note_law(Watched& one, int now, double t);
  void note_change(Watched& one, int now, const system::State& state);
  void note_gaps(const system::State& state);
  void note_stop(Index contact, const system::State& state, bool closes);

  const system::LocallyNonlinear& system_;
  StructureTimeline* located_;
  std::vector<Watched> watched_;    // what can change
  std::vector<std::size_t> parts_;  // place of each contact among the names
  std::vector<NearestApproach> stops_;
  Events events_;
};

}  // namespace rubato::integrate
