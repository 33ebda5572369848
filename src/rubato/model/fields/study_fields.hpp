#pragma once

#include <rubato/model/fields/analysis_fields.hpp>
#include <rubato/model/fields/model_fields.hpp>

// The keys of the study itself.
namespace rubato::model {

void fields(auto& visit, StudyDescription& study) {
  visit.text("title", study.title, {.says = "heads the report", .unless = "the name of the file"});
  visit.parameters("parameters", study.parameters, {.says = "numbers that expressions use and --set replaces"});
  fields(visit, study.model);
  visit.analyses("analysis", study.analyses,
                 {.required = true, .says = "what to run on the model; each has a CSV file of its name"});
}

}  // namespace rubato::model
