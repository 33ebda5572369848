#pragma once

#include <rubato/analysis/method_study_plan.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>

namespace rubato::analysis {

/// Compares methods on a linear model under harmonic loads with its exact response. Tables:
///
///   main        of each method: its order; error of the first step |x1 - x(h)|/|x(h)|; mean and largest error over the
///   run,
///               relative to the largest |x|; the order observed between h/2 and h/4
///   ladder      largest error against the step, down to round-off
///   response    displacement of each method beside the exact one
///   unstable    explicit Euler beyond its stability limit
///   stability   spectral radius, period elongation and numerical damping over omega h
///   as_printed  Tables 2.2 to 2.4 of the thesis, on request (see tables_as_printed)
///
/// Methods beyond their stability limit at the given step are left out where none were listed.
RunReport run_method_study(const std::string& name, const MethodStudyPlan& plan, const integrate::SystemKind& kind,
                           RunContext& context);

}  // namespace rubato::analysis
