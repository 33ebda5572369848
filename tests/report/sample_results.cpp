#include <rubato/io/write_netcdf.hpp>

#include "report/sample_responses.hpp"
#include "report/sample_results.hpp"
#include "report/sample_scene.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace rubato::test {
namespace {

using Rows = std::vector<std::vector<double>>;

results::Block column(const std::string& name, const std::string& unit, const std::string& dimension = "",
                      const std::vector<std::string>& labels = {}) {
  return {name, unit, name, dimension, labels, {}};
}

results::TableLayout energy_layout(const std::string& analysis) {
  results::TableLayout layout{analysis, "energy", "time", {column("time", "s")}, {}};
  for (const char* term :
       {"kinetic", "strain", "slider_stored", "damper_dissipated", "slider_dissipated", "load_work", "residue"}) {
    layout.blocks.push_back(column(term, "J"));
  }
  return layout;
}

/// Sliders between coordinates, springs and loads, marched by the symplectic Euler step.
struct SmallModel {
  std::vector<std::string> coordinates, sliders;
  std::vector<double> mass;
  std::vector<std::vector<double>> stiffness;
  double damping_per_stiffness, damping_per_mass;
  std::vector<std::pair<int, int>> ends;  ///< -1: ground
  double slider_stiffness, limit;
  std::vector<double> amplitude;
  double angular_frequency;
};

void march(const SmallModel& model, double h, int steps, Rows& rows, Rows& energies) {
  const std::size_t n = model.mass.size(), s = model.ends.size();
  std::vector<double> q(n), v(n), a(n), fc(s), u(s), pushed(n), resisted(n);
  double damped = 0.0, rubbed = 0.0, work = 0.0;
  for (int step = 0; step <= steps; ++step) {
    const double t = step * h;
    for (std::size_t k = 0; k < s; ++k) {
      const auto [first, second] = model.ends[k];
      const double u_now = q[first] - (second < 0 ? 0.0 : q[second]);
      const double next = std::clamp(fc[k] + model.slider_stiffness * (u_now - u[k]), -model.limit, model.limit);
      rubbed += 0.5 * (fc[k] + next) * (u_now - u[k] - (next - fc[k]) / model.slider_stiffness);
      u[k] = u_now;
      fc[k] = next;
    }
    double kinetic = 0.0, strain = 0.0, stored = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double damping = model.damping_per_mass * model.mass[i] * v[i];
      double force = model.amplitude[i] * std::cos(model.angular_frequency * t);
      const double load = force;
      for (std::size_t j = 0; j < n; ++j) {
        force -= model.stiffness[i][j] * q[j];
        damping += model.damping_per_stiffness * model.stiffness[i][j] * v[j];
        strain += 0.5 * q[i] * model.stiffness[i][j] * q[j];
      }
      pushed[i] = load;
      resisted[i] = damping;
      kinetic += 0.5 * model.mass[i] * v[i] * v[i];
      for (std::size_t k = 0; k < s; ++k) {
        if (model.ends[k].first == static_cast<int>(i)) force -= fc[k];
        if (model.ends[k].second == static_cast<int>(i)) force += fc[k];
      }
      a[i] = (force - damping) / model.mass[i];
    }
    for (const double force : fc) stored += 0.5 * force * force / model.slider_stiffness;
    std::vector<double> row{t};
    for (const auto* part : {&q, &v, &a, &fc}) row.insert(row.end(), part->begin(), part->end());
    for (std::size_t k = 0; k < s; ++k) row.push_back(u[k] - fc[k] / model.slider_stiffness);
    rows.push_back(row);
    energies.push_back(
        {t, kinetic, strain, stored, damped, rubbed, work, work - kinetic - strain - stored - damped - rubbed});
    for (std::size_t i = 0; i < n; ++i) {
      const double mean_velocity = v[i] + 0.5 * h * a[i];
      work += pushed[i] * mean_velocity * h;
      damped += resisted[i] * mean_velocity * h;
      v[i] += h * a[i];
    }
    for (std::size_t i = 0; i < n; ++i) q[i] += h * v[i];
  }
}

