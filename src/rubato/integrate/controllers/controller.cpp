#include <rubato/integrate/controllers/controller.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

struct Deciding {
  const ScaledError& tried;
  const ControlHistory& history;

  Decision operator()(const FixedStep&) const { return {true, tried.step}; }

  Decision operator()(const CardonaCassano&) const {
    const double e = tried.error, h = tried.step;
    if (!(e <= 1.0)) return {false, 0.5 * h};
    if (e > 0.5) return {true, h * std::pow(0.5 / e, 1.0 / tried.exponent)};
    if (e >= 1.0 / 16.0) return {true, h};
    return {true, 2.0 * h};
  }

  Decision operator()(const PiControl& pi) const {
    const double e = tried.error, h = tried.step;
    if (!(e <= 1.0)) {
      const double factor = std::isfinite(e) ? pi.safety * std::pow(e, -1.0 / tried.exponent) : 0.0;
      return {false, h * std::max(pi.shrink_most, factor)};
    }
    const double p = tried.exponent;
    const double now = std::max(e, 1e-10);  // an error of zero asks for the largest growth, not for an infinite one
    double factor = pi.safety * std::pow(now, -1.0 / p);
    if (history.last_error > 0.0) {
      const double density = history.last_error / now * std::pow(h / history.last_step, p);
      factor *= std::pow(std::min(1.0, density), pi.trend / p);
    }
    if (factor >= pi.safety * pi.safety && factor < pi.keep) return {true, h};
    return {true, h * std::clamp(factor, pi.shrink_most, history.was_rejected ? 1.0 : pi.grow_most)};
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
