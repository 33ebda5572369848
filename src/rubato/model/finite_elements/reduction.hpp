#pragma once

#include <rubato/core/error.hpp>
#include <rubato/core/types.hpp>
#include <rubato/model/quantity.hpp>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Component mode synthesis: a finite element model by the degrees of freedom that a study names, which stay as they
// are, and a few modes of the rest.
namespace rubato::model {

enum class ReductionMethod {
  craig_bampton,  ///< modes with the interface held (Craig and Bampton, AIAA J. 6 (1968) 1313)
  rubin,          ///< free modes, with the statics of the interface (Rubin, AIAA J. 13 (1975) 995)
  none            ///< all degrees of freedom
};

/// How far a frequency of the reduced model lies from that of the unreduced one.
struct FrequencyEstimate {
  double frequency = 0.0;  ///< of the reduced model [Hz]
  double error = 0.0;      ///< estimated, over the frequency [-]; infinite where the modes kept do not reach it
};

/// What a reduction made.
struct ReductionReport {
  ReductionMethod method = ReductionMethod::craig_bampton;
  Index before = 0;     ///< coordinates of the model that was reduced
  Index interface = 0;  ///< those that stayed as they are
  Index modes = 0;      ///< kept beside them
  Index statics = 0;    ///< of these, shapes under the inertia of even accelerations instead of modes
  double next = 0.0;    ///< frequency of the first mode with the interface held that was left out [Hz]; 0: none was
  std::vector<FrequencyEstimate> free;   ///< the lowest frequencies, without sliders
  std::vector<FrequencyEstimate> stuck;  ///< with sliders as springs; empty where there are none

  double worst() const;  ///< of the estimates [-]
};

struct FullMatrices;

/// What was made of a model, for all that build it again with other values of parameters. The number of modes is that
/// of the first that asked. Threads may share it.
struct ReductionStore {
  std::mutex mutex;
  std::optional<Index> modes;  ///< chosen
  Vector key;                  ///< what the matrices below were made of
  std::shared_ptr<const FullMatrices> matrices;
  std::optional<ReductionReport> report;  ///< of the first
};

/// [reduction]
struct ReductionDescription {
  ReductionMethod method = ReductionMethod::craig_bampton;
  std::optional<long> modes;      ///< how many; none: as the error says
  std::optional<Quantity> error;  ///< of the frequencies wanted [-]
  long frequencies = 6;           ///< which the error is of: the lowest so many, without sliders and with stuck ones
  std::vector<std::string> keep;  ///< nodes, node sets and degrees of freedom that stay, besides those of parts
  std::vector<Location> keep_where;
  std::vector<std::string> observed;  ///< names in `observe` of analyses, which stay where the model has them
  Location where, modes_where;
  std::shared_ptr<ReductionStore> store = std::make_shared<ReductionStore>();
};

/// What a reduction made, for people: sizes, modes, and the estimates; nothing before a model was built.
std::vector<std::string> facts_of(const ReductionDescription& description);
/// What of it is hardly meant: frequencies with a large error; or empty.
std::string doubt_of(const ReductionDescription& description);
/// What an analysis asks beyond the frequencies whose errors were estimated: a warning with the remedy; or empty.
/// @param highest  frequency that it drives or shows [Hz]
std::string beyond_estimates(const ReductionDescription& description, double highest);
/// The same of the lowest so many modes.
std::string modes_beyond_estimates(const ReductionDescription& description, Index count);

}  // namespace rubato::model
