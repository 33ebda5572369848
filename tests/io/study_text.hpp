#pragma once

#include <rubato/analysis/run_study.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

// Studies as text and what is said of them.
namespace rubato::testing {

/// Two masses, a slider and a force: right in all respects. The tests count lines and columns in it.
inline const std::string study_text =
    "title = \"A blade\"\n"                // 1
    "\n"                                   // 2
    "[parameters]\n"                       // 3
    "N0 = 10.0\n"                          // 4
    "\n"                                   // 5
    "[[coordinate]]\n"                     // 6
    "name = \"disk\"\n"                    // 7
    "mass = 10.0\n"                        // 8
    "\n"                                   // 9
    "[[coordinate]]\n"                     // 10
    "name = \"blade\"\n"                   // 11
    "mass = 1.0\n"                         // 12
    "\n"                                   // 13
    "[[spring]]\n"                         // 14
    "between = [\"disk\", \"ground\"]\n"   // 15
    "stiffness = 100.0\n"                  // 16
    "\n"                                   // 17
    "[[spring]]\n"                         // 18
    "between = [\"disk\", \"blade\"]\n"    // 19
    "stiffness = 50.0\n"                   // 20
    "\n"                                   // 21
    "[damping]\n"                          // 22
    "modal_ratio = 0.02\n"                 // 23
    "\n"                                   // 24
    "[[slider]]\n"                         // 25
    "name = \"contact\"\n"                 // 26
    "between = [\"blade\", \"ground\"]\n"  // 27
    "stiffness = 10.0\n"                   // 28
    "friction_coefficient = 0.5\n"         // 29
    "normal_load = \"N0\"\n"               // 30
    "\n"                                   // 31
    "[[force]]\n"                          // 32
    "on = \"blade\"\n"                     // 33
    "amplitude = 20.0\n"                   // 34
    "angular_frequency = 7.0\n"            // 35
    "\n"                                   // 36
    "[[analysis]]\n"                       // 37
    "name = \"response\"\n"                // 38
    "type = \"transient\"\n"               // 39
    "step = 0.005\n"                       // 40
    "duration = 60.0\n";                   // 41

/// The study with the first `from` replaced by `to`.
inline std::string edited(const std::string& from, const std::string& to, std::string text = study_text) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("the study holds no " + from);
  return text.replace(place, from.size(), to);
}

/// What is said of a study called study.toml when it is read, built, assembled and checked; "accepted" if nothing.
inline std::string verdict(const std::string& text, const std::filesystem::path& folder = ".") {
  try {
    const auto study = io::read_study_text(text, "study.toml", folder);
    const auto parameters = model::evaluate_parameters(study.parameters);
    const auto system = system::assemble(model::build(study.model, parameters));
    for (const auto& analysis : study.analyses)
      (void)analysis::check_analysis(analysis, {study, {}, parameters, integrate::StructureKind(system)});
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

inline std::string verdict_with(const std::string& from, const std::string& to) { return verdict(edited(from, to)); }

/// A folder of its own for the files of a test, removed at the end.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("rubato-" + name + "-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace rubato::testing
