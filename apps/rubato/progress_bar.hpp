#pragma once

#include <rubato/analysis/run_context.hpp>

#include <chrono>
#include <string>

namespace rubato::app {

/// On a terminal a bar with rate and time left, redrawn ten times a second; elsewhere, and where several analyses run
/// at a time, a plain line every ten seconds, and one at the end. Everything goes to stderr.
class ProgressBar final : public analysis::Progress {
 public:
  ProgressBar(bool quiet, bool has_neighbours);

  void begin(const std::string& what, double total, const std::string& unit) override;
  void advance(double done) override;
  void end() override;

 private:
  using Clock = std::chrono::steady_clock;
  void draw(bool is_last);

  bool quiet_, is_bar_;
  std::string what_, unit_;
  double total_ = 0.0, done_ = 0.0;
  Clock::time_point start_, last_;
};

}  // namespace rubato::app
