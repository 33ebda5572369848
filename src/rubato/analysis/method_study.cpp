#include <rubato/analysis/as_printed.hpp>
#include <rubato/analysis/method_study.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/stability.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rubato::analysis {
namespace {

using integrate::Method;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double most_ladder_steps = 1e6;  // a run of the finest step takes a tenth of a second

struct Plan {
  std::vector<Method> methods;
  std::vector<int> orders;
  double step = 0.0, duration = 0.0;
  std::vector<double> ladder;  ///< falling [s]
  Observed observed;
  std::vector<std::string> left_out;

  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const Method& method : methods) list.push_back(method.name);
    return list;
  }
};

double positive(const model::Quantity& quantity, const numerics::Parameters& parameters, const std::string& what) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value > 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must be positive, got {}", what, value));
  return value;
}

void take_methods(Plan& plan, const std::string& title, const model::MethodStudyDescription& study,
                  const system::LocallyNonlinear& system, const numerics::Parameters& parameters) {
  if (!study.methods.empty()) {
    for (const auto& description : study.methods) {
      Method method = method_of(description, parameters);
      if (std::holds_alternative<integrate::Exact>(method.formula))
        throw InvalidInput(description.where, title +
                                                  "the method exact takes no step; it is what the others are compared "
                                                  "with");
      const double limit = integrate::stability_of(method, system).step;
      if (plan.step > limit)
        throw InvalidInput(description.where,
                           fmt::format("{}{} is stable up to the step {:.6g} s on this model, the study "
                                       "takes {} s",
                                       title, method.name, limit, plan.step));
      plan.methods.push_back(std::move(method));
      plan.orders.push_back(integrate::find_method(description.name).order);
    }
    return;
  }
  for (const auto& info : integrate::catalogue()) {
    const bool needs_values = std::any_of(info.parameters.begin(), info.parameters.end(),
                                          [](const auto& parameter) { return std::isnan(parameter.default_value); });
    if (needs_values || info.name == "exact" || (info.name == "exponential" && system.size() > 500)) continue;
    Method method = integrate::make_method(info.name);
    if (plan.step > integrate::stability_of(method, system).step) {
      plan.left_out.push_back(info.name);
      continue;
    }
    plan.methods.push_back(std::move(method));
    plan.orders.push_back(info.order);
  }
}

Plan make_plan(const std::string& name, const Location& where, const model::MethodStudyDescription& study,
               const system::LocallyNonlinear& system, const numerics::Parameters& parameters) {
  const std::string title = "analysis \"" + name + "\": ";
  if (system.slider_count() > 0)
    throw InvalidInput(where,
                       fmt::format("{}a method study needs a linear model with a closed-form response, this one has "
                                   "{} slider(s)",
                                   title, system.slider_count()));
  if (!system.loads().are_harmonic())
    throw InvalidInput(where, title + "a method study needs harmonic loads, whose response has a closed form");
  try {
    const integrate::ExactFlow flow(system);
    if (study.as_printed) (void)tables_as_printed(system, 0.01);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(where, title + fault.message());
  }
  Plan plan;
  plan.step = positive(study.step, parameters, title + "step");
  plan.duration = positive(study.duration, parameters, title + "duration");
  const double count = plan.duration / plan.step;
  if (!(count >= 1.0 && count <= most_ladder_steps))
    throw InvalidInput(study.step.where, fmt::format("{}{} steps; take from 1 to 1e6", title, count));
  if (std::abs(count - std::round(count)) > 1e-9 * count)
    throw InvalidInput(study.step.where, fmt::format("{}the duration {} s must be a multiple of the step {} s", title,
                                                     plan.duration, plan.step));
  plan.observed =
      study.observe ? observed_of(*study.observe, system) : Observed{system.coordinates().front(), 0, ground};
  take_methods(plan, title, study, system, parameters);
  for (const auto& quantity : study.ladder) {
    const double h = positive(quantity, parameters, title + "ladder");
    if (h > plan.duration || plan.duration / h > 1e7)
      throw InvalidInput(quantity.where,
                         fmt::format("{}ladder: {} s makes {} steps; take from 1 to 1e7", title, h, plan.duration / h));
    plan.ladder.push_back(h);
  }
  std::sort(plan.ladder.begin(), plan.ladder.end(), std::greater<>());
  if (plan.ladder.empty())
    for (int k = 5; k >= -8; --k) {
      const double h = plan.step * std::pow(2.0, k);
      if (plan.duration / h >= 8.0 && plan.duration / h <= most_ladder_steps) plan.ladder.push_back(h);
    }
  return plan;
}

