#include "report/sample_responses.hpp"

#include "report/sample_results.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace rubato::test {
namespace {

constexpr double pi = std::numbers::pi;

results::Block column(const std::string& name, const std::string& unit, const std::string& dimension = "",
                      const std::vector<std::string>& labels = {}, const std::vector<std::string>& words = {}) {
  return {name, unit, name, dimension, labels, words};
}

/// m = k = kT = f0 = 1, c = 0.2 on a slider of limit mu N.
struct Mass {
  double limit;
  double mass = 1.0, damping = 0.2;

  /// Stiffness of the first harmonic of a Jenkins element under a sine of this amplitude, kT = 1.
  double stiffness(double amplitude) const {
    if (amplitude <= limit) return 1.0;
    const double theta = std::acos(1.0 - 2.0 * limit / amplitude);
    return (theta - 0.5 * std::sin(2.0 * theta)) / pi;
  }
  double dissipated(double amplitude) const { return 4.0 * limit * std::max(0.0, amplitude - limit); }

  std::complex<double> dynamic_stiffness(double omega, double amplitude) const {
    const double friction = amplitude > 0.0 ? dissipated(amplitude) / (pi * amplitude * amplitude) : 0.0;
    return {1.0 + stiffness(amplitude) - mass * omega * omega, damping * omega + friction};
  }
  /// The amplitude at which |D(A)| A = 1, by bisection.
  double amplitude(double omega) const {
    double low = 0.0, high = 100.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (std::abs(dynamic_stiffness(omega, middle)) * middle < 1.0 ? low : high) = middle;
    }
    return low;
  }
};

const std::vector<std::string> observed{"mass", "mass - ground"}, sliders{"pad"};
const std::vector<std::string> statuses{"converged", "not converged", "subharmonic", "quasi periodic", "unbounded"};

void add_response_blocks(results::TableLayout& layout, bool is_full) {
  layout.blocks.push_back(column("angular_frequency", "rad/s"));
  layout.blocks.push_back(column("amplitude", "m", "coordinate", observed));
  if (is_full) {
    layout.blocks.push_back(column("velocity_amplitude", "m/s", "coordinate", observed));
    layout.blocks.push_back(column("acceleration_amplitude", "m/s2", "coordinate", observed));
  }
  layout.blocks.push_back(column("phase", "rad", "coordinate", observed));
  if (is_full) layout.blocks.push_back(column("harmonic3_amplitude", "m", "coordinate", observed));
  layout.blocks.push_back(column("dissipated", "J", "slider", sliders));
  layout.blocks.push_back(column("slip_share", "1", "slider", sliders));
  layout.blocks.push_back(column("viscous_work", "J"));
  layout.blocks.push_back(column("input_work", "J"));
  layout.blocks.push_back(column("transitions", "1"));
  layout.blocks.push_back(column("residual", "1"));
  layout.blocks.push_back(column("error", "1"));
  layout.blocks.push_back(column("status", "1", "", {}, statuses));
}

/// The rest of a row behind the swept parameters.
void append_response(std::vector<double>& row, const Mass& mass, double omega, bool is_full, int status) {
  const double x = mass.amplitude(omega);
  const double phase = -std::arg(mass.dynamic_stiffness(omega, x));
  const double friction = mass.dissipated(x), viscous = pi * mass.damping * omega * x * x;
  const double slip = x > mass.limit ? 1.0 - std::acos(1.0 - 2.0 * mass.limit / x) / pi : 0.0;
  row.insert(row.end(), {omega, x, 0.8 * x});
  if (is_full) row.insert(row.end(), {omega * x, 0.8 * omega * x, omega * omega * x, 0.8 * omega * omega * x});
  row.insert(row.end(), {phase, phase});
  if (is_full) row.insert(row.end(), {0.01 * slip * x, 0.008 * slip * x});
  row.insert(row.end(), {friction, slip, viscous, viscous + friction, slip > 0.0 ? 4.0 : 0.0,
                         status == 0 ? 3e-12 : 2e-4, status == 0 ? 5e-11 : 3e-3, static_cast<double>(status)});
}

