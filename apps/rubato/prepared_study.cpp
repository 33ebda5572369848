#include "prepared_study.hpp"

#include <rubato/io/read_study.hpp>

#include <fmt/format.h>

#include <utility>

namespace rubato::app {
namespace {

numerics::Parameters overrides_of(const std::vector<std::string>& settings) {
  numerics::Parameters values;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InvalidInput(fmt::format("--set {}: write PARAM=VALUE, such as --set N0=25", setting));
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    try {
      values.emplace_back(name, numerics::Formula(text, {})());
    } catch (const InvalidInput& fault) {
      throw InvalidInput(fmt::format("--set {}: {}", setting, fault.message()));
    }
  }
  return values;
}

}  // namespace

CommandStudy prepare(const StudyOptions& options) {
  const numerics::Parameters overrides = overrides_of(options.set);
  CommandStudy study;
  const auto description = std::make_shared<const model::StudyDescription>(io::read_study(options.study, &study.files));
  study.prepared =
      analysis::prepare(description, overrides, analysis::chosen_analyses(*description, options.only, "--only "));
  return study;
}

}  // namespace rubato::app
