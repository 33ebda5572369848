#pragma once

#include <rubato/analysis/samples/campbell.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/analysis/sweep.hpp>
#include <rubato/model/description.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

struct PlannedAnalysis;

/// Plans an analysis at some values of the parameters. Throws InvalidInput.
using SamplePlanner = std::function<PlannedAnalysis(const model::AnalysisDescription&, const StudyInput&)>;

/// An analysis that is repeated over samples of parameters: what the description says, evaluated and found possible.
struct SamplesPlan {
  model::AnalysisDescription sample;  ///< without its sweep
  Sweep sweep;
  bool keeps_samples = false;  ///< the main table of each
  std::optional<CampbellPlan> campbell = {};
  std::vector<std::string> warnings = {};  ///< before anything is computed
  std::string summary = {};                ///< "21 samples over speed: modes, the lowest 6 of the model"
  double bytes_of_one = 0.0;               ///< that a sample writes, roughly
};

/// The sweep that an analysis is repeated over; null where it is not, or has a sweep of its own.
const model::SweptDescription* swept_of(const model::AnalysisDescription& analysis);

/// Refuses modes about the state to which a transient leads where that transient is repeated over parameters that the
/// modes are not: which of its samples is meant is not said. Throws InvalidInput.
void refuse_ambiguous_state(const model::AnalysisDescription& analysis,
                            const std::vector<model::AnalysisDescription>& analyses);

/// Evaluates the sweep, checks that its parameters do something, and plans the first and the last sample, one of which
/// must be possible. Throws InvalidInput.
SamplesPlan plan_samples(const model::AnalysisDescription& analysis, const StudyInput& input,
                         const SamplePlanner& plan_one);

/// The model at one sample of a sweep; keeps everything alive that its analysis looks at.
class SampleModel {
 public:
  /// Throws InvalidInput for a model that cannot be.
  SampleModel(const Sweep& sweep, long number, const StudyInput& input);
  SampleModel(const SampleModel&) = delete;
  SampleModel& operator=(const SampleModel&) = delete;

  StudyInput input() const { return {study_, overrides_, parameters_, *kind_}; }

 private:
  const model::StudyDescription& study_;
  numerics::Parameters overrides_, parameters_;
  std::unique_ptr<const integrate::SystemKind> kind_;
};

/// "N0 = 10, k = 2"
std::string place_text(const Sweep& sweep, long number);

}  // namespace rubato::analysis