void add_linear(results::Sink& sink, const std::string& analysis) {
  results::TableLayout layout{analysis, "linear", "point", {column("angular_frequency", "rad/s")}, {}};
  for (const char* limit : {"free", "stuck"}) {
    layout.blocks.push_back(column(limit + std::string("_amplitude"), "m", "coordinate", observed));
    layout.blocks.push_back(column(limit + std::string("_phase"), "rad", "coordinate", observed));
  }
  std::vector<std::vector<double>> rows;
  for (double omega = 0.5; omega <= 2.0; omega += 0.01) {
    rows.push_back({omega});
    for (const double slider : {0.0, 1.0}) {
      const std::complex<double> x = 1.0 / std::complex<double>(1.0 + slider - omega * omega, 0.2 * omega);
      rows.back().insert(rows.back().end(), {std::abs(x), 0.8 * std::abs(x), std::arg(x), std::arg(x)});
    }
  }
  add_table(sink, layout, rows);
}

/// Displacement and force over a period of a sine through the slider.
void add_waveforms(results::Sink& sink, const std::string& analysis, const std::vector<double>& preloads) {
  results::TableLayout layout{analysis, "waveforms", "point", {column("N0", "")}, {}};
  layout.blocks.push_back(column("angular_frequency", "rad/s"));
  layout.blocks.push_back(column("time", "s"));
  layout.blocks.push_back(column("position", "m", "coordinate", observed));
  layout.blocks.push_back(column("force", "N", "slider", sliders));
  layout.blocks.push_back(column("displacement", "m", "slider", sliders));
  std::vector<std::vector<double>> rows;
  constexpr int points = 128;
  for (const double preload : preloads) {
    for (const double omega : {0.8, 1.1}) {
      const Mass mass{0.5 * preload};
      const double x = mass.amplitude(omega);
      double force = 0.0, before = 0.0;
      for (int i = 0; i < 3 * points; ++i) {  // the loop closes after a period
        const double u = x * std::sin(2.0 * pi * i / points);
        force = std::clamp(force + u - before, -mass.limit, mass.limit);
        before = u;
        if (i >= 2 * points)
          rows.push_back({preload, omega, 2.0 * pi / omega * (i - 2 * points) / points, u, 0.8 * u, force, u});
      }
    }
  }
  add_table(sink, layout, rows);
}

}  // namespace

void add_preload_sweep(results::Sink& sink) {
  const std::string name = "preloads";
  results::TableLayout layout{name, "", "point", {column("N0", "")}, {}};
  layout.attributes = {{"type", "frequency_response"}, {"solver", "periodic"}, {"excitation", "Omega"},
                       {"swept_parameters", "N0"},     {"sweep", "grid"},      {"start", "unloaded"}};
  add_response_blocks(layout, true);
  const std::vector<double> preloads{0.0, 0.3, 0.8, 1.2, 4.0};
  std::vector<std::vector<double>> rows;
  for (const double preload : preloads) {
    for (int i = 0; i <= 150; ++i) {
      rows.push_back({preload});
      const int status = preload == 0.8 && i > 60 && i < 64 ? 1 : preload == 0.3 && i == 20 ? 3 : 0;
      append_response(rows.back(), {0.5 * preload}, 0.5 + 0.01 * i, true, status);
    }
  }
  add_table(sink, layout, rows);
  add_linear(sink, name);
  add_waveforms(sink, name, {0.3, 0.8, 1.2});
  sink.conclude(name, "done", "", {{"points", std::to_string(rows.size())}});
}

void add_grid_sweep(results::Sink& sink) {
  const std::string name = "grid";
  results::TableLayout layout{name, "", "point", {column("mu", ""), column("N0", "")}, {}};
  layout.attributes = {{"type", "frequency_response"},
                       {"solver", "harmonic_balance"},
                       {"excitation", "Omega"},
                       {"swept_parameters", "mu, N0"},
                       {"sweep", "grid"},
                       {"start", "previous"}};
  add_response_blocks(layout, false);
  std::vector<std::vector<double>> rows;
  for (const double mu : {0.2, 0.5}) {
    for (int k = 0; k < 24; ++k) {
      const double preload = 0.05 * std::pow(10.0, 0.1 * k);
      for (int i = 0; i <= 100; ++i) {
        rows.push_back({mu, preload});
        append_response(rows.back(), {mu * preload}, 0.5 + 0.015 * i, false, 0);
      }
    }
  }
  add_table(sink, layout, rows);
  add_linear(sink, name);
  sink.conclude(name, "done", "", {{"points", std::to_string(rows.size())}});
}

