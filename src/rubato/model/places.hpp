#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/model.hpp>

#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

// Private to the model floor.
namespace rubato::model {

/// The coordinates of a model that is being built, by their names, with messages that name the part that asks.
class Places {
 public:
  /// @param model  whose coordinates are named; it must live on
  Places(Model& model, const numerics::Parameters& parameters, bool has_finite_elements)
      : model_(model), parameters_(parameters), has_finite_elements_(has_finite_elements) {}

  /// A new coordinate at the end of those of the model. Throws InvalidInput for a name that does not serve.
  void add(const std::string& name, const Location& where);
  /// A place that has a name already, or whose name needs no check. False where the name is taken.
  bool add_name(const std::string& name, Index place) { return places_.emplace(name, place).second; }
  /// Names of what a support holds.
  template <class Names>
  void hold(const Names& names) {
    held_.insert(names.begin(), names.end());
  }

  /// Names of what has no place and need not stand still either. @param doubt  what may be the case
  void doubt(const std::vector<std::string>& names, const std::string& doubt) {
    doubtful_.insert(names.begin(), names.end());
    doubt_ = doubt;
  }

  bool has(const std::string& name) const { return places_.count(name) > 0; }
  bool stands(const std::string& name) const { return name == "ground" || held_.count(name) > 0; }
  /// Throws InvalidInput for the ground, for what a support holds, and for a name that is no coordinate.
  /// @param role  "slider \"contact1\" joins"
  Index find(const std::string& name, const Location& where, const std::string& role) const;
  /// As find(), but ground of what stands.
  Index end_of(const std::string& name, const Location& where, const std::string& role) const {
    return stands(name) ? ground : find(name, where, role);
  }
  /// The two ends of a part. Throws InvalidInput where nothing lies between them.
  /// @param part  "slider \"contact1\""
  void join(const Between& names, const std::array<Location, 2>& where, const std::string& part, Index& first,
            Index& second) const;
  /// Writes the values of { name = value, ... } into `out` [n]. Throws InvalidInput for a name that is twice there.
  void take(const std::vector<std::pair<std::string, Quantity>>& values, const std::string& key, Vector& out) const;

 private:
  void refuse_missing_axis(const std::string& name, const Location& where, const std::string& role) const;
  std::string rows_of(const std::string& node) const;
  bool is_rotation_at(Index place) const {
    return !model_.is_rotation.empty() && model_.is_rotation[static_cast<std::size_t>(place)];
  }

  Model& model_;
  const numerics::Parameters& parameters_;
  bool has_finite_elements_;
  std::unordered_map<std::string, Index> places_;
  std::unordered_set<std::string> held_, doubtful_;
  std::string doubt_;
};

}  // namespace rubato::model
