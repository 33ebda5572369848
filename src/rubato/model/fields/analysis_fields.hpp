#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>

#include <fmt/format.h>

// The keys of analyses. `type` says which of them an analysis has.
namespace rubato::model {

/// The table of a step that chooses itself.
void fields(auto& visit, StepDescription& step) {
  visit.where(step.where);
  visit.quantity(
      "tolerance", step.tolerance,
      {.required = true,
       .unit = "-",
       .says =
           "of local_error and embedded the error at the end over the size of the response; of inertia_jump that of "
           "its source"});
  visit.word(
      "controller", step.controller, {{"pi", "pi"}, {"cardona_cassano", "cardona_cassano"}, {"fixed", "fixed"}},
      {.says = "what picks the next step; cardona_cassano has four actions (1991), fixed keeps the first step and the "
               "error is watched",
       .unless = "pi"});
  visit.word(
      "estimator", step.estimator,
      {{"local_error", "local_error"}, {"inertia_jump", "inertia_jump"}, {"embedded", "embedded"}},
      {.says = "what measures the error: local_error (alpha family), embedded (explicit pairs, and Wilson-theta where "
               "there are no stops) or inertia_jump (methods of second order that carry an acceleration)",
       .unless = "what suits the method; inertia_jump with cardona_cassano and a method of second order"});
  visit.quantity("first", step.first,
                 {.unit = "s", .says = "the first step", .unless = "from the response expected; needed by fixed"});
  visit.quantity(
      "smallest", step.smallest,
      {.unit = "s", .says = "the run ends where a smaller step is asked for", .unless = "1e-12 of the duration"});
  visit.quantity(
      "largest", step.largest,
      {.unit = "s",
       .says = "no step is larger",
       .unless = "a fiftieth of the duration, at most a sixth of the shortest period of a harmonic load, and nine "
                 "tenths of the stability limit; while a formula swings, at most a sixth of its swing"});
  visit.word(
      "events", step.locate_events, {{"locate", true}, {"pass", false}},
      {.says = "end a step where a slider sticks or slips anew, where a stop closes or opens and where a law with a "
               "memory turns, or pass over it",
       .unless = "locate stops, and sliders and laws with the pairs bogacki_shampine and dormand_prince, whose "
                 "estimate does not see them"});
  visit.quantity_or_word(
      "reference", step.reference, step.reference_is_initial, "initial",
      {.unit = "m sqrt(kg)",
       .says = "of inertia_jump: the reference value l, or \"initial\" for that of the initial displacements"});
  visit.flag("as_printed", step.as_printed,
             {.says = "of inertia_jump: with the misprint of its source", .unless = "false"});
  visit.flag("rebuild", step.rebuild,
             {.says = "rebuild the auxiliary acceleration when the step changes", .unless = "true"});
}

void fields(auto& visit, OutputDescription& output) {
  using Kind = OutputDescription::Kind;
  std::optional<long> every;
  std::optional<Quantity> interval;
  std::vector<Quantity> times;
  visit.part(
      "output",
      {.says = "which times are written", .unless = "every step; of exact its transitions and 64 samples a period"},
      [&](auto& inner) {
        inner.where(output.where);
        inner.whole("every", every, {1}, {.says = "every n-th step"});
        inner.quantity("interval", interval, {.unit = "s", .says = "between two rows"});
        inner.quantities("times", times, {}, {.unit = "s", .says = "rising"});
        inner.exactly_one_of({"every", "interval", "times"});
        inner.check_at_end([&](auto& reader) {
          if (every.has_value() + interval.has_value() + !times.empty() != 1)
            throw InvalidInput(
                reader.where(),
                reader.what() + " needs exactly one of \"every\" (steps), \"interval\" [s] and \"times\" [s]");
          if (every && (*every < 1 || *every > 2'000'000'000))
            throw InvalidInput(reader.where("every"), fmt::format("every must be at least 1, got {}", *every));
          output.kind = every ? Kind::every : interval ? Kind::interval : Kind::times;
          output.every = static_cast<int>(every.value_or(1));
          if (interval) output.interval = *interval;
          output.times = times;
        });
      });
}

inline constexpr Key duration_key{.required = true, .unit = "s"};

/// What several kinds of analysis keep.
void section_forces_field(auto& visit, SectionForcesDescription& wanted) {
  visit.section_forces(
      "section_forces", wanted,
      {.says = "of mechanisms: beams whose section forces are kept, or true for all", .unless = "none"});
}

void held_displacements_field(auto& visit, std::optional<std::vector<ObservationDescription>>& held) {
  visit.names_with_places("displacements", held,
                          {.says = "which [[displacement]]s are held in static states", .unless = "all"});
}

void observe_field(auto& visit, std::optional<std::vector<ObservationDescription>>& observed) {
  visit.observe("observe", observed,
                {.says = "coordinates to keep, or differences such as \"blade1 - damper\"", .unless = "all"});
}

inline constexpr const char* sweep_says =
    "a grid { N0 = [...], mu = [...] }, a list of cases { file = \"cases.csv\" }, or random samples";

/// The sweep of an analysis that is repeated over samples.
void swept_fields(auto& visit, SweptDescription& swept) {
  visit.sweep("sweep", swept.sweep, {.says = sweep_says});
  visit.where(swept.where, "sweep");
}

/// A key that is for the samples of a sweep.
void needs_a_sweep(auto& visit, const char* key) {
  visit.requires_beside(key, "sweep");
  visit.check([key](auto& reader) {
    if (reader.has(key) && !reader.has("sweep"))
      throw InvalidInput(reader.where(key),
                         fmt::format("{}: \"{}\" is of the samples of a sweep; add sweep = {{ ... }}, "
                                     "or leave it out",
                                     reader.what(), key));
  });
}

void fields(auto& visit, TransientDescription& transient) {
  visit.method(
      "method", transient.method,
      {.says =
           "a method's name, or a table of its name and parameters such as { name = \"hht\", alpha = -0.1 }; `rubato "
           "methods` lists them",
       .unless = "generalized_alpha"});
  visit.quantity_or_part(
      "step", transient.step,
      {.unit = "s", .says = "or a table for steps that choose themselves; needed, but not for the method exact"},
      [&](auto& inner) { fields(inner, transient.automatic_step.emplace()); });
  visit.quantity("duration", transient.duration, duration_key);
  fields(visit, transient.output);
  observe_field(visit, transient.observe);
  section_forces_field(visit, transient.section_forces);
  visit.flag("energy", transient.energy, {.says = "keep the energy ledger", .unless = "true"});
  visit.flag("allow_unstable", transient.allow_unstable, {.says = "run beyond the stability limit", .unless = "false"});
  visit.flag("project_velocities", transient.project_velocities,
             {.says = "of mechanisms: remove the drift of velocities from the joints at each step", .unless = "false"});
  visit.where(transient.project_velocities_where, "project_velocities");
  bool is_static = false;
  visit.word("initial", is_static, {{"given", false}, {"static", true}},
             {.says = "where it starts: from the positions given, or from equilibrium under the loads at t = 0",
              .unless = "given"});
  visit.check([&](auto& reader) {
    if (!is_static && reader.has("displacements"))
      throw InvalidInput(reader.where("displacements"),
                         reader.what() + ": displacements are held in the static start; add initial = \"static\"");
  });
  StaticDescription equilibrium;
  held_displacements_field(visit, equilibrium.displacements);
  if (is_static) transient.initial = equilibrium;
  swept_fields(visit, transient.swept);
  visit.flag("histories", transient.swept.keeps_samples,
             {.says = "of a sweep: keep the rows of every sample, besides its key numbers", .unless = "false"});
  needs_a_sweep(visit, "histories");
  visit.rule(R"({"dependentSchemas": {"displacements": {
    "required": ["initial"], "properties": {"initial": {"const": "static"}}}}})");
  visit.rule(R"({"if": {"properties": {"method": {"anyOf": [{"const": "exact"},
      {"type": "object", "properties": {"name": {"const": "exact"}}, "required": ["name"]}]}}, "required": ["method"]},
    "then": {"not": {"required": ["step"]}}, "else": {"required": ["step"]}})");
}

