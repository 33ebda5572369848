#pragma once

#include <atomic>

namespace rubato::app {

/// A flag that the first Ctrl-C (or SIGTERM, or the end of the terminal) raises, so that analyses stop at the next
/// accepted step or iteration and keep what they have; a second Ctrl-C or SIGTERM ends the process.
///
/// A file that may not grow is then an error of its write, and whoever stops reading the messages stops no run: SIGXFSZ
/// and SIGPIPE are ignored.
const std::atomic<bool>& stop_on_interrupt();

/// Raises the flag as the first of those signals does.
void request_stop();

}  // namespace rubato::app
