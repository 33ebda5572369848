#include <rubato/analysis/prepared_study.hpp>
#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/model/finite_elements/check_finite_elements.hpp>
#include <rubato/model/finite_elements/reduction.hpp>

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

namespace rubato::analysis {
namespace {

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

std::vector<model::AnalysisDescription> chosen_analyses(const model::StudyDescription& study,
                                                        const std::vector<std::string>& names,
                                                        const std::string& option) {
  if (study.analyses.empty())
    throw InvalidInput({study.file, 0, 0}, "the study has no [[analysis]]; add one, such as type = \"transient\"");
  if (names.empty()) return study.analyses;
  std::vector<std::string> known;
  for (const auto& analysis : study.analyses) known.push_back(analysis.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidInput(fmt::format("{}{}: no such analysis{}", option, name, suggestion(name, known)));
  std::vector<model::AnalysisDescription> analyses;
  for (const auto& analysis : study.analyses)
    if (std::find(names.begin(), names.end(), analysis.name) != names.end()) analyses.push_back(analysis);
  return analyses;
}

std::unique_ptr<const PreparedStudy> prepare(std::shared_ptr<const model::StudyDescription> study,
                                             const numerics::Parameters& overrides,
                                             std::vector<model::AnalysisDescription> analyses) {
  std::string task = "to assemble the model";
  try {
    auto prepared = std::make_unique<PreparedStudy>();
    prepared->description = study;
    prepared->overrides = overrides;
    prepared->parameters = model::evaluate_parameters(study->parameters, overrides);
    prepared->analyses = std::move(analyses);
    prepared->kind = assembled(*study, prepared->parameters);
    prepared->transients = std::make_unique<StudyTransients>(study->analyses, *prepared->kind, prepared->parameters);
    for (const auto& analysis : prepared->analyses) {
      task = fmt::format("to check the analysis \"{}\"", analysis.name);
      prepared->planned.push_back(plan_analysis(analysis, prepared->input()));
    }
    return prepared;
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(
        fmt::format("{}: there is not enough memory {}; observe fewer coordinates, or take a "
                    "smaller model",
                    study->file, task));
  }
}

namespace {

void add_doubts(const model::ReductionDescription& reduction, const PreparedStudy& study,
                std::vector<model::DoubtfulValue>& doubts) {
  if (std::string doubt = model::doubt_of(reduction); !doubt.empty()) doubts.push_back({reduction.where, doubt});
  for (const model::AnalysisDescription& analysis : study.analyses) {
    const auto* modes = std::get_if<model::ModesDescription>(&analysis.task);
    if (!modes) continue;
    const Index count = study.kind->mode_count({"", analysis.where, *modes, study.parameters});
    if (const std::string doubt = model::modes_beyond_estimates(reduction, count); !doubt.empty())
      doubts.push_back({analysis.where, fmt::format("analysis \"{}\": {}", analysis.name, doubt)});
  }
}

}  // namespace

ModelFindings findings_of(const PreparedStudy& study) {
  ModelFindings findings;
  findings.doubts = model::doubtful_values(study.description->model, study.parameters);
  if (const auto& elements = study.description->model.finite_elements) {
    model::FiniteElementFindings found = model::check_finite_elements(*elements);
    findings.doubts.insert(findings.doubts.end(), found.doubts.begin(), found.doubts.end());
    findings.facts = std::move(found.facts);
    if (elements->reduction) add_doubts(*elements->reduction, study, findings.doubts);
  }
  return findings;
}

void require_memory(const PreparedStudy& study, bool keeps_results) {
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  constexpr double share = 8.0 / 28.0;  // a number takes 8 bytes in memory and about 28 in both files
  for (std::size_t i = 0; i < study.analyses.size(); ++i) {
    const auto& outline = study.planned[i].outline;
    const auto& task = study.analyses[i];
    if (outline.memory > 0.8 * memory)
      throw InvalidInput(task.where,
                         fmt::format("analysis \"{}\": a sweep of {:.6g} points keeps {:.3g} GB, and this "
                                     "machine has {:.3g} GB; observe fewer coordinates, or take fewer points",
                                     task.name, outline.points, outline.memory / 1e9, memory / 1e9));
    if (const double kept = outline.memory + share * outline.expected_bytes; keeps_results && kept > 0.8 * memory)
      throw InvalidInput(task.where,
                         fmt::format("analysis \"{}\": its results take {:.3g} GB of memory, and this machine has "
                                     "{:.3g} GB; observe fewer coordinates, keep fewer rows (output), or write to "
                                     "files with the command `rubato run`",
                                     task.name, kept / 1e9, memory / 1e9));
  }
}

}  // namespace rubato::analysis