void fields(auto& visit, MethodStudyDescription& study) {
  visit.methods("methods", study.methods, {.says = "which are compared", .unless = "all that apply"});
  visit.quantity("step", study.step, {.required = true, .unit = "s", .says = "of the table of errors"});
  visit.quantity("duration", study.duration, duration_key);
  visit.quantities("ladder", study.ladder, {}, {.unit = "s", .says = "steps of the figure error against step"});
  visit.observation("observe", study.observe, {.says = "a coordinate or a difference", .unless = "the first"});
  visit.flag("as_printed", study.as_printed, {.says = "also the figures as the thesis prints them", .unless = "false"});
}

void fields(auto& visit, ReachedDescription& reached) {
  visit.where(reached.where);
  visit.text("analysis", reached.analysis, {.required = true, .says = "the name of a transient"});
  visit.where(reached.analysis_where, "analysis");
  visit.quantity("time", reached.time, {.unit = "s", .says = "of the transient", .unless = "its end"});
  visit.flag("static", reached.settles, {.says = "go on to the equilibrium next to it", .unless = "false"});
}

/// Engine orders across the natural frequencies over a speed: a Campbell diagram.
void campbell_fields(auto& visit, SweptDescription& swept) {
  using Unit = SweptDescription::SpeedUnit;
  visit.quantities(
      "engine_orders", swept.engine_orders, {},
      {.unit = "-", .says = "of a sweep over a speed: where these multiples of it meet natural frequencies"});
  visit.where(swept.engine_orders_where, "engine_orders");
  visit.requires_beside("engine_orders", "sweep");
  visit.text("speed", swept.speed, {.says = "the swept parameter that is the speed", .unless = "the only one"});
  visit.where(swept.speed_where, "speed");
  visit.word("speed_unit", swept.speed_unit, {{"rad/s", Unit::rad_per_second}, {"Hz", Unit::hertz}, {"rpm", Unit::rpm}},
             {.says = "of the speed", .unless = "rad/s"});
  for (const char* key : {"speed", "speed_unit"}) visit.requires_beside(key, "engine_orders");
  visit.check([](auto& reader) {
    if (reader.has("engine_orders") && !reader.has("sweep"))
      throw InvalidInput(reader.where("engine_orders"),
                         reader.what() +
                             ": \"engine_orders\" are lines over a speed; add sweep = { speed = { from = 0, to = "
                             "..., points = ... } }, or leave them out");
    for (const char* key : {"speed", "speed_unit"})
      if (reader.has(key) && !reader.has("engine_orders"))
        throw InvalidInput(
            reader.where(key),
            fmt::format("{}: \"{}\" goes with \"engine_orders\"; add these, or leave it out", reader.what(), key));
  });
}

