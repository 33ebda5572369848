#include <rubato/integrate/controllers/controller.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

struct Deciding {
  const ScaledError& tried;
  const ControlHistory& history;

  Decision operator()(const FixedStep&) const { return {true, tried.step, 0.0}; }

  Decision operator()(const CardonaCassano&) const {
    const double e = tried.error, h = tried.step;
    if (!(e <= 1.0)) return {false, 0.5 * h, 0.0};
    if (e > 0.5) return {true, h * std::pow(0.5 / e, 1.0 / tried.exponent), 0.0};
    if (e >= 1.0 / 16.0) return {true, h, 0.0};
    return {true, 2.0 * h, 0.0};
  }

  Decision operator()(const PiControl& pi) const {
    const double e = tried.error, h = tried.step, p = tried.exponent;
    const auto factor_to = [p](double ratio) { return std::pow(ratio, 1.0 / p); };
    if (!(e <= 1.0)) {
      const double factor = std::isfinite(e) ? factor_to(pi.aim / e) : 0.0;
      return {false, h * std::max(pi.shrink_most, factor), 0.0};
    }
    const double now = std::max(e, 1e-10);  // an error of zero asks for the largest growth, not for an infinite one
    // Ratios of errors, of which lengths are the roots: most steps stay as they are, and need none.
    double ratio = pi.aim / now;
    if (history.last_error > 0.0) {
      const double lengths = h == history.last_step ? 1.0 : std::pow(h / history.last_step, p);
      const double density = history.last_error / now * lengths;
      if (density < 1.0) ratio *= std::pow(density, pi.trend);
    }
    if (ratio >= pi.aim * pi.aim && ratio < pi.aim / pi.least) return {true, h, 0.0};
    const double factor = factor_to(ratio);
    const double next = h * std::clamp(factor, pi.shrink_most, history.was_rejected ? 1.0 : pi.grow_most);
    if (ratio < 1.0 || ratio >= pi.aim / pi.at_once) return {true, next, 0.0};
    const double forgone = history.forgone + 1.0 - 1.0 / factor;
    return forgone < pi.patience ? Decision{true, h, forgone} : Decision{true, next, 0.0};
  }
};

}  // namespace

Decision decide(const Controller& controller, const ScaledError& tried, const ControlHistory& history) {
  return std::visit(Deciding{tried, history}, controller);
}

std::string name_of(const Controller& controller) {
  static const char* const names[] = {"fixed", "cardona_cassano", "pi"};
  return names[controller.index()];
}

}  // namespace rubato::integrate
