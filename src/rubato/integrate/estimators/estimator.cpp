#include <rubato/core/error.hpp>
#include <rubato/integrate/estimators/estimators.hpp>

#include <fmt/format.h>

namespace rubato::integrate {
namespace {

constexpr double least_tolerance = 1e-13;

void require_tolerance(double tolerance, bool is_relative) {
  if (!(tolerance > 0.0)) throw InvalidInput(fmt::format("the tolerance must be positive, got {}", tolerance));
  if (!(tolerance >= least_tolerance))
    throw InvalidInput(
        fmt::format("the tolerance {} is below the round-off of a march; the least is {}", tolerance, least_tolerance));
  if (is_relative && !(tolerance < 1.0))
    throw InvalidInput(fmt::format(
        "the tolerance {} is no error at all: it is relative to the size of the response and must be below 1",
        tolerance));
}

}  // namespace

std::unique_ptr<Estimator> make_estimator(const EstimatorKind& kind, const Method& method,
                                          const system::LocallyNonlinear& system, Stepper& stepper, double duration,
                                          const std::vector<numerics::StepBound>& bounds) {
  const auto* alpha = std::get_if<GeneralizedAlpha>(&method.formula);
  const auto* wilson = std::get_if<WilsonTheta>(&method.formula);
  if (const auto* embedded = std::get_if<Embedded>(&kind)) {
    require_tolerance(embedded->tolerance, true);
    return make_embedded(*embedded, method, system, stepper, duration, bounds);
  }
  if (!alpha && !wilson)
    throw InvalidInput(
        fmt::format("the estimator {} reads the acceleration that Newmark's relatives carry, and {} carries none; {}",
                    name_of(kind), method.name,
                    can_embed(method) ? "take the estimator embedded"
                                      : "take the method generalized_alpha, or for an explicit one dormand_prince"));
  const GeneralizedAlpha linear{0.0, 0.0, 1.0 / 6.0, 0.5};  // acceleration
  const auto* local = std::get_if<LocalError>(&kind);
  if (alpha || !local)
    return make_estimator(kind, alpha ? *alpha : linear, make_error_space(system, duration, bounds), system.start(),
                          duration);
  require_tolerance(local->tolerance, true);
  return make_local_error(*local, error_constants(*wilson), make_error_space(system, duration, bounds), duration);
}

std::unique_ptr<Estimator> make_estimator(const EstimatorKind& kind, const GeneralizedAlpha& method,
                                          std::unique_ptr<ErrorSpace> space, const system::State& start,
                                          double duration) {
  if (const auto* jump = std::get_if<InertiaJump>(&kind)) {
    require_tolerance(jump->tolerance, false);
    if (!is_of_second_order({"", method}))
      throw InvalidInput(
          "the estimator inertia_jump measures the error of methods of second order, and this one is of first; take "
          "the "
          "estimator local_error");
    return make_inertia_jump(*jump, method, std::move(space), start);
  }
  const auto* local = std::get_if<LocalError>(&kind);
  if (!local) throw InvalidInput("the estimator embedded compares two methods; take local_error or inertia_jump");
  require_tolerance(local->tolerance, true);
  return make_local_error(*local, error_constants(method), std::move(space), duration);
}

bool is_of_second_order(const Method& method) {
  const auto* alpha = std::get_if<GeneralizedAlpha>(&method.formula);
  return !alpha || error_constants(*alpha).order == 2;
}

EstimatorKind default_estimator(const Method& method, double tolerance, bool has_stops) {
  if (std::holds_alternative<GeneralizedAlpha>(method.formula)) return LocalError{tolerance};
  if (std::holds_alternative<WilsonTheta>(method.formula) && has_stops) return LocalError{tolerance};
  return Embedded{tolerance};
}

std::string name_of(const EstimatorKind& kind) {
  static const char* const names[] = {"inertia_jump", "local_error", "embedded"};
  return names[kind.index()];
}

}  // namespace rubato::integrate