void fields(auto& visit, ModesDescription& modes) {
  visit.quantity("count", modes.count, {.says = "the lowest so many modes of each limit", .unless = "all, at most 20"});
  visit.observe(
      "observe", modes.observe,
      {.says = "coordinates whose shapes are kept, or differences such as \"blade1 - damper\"", .unless = "all"});
  bool is_static = false;
  visit.word_or_part("about", is_static, {{"given", false}, {"static", true}},
                     {.says = "of a mechanism: about its start, about its static equilibrium, or about where a "
                              "transient leads",
                      .unless = "given"},
                     [&](auto& inner) { fields(inner, modes.about_reached.emplace()); });
  if (is_static) visit.where(modes.about_equilibrium.emplace(), "about");
  visit.contact_limits(
      "contacts", modes.contacts, modes.contacts_where,
      {.says =
           "limits of contacts and sliders: \"open\", \"stuck\", \"frictionless\", \"static\", or { sliding = { NAME "
           "= 1 } } with the sign in which each slides",
       .unless = "free and stuck"});
  visit.quantities("nodal_diameters", modes.nodal_diameters, {},
                   {.says = "of a disk of equal sectors ([cyclic]), from 0 to half their number", .unless = "all"});
  visit.where_given(modes.nodal_diameters_where, "nodal_diameters");
  swept_fields(visit, modes.swept);
  visit.flag("shapes", modes.swept.keeps_samples,
             {.says = "of a sweep: keep all columns of every sample, besides its key numbers", .unless = "false"});
  needs_a_sweep(visit, "shapes");
  campbell_fields(visit, modes.swept);
}

