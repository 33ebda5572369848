#include "interrupt.hpp"

#include <csignal>

namespace rubato::app {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void raise_flag(int) { stop.store(true); }

void on(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void request_stop() { stop.store(true); }

const std::atomic<bool>& stop_on_interrupt() {
  // The default action comes back with the first signal; calls that it meets (a write) go on.
  constexpr int once = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  on(SIGINT, raise_flag, once);
  on(SIGTERM, raise_flag, once);
  if (!is_ignored(SIGHUP)) on(SIGHUP, raise_flag, once);  // nohup ignores it
  on(SIGXFSZ, SIG_IGN, 0);
  on(SIGPIPE, SIG_IGN, 0);
  return stop;
}

}  // namespace rubato::app
