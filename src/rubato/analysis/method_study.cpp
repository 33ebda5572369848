#include <rubato/analysis/as_printed.hpp>
#include <rubato/analysis/method_study.hpp>
#include <rubato/analysis/method_study_comparison.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/stability.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace rubato::analysis {
namespace {

using integrate::Method;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

bool march(const Method& method, const integrate::SystemKind& kind, double step, double end, Comparison& comparison) {
  const integrate::MarchPlan plan = march_plan_of(method, kind, step, end);
  return kind.marches().march(plan)->go_to(end, &comparison, nullptr).march.end == integrate::MarchEnd::reached;
}

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// Writes the tables one after another; each returns false if it was interrupted.
class MethodStudy {
 public:
  MethodStudy(const std::string& name, const MethodStudyPlan& plan, const integrate::SystemKind& kind,
              RunContext& context)
      : name_(name), plan_(plan), kind_(kind), context_(context) {
    ExactResponse response = exact_response(plan, kind, 0.25 * plan.step);
    exact_ = std::move(response.values);
    size_ = response.largest > 0.0 ? response.largest : 1.0;
    const double methods = static_cast<double>(plan.methods.size());
    for (const double h : plan.ladder) total_ += methods * plan.duration / h;
    total_ += methods * 7.0 * plan.duration / plan.step;
  }

  bool errors() {
    results::Block method = scalar("method", "", "method");
    method.categories = plan_.names();
    const auto rows = context_.sink.open({name_,
                                          "",
                                          "method",
                                          {method, scalar("order", "1", "order of the method (0: exact)"),
                                           scalar("first_step_error", "1", "|x1 - x(h)| / |x(h)|"),
                                           scalar("mean_error", "1", "mean of |x - x(t)| / largest |x|"),
                                           scalar("max_error", "1", "largest |x - x(t)| / largest |x|"),
                                           scalar("observed_order", "1", "from the largest errors at h/2 and h/4")},
                                          {{"type", "method_study"},
                                           {"step", fmt::format("{} s", plan_.step)},
                                           {"duration", fmt::format("{} s", plan_.duration)},
                                           {"observed", plan_.observed.label}}});
    for (std::size_t i = 0; i < plan_.methods.size(); ++i) {
      const Method& method_i = plan_.methods[i];
      double largest[3];
      double first = 0.0, mean = 0.0;
      for (int level = 0; level < 3; ++level) {
        Comparison comparison(plan_, exact_, 4 >> level, context_.stop);
        if (!march(method_i, kind_, plan_.step / (1 << level), plan_.duration, comparison)) return false;
        largest[level] = comparison.largest() / size_;
        if (level == 0) first = comparison.first(), mean = comparison.mean() / size_;
        advance(plan_.duration / plan_.step * (1 << level));
      }
      const bool above_round_off = largest[2] > 1e-13;
      const double row[] = {static_cast<double>(i),
                            static_cast<double>(plan_.orders[i]),
                            first,
                            mean,
                            largest[0],
                            above_round_off ? std::log2(largest[1] / largest[2]) : missing};
      rows->append(row);
    }
    return true;
  }

  bool responses() {
    constexpr long most_rows = 3000;
    const long count = std::min(integrate::count_steps(plan_.duration, plan_.step).full, most_rows);
    const double end = static_cast<double>(count) * plan_.step;
    std::vector<std::string> labels;
    std::vector<std::vector<double>> columns;
    for (const Method& method : plan_.methods) {
      Comparison comparison(plan_, exact_, 4, context_.stop);
      comparison.keep_values = true;
      if (!march(method, kind_, plan_.step, end, comparison)) return false;
      labels.push_back(method.name);
      columns.push_back(std::move(comparison.values));
    }
    std::vector<double> exact;
    for (long j = 0; j <= count; ++j) exact.push_back(exact_[static_cast<std::size_t>(4 * j)]);
    write_displacements("response", {}, plan_.step, labels, exact, columns);
    return true;
  }

