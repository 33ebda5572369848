#include "prepared_study.hpp"

#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/io/read_study.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <new>
#include <stdexcept>

namespace rubato::app {
namespace {

numerics::Parameters overrides_of(const std::vector<std::string>& settings) {
  numerics::Parameters values;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InvalidInput(fmt::format("--set {}: write PARAM=VALUE, such as --set N0=25", setting));
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    try {
      values.emplace_back(name, numerics::Formula(text, {})());
    } catch (const InvalidInput& fault) {
      throw InvalidInput(fmt::format("--set {}: {}", setting, fault.message()));
    }
  }
  return values;
}

std::vector<model::AnalysisDescription> chosen(const model::StudyDescription& study,
                                               const std::vector<std::string>& only) {
  if (study.analyses.empty())
    throw InvalidInput({study.file, 0, 0}, "the study has no [[analysis]]; add one, such as type = \"transient\"");
  if (only.empty()) return study.analyses;
  std::vector<std::string> known;
  for (const auto& analysis : study.analyses) known.push_back(analysis.name);
  for (const std::string& name : only)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidInput(fmt::format("--only {}: no such analysis{}", name, suggestion(name, known)));
  std::vector<model::AnalysisDescription> analyses;
  for (const auto& analysis : study.analyses)
    if (std::find(only.begin(), only.end(), analysis.name) != only.end()) analyses.push_back(analysis);
  return analyses;
}

std::unique_ptr<const integrate::SystemKind> assembled(const model::StudyDescription& study,
                                                       const numerics::Parameters& parameters) {
  try {
    return integrate::assemble_kind(study.model, parameters);
  } catch (const InvalidInput& fault) {
    if (!fault.where().file.empty()) throw;
    throw InvalidInput({study.file, 0, 0}, fault.message());
  }
}

}  // namespace

double PreparedStudy::expected_bytes() const {
  double bytes = 0.0;
  for (const auto& analysis : planned) bytes += analysis.outline.expected_bytes;
  return bytes;
}

std::unique_ptr<const PreparedStudy> prepare(const StudyOptions& options) {
  const numerics::Parameters overrides = overrides_of(options.set);
  io::SourceFiles files;
  model::StudyDescription study = io::read_study(options.study, &files);
  const numerics::Parameters parameters = model::evaluate_parameters(study.parameters, overrides);
  const auto analyses = chosen(study, options.only);
  std::string task = "to assemble the model";
  try {
    auto prepared = std::make_unique<PreparedStudy>(
        PreparedStudy{study, files, overrides, parameters, analyses, {}, assembled(study, parameters)});
    prepared->transients = std::make_unique<analysis::StudyTransients>(prepared->description.analyses, *prepared->kind,
                                                                       prepared->parameters);
    for (const auto& analysis : analyses) {
      task = fmt::format("to check the analysis \"{}\"", analysis.name);
      prepared->planned.push_back(analysis::plan_analysis(analysis, prepared->input()));
    }
    return prepared;
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(
        fmt::format("{}: there is not enough memory {}; observe fewer coordinates, or take a "
                    "smaller model",
                    study.file, task));
  }
}

}  // namespace rubato::app