std::string repeated(double value, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += (i > 0 ? ", " : "") + std::to_string(value);
  return out;
}

/// Tries of steps between 1 ms and 0.1 s; every tenth is rejected, every twentieth ends at an event after two tries.
void add_steps(results::Sink& sink, const std::string& analysis) {
  results::TableLayout layout{analysis, "steps", "time", {}, {}};
  layout.attributes = {{"type", "steps"}, {"tolerance", "0.001"}};
  for (const char* name : {"time", "step"}) layout.blocks.push_back(column(name, "s"));
  for (const char* name : {"error", "accepted", "reason"}) layout.blocks.push_back(column(name, "1"));
  layout.blocks.back().categories = {"accepted", "error_too_large", "not_converged", "not_finite", "singular", "event"};
  Rows rows;
  double t = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double step = std::pow(10.0, -2.0 + std::sin(0.05 * i));
    if (i % 10 == 5) rows.push_back({t, 2.0 * step, 3e-3, 0.0, 1.0});
    if (i % 20 == 10)
      for (const double share : {1.6, 1.2}) rows.push_back({t, share * step, std::nan(""), 0.0, 5.0});
    rows.push_back({t, step, 5e-4 + 4e-4 * std::sin(i), 1.0, 0.0});
    t += step;
  }
  add_table(sink, layout, rows);
}

void add_transient(results::Sink& sink, const std::string& name, const SmallModel& model, double h, int steps,
                   const std::string& status, const std::string& message) {
  results::TableLayout layout{name, "", "time", {column("time", "s")}, {}};
  layout.attributes = {{"type", "transient"},
                       {"method", "generalized_alpha (rho_inf = 0.9)"},
                       {"step", std::to_string(h) + " s"},
                       {"slider_stiffness", repeated(model.slider_stiffness, model.sliders.size())},
                       {"slider_limit", repeated(model.limit, model.sliders.size())}};
  layout.blocks.push_back(column("position", "m", "coordinate", model.coordinates));
  layout.blocks.push_back(column("velocity", "m/s", "coordinate", model.coordinates));
  layout.blocks.push_back(column("acceleration", "m/s2", "coordinate", model.coordinates));
  layout.blocks.push_back(column("force", "N", "slider", model.sliders));
  layout.blocks.push_back(column("slip", "m", "slider", model.sliders));
  layout.blocks.push_back(column("force", "N", "stop", {"bumper"}));
  layout.blocks.push_back(column("penetration", "m", "stop", {"bumper"}));
  layout.blocks.push_back(column("force", "N", "law", {"rubber"}));
  layout.blocks.push_back(column("displacement", "m", "law", {"rubber"}));
  Rows rows, energies;
  march(model, h, steps, rows, energies);
  for (auto& row : rows) {
    const double penetration = std::max(0.0, row[1]);  // of the first coordinate
    row.insert(row.end(), {100.0 * penetration, penetration, 10.0 * row[1], row[1]});
  }
  add_table(sink, layout, rows);
  add_table(sink, energy_layout(name), energies);
  if (status == "done") add_steps(sink, name);
  sink.conclude(name, status, message, {{"steps", std::to_string(steps)}});
}

/// One Newmark step of m = c = k = 1 under cos(2 t) from rest, and its exact response.
Rows newmark_response(double beta, double gamma, double h, int steps) {
  double q = 0.0, v = 0.0, a = 1.0;
  Rows out{{0.0, 0.0}};
  for (int j = 1; j <= steps; ++j) {
    const double q_star = q + h * v + h * h * (0.5 - beta) * a, v_star = v + h * (1.0 - gamma) * a;
    a = (std::cos(2.0 * j * h) - v_star - q_star) / (1.0 + gamma * h + beta * h * h);
    q = q_star + beta * h * h * a;
    v = v_star + gamma * h * a;
    out.push_back({j * h, q});
  }
  return out;
}

