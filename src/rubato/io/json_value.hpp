#pragma once

#include <string>
#include <utility>
#include <vector>

// Private to io.
namespace rubato::io {

/// A value of JSON on its way to a text: objects keep the order in which their members were set.
class Json {
 public:
  static Json text(const std::string& value);
  static Json number(long value) { return Json(std::to_string(value)); }
  static Json boolean(bool value) { return Json(value ? "true" : "false"); }
  /// A text that is JSON already.
  static Json raw(std::string value) { return Json(std::move(value)); }
  static Json object(std::vector<std::pair<std::string, Json>> members = {});
  static Json array(std::vector<Json> entries = {});
  static Json texts(const std::vector<std::string>& values);

  /// Adds a member, or replaces the one of this name.
  Json& set(const std::string& name, Json value);
  Json& add(Json entry);
  bool has(const std::string& name) const;
  bool is_empty() const { return names_.empty() && values_.empty(); }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<Json>& values() const { return values_; }

  /// Pretty, each level indented by two blanks; what is short stands on one line.
  std::string written(int indent = 0) const;

 private:
  enum class Kind { scalar, object, array };
  explicit Json(std::string scalar) : scalar_(std::move(scalar)) {}

  Kind kind_ = Kind::scalar;
  std::string scalar_;
  std::vector<std::string> names_;  ///< of the members of an object
  std::vector<Json> values_;        ///< members or entries
};

}  // namespace rubato::io
