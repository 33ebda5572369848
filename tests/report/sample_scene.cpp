#include "report/sample_scene.hpp"
#include "report/sample_results.hpp"

#include <cmath>
#include <numbers>

namespace rubato::test {
namespace {

const std::string repeated_rows = "\"hinge pin x\" repeats what other joints say";

}  // namespace

void add_scene(results::Sink& sink) {
  const std::string name = "shaken";
  results::TableLayout motion{name, "", "time", {{"time", "s", "time", "", {}}}, {{"type", "transient"}}};
  motion.blocks.push_back({"position", "m", "", "coordinate", {"b.x", "b.y", "c.x", "c.y"}});
  motion.blocks.push_back({"angle", "rad", "", "rotation", {"b.rz", "c.rz"}});
  std::vector<std::vector<double>> rows;
  for (int i = 0; i <= 10; ++i) {
    const double t = 0.1 * i, u = 0.1 * std::sin(std::numbers::pi * t);
    rows.push_back({t, u, 0.0, u, 0.0, -u, 0.5 * u});
  }
  add_table(sink, motion, rows);
  const std::vector<std::string> nodes{"a", "b", "c"};
  add_table(sink,
            {name,
             "nodes",
             "node",
             {{"node", "1", "", "", {}, nodes},
              {"x", "m", "", "", {}},
              {"y", "m", "", "", {}},
              {"z", "m", "", "", {}},
              {"support", "1", "", "", {}, {"free", "held", "pinned", "clamped"}}},
             {{"motion", "displacement"}, {"degrees_of_freedom", "6"}}},
            {{0, 0, 0, 0, 3}, {1, 0, 1, 0, 0}, {2, 1, 1, 0, 0}});
  add_table(sink,
            {name,
             "lines",
             "line",
             {{"line", "1", "", "", {}}, {"first", "1", "", "", {}, nodes}, {"second", "1", "", "", {}, nodes}},
             {}},
            {{1, 0, 1}, {2, 1, 2}});
  sink.conclude(name, "done", "", {});
}

void add_mechanism_modes(results::Sink& sink) {
  const std::string name = "swinging";
  const std::vector<std::string> nodes{"bob", "bob:2"};
  const auto number = [](const char* column) { return results::Block{column, "1", "", "", {}}; };
  results::Block limit = number("limit");
  limit.categories = {"free", "stuck"};
  results::TableLayout modes{name,
                             "",
                             "row",
                             {limit, number("mode"), number("angular_frequency"), number("frequency"),
                              number("damping_ratio"), number("eigenvalue_real"), number("eigenvalue_imaginary")},
                             {{"type", "modes"}}};
  modes.blocks.push_back({"shape", "1/sqrt(kg)", "", "coordinate", {"bob.x", "bob.y"}});
  modes.blocks.push_back({"angle_shape", "rad/(m sqrt(kg))", "", "rotation", {"bob.rz"}});
  modes.blocks.push_back({"shape_imaginary", "1/sqrt(kg)", "", "coordinate", {"bob.x", "bob.y"}});
  modes.blocks.push_back({"angle_shape_imaginary", "rad/(m sqrt(kg))", "", "rotation", {"bob.rz"}});
  // About the pin, which is told in the first; in the second along x, a quarter of a period ahead of along y, and
  // growing.
  add_table(sink, modes,
            {{0, 1, 6.0, 6.0 / (2.0 * std::numbers::pi), 0.02, -0.12, 6.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0},
             {0, 2, 10.0, 10.0 / (2.0 * std::numbers::pi), -0.05, 0.5, 10.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0}});
  add_table(sink,
            {name,
             "nodes",
             "node",
             {{"node", "1", "", "", {}, nodes},
              {"x", "m", "", "", {}},
              {"y", "m", "", "", {}},
              {"z", "m", "", "", {}},
              {"support", "1", "", "", {}, {"free", "held", "pinned", "clamped"}},
              number("carrier"),
              number("offset_x"),
              number("offset_y"),
              number("offset_z"),
              number("rotation_x"),
              number("rotation_y"),
              number("rotation_z")},
             {{"type", "nodes"}, {"motion", "shape"}, {"degrees_of_freedom", "3"}}},
            {{0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.5}, {1, 0, 0, 0, 0, 0, -0.07073720166, 0.9974949866, 0, 0, 0, 1.5}});
  add_table(sink,
            {name,
             "lines",
             "line",
             {{"line", "1", "", "", {}},
              {"first", "1", "", "", {}, nodes},
              {"second", "1", "", "", {}, nodes},
              {"kind", "1", "", "", {}, {"beam", "body", "link"}}},
             {}},
            {{1, 0, 1, 1}});
  sink.conclude(name, "failed", "the configuration is not stable", {{"warning1", repeated_rows}});
}

void add_mechanism(results::Sink& sink) {
  const std::string name = "pendulum";
  const auto number = [](const char* column) { return results::Block{column, "1", "", "", {}}; };
  results::TableLayout motion{name, "", "time", {{"time", "s", "time", "", {}}}, {{"type", "transient"}}};
  motion.blocks.push_back({"position", "m", "", "coordinate", {"arm.x", "arm.y", "arm:1.x"}});
  motion.blocks.push_back({"velocity", "m/s", "", "coordinate", {"arm.x", "arm.y", "arm:1.x"}});
  motion.blocks.push_back({"angle", "rad", "", "rotation", {"arm.rz", "hinge pin"}});
  motion.blocks.push_back({"angular_velocity", "rad/s", "", "rotation", {"arm.rz", "hinge pin"}});
  motion.blocks.push_back({"reaction_x", "N", "", "reaction_x_joint", {"hinge pin"}});
  motion.blocks.push_back({"reaction_y", "N", "", "reaction_y_joint", {"hinge pin"}});
  motion.blocks.push_back({"law_moment", "N m", "", "law_moment_joint", {"hinge pin"}});
  motion.blocks.push_back({"force_x", "N", "", "bushing", {"mount"}});
  motion.blocks.push_back({"force_y", "N", "", "bushing", {"mount"}});
  motion.blocks.push_back({"moment", "N m", "", "bushing", {"mount"}});
  std::vector<std::vector<double>> rows;
  const double pi = std::numbers::pi, largest = 0.5 * pi;
  for (int i = 0; i <= 100; ++i) {
    const double t = 1e-4 * i * i, angle = -largest * std::sin(pi * t), rate = -largest * pi * std::cos(pi * t);
    const double c = 0.5 * std::cos(angle), s = 0.5 * std::sin(angle), pull = rate * rate;  // of 1 kg
    rows.push_back(
        {t, c, s, 0.0, -s * rate, c * rate, 0.0, angle, angle, rate, rate, -c * pull, -s * pull, 3.0 * t, c, s, angle});
  }
  add_table(sink, motion, rows);
  const std::vector<std::string> nodes{"arm", "arm:1", "arm:3", "ground:4"};
  add_table(sink,
            {name,
             "nodes",
             "node",
             {{"node", "1", "", "", {}, nodes},
              {"x", "m", "", "", {}},
              {"y", "m", "", "", {}},
              {"z", "m", "", "", {}},
              {"support", "1", "", "", {}, {"free", "held", "pinned", "clamped"}},
              number("carrier"),
              number("offset_x"),
              number("offset_y"),
              number("offset_z")},
             {{"type", "nodes"}, {"motion", "position"}, {"degrees_of_freedom", "4"}}},
            {{0, 0.5, 0, 0, 0, 0, 0, 0, 0},
             {1, 0, 0, 0, 0, 1, 0, 0, 0},
             {2, 0, 0, 0, 0, 0, -0.5, 0, 0},
             {3, 0, 0, 0, 2, -1, 0, 0, 0}});
  add_table(sink,
            {name,
             "lines",
             "line",
             {number("line"),
              {"first", "1", "", "", {}, nodes},
              {"second", "1", "", "", {}, nodes},
              {"kind", "1", "", "", {}, {"beam", "body", "link", "strut"}}},
             {}},
            {{1, 0, 2, 1}});
  add_table(sink,
            {name,
             "joints",
             "joint",
             {{"joint", "1", "", "", {}, {"hinge pin"}},
              {"type", "1", "", "", {}, {"rigid", "revolute"}},
              {"first", "1", "", "", {}, nodes},
              {"second", "1", "", "", {}, nodes},
              number("axis_x"),
              number("axis_y"),
              number("axis_z"),
              {"law", "1", "", "", {}, {"none", "drive"}},
              {"limit", "1", "", "", {}, {"none", "stop", "latch"}}},
             {}},
            {{0, 1, 3, 2, 0, 0, 0, 0, 1}});
  add_table(sink,
            {name,
             "shapes",
             "shape",
             {number("shape"),
              {"body", "1", "", "", {}, nodes},
              {"kind", "1", "", "", {}, {"box", "cylinder", "sphere"}},
              number("size_x"),
              number("size_y"),
              number("size_z")},
             {}},
            {{1, 0, 0, 1.0, 0.2, 0.1}});
  add_table(sink,
            {name,
             "events",
             "time",
             {{"time", "s", "", "", {}},
              {"joint", "1", "", "", {}, {"hinge pin"}},
              {"event", "1", "", "", {}, {"lets_go", "locks", "slips", "sticks"}},
              {"energy_lost", "J", "", "", {}}},
             {{"type", "events"}}},
            {{0.1, 0, 3, 0}, {0.2, 0, 2, 0}, {0.4, 0, 1, 0.5}, {0.6, 0, 0, 0}});
  sink.conclude(name, "done", "",
                {{"steps", "100"}, {"finding1", "\"hinge pin\" locks at t = 0.4 s"}, {"warning1", repeated_rows}});
}

}  // namespace rubato::test
