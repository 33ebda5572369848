#pragma once

#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <fmt/format.h>

#include <string>
#include <vector>

namespace rubato::model {

/// The numbers of a law by the keys of its kind, for the function that makes it.
class LawValues {
 public:
  /// Throws InvalidInput where a formula is faulty or a value is not finite.
  LawValues(const LawDescription& description, const numerics::Parameters& parameters, std::string part)
      : description_(description), part_(std::move(part)) {
    const auto& keys = law_kind(description.kind).keys;
    for (std::size_t i = 0; i < keys.size(); ++i)
      values_.push_back(evaluate(description.values[i], parameters, part_ + ": " + keys[i].name));
  }

  double operator[](std::size_t key) const { return values_[key]; }

  /// Throws InvalidInput at the place of a key.
  [[noreturn]] void refuse(std::size_t key, const std::string& why) const {
    const Location& where = description_.values[key].where;
    throw InvalidInput(where.line > 0 ? where : description_.where, fmt::format("{}: {}", part_, why));
  }
  void must_be_positive(std::size_t key) const {
    if (!(values_[key] > 0.0)) refuse(key, fmt::format("{} must be positive, got {}", name(key), values_[key]));
  }
  void must_not_be_negative(std::size_t key) const {
    if (!(values_[key] >= 0.0)) refuse(key, fmt::format("{} must not be negative, got {}", name(key), values_[key]));
  }

 private:
  const char* name(std::size_t key) const { return law_kind(description_.kind).keys[key].name; }

  const LawDescription& description_;
  std::string part_;
  std::vector<double> values_;
};

}  // namespace rubato::model
