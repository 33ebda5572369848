#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace rubato::python {

/// Work in a thread of its own, so that Python's thread stays free to hear of Ctrl-C. The work must not touch Python.
class Task {
 public:
  explicit Task(std::function<void(const std::atomic<bool>& stop)> work)
      : thread_([this, work = std::move(work)] { run(work); }) {}
  /// Asks the work to stop, and waits for that.
  ~Task() { stop(); }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  void stop() { stop_.store(true); }
  /// Returns as soon as the work is over, at the latest after `seconds`. Whether it is over.
  bool wait(double seconds) {
    std::unique_lock lock(mutex_);
    return over_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return is_over_; });
  }
  /// Throws what ended the work, which must be over.
  void require_success() {
    const std::lock_guard lock(mutex_);
    if (fault_) std::rethrow_exception(fault_);
  }

 private:
  void run(const std::function<void(const std::atomic<bool>&)>& work) {
    std::exception_ptr fault;
    try {
      work(stop_);
    } catch (...) {
      fault = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    fault_ = fault;
    is_over_ = true;
    over_.notify_all();
  }

  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::exception_ptr fault_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace rubato::python