void add_random_sweep(results::Sink& sink) {
  const std::string name = "tolerance";
  results::TableLayout layout{name, "", "point", {column("N0", ""), column("m1", "")}, {}};
  layout.attributes = {{"type", "frequency_response"},
                       {"solver", "harmonic_balance"},
                       {"excitation", "Omega"},
                       {"swept_parameters", "N0, m1"},
                       {"sweep", "random"},
                       {"start", "unloaded"}};
  add_response_blocks(layout, false);
  constexpr int samples = 400, points = 201;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> rows, amplitudes(points);
  for (int sample = 0; sample < samples; ++sample) {
    const double preload = 0.8 * std::exp(0.2 * normal(generator)), mass = 1.0 + 0.03 * normal(generator);
    for (int i = 0; i < points; ++i) {
      rows.push_back({preload, mass});
      append_response(rows.back(), {0.5 * preload, mass}, 0.5 + 1.5 * i / (points - 1), false, 0);
      amplitudes[static_cast<std::size_t>(i)].push_back(rows.back()[3]);
    }
  }
  add_table(sink, layout, rows);
  const std::vector<int> percents{5, 25, 50, 75, 95};
  results::TableLayout bands{name, "bands", "frequency", {column("angular_frequency", "rad/s")}, {}};
  for (const int percent : percents)
    bands.blocks.push_back(
        column((percent < 10 ? "amplitude_p0" : "amplitude_p") + std::to_string(percent), "m", "coordinate", observed));
  bands.blocks.push_back(column("missing", "1"));
  std::vector<std::vector<double>> band_rows;
  for (std::size_t i = 0; i < points; ++i) {
    std::vector<double>& values = amplitudes[i];
    std::sort(values.begin(), values.end());
    band_rows.push_back({0.5 + 1.5 * static_cast<double>(i) / (points - 1)});
    for (const int percent : percents) {
      const double value = values[static_cast<std::size_t>(percent) * (samples - 1) / 100];
      band_rows.back().insert(band_rows.back().end(), {value, 0.8 * value});
    }
    band_rows.back().push_back(0.0);
  }
  add_table(sink, bands, band_rows);
  sink.conclude(name, "done", "", {{"points", std::to_string(rows.size())}});
}

void add_damper_curve(results::Sink& sink) {
  const std::string name = "damper";
  const std::vector<std::string> blades{"blade1", "blade2"};
  const std::vector<std::pair<std::string, std::string>> attributes{
      {"type", "damper_curve"}, {"solver", "periodic"}, {"parameter", "N0"}};
  results::TableLayout layout{name, "", "point", {column("N0", ""), column("angular_frequency", "rad/s")}, attributes};
  layout.blocks.push_back(column("amplitude", "m", "coordinate", blades));
  for (const char* what : {"objective", "residual", "error"})
    layout.blocks.push_back(column(what, what == std::string("objective") ? "m" : "1"));
  layout.blocks.push_back(column("status", "1", "", {}, statuses));
  // Two peaks: one falls with the preload, one rises; they cross at N0 = 34, as cosh about it.
  const auto peak = [](double preload, int which) {
    const double place = std::log(preload / 34.0);
    return 3.45 * std::exp(which == 0 ? -0.22 * place : 0.15 * place);
  };
  results::TableLayout tracked{name, "peaks", "point", {column("N0", ""), column("peak", "1")}, {}};
  tracked.blocks.push_back(column("angular_frequency", "rad/s"));
  tracked.blocks.push_back(column("amplitude", "m", "coordinate", blades));
  std::vector<std::vector<double>> rows, peaks;
  for (int k = 0; k < 60; ++k) {
    const double preload = std::pow(10.0, 3.0 * k / 59.0);
    const double low = peak(preload, 0), high = peak(preload, 1), at = low > high ? 7.5 : 8.05;
    const double largest = std::max(low, high);
    const double status = k == 7 ? 1.0 : 0.0;
    rows.push_back({preload, at + 0.02 * std::log(preload), largest, 0.98 * largest, largest, 1e-12, 1e-10, status});
    peaks.push_back({preload, 1.0, 7.5 + 0.02 * std::log(preload), low, 0.98 * low});
    peaks.push_back({preload, 2.0, 8.05 + 0.02 * std::log(preload), high, 0.98 * high});
  }
  add_table(sink, layout, rows);
  results::TableLayout optimum = layout;
  optimum.table = "optimum";
  optimum.attributes = {};
  optimum.blocks.push_back(column("kind", "1", "", {}, {"smooth", "bound", "kink"}));
  for (const char* what : {"derivative_1", "derivative_2", "multiplier_1", "multiplier_2"})
    optimum.blocks.push_back(column(what, "1"));
  add_table(
      sink, optimum,
      {{34.0, 7.57, 3.45, 0.98 * 3.45, 3.45, 1e-12, 1e-10, 0.0, 2.0, -0.022323529, 0.015220588, 0.405405, 0.594595}});
  add_table(sink, tracked, peaks);
  sink.conclude(name, "done", "", {});
}

