#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace rubato::app {

/// Looks several times a second whether the folder of results is still there, and asks the analyses to stop when it is
/// not: what they write then goes nowhere.
class FolderWatch {
 public:
  /// @param loss  says what has become of the folder; empty where all is well. Called from a thread of the watch's own.
  explicit FolderWatch(std::function<std::string()> loss);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// What has become of the folder, as of now; empty where all is well.
  std::string loss();

 private:
  void look();

  std::function<std::string()> ask_;
  std::mutex mutex_;
  std::condition_variable_any wakes_;
  std::string loss_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace rubato::app