  /// What lies beyond the limit: explicit Euler at a tenth more than its largest stable step.
  bool unstable() {
    const Method euler = integrate::make_method("explicit_euler");
    const double limit = kind_.marches().stability_of(euler).step;
    if (!(limit > 0.0) || std::isinf(limit)) return true;
    const double step = 1.1 * limit;
    const auto exact = exact_response(plan_, kind_, step).values;
    Comparison comparison(plan_, exact, 1, context_.stop);
    comparison.keep_values = true;
    const double end = std::min(60.0 * step, plan_.duration);
    (void)march(euler, kind_, step, end, comparison);
    write_displacements("unstable",
                        {{"step", fmt::format("{} s", step)}, {"stability_limit", fmt::format("{} s", limit)}}, step,
                        {euler.name}, exact, {comparison.values});
    return !context_.stop.load();
  }

  bool ladder() {
    const auto rows = context_.sink.open(
        {name_,
         "ladder",
         "step",
         {scalar("step", "s", "step"),
          {"max_error", "1", "largest |x - x(t)| / largest |x|, at 2000 times or more where there are as many steps",
           "method", plan_.names()}},
         {}});
    std::vector<double> limits;
    for (const Method& method : plan_.methods) limits.push_back(kind_.marches().stability_of(method).step);
    for (const double h : plan_.ladder) {
      // Fine runs are compared at a thousand times or more, not at every step.
      const long count = integrate::count_steps(plan_.duration, h).full;
      const long thinned = std::max(1L, count / 2000);
      const auto exact = exact_response(plan_, kind_, h * static_cast<double>(thinned)).values;
      std::vector<double> row{h};
      for (std::size_t i = 0; i < plan_.methods.size(); ++i) {
        Comparison comparison(plan_, exact, -thinned, context_.stop);
        const bool is_stable = h <= limits[i];
        if (is_stable && !march(plan_.methods[i], kind_, h, static_cast<double>(count) * h, comparison)) return false;
        // No error at all is below what a logarithmic axis shows.
        row.push_back(is_stable && comparison.largest() > 0.0 ? comparison.largest() / size_ : missing);
        advance(plan_.duration / h);
      }
      rows->append(row);
    }
    return true;
  }

  bool stability() {
    const auto names = plan_.names();
    const auto rows = context_.sink.open(
        {name_,
         "stability",
         "omega_h",
         {scalar("omega_h", "1", "angular frequency times step"),
          {"spectral_radius", "1", "spectral radius of an undamped mode", "method", names},
          {"period_elongation", "1", "(numerical period - true period) / true period", "method", names},
          {"numerical_damping", "1", "damping ratio that the method adds", "method", names}},
         {}});
    for (int i = 1; i <= 200; ++i) {
      const double x = 0.05 * i;
      std::vector<double> row{x}, elongation, damping;
      for (const Method& method : plan_.methods) {
        const integrate::ModeResponse mode = integrate::mode_response(method, x);
        row.push_back(std::isfinite(mode.spectral_radius) ? mode.spectral_radius : missing);
        elongation.push_back(mode.period_elongation.value_or(missing));
        damping.push_back(mode.numerical_damping.value_or(missing));
      }
      row.insert(row.end(), elongation.begin(), elongation.end());
      row.insert(row.end(), damping.begin(), damping.end());
      rows->append(row);
    }
    return !context_.stop.load();
  }

