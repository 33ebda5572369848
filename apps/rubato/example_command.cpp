#include "commands.hpp"

#include <rubato/core/error.hpp>
#include <rubato/io/read_study.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::app {
namespace {

namespace fs = std::filesystem;

/// Beside the installed command (../share/rubato/examples), else where the source was built.
fs::path examples_folder() {
  std::error_code fault;
  const fs::path self = fs::read_symlink("/proc/self/exe", fault);
  const fs::path installed = self.parent_path().parent_path() / "share" / "rubato" / "examples";
  for (const fs::path& folder : {installed, fs::path(RUBATO_EXAMPLES)})
    if (fs::is_directory(folder, fault)) return folder;
  throw InvalidInput(
      fmt::format("the examples are neither in {} nor in {}; reinstall Rubato", installed.string(), RUBATO_EXAMPLES));
}

std::vector<std::string> names(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (fs::exists(entry.path() / "study.toml")) found.push_back(entry.path().filename().string());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

int list_examples() {
  const fs::path folder = examples_folder();
  for (const std::string& name : names(folder))
    fmt::print("{:<24}{}\n", name, io::read_study(folder / name / "study.toml").title);
  fmt::print("\n`rubato example NAME` copies one here; run it with `rubato run NAME/study.toml`.\n");
  return exit_done;
}

int copy_example(const std::string& name, const fs::path& folder) {
  const fs::path source = examples_folder();
  const auto known = names(source);
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw InvalidInput(fmt::format("no example is called \"{}\"{}", name, suggestion(name, known)));
  const fs::path target = folder.empty() ? fs::path(name) : folder;
  if (fs::exists(target))
    throw InvalidInput(
        fmt::format("{} exists already; name another folder: rubato example {} DIR", target.string(), name));
  std::error_code fault;
  fs::create_directories(target, fault);
  for (const auto& entry : fs::directory_iterator(source / name))
    if (!fault && entry.is_regular_file()) fs::copy(entry.path(), target / entry.path().filename(), fault);
  if (fault) throw InvalidInput(fmt::format("{}: the example cannot be copied: {}", target.string(), fault.message()));
  fmt::print("{}\n", (target / "study.toml").string());
  return exit_done;
}

}  // namespace rubato::app
