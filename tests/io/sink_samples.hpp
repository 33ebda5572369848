#pragma once

#include <rubato/results/sink.hpp>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace rubato::io::testing {

/// A folder of its own for a test, removed after it.
class SinkTest : public ::testing::Test {
 protected:
  SinkTest() {
    std::string name = (std::filesystem::temp_directory_path() / "rubato-sink-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~SinkTest() override { std::filesystem::remove_all(folder_); }

  std::string text(const std::string& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    std::ostringstream all;
    all << stream.rdbuf();
    return all.str();
  }

  std::filesystem::path folder_;
};

/// While it lives no file may grow beyond `bytes`, and a write that would is an error (EFBIG) as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

/// Two coordinates and a slider, as a transient lays them out.
inline results::TableLayout transient_layout() {
  const std::vector<std::string> coordinates{"disk", "blade, left"}, sliders{"contact"};
  return {"response",
          "",
          "time",
          {{"time", "s", "time", "", {}},
           {"position", "m", "displacement", "coordinate", coordinates},
           {"velocity", "m/s", "velocity", "coordinate", coordinates},
           {"force", "N", "slider force", "slider", sliders}},
          {{"method", "newmark"}}};
}

/// A table with words and a quantity without unit.
inline results::TableLayout word_layout() {
  return {"study",
          "orders",
          "method",
          {{"method", "1", "the method", "", {}, {"heun", "rk 4"}},
           {"ratio", "1", "error over bound", "", {}},
           {"status", "", "what became of it", "", {}, {"done", "not, \"yet\""}}},
          {}};
}

}  // namespace rubato::io::testing
