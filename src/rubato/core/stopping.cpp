#include <rubato/core/stopping_aside.hpp>

namespace rubato {
namespace {

thread_local const std::atomic<bool>* current = nullptr;

}  // namespace

StopScope::StopScope(const std::atomic<bool>& flag) noexcept : outer_(current) { current = &flag; }

StopScope::~StopScope() { current = outer_; }

void stop_if_asked() {
  if (current && current->load(std::memory_order_relaxed)) throw Stopped();
}

bool can_be_stopped() { return current != nullptr; }

}  // namespace rubato
