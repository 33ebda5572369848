#include "progress_bar.hpp"

#include "messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rubato::app {
namespace {

std::string duration(double seconds) {
  if (seconds < 59.5) return fmt::format("{:.0f} s", seconds);
  if (!(seconds < 1e9)) return "very long";
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string rate(double per_second, const std::string& unit) {
  if (per_second >= 1e6) return fmt::format("{:.1f} million {}/s", per_second / 1e6, unit);
  if (per_second < 1000.0) return fmt::format("{:.3g} {}/s", per_second, unit);
  return fmt::format("{:.0f} {}/s", per_second, unit);
}

}  // namespace

ProgressBar::ProgressBar(bool quiet, bool has_neighbours)
    : quiet_(quiet), is_bar_(!has_neighbours && isatty(STDERR_FILENO) != 0) {}

void ProgressBar::begin(const std::string& what, double total, const std::string& unit) {
  what_ = what;
  unit_ = unit;
  total_ = total;
  done_ = 0.0;
  start_ = last_ = Clock::now();
}

void ProgressBar::advance(double done) {
  done_ = done;
  if (quiet_) return;
  const auto now = Clock::now();
  if (now - last_ < (is_bar_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000))) return;
  last_ = now;
  draw(false);
}

void ProgressBar::end() {
  if (!quiet_) draw(true);
}

void ProgressBar::draw(bool is_last) {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  const double share = total_ > 0.0 ? std::min(done_ / total_, 1.0) : 1.0;
  const double speed = seconds > 0.0 ? done_ / seconds : 0.0;
  std::string line = fmt::format("{}: {:.10g} of {:.10g} {} ({:.0f} %)", what_, done_, total_, unit_, 100.0 * share);
  if (seconds > 0.05) line += ", " + rate(speed, unit_);
  line += is_last ? ", " + duration(seconds) : speed > 0.0 ? ", " + duration((total_ - done_) / speed) + " left" : "";
  if (!is_bar_) {
    tell(line);
    return;
  }
  const int filled = static_cast<int>(share * 24.0);
  const std::string bar =
      std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(24 - filled), '.');
  std::fputs(fmt::format("\r\033[K[{}] {}{}", bar, line, is_last ? "\n" : "").c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace rubato::app
