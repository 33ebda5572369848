#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/model/description.hpp>
#include <rubato/system/locally_nonlinear.hpp>

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
RunReport run_method_study(const std::string& name, const model::MethodStudyDescription& study,
                           const system::LocallyNonlinear& system, const numerics::Parameters& parameters,
                           RunContext& context);

/// Throws InvalidInput for a model with sliders or loads that are not harmonic, and for values out of their range.
void check_method_study(const std::string& name, const Location& where, const model::MethodStudyDescription& study,
                        const system::LocallyNonlinear& system, const numerics::Parameters& parameters);

}  // namespace rubato::analysis
