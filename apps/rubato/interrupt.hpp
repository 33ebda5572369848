#pragma once

#include <atomic>

namespace rubato::app {

/// A flag that the first Ctrl-C (or SIGTERM) raises, so that analyses stop at the next accepted step and keep what they
/// have; the second ends the process. SIGXFSZ is ignored: a file that may not grow is an error of its write.
const std::atomic<bool>& stop_on_interrupt();

}  // namespace rubato::app
