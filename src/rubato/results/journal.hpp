#pragma once

#include <span>
#include <vector>

namespace rubato::results {

/// Remembers the finished pieces of a long analysis, so that an interrupted one resumes where it stopped. Pieces are
/// numbered from 0; what a piece holds is the analysis's business.
class Journal {
 public:
  virtual ~Journal() = default;
  /// How many pieces, 0, 1, ... without a gap, are finished.
  virtual long finished() const = 0;
  /// The values of a finished piece; to be asked for in rising order.
  virtual std::vector<double> read(long piece) = 0;
  /// Keeps the values of the next piece. Throws OutputError.
  virtual void keep(std::span<const double> values) = 0;
};

}  // namespace rubato::results
