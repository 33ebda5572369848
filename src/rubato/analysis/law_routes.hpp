#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>

#include <optional>
#include <span>
#include <string>

// Which route takes which law: the one table that analyses refuse by, and that `rubato laws` prints.
namespace rubato::analysis {

/// How an analysis finds its answers.
enum class Route {
  steps,        ///< transients by a method with a step
  exact,        ///< transients by the method `exact`
  equilibrium,  ///< statics
  modes,
  periodic,          ///< frequency responses
  harmonic_balance,  ///< likewise
  time_marching,     ///< likewise
  damper_curve,
  method_study
};
inline constexpr int route_count = 9;

/// What a model may have that is not linear.
using Element = integrate::NonlinearPart::Family;
inline constexpr int element_count = 7;

/// What a route does with an element.
struct Handling {
  const char* how;      ///< in a word or two; "" where it refuses
  const char* instead;  ///< what to take where it refuses; "" where nothing does
};
const Handling& handling(Element element, Route route);

/// For tables: "harmonic balance".
const char* name_of(Route route);
/// For messages: "the solver harmonic_balance".
const char* title_of(Route route);

/// Why a route cannot take the parts of a model, and what can; nothing where it can.
std::optional<std::string> refusal(Route route, const integrate::SystemKind& kind);

/// Why no steady response follows from the laws of a model: one depends on time, or never repeats. Nothing where all
/// are fit for one.
std::optional<std::string> refusal_of_steady_response(const integrate::SystemKind& kind);

}  // namespace rubato::analysis