  void as_printed() {
    const auto table = tables_as_printed(kind_, plan_.step);
    results::Block method = scalar("row", "", "row of the thesis's tables 2.2 to 2.4"),
                   convention = scalar("convention", "", "how the printed figure arises"),
                   unit = scalar("printed_in", "", "unit of the printed figures");
    unit.categories = {"fraction", "percent"};
    for (const PrintedRow& row : table) {
      method.categories.push_back(row.title);
      convention.categories.push_back(row.convention.empty() ? "as it should be" : row.convention);
    }
    const auto rows = context_.sink.open(
        {name_,
         "as_printed",
         "row",
         {method, scalar("first_step_error", "1", "error at the first step, as printed"),
          scalar("indicator", "1", "mean of the relative errors, as printed"),
          scalar("correct_first_step_error", "1", "error at the first step of the method meant"),
          scalar("correct_indicator", "1", "mean of the relative errors of the method meant"), unit, convention},
         {}});
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double index = static_cast<double>(i);
      double row[] = {index,
                      table[i].first_step_error,
                      table[i].indicator,
                      table[i].correct_first_step_error,
                      table[i].correct_indicator,
                      table[i].in_percent ? 1.0 : 0.0,
                      index};
      for (double& value : row)
        if (!std::isfinite(value)) value = missing;  // explicit Euler beyond its limit
      rows->append(row);
    }
  }

  double total() const { return total_; }

 private:
  /// Methods beside the exact displacement, and what they miss it by: subtracted here, since after rounding to the
  /// digits of a figure nothing would be left of it. Row j is at j steps, columns[i][j - 1] the displacement of method
  /// i.
  void write_displacements(const std::string& table, std::vector<std::pair<std::string, std::string>> attributes,
                           double step, const std::vector<std::string>& names, const std::vector<double>& exact,
                           const std::vector<std::vector<double>>& columns) {
    std::vector<std::string> labels{"exact"};
    labels.insert(labels.end(), names.begin(), names.end());
    const std::string unit = plan_.observed.is_rotation ? "rad" : "m";
    const std::string motion = plan_.observed.is_rotation ? "rotation" : "displacement";
    const auto rows =
        context_.sink.open({name_,
                            table,
                            "time",
                            {scalar("time", "s", "time"),
                             {plan_.observed.is_rotation ? "angle" : "position", unit,
                              motion + " of " + plan_.observed.label, "method", labels},
                             {"difference", unit, motion + " less the exact one", "compared_method", names}},
                            std::move(attributes)});
    std::size_t count = exact.size();
    for (const auto& column : columns) count = std::min(count, column.size() + 1);
    std::vector<double> row;
    for (std::size_t j = 0; j < count; ++j) {
      row = {static_cast<double>(j) * step, exact[j]};
      for (const auto& column : columns) row.push_back(j == 0 ? exact[0] : column[j - 1]);
      for (std::size_t i = 0; i < columns.size(); ++i) row.push_back(row[2 + i] - exact[j]);
      rows->append(row);
    }
  }

  void advance(double steps) { context_.progress.advance(done_ += steps); }

  const std::string& name_;
  const MethodStudyPlan& plan_;
  const integrate::SystemKind& kind_;
  RunContext& context_;
  std::vector<double> exact_;  ///< at the multiples of a quarter of the step
  double size_ = 0.0, total_ = 0.0, done_ = 0.0;
};

}  // namespace

RunReport run_method_study(const std::string& name, const MethodStudyPlan& plan, const integrate::SystemKind& kind,
                           RunContext& context) {
  MethodStudy tables(name, plan, kind, context);
  context.progress.begin(name, tables.total(), "steps");
  const bool finished =
      tables.errors() && tables.responses() && tables.unstable() && tables.ladder() && tables.stability();
  if (finished && plan.as_printed) tables.as_printed();
  context.progress.end();
  RunReport report;
  if (!finished) {
    report.status = context.stop.load() ? RunStatus::interrupted : RunStatus::failed;
    report.message = context.stop.load()
                         ? "interrupted; the tables written so far are complete or cut at a row"
                         : "a method failed on this model: its step is singular or not finite; leave it "
                           "out of methods = [...]";
  }
  if (!plan.left_out.empty())
    report.statistics.emplace_back("left_out",
                                   fmt::format("unstable at this step: {}", fmt::join(plan.left_out, ", ")));
  return report;
}

}  // namespace rubato::analysis
