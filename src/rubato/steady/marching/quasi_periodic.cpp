#include <rubato/steady/marching/quasi_periodic.hpp>

#include <rubato/core/error.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/steady/marching/stepper_map.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int windows_alike = 3;

double change(const Vector& a, const Vector& b) {
  const double size = b.size() > 0 ? b.maxCoeff() : 0.0;
  return size == 0.0 ? 0.0 : (a - b).cwiseAbs().maxCoeff() / size;
}

/// Marches windows of equal steps, and keeps the record of the last one.
class WindowMarch {
 public:
  WindowMarch(const integrate::Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request,
              double window, int steps)
      : system_(system),
        request_(request),
        window_(window),
        steps_(steps),
        stepper_(integrate::make_stepper(method, system)),
        writer_(system, request),
        now_(integrate::consistent_start(system, system.start())),
        next_(now_) {}

  /// False if a step failed.
  bool advance() {
    record_.reset(static_cast<Index>(request_.observed.size()), system_, steps_, request_.rates, true);
    writer_.write(now_, record_, 0, false);
    const double h = window_ / steps_;
    for (int j = 0; j < steps_; ++j) {
      stop_if_asked();
      const double t1 = h * (static_cast<double>(windows_) * steps_ + j + 1);
      if (stepper_->attempt(now_, h, t1, next_).outcome != integrate::StepOutcome::accepted) return false;
      std::swap(now_, next_);
      writer_.write(now_, record_, j + 1, true);
    }
    ++windows_;
    return true;
  }

  Vector amplitudes() const { return half_peak_to_peak(record_.position, record_.velocity, window_ / steps_); }
  const PeriodRecord& record() const { return record_; }
  int windows() const { return windows_; }

 private:
  const system::LocallyNonlinear& system_;
  const SteadyRequest& request_;
  double window_;
  int steps_, windows_ = 0;
  std::unique_ptr<integrate::Stepper> stepper_;
  RecordWriter writer_;
  system::State now_, next_;
  PeriodRecord record_;
};

// Where a march with a given number of steps settles; of the last window where it does not.
SteadyResponse settle(const TimeMarchingOptions& options, const system::LocallyNonlinear& system,
                      const SteadyRequest& request, double window, int steps) {
  system::Excitation whole;  // only what a record needs to know
  whole.angular_frequency = 2.0 * std::numbers::pi / window;
  whole.limits.resize(system.slider_count());
  Vector stiffness(system.slider_count());
  for (Index i = 0; i < stiffness.size(); ++i) {
    whole.limits[i] = system.sliders()[static_cast<std::size_t>(i)].limit;
    stiffness[i] = system.sliders()[static_cast<std::size_t>(i)].stiffness;
  }
  WindowMarch march(options.method, system, request, window, steps);
  SteadyResponse response;
  response.residual = infinity;
  Vector last;
  int alike = 0;
  while (march.windows() < options.max_periods && alike < windows_alike) {
    if (!march.advance()) {
      response.residual = infinity;
      break;
    }
    const Vector now = march.amplitudes();
    if (last.size() == now.size()) response.residual = change(last, now);
    alike = last.size() == now.size() && response.residual <= options.tolerance ? alike + 1 : 0;
    last = now;
  }
  read_record(march.record(), whole, stiffness, 1, request, response);
  response.status = alike >= windows_alike ? SteadyStatus::quasi_periodic : SteadyStatus::not_converged;
  response.iterations = march.windows();
  return response;
}

// Amplitudes after so many windows, or nothing.
Vector amplitudes_after(const TimeMarchingOptions& options, const system::LocallyNonlinear& system,
                        const SteadyRequest& request, double window, int steps, int windows) {
  WindowMarch march(options.method, system, request, window, steps);
  for (int i = 0; i < windows; ++i)
    if (!march.advance()) return {};
  return march.amplitudes();
}

}  // namespace

SteadyResponse solve_quasi_periodic(const system::LocallyNonlinear& system, TimeMarchingOptions options,
                                    const SteadyRequest& request, double window) {
  check_options(options, system);
  if (!(window > 0.0) || std::isinf(window))
    throw InvalidInput(fmt::format("the window of a quasi-periodic response must be a time > 0, got {} s", window));
  double fastest = 2.0 * std::numbers::pi / window;
  for (const auto& term : system.loads().terms())
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law))
      fastest = std::max(fastest, std::abs(harmonic->angular_frequency));
  const double periods = window * fastest / (2.0 * std::numbers::pi);
  const double least = window / longest_step(options.method, system);
  const double given = options.steps_per_period * periods;
  if (given > 0.0 && given < least)
    throw InvalidInput(fmt::format("{} steps a period are too few for {}: it is stable from {} steps on",
                                   options.steps_per_period, options.method.name, std::ceil(least / periods)));
  SteadyRequest without_harmonics = request;
  without_harmonics.harmonics.clear();
  const int order = amplitude_order(options.method);
  const double most = options.max_steps * periods;
  double steps = std::max(given > 0.0 ? given : 64.0 * periods, 2.0 * least);
  for (;;) {
    const int count = 2 * static_cast<int>(std::ceil(0.5 * steps));
    SteadyResponse response = settle(options, system, without_harmonics, window, count);
    const int companion = 0.5 * count >= least ? count / 2 : 2 * count;
    const double ratio = std::pow(static_cast<double>(count) / companion, order);
    const Vector other = amplitudes_after(options, system, without_harmonics, window, companion, response.iterations);
    response.error = other.size() == response.amplitude.size()
                         ? change(other, response.amplitude) / std::abs(ratio - 1.0)
                         : std::numeric_limits<double>::quiet_NaN();
    if (given > 0.0 || response.status != SteadyStatus::quasi_periodic || response.error <= options.tolerance)
      return response;
    steps = count * std::clamp(std::pow(2.0 * response.error / options.tolerance, 1.0 / order), 1.2, 4.0);
    if (!(steps <= most)) {
      response.status = SteadyStatus::not_converged;
      return response;
    }
  }
}

}  // namespace rubato::steady
