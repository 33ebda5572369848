#pragma once

#include <rubato/core/error.hpp>

#include <fmt/format.h>

#include <string>
#include <unordered_map>
#include <vector>

// Private to the model floor.
namespace rubato::model {

/// Values by name, with messages about names that are missing or doubled.
template <class Value>
class ByName {
 public:
  explicit ByName(std::string kind) : kind_(std::move(kind)) {}

  void add(const std::string& name, const Location& where, Value value) {
    if (name.empty()) throw InvalidInput(where, fmt::format("a {} needs a name", kind_));
    if (!places_.emplace(name, values_.size()).second)
      throw InvalidInput(where, fmt::format("two {}s are called \"{}\"", kind_, name));
    names_.push_back(name);
    values_.push_back(std::move(value));
  }
  std::size_t place(const std::string& name, const Location& where, const std::string& role) const {
    const auto found = places_.find(name);
    if (found != places_.end()) return found->second;
    throw InvalidInput(where, fmt::format("{} \"{}\", which is no {}{}", role, name, kind_, suggestion(name, names_)));
  }
  bool has(const std::string& name) const { return places_.count(name) > 0; }
  const Value& at(std::size_t place) const { return values_[place]; }

 private:
  std::string kind_;
  std::vector<std::string> names_;
  std::vector<Value> values_;
  std::unordered_map<std::string, std::size_t> places_;
};

}  // namespace rubato::model
