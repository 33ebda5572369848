#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

namespace rubato::io {

using namespace model;

namespace {

/// { from, to }, and perhaps points.
void read_frequency_range(TomlReader& reader, DamperCurveDescription& task) {
  const std::string key = frequency_key(reader);
  task.frequencies_in_hertz = key == "frequency";
  const toml::node& node = *reader.node(key);
  const auto* table = node.as_table();
  if (!table) reader.refuse_type(node, key, "a range in which peaks are looked for, such as { from = 7.0, to = 8.5 }");
  TomlReader range(*table, reader.what() + ": " + key, reader.file());
  task.frequencies.where = reader.location(node);
  task.frequencies.from = range.quantity("from");
  task.frequencies.to = range.quantity("to");
  const auto points = range.optional_quantity("points");
  task.has_frequency_points = points.has_value();
  if (points) task.frequencies.points = *points;
  range.finish();
}

}  // namespace

DamperCurveDescription read_damper_curve(TomlReader& reader, const StudyFolder& folder) {
  DamperCurveDescription task;
  task.parameter = reader.text("parameter");
  task.parameter_where = reader.where("parameter");
  const toml::node* range = reader.node("range");
  if (!range) {
    reader.refuse_misspelling_of("range");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"range\": the values of {}, such as {{ from = 1, "
                                                   "to = 100, points = 40 }}",
                                                   reader.what(), task.parameter));
  }
  task.range = to_values(reader, *range, "range");
  read_frequency_range(reader, task);
  task.excitation = reader.optional_text("excitation").value_or("");
  task.excitation_where = reader.where("excitation");
  task.sweep = read_sweep(reader, folder);
  task.sweep_where = reader.where("sweep");
  const std::string objective = reader.optional_word("objective", {"amplitude", "dissipated"}).value_or("amplitude");
  task.objective = objective == "dissipated" ? DamperCurveDescription::Objective::dissipated
                                             : DamperCurveDescription::Objective::amplitude;
  task.objective_where = reader.where("objective");
  task.optimum = reader.optional_bool("optimum").value_or(true);
  task.observe = read_observe(reader);
  return task;
}

}  // namespace rubato::io