void add_swept_damper_curve(results::Sink& sink) {
  const std::string name = "dampers";
  results::TableLayout layout{name,
                              "",
                              "point",
                              {column("mu", ""), column("N0", ""), column("angular_frequency", "rad/s"),
                               column("objective", "m"), column("status", "1", "", {}, statuses)},
                              {{"type", "damper_curve"}, {"parameter", "N0"}, {"swept_parameters", "mu"}}};
  results::TableLayout tracked{name,
                               "peaks",
                               "point",
                               {column("mu", ""), column("N0", ""), column("peak", "1"),
                                column("angular_frequency", "rad/s"), column("objective", "m")},
                               {}};
  std::vector<std::vector<double>> rows, peaks;
  for (const double mu : {0.2, 0.3, 0.5})
    for (int k = 1; k <= 20; ++k) {
      const double preload = 5.0 * k, falling = 4.0 - 0.01 * mu * preload, rising = 3.0 + 0.01 * mu * preload;
      rows.push_back({mu, preload, falling > rising ? 7.5 : 8.0, std::max(falling, rising), 0.0});
      peaks.push_back({mu, preload, 1.0, 7.5, falling});
      peaks.push_back({mu, preload, 2.0, 8.0, rising});
    }
  add_table(sink, layout, rows);
  add_table(sink, tracked, peaks);
  sink.conclude(name, "done", "", {});
}

void add_modes(results::Sink& sink) {
  const std::vector<std::string> coordinates{"disk1", "blade1", "disk2", "blade2", "damper"};
  results::TableLayout layout{"modes", "", "mode", {column("limit", "1", "", {}, {"free", "stuck"})}, {}};
  layout.attributes = {{"type", "modes"}};
  layout.blocks.push_back(column("mode", "1"));
  layout.blocks.push_back(column("angular_frequency", "rad/s"));
  layout.blocks.push_back(column("frequency", "Hz"));
  layout.blocks.push_back(column("damping_ratio", "1"));
  layout.blocks.push_back(column("shape", "1", "coordinate", coordinates));
  const std::vector<std::vector<double>> frequencies{
      {2.985807624388833, 2.985807624388833, 3.162277660168379, 7.488988772200257, 7.488988772200257},
      {2.996205323187844, 3.162277660168379, 5.137956574909118, 8.062257748298550, 8.344109053436982}};
  std::vector<std::vector<double>> rows;
  for (std::size_t limit = 0; limit < 2; ++limit) {
    for (std::size_t mode = 0; mode < 5; ++mode) {
      const double omega = frequencies[limit][mode];
      rows.push_back({static_cast<double>(limit), static_cast<double>(mode + 1), omega, omega / (2.0 * pi), 0.02});
      for (std::size_t i = 0; i < 5; ++i)
        rows.back().push_back(std::sin(pi * static_cast<double>((mode + 1) * (i + 1)) / 6.0));
    }
  }
  add_table(sink, layout, rows);
  sink.conclude("modes", "done", "", {});
}

}  // namespace rubato::test
