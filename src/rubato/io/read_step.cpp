#include <rubato/io/read_step.hpp>

namespace rubato::io {

model::StepDescription read_step(const TomlReader& analysis, const toml::table& table) {
  TomlReader reader(table, analysis.what() + ": step", analysis.file());
  model::StepDescription step;
  step.where = reader.where();
  step.tolerance = reader.quantity("tolerance");
  step.controller = reader.optional_word("controller", {"pi", "cardona_cassano", "fixed"}).value_or("");
  step.estimator = reader.optional_word("estimator", {"local_error", "inertia_jump", "embedded"}).value_or("");
  step.first = reader.optional_quantity("first");
  step.smallest = reader.optional_quantity("smallest");
  step.largest = reader.optional_quantity("largest");
  if (const auto events = reader.optional_word("events", {"locate", "pass"})) step.locate_events = *events == "locate";
  if (const toml::node* reference = reader.node("reference")) {
    const auto* word = reference->as_string();
    if (word && word->get() == "initial")
      step.reference_is_initial = true;
    else
      step.reference = reader.quantity("reference");
  }
  step.as_printed = reader.optional_bool("as_printed").value_or(false);
  step.rebuild = reader.optional_bool("rebuild").value_or(true);
  reader.finish();
  return step;
}

}  // namespace rubato::io
