#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <array>

namespace rubato::io {
namespace {

using namespace model;

/// @param units  that the values of a table may have
TimeLawDescription read_law(TomlReader& reader, const StudyFolder& folder, const std::vector<std::string>& units) {
  const bool has_amplitude = reader.has("amplitude"), has_expression = reader.has("expression"),
             has_table = reader.has("table");
  if (!has_amplitude && !has_expression && !has_table)
    for (const char* key : {"amplitude", "expression", "table"}) reader.refuse_misspelling_of(key);
  if (has_amplitude + has_expression + has_table != 1)
    throw InvalidInput(reader.where(),
                       fmt::format("{} needs exactly one of \"amplitude\" (harmonic), \"expression\" (of "
                                   "t) and \"table\" (a CSV file), got {}",
                                   reader.what(), has_amplitude + has_expression + has_table));
  const std::vector<std::string> of_harmonic{"angular_frequency", "frequency", "phase"};
  if (has_expression || has_table) reader.refuse_beside(has_table ? "table" : "expression", of_harmonic);
  if (!has_table) reader.refuse_beside(has_expression ? "expression" : "amplitude", {"beyond"});
  if (has_expression) {
    TimeFormulaDescription formula{reader.quantity("expression")};
    if (formula.formula.expression.empty()) formula.formula.expression = fmt::format("{}", formula.formula.value);
    return formula;
  }
  if (has_table) {
    TableDescription table = read_table(reader.text("table"), folder, reader.where("table"), units);
    const auto beyond = reader.optional_word("beyond", {"error", "zero", "hold"});
    if (beyond == "zero") table.beyond = TableDescription::Beyond::zero;
    if (beyond == "hold") table.beyond = TableDescription::Beyond::hold;
    return table;
  }
  HarmonicDescription harmonic;
  harmonic.amplitude = reader.quantity("amplitude");
  harmonic.phase = reader.optional_quantity("phase").value_or(Quantity(0.0));
  const auto angular = reader.optional_quantity("angular_frequency");
  const auto hertz = reader.optional_quantity("frequency");
  if (angular && hertz)
    throw InvalidInput(hertz->where,
                       reader.what() + " has both \"angular_frequency\" [rad/s] and \"frequency\" [Hz]; keep one");
  if (!angular && !hertz)
    for (const char* key : {"angular_frequency", "frequency"}) reader.refuse_misspelling_of(key);
  if (!angular && !hertz)
    throw InvalidInput(reader.where(), reader.what() + " lacks \"angular_frequency\" [rad/s] or \"frequency\" [Hz]");
  harmonic.angular_frequency = angular ? *angular : *hertz;
  harmonic.frequency_in_hertz = hertz.has_value();
  return harmonic;
}

template <class Element>
Element read_joining(TomlReader& reader) {
  Element element;
  element.where = reader.where();
  std::array<Location, 2> places;
  element.between = reader.between("between", places);
  element.between_where = places;
  return element;
}

DampingDescription read_damping(TomlReader& root) {
  auto reader = root.optional_table("damping", "[damping]");
  if (!reader) return {};
  const bool modal = reader->has("modal_ratio"), rayleigh = reader->has("rayleigh");
  if (!modal && !rayleigh)
    for (const char* key : {"modal_ratio", "rayleigh"}) reader->refuse_misspelling_of(key);
  if (modal == rayleigh)
    throw InvalidInput(reader->where(), modal ? "[damping] has both \"modal_ratio\" and \"rayleigh\"; keep one"
                                              : "[damping] needs \"modal_ratio\" or \"rayleigh\"; a dashpot is a "
                                                "[[damper]]");
  DampingDescription damping;
  if (modal) {
    ModalDamping description;
    description.where = reader->where("modal_ratio");
    if (reader->node("modal_ratio")->is_array())
      description.ratios = *reader->optional_quantities("modal_ratio");
    else
      description.ratios = {reader->quantity("modal_ratio")};
    description.modes = reader->optional_quantity("modes");
    damping = description;
  } else {
    reader->refuse_beside("rayleigh", {"modes"});
    auto coefficients = reader->optional_table("rayleigh", "[damping]: rayleigh");
    RayleighDamping description;
    description.where = coefficients->where();
    description.mass = coefficients->optional_quantity("mass").value_or(Quantity(0.0));
    description.stiffness = coefficients->optional_quantity("stiffness").value_or(Quantity(0.0));
    coefficients->finish();
    if (!coefficients->has("mass") && !coefficients->has("stiffness"))
      throw InvalidInput(coefficients->where(), "[damping]: rayleigh needs \"mass\" [1/s], \"stiffness\" [s] or both");
    damping = description;
  }
  reader->finish();
  return damping;
}

std::optional<MatricesDescription> read_matrices(TomlReader& root, const StudyFolder& folder) {
  auto reader = root.optional_table("matrices", "[matrices]");
  if (!reader) return std::nullopt;
  const auto matrix = [&](const std::string& key) {
    const std::string file = reader->text(key);
    return read_matrix_market(file, folder, reader->where(key));
  };
  MatricesDescription matrices;
  matrices.where = reader->where();
  matrices.mass = matrix("mass");
  if (reader->has("damping")) matrices.damping = matrix("damping");
  matrices.stiffness = matrix("stiffness");
  matrices.names = reader->optional_texts("names", &matrices.names_where).value_or(std::vector<std::string>{});
  matrices.position = reader->optional_quantities_by_name("position").value_or(decltype(matrices.position){});
  matrices.velocity = reader->optional_quantities_by_name("velocity").value_or(decltype(matrices.velocity){});
  reader->finish();
  return matrices;
}

/// Held in static states by its value, or moving as a law says.
void read_displacement(TomlReader& reader, const StudyFolder& folder, ModelDescription& model) {
  Location where;
  const std::string on = reader.name("on", &where);
  reader.rename(fmt::format("the displacement of \"{}\"", on));
  const std::vector<std::string> of_laws{"amplitude", "expression", "table", "angular_frequency",
                                         "frequency", "phase",      "beyond"};
  if (reader.has("value")) {
    reader.refuse_beside("value", of_laws);
    model.displacements.push_back({on, reader.quantity("value"), where});
  } else {
    reader.refuse_misspelling_of("value");
    if (!reader.has("amplitude") && !reader.has("expression") && !reader.has("table"))
      throw InvalidInput(where,
                         fmt::format("{} needs a \"value\", which is held in static states and then released, or a "
                                     "law by which it moves: \"expression\" of t, \"table\" or \"amplitude\"",
                                     reader.what()));
    model.prescribed.push_back({on, read_law(reader, folder, {"m", "rad"}), where});
  }
  reader.finish();
}

std::optional<BaseMotionDescription> read_base_motion(TomlReader& root, const StudyFolder& folder) {
  auto reader = root.optional_table("base_motion", "[base_motion]");
  if (!reader) return std::nullopt;
  BaseMotionDescription motion;
  motion.where = reader->where();
  const auto of = reader->optional_word("of", {"acceleration", "velocity", "displacement"});
  motion.law = read_law(*reader, folder, {of == "velocity" ? "m/s" : of == "displacement" ? "m" : "m/s2"});
  if (of == "velocity") motion.of = BaseMotionDescription::Of::velocity;
  if (of == "displacement") motion.of = BaseMotionDescription::Of::displacement;
  if (motion.of != BaseMotionDescription::Of::acceleration && !std::holds_alternative<HarmonicDescription>(motion.law))
    throw InvalidInput(reader->where("of"), fmt::format("[base_motion]: of = \"{}\" is for harmonic motion, whose "
                                                        "acceleration is known; give the acceleration",
                                                        *of));
  const auto direction = reader->optional_quantities_by_name("direction");
  if (direction && direction->empty())
    throw InvalidInput(reader->where("direction"),
                       "[base_motion]: direction names nothing that the ground moves; leave it out where it moves all "
                       "coordinates alike");
  motion.direction = direction.value_or(decltype(motion.direction){});
  reader->finish();
  return motion;
}

}  // namespace

ModelDescription read_model(TomlReader& root, const StudyFolder& folder) {
  ModelDescription model;
  model.where = root.where();
  for (TomlReader& reader : root.tables("coordinate")) {
    CoordinateDescription coordinate;
    coordinate.name = reader.text("name");
    coordinate.where = reader.where("name");
    reader.rename(fmt::format("coordinate \"{}\"", coordinate.name));
    coordinate.mass = reader.quantity("mass");
    coordinate.position = reader.optional_quantity("position").value_or(Quantity(0.0));
    coordinate.velocity = reader.optional_quantity("velocity").value_or(Quantity(0.0));
    reader.finish();
    model.coordinates.push_back(std::move(coordinate));
  }
  model.matrices = read_matrices(root, folder);
  for (TomlReader& reader : root.tables("spring")) {
    model.springs.push_back(read_joining<SpringDescription>(reader));
    model.springs.back().stiffness = reader.quantity("stiffness");
    reader.finish();
  }
  for (TomlReader& reader : root.tables("damper")) {
    model.dampers.push_back(read_joining<DamperDescription>(reader));
    model.dampers.back().damping = reader.quantity("damping");
    reader.finish();
  }
  model.damping = read_damping(root);
  for (TomlReader& reader : root.tables("slider")) {
    const std::string name = reader.optional_text("name").value_or(fmt::format("slider{}", model.sliders.size() + 1));
    reader.rename(fmt::format("slider \"{}\"", name));
    model.sliders.push_back(read_joining<SliderDescription>(reader));
    SliderDescription& slider = model.sliders.back();
    slider.name = name;
    slider.where = reader.where("name");
    slider.stiffness = reader.quantity("stiffness");
    slider.friction_coefficient = reader.quantity("friction_coefficient");
    slider.normal_load = reader.quantity("normal_load");
    reader.finish();
  }
  for (TomlReader& reader : root.tables("stop")) {
    const std::string name = reader.optional_text("name").value_or(fmt::format("stop{}", model.stops.size() + 1));
    reader.rename(fmt::format("stop \"{}\"", name));
    model.stops.push_back(read_joining<StopDescription>(reader));
    StopDescription& stop = model.stops.back();
    stop.name = name;
    stop.where = reader.where("name");
    stop.gap = reader.quantity("gap");
    stop.stiffness = reader.quantity("stiffness");
    stop.damping = reader.optional_quantity("damping").value_or(Quantity(0.0));
    reader.finish();
  }
  for (TomlReader& reader : root.tables("force")) {
    ForceDescription force;
    force.on = reader.name("on", &force.where);
    reader.rename(fmt::format("the force on \"{}\"", force.on));
    if (reader.has("held")) {
      reader.refuse_beside("held",
                           {"amplitude", "expression", "table", "angular_frequency", "frequency", "phase", "beyond"});
      model.held_forces.push_back({force.on, reader.quantity("held"), force.where});
      reader.finish();
      continue;
    }
    force.law = read_law(reader, folder, {"N", "N m"});
    force.follows = reader.optional_bool("following").value_or(false);
    if (reader.has("following")) force.follows_where = reader.where("following");
    force.at = reader.optional_quantities("at").value_or(std::vector<Quantity>{});
    force.at_where = reader.where("at");
    if (!force.at.empty() && !force.follows)
      throw InvalidInput(force.at_where, reader.what() +
                                             ": \"at\" goes with following = true; other forces act at the "
                                             "node, or at the centre of mass of the body");
    reader.finish();
    model.forces.push_back(std::move(force));
  }
  for (TomlReader& reader : root.tables("distributed_force")) {
    DistributedForceDescription force;
    force.on = reader.name("on", &force.where);
    reader.rename(fmt::format("the distributed force on \"{}\"", force.on));
    force.direction = reader.optional_quantities("direction").value_or(std::vector<Quantity>{});
    force.law = read_law(reader, folder, {"N/m"});
    reader.finish();
    model.distributed_forces.push_back(std::move(force));
  }
  for (TomlReader& reader : root.tables("displacement")) read_displacement(reader, folder, model);
  model.base_motion = read_base_motion(root, folder);
  read_structure(root, folder, model);
  read_mechanism(root, folder, model);
  return model;
}

}  // namespace rubato::io