/// The parameter that takes the frequencies of steady responses, and what is swept besides.
void excitation_fields(auto& visit, auto& task) {
  visit.text(
      "excitation", task.excitation,
      {.says = "the parameter that takes the frequencies", .unless = "the only one in the frequencies of the forces"});
  visit.where(task.excitation_where, "excitation");
  visit.sweep("sweep", task.sweep, {.says = sweep_says});
  visit.where(task.sweep_where, "sweep");
}

void fields(auto& visit, WaveformsDescription& waveforms) {
  visit.where(waveforms.where);
  visit.check([](auto& reader) {
    if (!reader.has("at")) reader.refuse_to_lack("at", ": a list of frequencies");
  });
  visit.values("at", waveforms.at,
               {.required = true, .says = "frequencies, in the unit of the response; the nearest points"});
  visit.quantity("points", waveforms.points, {.says = "samples a period", .unless = "128"});
}

void fields(auto& visit, FrequencyResponseDescription& task) {
  using Task = FrequencyResponseDescription;
  visit.frequencies(task.frequencies, task.frequencies_in_hertz, {.unit = "rad/s", .says = "rising"},
                    {.unit = "Hz", .says = "instead of angular_frequency"});
  excitation_fields(visit, task);
  visit.word("solver", task.route,
             {{"periodic", Task::Route::periodic},
              {"harmonic_balance", Task::Route::harmonic_balance},
              {"time_marching", Task::Route::time_marching}},
             {.says = "the route", .unless = "periodic"});
  visit.where_given(task.route_where, "solver");
  visit.word("start", task.start,
             {{"unloaded", Task::Start::unloaded}, {"previous", Task::Start::previous}, {"rest", Task::Start::rest}},
             {.says = "what a slider that never slips remembers: nothing, the point solved before, or a march from the "
                      "start of the "
                      "study",
              .unless = "unloaded"});
  visit.where(task.start_where, "start");
  visit.word("direction", task.direction,
             {{"up", Task::Direction::up}, {"down", Task::Direction::down}, {"both", Task::Direction::both}},
             {.says = "of the frequency, with start = \"previous\"", .unless = "up"});
  visit.where(task.direction_where, "direction");
  bool is_static = false;
  visit.word(
      "about", is_static, {{"static", true}},
      {.says = "of a mechanism: small motions about its static equilibrium, where the harmonic loads are left out",
       .unless = "a structure answers as it is"});
  if (is_static) visit.where(task.about_equilibrium.emplace(), "about");
  observe_field(visit, task.observe);
  visit.quantities(
      "harmonics", task.harmonics, {},
      {.says =
           "orders whose amplitude and phase are kept besides the first, up to 1000; harmonic balance reaches to 127; "
           "with 1 among them the first is kept by its parts, too (first_real, first_imaginary)"});
  visit.quantity("orders", task.orders,
                 {.says = "of harmonic_balance: all orders up to this one, from 1 to 127, whatever their error",
                  .unless = "chosen by the error"});
  visit.quantity(
      "tolerance", task.tolerance,
      {.unit = "-",
       .says = "relative error wanted of the amplitudes; of periodic: residual of the orbit; between 0 and 1",
       .unless = "the route's own"});
  visit.method("method", task.method, {.says = "of time_marching", .unless = "generalized_alpha"});
  visit.quantity("steps_per_period", task.steps_per_period,
                 {.says = "of time_marching, at least 4", .unless = "chosen by the error"});
  visit.quantity("max_periods", task.max_periods,
                 {.says = "of time_marching: give up after so many", .unless = "1000"});
  visit.table("waveforms", task.waveforms, {.says = "time histories over a period, and hysteresis loops"});
}

