// A pendulum let go from the horizontal, as a program that embeds the analyses of Rubato would run it: a study, its
// system, and a sink of the program's own that takes the rows.
#include <rubato/analysis/transient.hpp>
#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/io/read_study.hpp>

#include <cmath>
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

namespace {

/// Keeps the last row of the main table.
class LastRow final : public rubato::results::Sink {
 public:
  std::unique_ptr<rubato::results::RowWriter> open(const rubato::results::TableLayout& layout) override {
    return std::make_unique<Writer>(layout.table.empty() ? &row : nullptr);
  }
  void conclude(const std::string&, const std::string&, const std::string&,
                const std::vector<std::pair<std::string, std::string>>&) override {}
  std::vector<double> row;

 private:
  struct Writer final : rubato::results::RowWriter {
    explicit Writer(std::vector<double>* kept) : kept_(kept) {}
    void append(std::span<const double> values) override {
      if (kept_) kept_->assign(values.begin(), values.end());
    }
    void flush() override {}
    std::vector<double>* kept_;
  };
};

class Silent final : public rubato::analysis::Progress {
  void begin(const std::string&, double, const std::string&) override {}
  void advance(double) override {}
  void end() override {}
};

}  // namespace

int main() {
  // From the horizontal a pendulum of length l takes K(sin 45 degrees) sqrt(l/g), K = 1.8540746773, to the lowest
  // point.
  const double quarter = 1.8540746773013719 / std::sqrt(9.81);
  const auto study = rubato::io::read_study_text(
      "node = [{ name = \"bob\", position = [1.0, 0.0] }]\n"
      "mass = [{ node = \"bob\", mass = 2.0 }]\n"
      "joint = [{ name = \"link\", type = \"distance\", between = [\"ground\", \"bob\"], at = [0.0, 0.0] }]\n"
      "gravity = { acceleration = [0.0, -9.81] }\n"
      "analysis = [{ name = \"swing\", type = \"transient\", step = { tolerance = 1e-6 }, duration = " +
          std::to_string(5.0 * quarter) + " }]\n",
      "pendulum.toml");
  const auto parameters = rubato::model::evaluate_parameters(study.parameters);
  const auto pendulum = rubato::integrate::assemble_kind(study.model, parameters);
  const auto& analysis = study.analyses.front();
  const auto& transient = std::get<rubato::model::TransientDescription>(analysis.task);
  const auto plan = rubato::analysis::plan_transient(analysis.name, analysis.where, transient, *pendulum, parameters);

  LastRow sink;
  Silent progress;
  const std::atomic<bool> stop{false};
  rubato::analysis::RunContext context{sink, progress, stop};
  const auto report = rubato::analysis::run_transient(analysis.name, plan, *pendulum, context);
  if (report.status != rubato::analysis::RunStatus::done || sink.row.size() < 3) {
    std::printf("%s\n", report.message.c_str());
    return 1;
  }
  // Columns: time, positions, ... The duration is written with six decimals, and the bob passes at 4.4 m/s.
  std::printf("t = %g s: x = %g m, y = %g m\n", sink.row[0], sink.row[1], sink.row[2]);
  return std::abs(sink.row[1]) < 1e-3 && std::abs(sink.row[2] + 1.0) < 1e-3 ? 0 : 1;
}
