#pragma once

#include <rubato/core/stopping.hpp>

#include <chrono>
#include <future>
#include <thread>
#include <utility>

namespace rubato {

/// Whether this thread has a StopScope.
bool can_be_stopped();

/// Runs work of a library that takes long and cannot be asked to stop (a dense eigenproblem). Within a StopScope it
/// runs in a thread of its own, which is left behind where the scope's flag is raised: it ends with its work, or with
/// the process, and nobody hears of it. So `work` must own all that it touches.
template <typename Work>
auto stoppable_aside(Work work) {
  if (!can_be_stopped()) return work();
  stop_if_asked();
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) stop_if_asked();
  return result.get();
}

}  // namespace rubato
