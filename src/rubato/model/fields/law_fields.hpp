#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>
#include <rubato/model/friction_coefficient.hpp>

#include <fmt/format.h>

#include <cstring>
#include <string>

// The keys of coordinates and of what acts between two of them: springs, dampers, sliders, stops and other laws; and of
// [damping].
namespace rubato::model {

void fields(auto& visit, Like<CoordinateDescription> auto& coordinate) {
  visit.text("name", coordinate.name, {.required = true, .says = "heads its columns in the results"});
  visit.where(coordinate.where, "name");
  visit.title("coordinate", coordinate.name);
  visit.quantity("mass", coordinate.mass, {.required = true, .unit = "kg", .range = Range::positive});
  visit.quantity("position", coordinate.position, {.unit = "m", .says = "at the start", .unless = "0"});
  visit.quantity("velocity", coordinate.velocity, {.unit = "m/s", .says = "at the start", .unless = "0"});
}

void fields(auto& visit, Like<SpringDescription> auto& spring) {
  visit.where(spring.where);
  visit.between("between", spring.between, spring.between_where, {.required = true});
  visit.quantity("stiffness", spring.stiffness, {.required = true, .unit = "N/m"});
}

void fields(auto& visit, Like<DamperDescription> auto& damper) {
  visit.where(damper.where);
  visit.between("between", damper.between, damper.between_where, {.required = true});
  visit.quantity("damping", damper.damping, {.required = true, .unit = "N s/m"});
}

/// Sliders and stops join two coordinates.
void refuse_shares(auto& reader, const char* instead) {
  if (reader.has("shares"))
    throw InvalidInput(reader.where("shares"),
                       fmt::format("{}: \"shares\" are not taken here, whose u is the difference of two "
                                   "coordinates: take between, or {}",
                                   reader.what(), instead));
}

void fields(auto& visit, Like<SliderDescription> auto& slider) {
  visit.numbered_name("slider", slider.name, slider.where, {.says = "heads its columns in the results"});
  visit.between("between", slider.between, slider.between_where, {});
  visit.text("joint", slider.joint, {.says = "instead of between: it rubs on what this joint leaves free"});
  visit.where_given(slider.joint_where, "joint");
  visit.exactly_one_of({"between", "joint"});
  visit.check([&](auto& reader) {
    refuse_shares(reader, "a [[contact]] with tangential and normal shares and a constant normal_load");
    if (!slider.joint.empty()) reader.refuse_beside("joint", {"between"});
    if (slider.joint.empty() && slider.between[0].empty()) reader.refuse_to_lack("between");
  });
  visit.quantity("stiffness", slider.stiffness,
                 {.required = true, .unit = "N/m", .says = "kT", .range = Range::positive});
  const bool is_law = slider.is_law();
  const Role role = is_law ? Role::structure : Role::limit;
  visit.quantity_of_rate("friction_coefficient", slider.friction_coefficient,
                         depends_on_rate(slider.friction_coefficient),
                         {.required = true,
                          .unit = "-",
                          .says = "mu; may be a formula of the rate [m/s], as \"0.3 + 0.2*exp(-abs(rate)/0.05)\"",
                          .role = role});
  visit.load_or_part(
      "normal_load", slider.normal_load, is_law,
      {.required = true,
       .unit = "N",
       .says = "N, which may use t; \"reaction\", of the joint that it rubs on; or { law = \"NAME\" }, the "
               "force of a stop or of another law, or \"JOINT.reaction\"",
       .role = role},
      [&](auto& inner) {
        inner.text("law", slider.normal_law, {.required = true, .says = "the stop or law whose force presses"});
        inner.where_given(slider.normal_law_where, "law");
      });
}

void fields(auto& visit, Like<StopDescription> auto& stop) {
  visit.numbered_name("stop", stop.name, stop.where, {.says = "heads its columns in the results"});
  visit.between("between", stop.between, stop.between_where, {});
  visit.text("joint", stop.joint, {.says = "instead of between: u is what this joint leaves free"});
  visit.where_given(stop.joint_where, "joint");
  visit.exactly_one_of({"between", "joint"});
  visit.check([&](auto& reader) {
    refuse_shares(reader, "a [[contact]] with normal shares");
    if (!stop.joint.empty()) reader.refuse_beside("joint", {"between"});
    if (stop.joint.empty() && stop.between[0].empty()) reader.refuse_to_lack("between");
  });
  visit.quantity("gap", stop.gap,
                 {.required = true,
                  .unit = "m",
                  .says = "closed where u = x_first - x_second exceeds it; negative: compressed at u = 0"});
  visit.quantity("stiffness", stop.stiffness, {.required = true, .unit = "N/m", .says = "k", .range = Range::positive});
  visit.quantity("damping", stop.damping,
                 {.unit = "N s/m", .says = "c while closed; the force never pulls", .unless = "0"});
}

/// The table in which a key of a law is, of "degradation.A" that is "degradation"; empty: beside the others.
inline std::string table_of(const LawKey& key) {
  const char* dot = std::strchr(key.name, '.');
  return dot ? std::string(key.name, dot) : std::string();
}

void law_key(auto& visit, const LawKey& key, auto& value) {
  const Key about{.required = !key.preset, .unit = key.unit, .says = key.meaning, .unless = key.unless.c_str()};
  const char* dot = std::strchr(key.name, '.');
  const char* name = dot ? dot + 1 : key.name;
  if (key.type == LawKey::Type::formula)
    visit.formula(name, value, about);
  else
    visit.quantity(name, value, about);
}

/// Of the kinds of model/laws: each says its own keys.
void fields(auto& visit, Like<LawDescription> auto& law) {
  const LawKind& kind = law_kind(law.kind);
  visit.numbered_name(kind.table, law.name, law.where, {.says = "heads its columns in the results"});
  visit.between("between", law.between, law.between_where, {});
  visit.text("joint", law.joint, {.says = "instead of between: it acts on what this joint leaves free"});
  visit.where_given(law.joint_where, "joint");
  visit.by_name("shares", law.shares,
                {.says = "instead of between: u as coordinates times weights, { x1 = 1.0, x2 = \"-cos(b)\" }"});
  visit.where_given(law.shares_where, "shares");
  visit.exactly_one_of({"between", "joint", "shares"});
  visit.check([&](auto& reader) {
    if (!law.joint.empty()) reader.refuse_beside("joint", {"between", "shares"});
    if (!law.shares.empty()) reader.refuse_beside("shares", {"between"});
    if (law.joint.empty() && law.shares.empty() && law.between[0].empty()) reader.refuse_to_lack("between");
  });
  for (std::size_t i = 0; i < kind.keys.size();) {
    const std::string table = table_of(kind.keys[i]);
    if (table.empty()) {
      law_key(visit, kind.keys[i], law.values[i]);
      ++i;
      continue;
    }
    const std::size_t first = i;
    while (i < kind.keys.size() && table_of(kind.keys[i]) == table) ++i;
    visit.part(table.c_str(), {.says = "what of it changes, each of these 0 where it is left out"}, [&](auto& inner) {
      for (std::size_t j = first; j < i; ++j) law_key(inner, kind.keys[j], law.values[j]);
    });
  }
}

void fields(auto& visit, Like<ContactDescription> auto& contact) {
  visit.numbered_name("contact", contact.name, contact.where, {.says = "heads its columns in the results"});
  visit.between("between", contact.between, contact.between_where,
                {.says = "two nodes, or a node and the ground; with a normal_direction"});
  visit.quantities("normal_direction", contact.normal_direction, {2, 3},
                   {.says = "from the second of the two to the first, across the plane of contact"});
  visit.where_given(contact.normal_direction_where, "normal_direction");
  visit.quantities("tangential_direction", contact.tangential_direction, {3, 3},
                   {.says = "in space, the first of two along the plane", .unless = "the axis least along the normal"});
  visit.where_given(contact.tangential_direction_where, "tangential_direction");
  visit.quantities("at", contact.at, {2, 3},
                   {.unit = "m",
                    .says = "with bodies and joints: the point of the first part, in the configuration given",
                    .unless = "its node, of a body its centre of mass"});
  visit.where_given(contact.at_where, "at");
  visit.quantities("to", contact.to, {2, 3},
                   {.unit = "m",
                    .says = "with bodies and joints: a point of the plane of the second part, in the configuration "
                            "given, instead of the gap"});
  visit.where_given(contact.to_where, "to");
  visit.quantity("radius", contact.radius,
                 {.unit = "m",
                  .says = "with bodies and joints: of a disk (in space a sphere, without friction) about `at`",
                  .unless = "a point",
                  .range = Range::positive});
  visit.one_or_two_by_name(
      "tangential", contact.tangential,
      {.says = "instead of between: u along the plane as coordinates times weights, { x1 = 1.0 }, or a list of two"});
  visit.where_given(contact.tangential_where, "tangential");
  visit.by_name("normal", contact.normal,
                {.says = "with tangential: d, positive where the two come nearer, as coordinates times weights"});
  visit.where_given(contact.normal_where, "normal");
  visit.quantity("tangential_stiffness", contact.tangential_stiffness,
                 {.unit = "N/m", .says = "kT; of a contact that rubs", .range = Range::positive});
  visit.quantity("normal_stiffness", contact.normal_stiffness,
                 {.required = true, .unit = "N/m", .says = "kn", .range = Range::positive});
  visit.quantity("friction_coefficient", contact.friction_coefficient,
                 {.unit = "-", .says = "mu: |T| <= mu N", .unless = "nothing rubs", .range = Range::not_negative});
  visit.quantity("gap", contact.gap,
                 {.unit = "m", .says = "N = max(0, kn (d - gap)); negative: pressed at d = 0", .unless = "0"});
  visit.quantity(
      "normal_load", contact.normal_load,
      {.unit = "N", .says = "instead of the gap: N = max(0, normal_load + kn d)", .range = Range::not_negative});
  visit.quantity("normal_damping", contact.normal_damping,
                 {.unit = "N s/m",
                  .says = "cn while closed: N = max(0, kn (d - gap) + cn dd/dt), which never pulls",
                  .unless = "0",
                  .range = Range::not_negative});
  visit.quantity("sliding_velocity", contact.sliding_velocity,
                 {.unit = "m/s", .says = "V of a belt or disc: V t is added to u, the first of two", .unless = "0"});
  visit.exactly_one_of({"between", "normal"});
  visit.requires_beside("sliding_velocity", "friction_coefficient");
  visit.excludes("gap", "normal_load");
  visit.excludes("to", "gap");
  visit.excludes("to", "normal_load");
  visit.requires_beside("at", "between");
  visit.requires_beside("to", "between");
  visit.requires_beside("radius", "between");
  visit.requires_beside("between", "normal_direction");
  visit.requires_beside("normal_direction", "between");
  visit.requires_beside("tangential_direction", "between");
  visit.requires_beside("tangential", "normal");
  visit.requires_beside("tangential_stiffness", "friction_coefficient");
  visit.requires_beside("friction_coefficient", "tangential_stiffness");
  visit.check([&](auto& reader) {
    const bool is_of_nodes = !contact.between[0].empty();
    if (is_of_nodes) reader.refuse_beside("between", {"tangential", "normal"});
    if (!contact.normal.empty())
      reader.refuse_beside("normal", {"normal_direction", "tangential_direction", "at", "to", "radius"});
    if (!is_of_nodes && contact.normal.empty()) reader.refuse_to_lack("between");
    if (is_of_nodes && contact.normal_direction.empty()) reader.refuse_to_lack("normal_direction");
    if (contact.gap && contact.normal_load) reader.refuse_beside("gap", {"normal_load"});
    if (!contact.to.empty()) reader.refuse_beside("to", {"gap", "normal_load"});
    if (contact.tangential_stiffness && !contact.friction_coefficient) reader.refuse_to_lack("friction_coefficient");
    if (contact.friction_coefficient && !contact.tangential_stiffness) reader.refuse_to_lack("tangential_stiffness");
    if (!is_of_nodes && contact.friction_coefficient && contact.tangential.empty()) reader.refuse_to_lack("tangential");
    if (!contact.friction_coefficient && !contact.tangential.empty()) reader.refuse_to_lack("friction_coefficient");
    if (!contact.friction_coefficient && contact.sliding_velocity) reader.refuse_to_lack("friction_coefficient");
  });
}

void fields(auto& visit, Like<ModalDamping> auto& damping) {
  visit.where(damping.where, "modal_ratio");
  visit.one_or_more(
      "modal_ratio", damping.ratios, {},
      {.required = true, .unit = "-", .says = "of the modes without sliders and laws: one for all, or one a mode"});
  visit.quantity("modes", damping.modes, {.says = "only so many of the lowest modes are damped"});
}

void fields(auto& visit, Like<RayleighDamping> auto& damping) {
  visit.part("rayleigh", {.required = true, .says = "C = mass M + stiffness K"}, [&](auto& inner) {
    inner.where(damping.where);
    inner.quantity("mass", damping.mass, {.unit = "1/s", .unless = "0"});
    inner.quantity("stiffness", damping.stiffness, {.unit = "s", .unless = "0"});
    inner.some_of({"mass", "stiffness"});
    inner.check_at_end([](auto& reader) {
      if (!reader.has("mass") && !reader.has("stiffness"))
        throw InvalidInput(reader.where(), reader.what() + " needs \"mass\" [1/s], \"stiffness\" [s] or both");
    });
  });
}

void fields(auto& visit, Like<DampingDescription> auto& damping) {
  visit.alternatives(damping, {"modal_ratio", "rayleigh"}, [](auto& reader, int given) {
    throw InvalidInput(reader.where(), given == 2 ? "[damping] has both \"modal_ratio\" and \"rayleigh\"; keep one"
                                                  : "[damping] needs \"modal_ratio\" or \"rayleigh\"; a dashpot is a "
                                                    "[[damper]]");
  });
}

}  // namespace rubato::model