double exact_response(double t) {
  // x = A cos 2t + B sin 2t + exp(-t/2) (C cos wt + D sin wt), w = sqrt(3)/2
  const double A = -3.0 / 13.0, B = 2.0 / 13.0, C = -A, w = std::sqrt(0.75), D = (0.5 * C - 2.0 * B) / w;
  return A * std::cos(2 * t) + B * std::sin(2 * t) + std::exp(-0.5 * t) * (C * std::cos(w * t) + D * std::sin(w * t));
}

void add_method_study(results::Sink& sink) {
  struct Named {
    const char* name;
    double beta, gamma;
  };
  const std::vector<Named> methods{
      {"central_difference", 0.0, 0.5},    {"fox_goodwin", 1.0 / 12, 0.5}, {"linear_acceleration", 1.0 / 6, 0.5},
      {"average_acceleration", 0.25, 0.5}, {"galerkin", 0.8, 1.5},         {"backward_difference", 1.0, 1.5}};
  std::vector<std::string> names;
  for (const Named& method : methods) names.emplace_back(method.name);
  const std::string study = "methods";
  const auto error_at = [](const Named& method, double h) {
    double error = 0.0;
    for (const auto& row : newmark_response(method.beta, method.gamma, h, static_cast<int>(std::lround(20.0 / h)))) {
      error = std::max(error, std::abs(row[1] - exact_response(row[0])) / 0.355015365305304);
    }
    return error;
  };

  results::TableLayout main{study, "", "method", {column("method", "1")}, {{"type", "method_study"}}};
  main.blocks[0].categories = names;
  for (const char* quantity : {"first_step_error", "maximum_error", "order"})
    main.blocks.push_back(column(quantity, "1"));
  Rows errors;
  for (std::size_t k = 0; k < methods.size(); ++k) {
    const double first =
        newmark_response(methods[k].beta, methods[k].gamma, 0.01, 1)[1][1] / exact_response(0.01) - 1.0;
    const double coarse = error_at(methods[k], 0.02), fine = error_at(methods[k], 0.01);
    errors.push_back({static_cast<double>(k), std::abs(first), fine, std::log2(coarse / fine)});
  }
  add_table(sink, main, errors);

  results::TableLayout ladder{study, "ladder", "step", {column("step", "s")}, {}};
  ladder.blocks.push_back(column("maximum_error", "1", "method", names));
  Rows rungs;
  for (double h = 0.4; h > 4e-4; h *= 0.5) {
    rungs.push_back({h});
    for (const Named& method : methods) rungs.back().push_back(error_at(method, h));
  }
  add_table(sink, ladder, rungs);

  auto with_exact = names;
  with_exact.emplace_back("exact");
  results::TableLayout response{study, "response", "time", {column("time", "s")}, {}};
  response.blocks.push_back(column("position", "m", "method", with_exact));
  Rows samples(1001);
  for (std::size_t j = 0; j < samples.size(); ++j) samples[j].push_back(0.05 * static_cast<double>(j));
  for (const Named& method : methods) {
    const Rows rows = newmark_response(method.beta, method.gamma, 0.05, 1000);
    for (std::size_t j = 0; j < samples.size(); ++j) samples[j].push_back(rows[j][1]);
  }
  for (auto& row : samples) row.push_back(exact_response(row[0]));
  add_table(sink, response, samples);

  results::TableLayout stability{study, "stability", "omega_h", {column("omega_h", "1")}, {}};
  stability.blocks.push_back(column("spectral_radius", "1", "method", names));
  stability.blocks.push_back(column("period_elongation", "1", "method", names));
  Rows radii;
  for (double omega_h = 0.05; omega_h < 10.0; omega_h += 0.05) {
    std::vector<double> radius{omega_h}, elongation;
    for (const Named& method : methods) {
      const double square = omega_h * omega_h, d = 1.0 + method.beta * square;
      const double half_trace = 1.0 - 0.5 * square * (method.gamma + 0.5) / d;
      const double determinant = 1.0 - square * (method.gamma - 0.5) / d;
      const std::complex<double> root = std::sqrt(std::complex<double>(half_trace * half_trace - determinant));
      const std::complex<double> first = half_trace + root, second = half_trace - root;
      radius.push_back(std::max(std::abs(first), std::abs(second)));
      elongation.push_back(root.imag() > 0.0 ? omega_h / std::arg(first) - 1.0 : NAN);
    }
    radius.insert(radius.end(), elongation.begin(), elongation.end());
    radii.push_back(radius);
  }
  add_table(sink, stability, radii);
  sink.conclude(study, "done", "", {});
}

}  // namespace

