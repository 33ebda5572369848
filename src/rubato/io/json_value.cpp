#include <rubato/io/json_value.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rubato::io {

Json Json::text(const std::string& value) {
  std::string written = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') written += '\\';
    if (c == '\n')
      written += "\\n";
    else
      written += c;
  }
  return Json(written + '"');
}

Json Json::object(std::vector<std::pair<std::string, Json>> members) {
  Json object("");
  object.kind_ = Kind::object;
  for (auto& [name, value] : members) object.set(name, std::move(value));
  return object;
}

Json Json::array(std::vector<Json> entries) {
  Json array("");
  array.kind_ = Kind::array;
  array.values_ = std::move(entries);
  return array;
}

Json Json::texts(const std::vector<std::string>& values) {
  Json array = Json::array();
  for (const std::string& value : values) array.add(text(value));
  return array;
}

Json& Json::set(const std::string& name, Json value) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) {
    values_[static_cast<std::size_t>(found - names_.begin())] = std::move(value);
  } else {
    names_.push_back(name);
    values_.push_back(std::move(value));
  }
  return *this;
}

Json& Json::add(Json entry) {
  values_.push_back(std::move(entry));
  return *this;
}

bool Json::has(const std::string& name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

std::string Json::written(int indent) const {
  constexpr std::size_t longest_line = 100;
  if (kind_ == Kind::scalar) return scalar_;
  const char open = kind_ == Kind::object ? '{' : '[', close = kind_ == Kind::object ? '}' : ']';
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < values_.size(); ++i)
    entries.push_back((kind_ == Kind::object ? text(names_[i]).scalar_ + ": " : std::string()) +
                      values_[i].written(indent + 2));
  const std::string line = fmt::format("{}{}{}", open, fmt::join(entries, ", "), close);
  if (line.size() <= longest_line && line.find('\n') == std::string::npos) return line;
  const std::string blanks(static_cast<std::size_t>(indent) + 2, ' ');
  return fmt::format("{}\n{}{}\n{}{}", open, blanks, fmt::join(entries, ",\n" + blanks),
                     std::string(static_cast<std::size_t>(indent), ' '), close);
}

}  // namespace rubato::io
