#include "study.hpp"

#include <rubato/core/error.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/numerics/formula.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::python {
namespace {

std::string text_of(const model::DoubtfulValue& doubt) {
  if (doubt.where.line <= 0) return doubt.message;
  return fmt::format("{}:{}:{}: {}", doubt.where.file, doubt.where.line, doubt.where.column, doubt.message);
}

numerics::Parameters overrides_of(const model::StudyDescription& study, const Settings& settings) {
  std::vector<std::string> known;
  for (const auto& parameter : study.parameters) known.push_back(parameter.name);
  numerics::Parameters values;
  for (const auto& [name, value] : settings) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidInput({study.file, 0, 0},
                         fmt::format("no such parameter: \"{}\"{}", name,
                                     known.empty() ? "; the study has no [parameters]" : suggestion(name, known)));
    if (const double* number = std::get_if<double>(&value)) {
      values.emplace_back(name, *number);
      continue;
    }
    try {
      values.emplace_back(name, numerics::Formula(std::get<std::string>(value), {})());
    } catch (const InvalidInput& fault) {
      throw InvalidInput({study.file, 0, 0}, fmt::format("parameter \"{}\": {}", name, fault.message()));
    }
  }
  return values;
}

}  // namespace

Study read_study(const std::filesystem::path& file) {
  return {std::make_shared<const model::StudyDescription>(io::read_study(file)),
          file.has_parent_path() ? file.parent_path() : std::filesystem::path(".")};
}

Study read_study_text(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  return {std::make_shared<const model::StudyDescription>(io::read_study_text(text, name, folder)), folder};
}

/// Notes how far its analysis is, for whoever asks.
class Run::Listener final : public analysis::Progress {
 public:
  explicit Listener(Run& run) : run_(run) {}

  void begin(const std::string& what, double total, const std::string& unit) override {
    const std::lock_guard lock(run_.mutex_);
    auto& all = run_.progress_;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.analysis == what; });
    place_ = static_cast<std::size_t>(found - all.begin());
    if (found == all.end()) all.emplace_back();
    all[place_] = {what, 0.0, total, unit};
  }
  void advance(double done) override {
    const std::lock_guard lock(run_.mutex_);
    if (place_ < run_.progress_.size()) run_.progress_[place_].done = done;
  }
  void end() override {}

 private:
  Run& run_;
  std::size_t place_ = static_cast<std::size_t>(-1);
};

Run::Run(Study study, Settings settings, std::vector<std::string> only, int jobs, bool checks_only)
    : study_(std::move(study)),
      settings_(std::move(settings)),
      only_(std::move(only)),
      jobs_(jobs),
      checks_only_(checks_only),
      task_(std::make_unique<Task>([this](const std::atomic<bool>& stop) { work(stop); })) {}

void Run::work(const std::atomic<bool>& stop) {
  const model::StudyDescription& study = *study_.description;
  const auto overrides = overrides_of(study, settings_);
  auto chosen = analysis::chosen_analyses(study, only_);
  try {
    std::unique_ptr<const analysis::PreparedStudy> prepared;
    {
      const StopScope scope(stop);
      prepared = analysis::prepare(study_.description, overrides, std::move(chosen));
      note_outline(*prepared);
    }
    if (checks_only_) return;
    analysis::require_memory(*prepared, true);
    run(*prepared, stop);
  } catch (const Stopped&) {  // before anything was computed: there are no results
  }
}

void Run::note_outline(const analysis::PreparedStudy& prepared) {
  outline_.title = prepared.description->title;
  outline_.summary = prepared.kind->summary();
  auto findings = analysis::findings_of(prepared);
  outline_.facts = std::move(findings.facts);
  for (const auto& doubt : findings.doubts) outline_.doubts.push_back(text_of(doubt));
  outline_.parameters = prepared.parameters;
  for (std::size_t i = 0; i < prepared.analyses.size(); ++i)
    outline_.analyses.push_back(
        {prepared.analyses[i].name, prepared.planned[i].outline.summary, prepared.planned[i].outline.warnings});
}

void Run::run(const analysis::PreparedStudy& prepared, const std::atomic<bool>& stop) {
  std::vector<std::string> names;
  for (const auto& analysis : prepared.analyses) names.push_back(analysis.name);
  sink_ = std::make_unique<results::MemorySink>(names);
  analysis::RunSetup setup{*sink_, stop, jobs_,
                           [this](std::size_t, bool) { return std::make_unique<Listener>(*this); }};
  setup.tell = [&](std::size_t i, const analysis::RunReport& report, bool) {
    const std::lock_guard lock(mutex_);
    for (const std::string& warning : report.warnings) warnings_.emplace_back(names[i], warning);
  };
  (void)analysis::note_unfinished(prepared, analysis::run_analyses(prepared, setup), *sink_);
}

const std::vector<results::MemoryAnalysis>& Run::analyses() const {
  static const std::vector<results::MemoryAnalysis> none;
  return sink_ ? sink_->analyses() : none;
}

std::vector<Progress> Run::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace rubato::python