void add_table(results::Sink& sink, const results::TableLayout& layout, const Rows& rows) {
  const auto writer = sink.open(layout);
  for (const auto& row : rows) writer->append(row);
}

void write_sample_results(const std::filesystem::path& file) {
  const io::Provenance provenance{
      "Two blade sectors and an under-platform damper", "examples/underplatform-damper/study.toml",
      "title = \"Two blade sectors and an under-platform damper\"\n\n[parameters]\nN0 = 10.0  # preload [N]\n"
      "# a comment that tries to end the page: </script><script>document.title = 'taken'</script>\n",
      "rubato run examples/underplatform-damper/study.toml", "2026-11-21T03:30:00Z"};
  io::NetcdfSink sink(file, provenance);
  const SmallModel damper{
      {"disk1", "blade1", "disk2", "blade2", "damper"},
      {"contact1", "contact2"},
      {10, 1, 10, 1, 1},
      {{150, -50, 0, 0, 0}, {-50, 50, 0, 0, 0}, {0, 0, 150, -50, 0}, {0, 0, -50, 50, 0}, {0, 0, 0, 0, 10}},
      0.00381868997597177,
      0.0853885037126992,
      {{1, 4}, {3, 4}},
      10.0,
      5.0,
      {0, 20, 0, -20, 0},
      10.0};
  add_transient(sink, "response", damper, 0.005, 12000, "done", "");
  const SmallModel mass{{"mass"}, {"pad"}, {1}, {{1}}, 1.0, 0.0, {{0, -1}}, 1.0, 0.15, {1}, 2.0};
  add_transient(
      sink, "single mass", mass, 0.02, 2500, "failed",
      "at t = 50.02 s the contact problem did not converge (residual 3.1e-4 after 50 iterations); try a smaller "
      "step or allow_unstable = false");
  add_method_study(sink);
  add_preload_sweep(sink);
  add_grid_sweep(sink);
  add_random_sweep(sink);
  add_damper_curve(sink);
  add_swept_damper_curve(sink);
  add_modes(sink);
  add_scene(sink);
  add_mechanism_modes(sink);
  add_mechanism(sink);

  const std::string hostile = "bl\"ade</script><b>\xCE\xA9";
  results::TableLayout unknown{"unknown", "", "angular_frequency", {column("angular_frequency", "rad/s")}, {}};
  unknown.attributes = {{"note", hostile}};
  unknown.blocks.push_back(column("amplitude", "m", "coordinate", {hostile, "disk"}));
  Rows rows;
  for (double omega = 7.0; omega <= 8.5; omega += 0.01) {
    const double other = omega > 8.0 && omega < 8.05 ? NAN : 0.1;
    rows.push_back({omega, 1.0 / std::hypot(60.0 - omega * omega, 0.3 * omega), other});
  }
  add_table(sink, unknown, rows);
  sink.conclude("unknown", "done", "", {});
  sink.close();
}

}  // namespace rubato::test
