#pragma once

#include <rubato/core/error.hpp>

#include <span>
#include <vector>

namespace rubato::analysis {

/// Reads what was packed into one list of numbers for the journal. Throws InvalidInput where the list holds something
/// else, as one that another build of the program has left.
class PackedNumbers {
 public:
  explicit PackedNumbers(std::span<const double> values) : values_(values) {}

  double next() {
    if (at_ == values_.size()) refuse();
    return values_[at_++];
  }
  void expect(double value) {
    if (next() != value) refuse();
  }
  /// Numbers behind their count, which is a multiple of `width`.
  std::vector<double> rows(std::size_t width) {
    const double count = next();
    if (!(count >= 0.0 && count <= static_cast<double>(values_.size() - at_))) refuse();
    const auto size = static_cast<std::size_t>(count);
    if (static_cast<double>(size) != count || (size > 0 && (width == 0 || size % width != 0))) refuse();
    const auto part = values_.subspan(at_, size);
    at_ += size;
    return {part.begin(), part.end()};
  }
  void expect_end() const {
    if (at_ != values_.size()) refuse();
  }
  [[noreturn]] static void refuse() {
    throw InvalidInput("--resume: the journal holds pieces of another kind; run without --resume to begin afresh");
  }

 private:
  std::span<const double> values_;
  std::size_t at_ = 0;
};

}  // namespace rubato::analysis
