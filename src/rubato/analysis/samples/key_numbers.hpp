#pragma once

#include <rubato/analysis/samples/sample_sink.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/description.hpp>

#include <map>
#include <string>
#include <vector>

namespace rubato::analysis {

/// The numbers that a sample of a sweep is told by: blocks as those of a table, and their values one after another.
struct KeyNumbers {
  std::vector<results::Block> blocks;
  std::vector<double> values;

  void add(const results::Block& block, std::span<const double> of_block);
};

/// What the sample of an analysis has to keep.
/// @param all  the main table whole, besides its key numbers
std::map<std::string, Kept> kept_for_key_numbers(const model::AnalysisDescription& sample, bool all);

/// The key numbers of what the analysis of a sample has written.
///
/// Static: its row. Modes: `frequency` and `damping_ratio` of each (`mode1`, or `free.mode1` and `stuck.mode1`).
/// Transient: of every column the least and the largest value at its accepted steps with their times, and the last one;
/// the last value of each account of energy; of every part that changes how often it does, and when first.
/// @param kind  of the sample
KeyNumbers key_numbers_of(const model::AnalysisDescription& sample, const SampleSink& tables,
                          const integrate::SystemKind& kind);

}  // namespace rubato::analysis
