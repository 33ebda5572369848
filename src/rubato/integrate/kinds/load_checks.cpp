#include <rubato/integrate/kinds/load_checks.hpp>
#include <rubato/numerics/formula_jump.hpp>

#include <fmt/format.h>

namespace rubato::integrate {

void require_rows_to_reach(const std::vector<double>& times, const std::string& source, double end,
                           const std::string& remedies, const Location& where) {
  if (times.front() <= 0.0 && times.back() >= end * (1.0 - 1e-12)) return;
  throw InvalidInput(where, fmt::format("the table {} reaches from {} s to {} s, the analysis from 0 s to {} s; extend "
                                        "it, or say beyond = {} where it is used",
                                        source.empty() ? "of a load" : "\"" + source + "\"", times.front(),
                                        times.back(), end, remedies));
}

void refuse_jump(const std::string& what, const numerics::Formula& motion, double end, const Location& where) {
  if (const auto jump = numerics::first_jump(motion, 0, 0.0, end))
    throw InvalidInput(where, fmt::format("{} \"{}\" jumps at t = {} s, and nothing moves from one place to another "
                                          "at once; give it a time between",
                                          what, motion.text(), *jump));
}

}  // namespace rubato::integrate