/// The exact displacement at the multiples of a step, by the event-driven flow (Taylor pieces, exact to round-off).
std::vector<double> exact_response(const Plan& plan, const system::LocallyNonlinear& system, double step) {
  struct Sampler final : integrate::ExactVisitor {
    explicit Sampler(const Observed& o) : observed(o) {}
    bool sample(const system::State& state, const integrate::ExactWork&) override {
      values.push_back(observed.of(state.q));
      return true;
    }
    bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
      return true;
    }
    const Observed& observed;
    std::vector<double> values;
  } sampler(plan.observed);
  const integrate::StepCount count = integrate::count_steps(plan.duration, step);
  std::vector<double> times;
  for (long i = 0; i <= count.full; ++i) times.push_back(std::min(static_cast<double>(i) * step, plan.duration));
  integrate::ExactFlow flow(system);
  system::State state = system.start();
  flow.advance(state, plan.duration, times, sampler);
  return sampler.values;
}

/// Compares every step of a march with the exact displacement.
class Comparison final : public integrate::Observer {
 public:
  Comparison(const Plan& plan, const std::vector<double>& exact, long stride, const std::atomic<bool>& stop)
      : plan_(plan), exact_(exact), stride_(stride), stop_(stop) {}

  bool accepted(const system::State&, const system::State& after) override {
    ++steps_;
    const double x = plan_.observed.of(after.q);
    if (keep_values) values.push_back(x);
    const bool on_grid = stride_ > 0 ? true : steps_ % -stride_ == 0;
    const auto place = static_cast<std::size_t>(stride_ > 0 ? steps_ * stride_ : steps_ / -stride_);
    if (on_grid && place < exact_.size()) {
      const double error = std::abs(x - exact_[place]);
      if (steps_ == 1) first_ = error / std::abs(exact_[place]);
      largest_ = std::max(largest_, error);
      sum_ += error;
      ++compared_;
    }
    return !stop_.load(std::memory_order_relaxed);
  }
  double first() const { return first_; }
  double largest() const { return largest_; }
  double mean() const { return sum_ / static_cast<double>(std::max(compared_, 1L)); }

  bool keep_values = false;
  std::vector<double> values;

 private:
  const Plan& plan_;
  const std::vector<double>& exact_;
  long stride_;  ///< samples a step; negative: steps a sample
  const std::atomic<bool>& stop_;
  long steps_ = 0, compared_ = 0;
  double first_ = missing, largest_ = 0.0, sum_ = 0.0;
};

bool march(const Method& method, const system::LocallyNonlinear& system, double step, double end,
           Comparison& comparison) {
  const auto stepper = integrate::make_stepper(method, system);
  system::State state = integrate::consistent_start(system, system.start());
  return integrate::march(*stepper, state, step, end, &comparison).end == integrate::MarchEnd::reached;
}

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// Writes the tables one after another; each returns false if it was interrupted.
class MethodStudy {
 public:
  MethodStudy(const std::string& name, const Plan& plan, const system::LocallyNonlinear& system, RunContext& context)
      : name_(name), plan_(plan), system_(system), context_(context) {
    exact_ = exact_response(plan, system, 0.25 * plan.step);
    for (const double x : exact_) size_ = std::max(size_, std::abs(x));
    if (!(size_ > 0.0)) size_ = 1.0;
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
        if (!march(method_i, system_, plan_.step / (1 << level), plan_.duration, comparison)) return false;
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
    std::vector<std::string> labels{"exact"};
    std::vector<std::vector<double>> columns;
    for (const Method& method : plan_.methods) {
      Comparison comparison(plan_, exact_, 4, context_.stop);
      comparison.keep_values = true;
      if (!march(method, system_, plan_.step, end, comparison)) return false;
      labels.push_back(method.name);
      columns.push_back(std::move(comparison.values));
    }
    const auto rows = context_.sink.open(response_layout("response", labels, {}));
    std::vector<double> row;
    for (long j = 0; j <= count; ++j) {
      row = {static_cast<double>(j) * plan_.step, exact_[static_cast<std::size_t>(4 * j)]};
      for (const auto& column : columns) row.push_back(j == 0 ? exact_[0] : column[static_cast<std::size_t>(j - 1)]);
      append_with_differences(*rows, row);
    }
    return true;
  }

