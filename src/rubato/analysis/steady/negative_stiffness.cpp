#include <rubato/analysis/steady/negative_stiffness.hpp>
#include <rubato/numerics/definiteness.hpp>

#include <fmt/format.h>

namespace rubato::analysis {

void NegativeStiffness::look_at(SparseMatrix stiffness, const std::string& where) {
  if (!where_.empty()) return;
  if (stiffness.rows() == last_.rows() && (stiffness - last_).norm() == 0.0) return;
  if (numerics::is_indefinite(stiffness)) where_ = where;
  last_ = std::move(stiffness);
}

std::string NegativeStiffness::warning() const {
  if (where_.empty()) return {};
  return fmt::format(
      "at {} the stiffness at rest, with all sliders stuck, is negative along some motion, which grows (type = "
      "\"modes\" tells how fast): a response about that rest may be told that does not last; see where a transient "
      "goes",
      where_);
}

}  // namespace rubato::analysis
