#include <rubato/core/error.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/exact/first_exit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr double at_limit = 1e-13;  // relative distance of a force from its limit that is round-off of the location
constexpr double at_rest = 1e-14;   // likewise of a term of u against the largest of the displacements it is made of
constexpr int most_order = 6;       // of the terms of u that are looked at
constexpr double no_time = 1e-10;   // of a piece: events that are as near happen at once
constexpr long most_without_time = 200;

int sign(SliderState state) { return static_cast<int>(state); }

void require_possible(const system::LocallyNonlinear& system) {
  if (system.size() > largest_exact)
    throw InvalidInput(
        fmt::format("the method exact is for up to {} coordinates, the model has {}; take "
                    "\"generalized_alpha\" with a small step",
                    largest_exact, system.size()));
  if (system.stop_count() > 0)
    throw InvalidInput(
        fmt::format("the method exact does not take the stop \"{}\"; take "
                    "\"generalized_alpha\" with step = {{ tolerance = ..., events = \"locate\" }}",
                    system.stops().front().name));
  if (system.has_laws())
    throw InvalidInput(
        fmt::format("the method exact does not take the law \"{}\"; take "
                    "\"generalized_alpha\" with step = {{ tolerance = ... }}",
                    system.law_count() > 0 ? system.laws().front().name : system.blocks().front().name));
  for (const auto& term : system.loads().terms())
    if (const auto* formula = std::get_if<model::FormulaLaw>(&term.law))
      throw InvalidInput(
          fmt::format("the method exact knows harmonic loads and tables, not the formula \"{}\" of t; give "
                      "it as a table, or take \"generalized_alpha\"",
                      formula->formula.text()));
}

const system::LocallyNonlinear& checked(const system::LocallyNonlinear& system) {
  require_possible(system);
  return system;
}

}  // namespace

ExactFlow::ExactFlow(const system::LocallyNonlinear& system)
    : system_(checked(system)),
      piece_(system),
      states_(static_cast<std::size_t>(system.slider_count()), SliderState::stick),
      decided_(states_),
      critical_(states_.size(), false),
      first_order_(states_.size(), 0),
      path_(TaylorPiece::degree + 1) {}

void ExactFlow::set_excitation(const system::Excitation& excitation) {
  piece_.set_excitation(excitation);
  own_loads_ = false;
}

// Sliders at their limit are snapped to it, and stick or slip by the first term of u that is not round-off. The states
// change the third term and later ones only; deciding is repeated until it stands. Where all undecided sliders at once
// do not settle, one at a time does, the first that must change: Murty's pivoting, which ends as the stiffness that
// couples them is positive (K. G. Murty, Note on a Bard-type scheme for solving the complementarity problem, 1974).
void ExactFlow::decide_states(system::State& state, double table_end) {
  const auto m = static_cast<Index>(states_.size());
  for (Index i = 0; i < m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double limit = piece_.limit(i);
    double& force = state.slider_force[i];
    critical_[k] = std::abs(force) >= limit * (1.0 - at_limit);
    if (critical_[k]) force = std::copysign(limit, force);
    // A slider at its limit that keeps its state is the likeliest; one inside sticks.
    if (!critical_[k]) states_[k] = SliderState::stick;
    if (is_idle(i)) states_[k] = SliderState::slip_positive;
  }
  for (Index round = 0; round < 6 * m + 6; ++round) {
    piece_.start(state, states_, table_end);
    bool stands = true;
    for (Index i = 0; i < m && (stands || round < m + 3); ++i) {
      const auto k = static_cast<std::size_t>(i);
      first_order_[k] = 0;
      if (!critical_[k] || is_idle(i)) continue;
      const SliderState next = state_at_limit(i, state.slider_force[i]);
      if (next == states_[k]) continue;
      states_[k] = next;
      stands = false;
    }
    if (stands) return;
  }
}

SliderState ExactFlow::state_at_limit(Index i, double force) {
  const auto k = static_cast<std::size_t>(i);
  const auto u = piece_.relative_displacement(i);
  const double tau = piece_.max_length(), negligible = at_rest * piece_.displacement_scale(i);
  double power = tau;
  int& order = first_order_[k];
  for (order = 1; order <= most_order; ++order, power *= tau)
    if (std::abs(u[static_cast<std::size_t>(order)]) * power > negligible) break;
  if (order > most_order || !(u[static_cast<std::size_t>(order)] * force > 0.0)) return SliderState::stick;
  return force > 0.0 ? SliderState::slip_positive : SliderState::slip_negative;
}

double ExactFlow::next_event(double length, Index& slider) {
  double first = -1.0;
  for (Index i = 0; i < static_cast<Index>(states_.size()); ++i) {
    if (is_idle(i)) continue;
    const auto& element = system_.sliders()[static_cast<std::size_t>(i)];
    const double reach = first < 0.0 ? length : first;
    const auto u = piece_.relative_displacement(i);
    const SliderState state = states_[static_cast<std::size_t>(i)];
    // What was round-off when the state was decided is none of a motion beyond the edge now.
    const auto order = static_cast<std::size_t>(first_order_[static_cast<std::size_t>(i)]);
    double s = -1.0;
    if (state == SliderState::stick) {  // its force, in units of its spring, reaches a limit
      const double slip = piece_.limit(i) / element.stiffness;
      std::copy(u.begin(), u.end(), path_.begin());
      path_[0] = order > 0 ? std::copysign(slip, piece_.offset(i) + element.stiffness * u[0])
                           : u[0] + piece_.offset(i) / element.stiffness;
      for (std::size_t k = 1; k < order; ++k) path_[k] = 0.0;
      s = first_exit({path_.data(), u.size()}, -slip, slip, reach);
    } else {  // its slip comes to rest
      const double outward = sign(state);
      double factor = outward;
      for (std::size_t k = 0; k + 1 < u.size(); ++k, factor += outward) path_[k] = factor * u[k + 1];
      for (std::size_t k = 1; k < order; ++k) path_[k - 1] = 0.0;
      s = first_exit({path_.data(), u.size() - 1}, 0.0, HUGE_VAL, reach);
    }
    if (s < 0.0 || (first >= 0.0 && s >= first)) continue;
    first = s;
    slider = i;
  }
  return first;
}

