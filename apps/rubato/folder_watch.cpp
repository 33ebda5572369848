#include "folder_watch.hpp"

#include "interrupt.hpp"

#include <chrono>
#include <utility>

namespace rubato::app {

FolderWatch::FolderWatch(std::function<std::string()> loss) : ask_(std::move(loss)) {
  thread_ = std::jthread([this](const std::stop_token& ends) {
    std::unique_lock lock(mutex_);
    while (!ends.stop_requested() && loss_.empty()) {
      wakes_.wait_for(lock, ends, std::chrono::milliseconds(300), [] { return false; });
      if (!ends.stop_requested()) look();
    }
  });
}

FolderWatch::~FolderWatch() = default;

std::string FolderWatch::loss() {
  const std::lock_guard lock(mutex_);
  look();
  return loss_;
}

void FolderWatch::look() {
  if (!loss_.empty()) return;
  loss_ = ask_();
  if (!loss_.empty()) request_stop();
}

}  // namespace rubato::app
