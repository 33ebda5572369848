#pragma once

#include <rubato/report/table_source.hpp>

#include <string>
#include <vector>

namespace rubato::report {

/// The largest reaction of a joint, or of its lock: norms over its components at the same time. NaN where it has none.
struct LargestReaction {
  std::string joint;
  bool is_of_lock = false;
  double force = 0.0, force_time = 0.0;    ///< [N], [s]
  double moment = 0.0, moment_time = 0.0;  ///< [N m], [s]
};

/// Of a table over time with variables `reaction_x`, `reaction_moment` and so on: of all joints over all rows, those of
/// the largest forces first, then those of the largest moments.
std::vector<LargestReaction> largest_reactions(const TableSource& table);

/// {"count", "joints": [{"name", "is_of_lock", "force", "force_time", "moment", "moment_time"}, ...]}: of `count` the
/// first so many. "null" for a table without reactions.
std::string reactions_json(const TableSource& table, std::size_t most = 12);

}  // namespace rubato::report
