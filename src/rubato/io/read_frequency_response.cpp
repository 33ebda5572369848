#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

namespace rubato::io {
namespace {

using namespace model;
using Task = FrequencyResponseDescription;

void read_waveforms(TomlReader& reader, Task& task) {
  auto table = reader.optional_table("waveforms", reader.what() + ": waveforms");
  if (!table) return;
  WaveformsDescription waveforms;
  waveforms.where = table->where();
  const toml::node* at = table->node("at");
  if (!at) {
    table->refuse_misspelling_of("at");
    throw InvalidInput(table->where(), fmt::format("{} lacks the key \"at\": a list of frequencies", table->what()));
  }
  waveforms.at = to_values(*table, *at, "at");
  if (const auto points = table->optional_quantity("points")) waveforms.points = *points;
  table->finish();
  task.waveforms = waveforms;
}

}  // namespace

FrequencyResponseDescription read_frequency_response(TomlReader& reader, const StudyFolder& folder) {
  Task task;
  const std::string frequencies = frequency_key(reader);
  task.frequencies_in_hertz = frequencies == "frequency";
  task.frequencies = to_values(reader, *reader.node(frequencies), frequencies);
  task.excitation = reader.optional_text("excitation").value_or("");
  task.excitation_where = reader.where("excitation");
  task.sweep = read_sweep(reader, folder);
  task.sweep_where = reader.where("sweep");
  const std::string solver =
      reader.optional_word("solver", {"periodic", "harmonic_balance", "time_marching"}).value_or("periodic");
  task.route = solver == "time_marching"      ? Task::Route::time_marching
               : solver == "harmonic_balance" ? Task::Route::harmonic_balance
                                              : Task::Route::periodic;
  task.route_where = reader.where("solver");
  const std::string start = reader.optional_word("start", {"unloaded", "previous", "rest"}).value_or("unloaded");
  task.start = start == "previous" ? Task::Start::previous
               : start == "rest"   ? Task::Start::rest
                                   : Task::Start::unloaded;
  task.start_where = reader.where("start");
  const std::string direction = reader.optional_word("direction", {"up", "down", "both"}).value_or("up");
  task.direction = direction == "down"   ? Task::Direction::down
                   : direction == "both" ? Task::Direction::both
                                         : Task::Direction::up;
  task.direction_where = reader.where("direction");
  task.observe = read_observe(reader);
  task.harmonics = reader.optional_quantities("harmonics").value_or(std::vector<Quantity>{});
  task.tolerance = reader.optional_quantity("tolerance");
  if (const toml::node* method = reader.node("method")) task.method = to_method(reader, *method, "method");
  task.steps_per_period = reader.optional_quantity("steps_per_period");
  task.max_periods = reader.optional_quantity("max_periods");
  read_waveforms(reader, task);
  return task;
}

}  // namespace rubato::io
