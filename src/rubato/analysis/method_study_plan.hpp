#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/integrate/method.hpp>
#include <rubato/model/description.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// A method study with all its values: what the description says, evaluated and found possible.
struct MethodStudyPlan {
  std::vector<integrate::Method> methods;
  std::vector<int> orders;            ///< of the methods
  double step = 0.0, duration = 0.0;  ///< [s]
  std::vector<double> ladder;         ///< falling [s]
  Observed observed;
  bool as_printed = false;            ///< the thesis's tables too
  std::vector<std::string> left_out;  ///< unstable at the step, where no methods were listed

  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& method : methods) list.push_back(method.name);
    return list;
  }
};

/// What a march with equal steps from the start of a system needs; of the method `exact` a step of 0.
integrate::MarchPlan march_plan_of(const integrate::Method& method, const integrate::SystemKind& kind, double step,
                                   double duration);

/// Throws InvalidInput for a model with sliders or loads that are not harmonic, for values out of their range, and for
/// a listed method that cannot take part: `exact`, or one beyond its stability limit at the step.
MethodStudyPlan plan_method_study(const std::string& name, const Location& where,
                                  const model::MethodStudyDescription& study, const integrate::SystemKind& kind,
                                  const numerics::Parameters& parameters);

}  // namespace rubato::analysis