  /// What lies beyond the limit: explicit Euler at a tenth more than its largest stable step.
  bool unstable() {
    const Method euler = integrate::make_method("explicit_euler");
    const double limit = integrate::stability_of(euler, system_).step;
    if (!(limit > 0.0) || std::isinf(limit)) return true;
    const double step = 1.1 * limit;
    const auto exact = exact_response(plan_, system_, step);
    Comparison comparison(plan_, exact, 1, context_.stop);
    comparison.keep_values = true;
    const double end = std::min(60.0 * step, plan_.duration);
    (void)march(euler, system_, step, end, comparison);
    const auto rows = context_.sink.open(
        response_layout("unstable", {"exact", "explicit_euler"},
                        {{"step", fmt::format("{} s", step)}, {"stability_limit", fmt::format("{} s", limit)}}));
    for (std::size_t j = 0; j < comparison.values.size() && j + 1 < exact.size(); ++j) {
      std::vector<double> row{static_cast<double>(j + 1) * step, exact[j + 1], comparison.values[j]};
      append_with_differences(*rows, row);
    }
    return !context_.stop.load();
  }

  bool ladder() {
    const auto rows = context_.sink.open(
        {name_,
         "ladder",
         "step",
         {scalar("step", "s", "step"), {"max_error", "1", "largest |x - x(t)| / largest |x|", "method", plan_.names()}},
         {}});
    std::vector<double> limits;
    for (const Method& method : plan_.methods) limits.push_back(integrate::stability_of(method, system_).step);
    for (const double h : plan_.ladder) {
      // Fine runs are compared at a thousand times or more, not at every step.
      const long count = integrate::count_steps(plan_.duration, h).full;
      const long thinned = std::max(1L, count / 2000);
      const auto exact = exact_response(plan_, system_, h * static_cast<double>(thinned));
      std::vector<double> row{h};
      for (std::size_t i = 0; i < plan_.methods.size(); ++i) {
        Comparison comparison(plan_, exact, -thinned, context_.stop);
        const bool is_stable = h <= limits[i];
        if (is_stable && !march(plan_.methods[i], system_, h, static_cast<double>(count) * h, comparison)) return false;
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
        row.push_back(mode.spectral_radius);
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
    const auto table = tables_as_printed(system_, plan_.step);
    results::Block method = scalar("row", "", "row of the thesis's tables 2.2 to 2.4"),
                   convention = scalar("convention", "", "how the printed figure arises"),
                   unit = scalar("printed_in", "", "unit of the printed figures");
    unit.categories = {"fraction", "percent"};
    for (const PrintedRow& row : table) {
      method.categories.push_back(row.title);
      convention.categories.push_back(row.convention.empty() ? "as it should be" : row.convention);
    }
    const auto rows =
        context_.sink.open({name_,
                            "as_printed",
                            "row",
                            {method, scalar("first_step_error", "1", "error at the first step, as printed"),
                             scalar("indicator", "1", "indicator, as printed"), unit, convention},
                            {}});
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double index = static_cast<double>(i);
      const double row[] = {index, table[i].first_step_error, table[i].indicator, table[i].in_percent ? 1.0 : 0.0,
                            index};
      rows->append(row);
    }
  }

  double total() const { return total_; }

 private:
  results::TableLayout response_layout(const std::string& table, const std::vector<std::string>& labels,
                                       const std::vector<std::pair<std::string, std::string>>& attributes) const {
    return {name_,
            table,
            "time",
            {scalar("time", "s", "time"),
             {"position", "m", "displacement of " + plan_.observed.label, "method", labels},
             {"difference", "m", "difference from the exact displacement", "method", labels}},
            attributes};
  }

  /// @param row  time and positions, the exact one first; the differences are added to it
  static void append_with_differences(results::RowWriter& rows, std::vector<double>& row) {
    const std::size_t end = row.size();
    for (std::size_t i = 1; i < end; ++i) row.push_back(row[i] - row[1]);
    rows.append(row);
  }

  void advance(double steps) { context_.progress.advance(done_ += steps); }

  const std::string& name_;
  const Plan& plan_;
  const system::LocallyNonlinear& system_;
  RunContext& context_;
  std::vector<double> exact_;  ///< at the multiples of a quarter of the step
  double size_ = 0.0, total_ = 0.0, done_ = 0.0;
};

}  // namespace

void check_method_study(const std::string& name, const Location& where, const model::MethodStudyDescription& study,
                        const system::LocallyNonlinear& system, const numerics::Parameters& parameters) {
  (void)make_plan(name, where, study, system, parameters);
}

RunReport run_method_study(const std::string& name, const model::MethodStudyDescription& study,
                           const system::LocallyNonlinear& system, const numerics::Parameters& parameters,
                           RunContext& context) {
  const Plan plan = make_plan(name, {}, study, system, parameters);
  MethodStudy tables(name, plan, system, context);
  context.progress.begin(name, tables.total(), "steps");
  const bool finished =
      tables.errors() && tables.responses() && tables.unstable() && tables.ladder() && tables.stability();
  if (finished && study.as_printed) tables.as_printed();
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