ExactReport ExactFlow::advance(system::State& state, double t_end, std::span<const double> samples,
                               ExactVisitor& visitor, bool with_work) {
  ExactReport report;
  ExactWork work;
  std::vector<double> breaks;
  if (own_loads_) breaks = system_.loads().breakpoints(state.t, t_end);
  std::size_t next_break = 0, next_sample = 0;
  long without_time = 0;
  double progress = state.t;
  // How far the state is beyond state.t, which is rounded: thousands of pieces that each lose some of it turn the phase
  // of the fastest mode.
  double beyond = 0.0;
  now_ = state;
  // Where forces and rates stand tells the likeliest states; the first decision sees all sliders.
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const auto i = static_cast<Index>(k);
    const double force = state.slider_force[i];
    const bool slips = std::abs(force) >= piece_.limit(i) && force * system_.relative_displacement(i, state.v) > 0.0;
    states_[k] = !slips ? SliderState::stick : force > 0.0 ? SliderState::slip_positive : SliderState::slip_negative;
  }
  const auto table_end = [&] { return next_break < breaks.size() ? breaks[next_break] : t_end; };
  decide_states(state, table_end());

  // Books the work of the present piece from `from` to `to`.
  const auto book = [&](double from, double to) {
    if (!with_work || !(to > from)) return;
    piece_.add_work(from, to, work.damper, work.load);
    for (std::size_t k = 0; k < states_.size(); ++k) {
      if (states_[k] == SliderState::stick) continue;
      const auto u = piece_.relative_displacement(static_cast<Index>(k));
      work.slider += sign(states_[k]) * piece_.limit(static_cast<Index>(k)) * (polynomial(u, to) - polynomial(u, from));
    }
  };

  while (state.t < t_end || next_sample < samples.size()) {
    stop_if_asked();
    const double piece_end = std::min(t_end, table_end());
    const bool reaches_end = piece_.max_length() >= piece_end - state.t;
    double end = reaches_end ? piece_end : state.t + piece_.max_length();
    double length = std::max((end - state.t) - beyond, 0.0);
    Index slider = -1;
    const double event = length > 0.0 ? next_event(length, slider) : -1.0;
    if (event >= 0.0) {
      length = event;
      end = std::min(state.t + (beyond + length), piece_end);
    }
    double booked = 0.0;
    while (next_sample < samples.size() && samples[next_sample] <= end) {
      const double s = std::clamp((samples[next_sample] - state.t) - beyond, 0.0, length);
      now_.t = samples[next_sample];
      piece_.evaluate(s, now_);
      book(booked, s);
      booked = std::max(booked, s);
      ++next_sample;
      if (visitor.sample(now_, work)) continue;
      std::swap(state, now_);
      report.end = ExactEnd::stopped;
      return report;
    }
    if (!(state.t < t_end)) break;
    book(booked, length);
    const bool goes_on = visitor.piece(piece_, state.t, length, states_);
    beyond += (state.t - end) + length;
    now_.t = end;
    piece_.evaluate(length, now_);
    // Against what a piece may be long: near t = 0 any time is large beside t.
    if (end > progress + no_time * piece_.max_length()) {
      progress = end;
      without_time = 0;
    } else {
      ++without_time;
    }
    std::swap(state, now_);
    if (!goes_on) {
      report.end = ExactEnd::stopped;
      return report;
    }
    if (!std::isfinite(state.v.sum()) || !std::isfinite(state.q.sum())) {
      report.end = ExactEnd::not_finite;
      return report;
    }
    if (next_break < breaks.size() && state.t >= breaks[next_break]) ++next_break;
    if (event < 0.0) {
      if (state.t >= t_end && next_sample >= samples.size()) break;
      piece_.start(state, states_, table_end());
      std::fill(first_order_.begin(), first_order_.end(), 0);
      if (state.t >= t_end) continue;
      if (next_break > 0 && state.t == breaks[next_break - 1]) decide_states(state, table_end());
      continue;
    }
    // The slider of the event is at its limit by construction: round-off of the location may not say otherwise.
    const auto k = static_cast<std::size_t>(slider);
    state.slider_force[slider] = std::copysign(piece_.limit(slider), state.slider_force[slider]);
    decided_ = states_;
    // The likeliest outcome first: it has changed, and the others have not.
    states_[k] = states_[k] != SliderState::stick   ? SliderState::stick
                 : state.slider_force[slider] > 0.0 ? SliderState::slip_positive
                                                    : SliderState::slip_negative;
    decide_states(state, table_end());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == decided_[i]) continue;
      ++report.transitions;
      if (visitor.transition(state, {state.t, static_cast<Index>(i), states_[i]}, work)) continue;
      report.end = ExactEnd::stopped;
      return report;
    }
    if (without_time > most_without_time) {
      report.end = ExactEnd::chattering;
      report.worst = slider;
      return report;
    }
  }
  return report;
}

}  // namespace rubato::integrate