void fields(auto& visit, DamperCurveDescription& task) {
  using Objective = DamperCurveDescription::Objective;
  visit.text("parameter", task.parameter, {.required = true, .says = "the parameter that the curve is over"});
  visit.where(task.parameter_where, "parameter");
  visit.check([&](auto& reader) {
    if (!reader.has("range"))
      reader.refuse_to_lack(
          "range", fmt::format(": the values of {}, such as {{ from = 1, to = 100, points = 40 }}", task.parameter));
  });
  visit.values("range", task.range, {.required = true, .says = "its values, rising"});
  visit.frequency_range(task.frequencies, task.frequencies_in_hertz, task.has_frequency_points,
                        {.unit = "rad/s", .says = "where peaks are looked for"},
                        {.unit = "Hz", .says = "instead of angular_frequency"});
  excitation_fields(visit, task);
  visit.word("objective", task.objective, {{"amplitude", Objective::amplitude}, {"dissipated", Objective::dissipated}},
             {.says = "the largest of the observed amplitudes, to be lowered, or the work of all that rubs (sliders, "
                      "contacts, laws), to be raised",
              .unless = "amplitude"});
  visit.where(task.objective_where, "objective");
  using Route = FrequencyResponseDescription::Route;
  Route route = Route::periodic;
  visit.word("solver", route, {{"periodic", Route::periodic}, {"harmonic_balance", Route::harmonic_balance}},
             {.says = "the route", .unless = "chosen by what the model has and by cost"});
  visit.where_given(task.route_where, "solver");
  if (task.route_where.line > 0) task.route = route;
  visit.quantity("tolerance", task.tolerance,
                 {.unit = "-",
                  .says = "of harmonic_balance: relative error wanted of the amplitudes, between 0 and 1",
                  .unless = "1e-4, with laws and contacts 1e-3"});
  bool is_static = false;
  visit.word(
      "about", is_static, {{"static", true}},
      {.says = "of a mechanism: small motions about its static equilibrium, where the harmonic loads are left out",
       .unless = "a structure answers as it is"});
  if (is_static) visit.where(task.about_equilibrium.emplace(), "about");
  visit.flag("optimum", task.optimum, {.says = "refine the best value and certify it", .unless = "true"});
  observe_field(visit, task.observe);
}

void fields(auto& visit, StaticDescription& equilibrium) {
  held_displacements_field(visit, equilibrium.displacements);
  visit.word("friction", equilibrium.without_friction, {{"grown", false}, {"none", true}},
             {.says = "of sliders and contacts: what loads that grow from zero leave, or none", .unless = "grown"});
  observe_field(visit, equilibrium.observe);
  section_forces_field(visit, equilibrium.section_forces);
  swept_fields(visit, equilibrium.swept);
}

/// Of analyses of all types.
void name_field(auto& visit, AnalysisDescription& analysis) {
  visit.where(analysis.where);
  visit.text("name", analysis.name, {.required = true, .says = "names the files of results"});
  visit.title("analysis", analysis.name);
  visit.rule(
      R"({"properties": {"name": {"pattern": "^[^/\\\\.\\u0000-\\u001f\\u007f]+$", "not": {"const": "results"}}}})");
}

/// Calls take.template operator()<Description>(type, what it does) for every `type` of analysis.
void analysis_types(auto&& take) {
  take.template operator()<TransientDescription>("transient", "march in time from the start");
  take.template operator()<MethodStudyDescription>(
      "method_study", "compare methods with the closed-form response of a linear model under harmonic loads");
  take.template operator()<ModesDescription>(
      "modes", "natural frequencies, damping ratios and shapes, with the sliders removed and stuck");
  take.template operator()<FrequencyResponseDescription>(
      "frequency_response", "steady response over frequency, and over sweeps of parameters");
  take.template operator()<DamperCurveDescription>(
      "damper_curve", "the largest amplitude over frequency against a parameter, and where it is lowest");
  take.template operator()<StaticDescription>(
      "static", "equilibrium under the loads at t = 0, held forces and held displacements");
}

}  // namespace rubato::model
