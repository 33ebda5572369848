#include "report/sample_scene.hpp"
#include "report/sample_results.hpp"

#include <cmath>
#include <numbers>

namespace rubato::test {

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

}  // namespace rubato::test
