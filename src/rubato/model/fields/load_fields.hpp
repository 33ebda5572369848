#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>

#include <fmt/format.h>

// The keys of laws of time, and of what moves by them: forces, displacements, the ground; and of gravity.
namespace rubato::model {

/// @param use  of tables; every alternative of a law takes it
void fields(auto& visit, Like<HarmonicDescription> auto& harmonic, const TableUse&) {
  visit.quantity("amplitude", harmonic.amplitude,
                 {.required = true,
                  .says = "of the harmonic law amplitude * cos(angular_frequency * t + phase), of either sign",
                  .role = Role::load});
  visit.either_quantity(
      {"angular_frequency", "frequency"}, harmonic.angular_frequency, harmonic.frequency_in_hertz,
      {.unit = "rad/s", .role = Role::frequency}, {.unit = "Hz", .says = "instead of angular_frequency"},
      [](auto& reader, int given, const Location& where) {
        if (given == 2)
          throw InvalidInput(
              where, reader.what() + " has both \"angular_frequency\" [rad/s] and \"frequency\" [Hz]; keep one");
        throw InvalidInput(where, reader.what() + " lacks \"angular_frequency\" [rad/s] or \"frequency\" [Hz]");
      });
  visit.quantity("phase", harmonic.phase, {.unit = "rad", .unless = "0", .role = Role::load});
}

void fields(auto& visit, Like<TimeFormulaDescription> auto& law, const TableUse&) {
  visit.formula("expression", law.formula,
                {.required = true, .says = "a formula of t [s] and of the parameters", .role = Role::load});
}

void fields(auto& visit, Like<TableDescription> auto& table, const TableUse& use) {
  using Beyond = TableDescription::Beyond;
  visit.columns("table", table, use, {.required = true, .says = use.says});
  std::vector<Choice<Beyond>> choices{{"error", Beyond::error}, {"zero", Beyond::zero}, {"hold", Beyond::hold}};
  if (!use.may_be_zero_beyond) choices.erase(choices.begin() + 1);
  visit.word("beyond", table.beyond, choices, {.says = "what holds outside the rows of the table", .unless = "error"});
}

/// The law itself: amplitude, expression or table, with what belongs to each.
void fields(auto& visit, Like<TimeLawDescription> auto& law, const TableUse& use) {
  visit.alternatives(
      law, {"amplitude", "expression", "table"},
      [](auto& reader, int given) {
        throw InvalidInput(reader.where(), fmt::format("{} needs exactly one of \"amplitude\" (harmonic), "
                                                       "\"expression\" (of t) and \"table\" (a CSV file), got {}",
                                                       reader.what(), given));
      },
      use);
}

/// What static states hold.
enum class Held { force, displacement };

/// [[force]] with `held`, or [[displacement]] with `value`.
void fields(auto& visit, Like<HeldDescription> auto& held, Held what) {
  const bool is_force = what == Held::force;
  visit.name("on", held.on, held.where,
             {.required = true, .says = "a coordinate or degree of freedom: its name, or its number with [matrices]"});
  visit.title(is_force ? "the force on" : "the displacement of", held.on);
  visit.quantity(is_force ? "held" : "value", held.value,
                 {.required = true,
                  .unit = is_force ? "N" : "m, or rad of a rotation",
                  .says = "held in static analyses and static starts, released in transients; instead of a law",
                  .role = Role::none});
}

/// [[force]] with a law.
void fields(auto& visit, Like<ForceDescription> auto& force) {
  visit.name("on", force.on, force.where,
             {.required = true, .says = "a coordinate or degree of freedom: its name, or its number with [matrices]"});
  visit.title("the force on", force.on);
  fields(visit, force.law, {.units = {"N", "N m"}});
  visit.flag("following", force.follows,
             {.says = "of mechanisms: along an axis of the node or body, which turns with it, or of the world",
              .unless = "false; of moments in space true"});
  visit.where_given(force.follows_where, "following");
  visit.quantities("at", force.at, {2, 3},
                   {.unit = "m",
                    .says = "its point in the configuration given, with following",
                    .unless = "the node",
                    .role = Role::none});
  visit.where(force.at_where, "at");
  visit.check([&](auto& reader) {
    if (!force.at.empty() && !force.follows)
      throw InvalidInput(force.at_where, reader.what() +
                                             ": \"at\" goes with following = true; other forces act at the "
                                             "node, or at the centre of mass of the body");
  });
}

void fields(auto& visit, Like<DistributedForceDescription> auto& force) {
  visit.name("on", force.on, force.where, {.required = true, .says = "the name of a beam or truss"});
  visit.title("the distributed force on", force.on);
  visit.quantities("direction", force.direction, {2, 3},
                   {.unit = "-", .says = "along x, y and in space z; its length multiplies the law"});
  visit.needs("direction");
  fields(visit, force.law, {.units = {"N/m"}});
}

/// [[displacement]] with a law.
void fields(auto& visit, Like<PrescribedDescription> auto& motion) {
  visit.name("on", motion.on, motion.where, {.required = true, .says = "a coordinate or degree of freedom"});
  visit.title("the displacement of", motion.on);
  visit.check([&](auto& reader) {
    reader.refuse_misspelling_of("value");
    if (!reader.has("amplitude") && !reader.has("expression") && !reader.has("table"))
      throw InvalidInput(motion.where,
                         fmt::format("{} needs a \"value\", which is held in static states and then released, or a "
                                     "law by which it moves: \"expression\" of t, \"table\" or \"amplitude\"",
                                     reader.what()));
  });
  fields(visit, motion.law,
         {.units = {"m", "rad"},
          .says = "a CSV file of time [s] and value, through which a cubic spline passes; relative to the study"});
}

void fields(auto& visit, Like<GravityDescription> auto& gravity) {
  visit.where(gravity.where);
  visit.quantities("acceleration", gravity.acceleration, {2, 3},
                   {.required = true, .unit = "m/s2", .says = "two numbers in the plane, three in space"});
}

void fields(auto& visit, Like<BaseMotionDescription> auto& motion) {
  using Of = BaseMotionDescription::Of;
  visit.where(motion.where);
  visit.word("of", motion.of,
             {{"acceleration", Of::acceleration}, {"velocity", Of::velocity}, {"displacement", Of::displacement}},
             {.says = "what the law gives; velocity [m/s] and displacement [m] for harmonic laws",
              .unless = "acceleration [m/s2]"});
  fields(visit, motion.law,
         {.units = {motion.of == Of::velocity       ? "m/s"
                    : motion.of == Of::displacement ? "m"
                                                    : "m/s2"}});
  visit.check([&](auto& reader) {
    if (motion.of != Of::acceleration && !std::holds_alternative<HarmonicDescription>(motion.law))
      throw InvalidInput(reader.where("of"), fmt::format("[base_motion]: of = \"{}\" is for harmonic motion, whose "
                                                         "acceleration is known; give the acceleration",
                                                         motion.of == Of::velocity ? "velocity" : "displacement"));
  });
  visit.by_name("direction", motion.direction,
                {.unit = "-",
                 .says = "share of each coordinate; with nodes x, y and z, the direction in which the ground moves",
                 .unless = "1 for all"});
  visit.rule(R"({"properties": {"direction": {"minProperties": 1}}})");
  visit.check([&](auto& reader) {
    if (reader.has("direction") && motion.direction.empty())
      throw InvalidInput(
          reader.where("direction"),
          "[base_motion]: direction names nothing that the ground moves; leave it out where it moves all "
          "coordinates alike");
  });
}

}  // namespace rubato::model
