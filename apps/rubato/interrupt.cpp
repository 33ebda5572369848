#include "interrupt.hpp"

#include <csignal>

namespace rubato::app {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

std::atomic<bool> was_asked{false};

void raise_flag(int signal) {
  stop.store(true);
  if (!was_asked.exchange(true)) return;
  std::signal(signal, SIG_DFL);  // its default action comes once this handler has returned
  std::raise(signal);
}

// Terminals and supervisors send this one beside another, in either order, or twice: it is neither a first nor a second
// request to end at once.
void raise_flag_by_hangup(int) { stop.store(true); }

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
  // Calls that a signal meets (a write) go on.
  on(SIGINT, raise_flag, SA_RESTART);
  on(SIGTERM, raise_flag, SA_RESTART);
  if (!is_ignored(SIGHUP)) on(SIGHUP, raise_flag_by_hangup, SA_RESTART);  // nohup ignores it
  on(SIGXFSZ, SIG_IGN, 0);
  on(SIGPIPE, SIG_IGN, 0);
  return stop;
}

}  // namespace rubato::app
